// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/critical_load.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>

#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/critical_ratio.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/number_unknowns.hpp"
#include "equidem/statics/solver_choice.hpp"

namespace equidem {
namespace {

/// K + lambda K_g with the motions held that nothing resists.
class LoadPencil final : public StiffnessPencil {
 public:
  LoadPencil(const Assembly& assembly, const ContactSprings& springs, std::span<const Support> supports,
             const CriticalLoadOptions& options)
      : StiffnessPencil(
            assembly, number_unknowns(assembly, springs, derive_effects(assembly, springs, options.rotation), supports),
            &springs, 0.1),
        springs_(springs),
        unstressed_(springs.with_prestress({})),
        weightless_(springs.changed([](SpringConstants) {
                             return SpringConstants{0, 0};
                           })
                        .with_bending({})) {
    check_memory(estimate(*symbolic_, unknowns_, true), options.memory_limit);
  }

  struct Inertia {
    std::int64_t negative = 0, zero = 0;
  };
  Inertia inertia(double factor) {
    const FactorReport report = factorize(factor)->report();
    return {report.negative_pivots.value(), report.zero_pivots};
  }
  bool stable(double factor) {
    const Inertia counted = inertia(factor);
    return counted.negative == 0 && counted.zero == 0;
  }

  [[nodiscard]] std::vector<DiscMotion> motions_of(const std::vector<double>& x) const {
    std::vector<DiscMotion> motions = disc_motions(unknowns_, x);
    double largest = 0;
    for (const DiscMotion& motion : motions) largest = std::max(largest, norm(motion.u));
    if (largest == 0) return motions;
    for (DiscMotion& motion : motions) motion = {motion.u / largest, motion.theta / largest};
    return motions;
  }

 private:
  [[nodiscard]] StiffnessMatrix stiffness(double factor) const override {
    return assemble_stiffness(assembly_, graph_, springs_.with_prestress(springs_.scaled_prestress(factor)), unknowns_);
  }
  [[nodiscard]] StiffnessMatrix slope(const StiffnessMatrix&) const override {
    return assemble_stiffness(assembly_, graph_, weightless_, unknowns_);
  }
  /// Energies are summed over contacts: in x.K x of a slender assembly the digits of its stretch would be lost.
  [[nodiscard]] double quotient(const StiffnessMatrix&, const StiffnessMatrix&,
                                const std::vector<double>& x) const override {
    const std::vector<DiscMotion> motions = disc_motions(unknowns_, x);
    return -elastic_energy(assembly_, unstressed_, motions) / elastic_energy(assembly_, weightless_, motions);
  }
  [[nodiscard]] bool settled(double value, double before) const override {
    return std::abs(value - before) <= 1e-12 * std::abs(value);
  }

  const ContactSprings& springs_;
  ContactSprings unstressed_, weightless_;  ///< springs without forces at rest, and these without springs
};

/// True where factorizations on both sides of the value, as close as round-off allows, have it between them: sets
/// `width`.
bool prove(LoadPencil& pencil, double value, CriticalLoad& result) {
  constexpr double closest = 1e-11, farthest = 1e-4, widen = 10;  // relative
  for (double way = closest; way <= farthest; way *= widen) {
    if (!pencil.stable(value * (1 - way)) || pencil.stable(value * (1 + way))) continue;
    result.width = 2 * way;
    return true;
  }
  return false;
}

void search(LoadPencil& pencil, double largest, CriticalLoad& result) {
  double safe = 0, unstable = 1;
  for (; pencil.stable(unstable); unstable *= 4) {
    safe = result.searched = unstable;
    if (4 * unstable > largest) {
      result.factor = std::numeric_limits<double>::infinity();
      return;
    }
  }
  result.searched = unstable;
  constexpr double near = 0.1, narrow = 1e-13;  // widths of the bracket over its place; from the former on
                                                // inverse iteration may get there
  for (int attempts = 0; safe == 0 || unstable - safe > narrow * unstable;) {
    if (safe > 0 && unstable - safe < near * safe && attempts < 4) {
      ++attempts;
      std::vector<double> x = pencil.random_motion();
      const double value = pencil.nearest(safe, x);
      if (value > safe && value < unstable && prove(pencil, value, result)) {
        result.factor = value;
        result.motion = pencil.motions_of(x);
        return;
      }
    }
    const double at = safe > 0 ? 0.5 * (safe + unstable) : unstable / 64;
    if (at < std::numeric_limits<double>::min()) {
      result.sought = false;
      result.why = "no factor above 0 is stable: the springs alone resist some motion by no more than round-off";
      return;
    }
    (pencil.stable(at) ? safe : unstable) = at;
  }
  result.factor = 0.5 * (safe + unstable);
  result.width = (unstable - safe) / unstable;
}

}  // namespace

CriticalLoad find_critical_load(const Assembly& assembly, const ContactSprings& springs,
                                std::span<const Support> supports, const CriticalLoadOptions& options) {
  if (!(options.largest > 0))
    bad_input(fmt::format("largest = {}", options.largest), "the search ends at a factor above 0", "Correct it");
  check(assembly);
  CriticalLoad result;
  const auto not_sought = [&](const char* why) {
    result.sought = false;
    result.why = why;
    return result;
  };
  if (!springs.prestressed()) return not_sought("no forces at rest count");
  LoadPencil pencil(assembly, springs, supports, options);
  const auto at_zero = pencil.inertia(0);
  if (at_zero.negative > 0) return not_sought("the springs alone are unstable (kT < 0)");
  if (at_zero.zero > 0) return not_sought("the springs alone leave motions that only the forces at rest resist");
  const double share = largest_prestress(assembly, springs);
  search(pencil, share > 0 ? options.largest / share : options.largest, result);
  result.factorizations = pencil.factorizations();
  return result;
}

}  // namespace equidem
