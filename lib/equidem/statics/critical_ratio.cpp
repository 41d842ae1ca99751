// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/critical_ratio.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "equidem/contact/effects.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/statics/solver_choice.hpp"

namespace equidem {
StiffnessPencil::StiffnessPencil(const Assembly& assembly, DegreesOfFreedom unknowns, const ContactSprings* held,
                                 double threshold)
    : assembly_(assembly), graph_(assembly), unknowns_(std::move(unknowns)), threshold_(threshold) {
  if (held != nullptr) hold_free_motions(assembly, graph_, *held, unknowns_);
  symbolic_ = std::make_shared<const SymbolicFactor>(analyze(dissect(assembly, graph_), graph_, unknowns_.per_disc));
}

void StiffnessPencil::clear_held(std::vector<double>& x) const {
  for (std::size_t k = 0; k < x.size(); ++k)
    if (unknowns_.held[k] != 0) x[k] = 0;
}

std::vector<double> StiffnessPencil::product(const StiffnessMatrix& m, const std::vector<double>& x) const {
  std::vector<double> y(x.size());
  multiply(m, assembly_, graph_, x, y);
  clear_held(y);
  return y;
}

std::vector<double> StiffnessPencil::random_motion() const {
  Random random(1);
  std::vector<double> x(unknowns_.held.size());
  for (double& value : x) value = random.uniform(-1, 1);
  clear_held(x);
  return x;
}

std::unique_ptr<Factorization> StiffnessPencil::factorize(double s) {
  stop_if_interrupted();
  ++factorizations_;
  const StiffnessMatrix matrix = stiffness(s);
  return multifrontal_ldlt(symbolic_, MatrixOnGraph{matrix, assembly_, graph_}, {.threshold = threshold_});
}

double StiffnessPencil::quotient(const StiffnessMatrix& a, const StiffnessMatrix& b,
                                 const std::vector<double>& x) const {
  return -dot(x, product(a, x)) / dot(x, product(b, x));
}

double StiffnessPencil::nearest(double shift, std::vector<double>& x) {
  const auto factor = factorize(shift);
  const StiffnessMatrix a = stiffness(0), b = slope(a);
  double before = std::numeric_limits<double>::quiet_NaN();
  constexpr int most = 60;
  for (int k = 0; k < most; ++k) {
    std::vector<double> b_x = product(b, x);
    factor->solve(b_x, 1);
    clear_held(b_x);
    const double size = std::sqrt(dot(b_x, b_x));
    if (!is_positive(size)) break;
    for (std::size_t c = 0; c < x.size(); ++c) x[c] = b_x[c] / size;
    const double value = quotient(a, b, x);
    if (settled(value, before)) return value;
    before = value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

namespace {

void check(const CriticalRatioOptions& options) {
  if (options.tolerance >= 1e-12 && options.lowest >= -1 && options.lowest < -options.tolerance) return;
  bad_input(
      fmt::format("the search for the critical ratio from {} with the tolerance {}", options.lowest, options.tolerance),
      "it needs a tolerance of at least 1e-12 and a start in [-1, -tolerance)", "Correct them");
}

/// kT = ratio kN, except where the given springs have kT = 0.
ContactSprings with_ratio(const ContactSprings& springs, double ratio) {
  const bool all = !springs.any_tangential();
  return springs.changed([&](SpringConstants k) { return SpringConstants{k.kN, all || k.kT != 0 ? ratio * k.kN : 0}; });
}

/// K_N + r K_T.
class RatioPencil final : public StiffnessPencil {
 public:
  RatioPencil(const Assembly& assembly, const ContactSprings& springs, std::span<const Support> supports,
              const CriticalRatioOptions& options)
      : RatioPencil(assembly, springs, with_ratio(springs, 1), supports, options) {}

  [[nodiscard]] std::int64_t mechanisms() const { return mechanisms_; }
  bool stable(double ratio) {
    const FactorReport report = factorize(ratio)->report();
    return report.zero_pivots == mechanisms_ && report.negative_pivots == negative_rotations_;
  }

  /// Whether one motion alone loses its stiffness within `reach` of r.
  bool simple(double r, double reach) {
    const auto negative = [&](double at) { return factorize(at)->report().negative_pivots.value_or(0); };
    return negative(r - reach) == negative(r + reach) + 1;
  }

  [[nodiscard]] std::vector<double> by_kN(double r, const std::vector<DiscMotion>& motion) const {
    const ContactSprings one = with_ratio(springs_, 1);
    std::vector<double> found(assembly_.contacts.size());
    double slips = 0;
    for (std::size_t c = 0; c < found.size(); ++c) {
      const Contact& contact = assembly_.contacts[c];
      const bool opposite = (options_.antiperiodic_x && contact.shift_x % 2 != 0) !=
                            (options_.antiperiodic_y && contact.shift_y % 2 != 0);
      const double sign = opposite ? -1 : 1;
      const DiscMotion& j = motion[contact.j];
      const ContactDeformation of =
          deformation(frame_of(assembly_, c), motion[contact.i], DiscMotion{sign * j.u, sign * j.theta});
      const double slip = one[c].kT != 0 ? of.tangential * of.tangential : 0;
      found[c] = of.normal * of.normal + r * slip;
      slips += one[c].kN * slip;
    }
    for (double& value : found) value /= -slips;
    return found;
  }

  [[nodiscard]] std::vector<DiscMotion> motions_of(const std::vector<double>& x) const {
    return disc_motions(unknowns_, x);
  }

 private:
  /// A wave that changes sign from period to period is no rigid motion, but gears may still turn.
  RatioPencil(const Assembly& assembly, const ContactSprings& springs, const ContactSprings& one,
              std::span<const Support> supports, const CriticalRatioOptions& options)
      : StiffnessPencil(
            assembly,
            number_unknowns(assembly, one,
                            derive_effects(assembly, one, options.rotation ? Rotation::free : Rotation::restrained),
                            supports),
            options.antiperiodic_x || options.antiperiodic_y ? nullptr : &one, IndefiniteOptions().threshold),
        springs_(springs),
        options_(options) {
    mechanisms_ = factorize(1)->report().zero_pivots;
    count_rotations();
  }

  [[nodiscard]] StiffnessMatrix slope(const StiffnessMatrix& normal) const override {
    StiffnessMatrix tangential = stiffness(1);
    for (std::size_t k = 0; k < normal.diagonal.size(); ++k) tangential.diagonal[k] -= normal.diagonal[k];
    for (std::size_t k = 0; k < normal.coupling.size(); ++k) tangential.coupling[k] -= normal.coupling[k];
    return tangential;
  }
  [[nodiscard]] bool settled(double value, double before) const override {
    return std::abs(value - before) <= 0.01 * options_.tolerance;
  }
  [[nodiscard]] StiffnessMatrix stiffness(double ratio) const override {
    return assemble_stiffness(assembly_, graph_, with_ratio(springs_, ratio), unknowns_,
                              {options_.antiperiodic_x, options_.antiperiodic_y});
  }

  /// The rotational block is r times that at r = 1: one negative eigenvalue for each rotation that is resisted.
  void count_rotations() {
    const ContactSprings springs = with_ratio(springs_, -1);
    const StiffnessMatrix matrix = stiffness(-1);
    const MatrixOnGraph k{matrix, assembly_, graph_};
    negative_rotations_ = negative_rotations({k, springs, unknowns_, symbolic_});
    if (negative_rotations_) return;
    computation_failed("some discs can turn without any slip, and no translation comes with it",
                       "the rotations they leave undecided hide the sign of the others",
                       "Hold the rotation of one disc of each such group, or restrain rotation");
  }

  const ContactSprings& springs_;
  const CriticalRatioOptions& options_;
  std::int64_t mechanisms_ = 0;
  std::optional<std::int64_t> negative_rotations_;
};

/// \param x the eigenvector that belongs to the value; empty where there is none
double search(RatioPencil& pencil, const CriticalRatioOptions& options, std::vector<double>& x) {
  double unstable = options.lowest, safe = -options.tolerance;
  if (!pencil.stable(safe)) return 0;
  if (pencil.stable(unstable)) return -std::numeric_limits<double>::infinity();
  const auto shrink = [&](double at) {
    if (at <= unstable || at >= safe) return;
    (pencil.stable(at) ? safe : unstable) = at;
  };
  x = pencil.random_motion();
  constexpr double try_below = 0.1;  // bracket over distance from 0: from here on inverse iteration may get there
  for (int attempts = 0; safe - unstable > options.tolerance;) {
    if (pencil.mechanisms() == 0 && attempts < 4 && safe - unstable < try_below * std::abs(safe)) {
      ++attempts;
      const double value = pencil.nearest(safe, x);
      if (value < safe && value > unstable) {
        const double before = safe - unstable;
        shrink(value + 0.4 * options.tolerance);
        shrink(value - 0.4 * options.tolerance);
        if (safe - unstable <= options.tolerance) return value;
        if (safe - unstable < 0.5 * before) continue;
      }
    }
    shrink(0.5 * (safe + unstable));
    shrink(0.5 * (safe + unstable));
  }
  x.clear();
  return 0.5 * (safe + unstable);
}

}  // namespace

CriticalRatio find_critical_ratio(const Assembly& assembly, const ContactSprings& springs,
                                  std::span<const Support> supports, const CriticalRatioOptions& options) {
  check(options);
  equidem::check(assembly);
  if (!on_lines_of_centres(assembly)) {
    bad_input("the critical kT/kN is asked of contacts that lie off the lines of centres",
              "there normal springs resist rotations too, so that the stiffness without them is not linear in kT/kN",
              "Ask for it of discs only; for other bodies examine the mechanisms");
  }
  if (springs.bends()) {
    bad_input("the critical kT/kN is asked of contacts with bending springs",
              "they resist rotations too, so that the stiffness without them is not linear in kT/kN",
              "Ask for it without bending springs; with them and kT >= 0 nothing loses stability");
  }
  RatioPencil pencil(assembly, springs, supports, options);
  CriticalRatio result;
  std::vector<double> x;
  result.ratio = search(pencil, options, x);
  if (!x.empty()) result.motion = pencil.motions_of(x);
  constexpr double alike = 1e-6;
  if (options.derivatives && !x.empty() && result.ratio < -2 * alike && pencil.simple(result.ratio, alike))
    result.by_kN = pencil.by_kN(result.ratio, result.motion);
  result.mechanisms = pencil.mechanisms();
  result.factorizations = pencil.factorizations();
  return result;
}

}  // namespace equidem
