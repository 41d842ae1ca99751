// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/laws/five_case_map.hpp"

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem::laws {

void FiveCaseMap::check_range(double a, double restitution) {
  if (restitution * restitution * (1 + a) >= a) return;
  bad_input(fmt::format("the law five_case_map is asked for restitution {:.6g} at dimensionless stiffness a = {:.6g}",
                        restitution, a),
            fmt::format("its first step has an answer only where e² >= a/(1 + a), that is e >= {:.6g}",
                        std::sqrt(a / (1 + a))),
            fmt::format("Choose energy_map, which takes any restitution, or an a of at most {:.6g}",
                        restitution * restitution / ((1 - restitution) * (1 + restitution))));
}

}  // namespace equidem::laws
