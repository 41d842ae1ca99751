// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/body_inertia.hpp"

#include "equidem/core/error.hpp"

namespace equidem {

std::vector<Inertia> inertia_of(const Assembly& assembly, double density, Body body) {
  std::vector<Inertia> all = inertia_of(assembly.radii, density, body);
  if (!assembly.sections.empty() && body != Body::disc) {
    bad_input("the bodies of the assembly are set to be spheres", "its file gives their cross-sections",
              "Write body = \"disc\", or remove \"sections\" from the file");
  }
  for (std::size_t d = 0; d < assembly.sections.size(); ++d)
    all[d] = {density * assembly.sections[d].area, density * assembly.sections[d].polar_moment};
  return all;
}

}  // namespace equidem
