// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/critical_ratio.hpp"

#include <limits>
#include <memory>

#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/multifrontal_ldlt.hpp"
#include "equidem/statics/rigidity.hpp"
#include "equidem/statics/solver_choice.hpp"

namespace equidem {

double critical_ratio(const Assembly& assembly, std::span<const Support> supports,
                      const CriticalRatioOptions& options) {
  if (!(options.tolerance > 0) || !(options.lowest >= -1 && options.lowest < -options.tolerance)) {
    bad_input(
        format("the search for the critical ratio from {} with the tolerance {}", options.lowest, options.tolerance),
        "it needs a tolerance > 0 and a start in [-1, -tolerance)", "Correct them");
  }
  check(assembly);
  const ContactGraph graph(assembly);
  const ContactSprings positive(SpringConstants{1, 1});
  const DegreesOfFreedom unknowns =
      number_unknowns(assembly, positive, derive_effects(positive, Rotation::free), supports);
  check_rigidity(assembly, graph, positive, unknowns);
  const auto symbolic =
      std::make_shared<const SymbolicFactor>(analyze(dissect(assembly, graph), graph, unknowns.per_disc));
  const auto stable = [&](double ratio) {
    const ContactSprings springs(SpringConstants{1, ratio});
    const StiffnessMatrix matrix = assemble_stiffness(assembly, graph, springs, unknowns);
    const MatrixOnGraph k{matrix, assembly, graph};
    const auto report = multifrontal_ldlt(symbolic, k)->report();
    return report.zero_pivots == 0 && report.negative_pivots == negative_rotations({k, springs, unknowns, symbolic});
  };
  double unstable = options.lowest, safe = -options.tolerance;
  if (!stable(safe)) return 0;
  if (stable(unstable)) return -std::numeric_limits<double>::infinity();
  while (safe - unstable > options.tolerance) {
    const double middle = 0.5 * (safe + unstable);
    (stable(middle) ? safe : unstable) = middle;
  }
  return 0.5 * (safe + unstable);
}

}  // namespace equidem
