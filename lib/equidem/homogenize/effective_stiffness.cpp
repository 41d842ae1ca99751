// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/effective_stiffness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/strain_stiffness.hpp"
#include "equidem/homogenize/traction_stiffness.hpp"

namespace equidem {
namespace {

/// A mean strain that costs nothing has no modulus.
void judge(EffectiveStiffness& result) {
  const StiffnessEigen eigen = eigenstrains(result.stiffness);
  const double largest = std::max(std::abs(eigen.values[0]), std::abs(eigen.values[2]));
  constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
  result.error_bound += rounding * largest;
  constexpr double nothing = 1e-13;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(eigen.values[k]) > nothing * largest + 2 * result.error_bound) continue;
    const auto& e = eigen.strains[k];
    bad_input("the network is floppy",
              format("the mean strain (xx {:.3f}, yy {:.3f}, shear {:.3f}) costs no energy beyond rounding", e[0], e[1],
                     e[2]),
              "A modulus would say nothing of it. Add contacts, or give the contacts tangential springs (kT > 0)");
  }
}

}  // namespace

EffectiveStiffness effective_stiffness(const Assembly& assembly, const ContactSprings& springs,
                                       const HomogenizeOptions& options) {
  check(assembly);
  check(options.solver);
  if (assembly.contacts.empty()) {
    bad_input("the assembly has no contacts", "nothing resists its deformation", "Give it contacts");
  }
  if (options.boundary == Boundary::periodic && !assembly.periodic()) {
    bad_input("the boundary is periodic but the assembly is not", "it has no images to be joined to",
              "Use boundary = \"displacement\" or \"traction\", or a periodic assembly");
  }
  EffectiveStiffness result;
  result.boundary = options.boundary;
  result.effects = derive_effects(springs, options.rotation);
  result.area = assembly.area();
  if (options.boundary == Boundary::traction) {
    solve_tractions(assembly, springs, options, result);
  } else {
    solve_strains(assembly, springs, options, result);
  }
  judge(result);
  return result;
}

}  // namespace equidem
