// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/critical_ratio.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>

#include "equidem/contact/effects.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/ordered_sums.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/multifrontal/multifrontal_ldlt.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/statics/solver_choice.hpp"

namespace equidem {
namespace {

void clear_held(const DegreesOfFreedom& unknowns, std::vector<double>& x) {
  for (std::size_t k = 0; k < x.size(); ++k)
    if (unknowns.held[k] != 0) x[k] = 0;
}

}  // namespace

std::vector<double> random_motion(const DegreesOfFreedom& unknowns) {
  Random random(1);
  std::vector<double> x(unknowns.held.size());
  for (double& value : x) value = random.uniform(-1, 1);
  clear_held(unknowns, x);
  return x;
}

double rayleigh_quotient(const Assembly& assembly, const ContactGraph& graph, const DegreesOfFreedom& unknowns,
                         const StiffnessMatrix& a, const StiffnessMatrix& b, const std::vector<double>& x) {
  std::vector<double> a_x(x.size()), b_x(x.size());
  multiply(a, assembly, graph, x, a_x);
  clear_held(unknowns, a_x);
  multiply(b, assembly, graph, x, b_x);
  clear_held(unknowns, b_x);
  return -dot(x, a_x) / dot(x, b_x);
}

double InverseIteration::run(std::vector<double>& x) const {
  std::vector<double> b_x(x.size());
  double before = std::numeric_limits<double>::quiet_NaN();
  constexpr int most = 60;
  for (int k = 0; k < most; ++k) {
    multiply(b, assembly, graph, x, b_x);
    clear_held(unknowns, b_x);
    shifted.solve(b_x, 1);
    clear_held(unknowns, b_x);
    const double size = std::sqrt(dot(b_x, b_x));
    if (!is_positive(size)) break;
    for (std::size_t c = 0; c < x.size(); ++c) x[c] = b_x[c] / size;
    const double value = quotient(x);
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

/// The stiffness matrix as a function of the ratio.
class RatioPencil {
 public:
  RatioPencil(const Assembly& assembly, const ContactSprings& springs, std::span<const Support> supports,
              const CriticalRatioOptions& options)
      : assembly_(assembly), springs_(springs), options_(options), graph_(assembly) {
    const ContactSprings one = with_ratio(springs, 1);
    unknowns_ = number_unknowns(assembly, one,
                                derive_effects(assembly, one, options.rotation ? Rotation::free : Rotation::restrained),
                                supports);
    // A wave that changes sign from period to period is no rigid motion, but gears may still turn.
    if (!options.antiperiodic_x && !options.antiperiodic_y) hold_free_motions(assembly, graph_, one, unknowns_);
    symbolic_ = std::make_shared<const SymbolicFactor>(analyze(dissect(assembly, graph_), graph_, unknowns_.per_disc));
    mechanisms_ = factorize(1)->report().zero_pivots;
    count_rotations();
  }

  [[nodiscard]] std::int64_t mechanisms() const { return mechanisms_; }
  [[nodiscard]] std::int64_t factorizations() const { return factorizations_; }

  bool stable(double ratio) {
    const FactorReport report = factorize(ratio)->report();
    return report.zero_pivots == mechanisms_ && report.negative_pivots == negative_rotations_;
  }

  /// The eigenvalue r < 0 of K_N x = -r K_T x nearest to `shift`, by inverse iteration from x; NaN where it does not
  /// settle.
  double nearest(double shift, std::vector<double>& x) {
    const auto factor = factorize(shift);
    const StiffnessMatrix normal = stiffness(0), tangential = difference(stiffness(1), normal);
    const InverseIteration iteration{
        assembly_,
        graph_,
        unknowns_,
        tangential,
        *factor,
        [&](const auto& y) { return rayleigh_quotient(assembly_, graph_, unknowns_, normal, tangential, y); },
        [&](double value, double before) { return std::abs(value - before) <= 0.01 * options_.tolerance; }};
    return iteration.run(x);
  }

  [[nodiscard]] std::vector<DiscMotion> motions_of(const std::vector<double>& x) const {
    return disc_motions(unknowns_, x);
  }
  [[nodiscard]] std::vector<double> first_motion() const { return random_motion(unknowns_); }

 private:
  [[nodiscard]] StiffnessMatrix stiffness(double ratio) const {
    const ContactSprings springs = with_ratio(springs_, ratio);
    StiffnessMatrix matrix = assemble_stiffness(assembly_, graph_, springs, unknowns_);
    if (options_.antiperiodic_x || options_.antiperiodic_y) change_signs(springs, matrix);
    return matrix;
  }

  /// The phase exp(i q.L) = -1 of a contact that leads into the next period, or an odd number of periods on.
  void change_signs(const ContactSprings& springs, StiffnessMatrix& matrix) const {
    const int b = matrix.block;
    for (std::size_t c = 0; c < assembly_.contacts.size(); ++c) {
      const Contact& contact = assembly_.contacts[c];
      const bool odd = (options_.antiperiodic_x && contact.shift_x % 2 != 0) !=
                       (options_.antiperiodic_y && contact.shift_y % 2 != 0);
      if (!odd) continue;
      double* coupling = &matrix.coupling[c * b * b];
      for (int k = 0; k < b * b; ++k) coupling[k] = -coupling[k];
      if (contact.i == contact.j) subtract_self_contact(c, springs[c], matrix);
    }
  }
  /// From (g_i + g_j)(g_i + g_j)^T to (g_i - g_j)(g_i - g_j)^T.
  void subtract_self_contact(std::size_t index, const SpringConstants& k, StiffnessMatrix& matrix) const {
    const Contact& contact = assembly_.contacts[index];
    const DeformationGradient g = deformation_gradient(frame_of(assembly_, index), unknowns_.rotation_scale);
    const int b = matrix.block;
    double* diagonal = &matrix.diagonal[static_cast<std::size_t>(contact.i) * b * b];
    for (int r = 0; r < b; ++r) {
      for (int c = 0; c < b; ++c) {
        const std::size_t component = static_cast<std::size_t>(contact.i) * b;
        if (unknowns_.held[component + r] != 0 || unknowns_.held[component + c] != 0) continue;
        diagonal[r * b + c] -=
            2 * (k.kN * (g.normal_i[r] * g.normal_j[c] + g.normal_j[r] * g.normal_i[c]) +
                 k.kT * (g.tangential_i[r] * g.tangential_j[c] + g.tangential_j[r] * g.tangential_i[c]));
      }
    }
  }

  [[nodiscard]] static StiffnessMatrix difference(StiffnessMatrix a, const StiffnessMatrix& b) {
    for (std::size_t k = 0; k < a.diagonal.size(); ++k) a.diagonal[k] -= b.diagonal[k];
    for (std::size_t k = 0; k < a.coupling.size(); ++k) a.coupling[k] -= b.coupling[k];
    return a;
  }

  std::unique_ptr<Factorization> factorize(double ratio) {
    stop_if_interrupted();
    ++factorizations_;
    const StiffnessMatrix matrix = stiffness(ratio);
    return multifrontal_ldlt(symbolic_, MatrixOnGraph{matrix, assembly_, graph_});
  }

  /// The rotational block is r times that at r = 1: one negative eigenvalue for each rotation that is resisted.
  void count_rotations() {
    const ContactSprings springs = with_ratio(springs_, -1);
    const StiffnessMatrix matrix = stiffness(-1);
    const MatrixOnGraph k{matrix, assembly_, graph_};
    negative_rotations_ = negative_rotations({k, springs, unknowns_, symbolic_});
    if (negative_rotations_ >= 0) return;
    computation_failed("some discs can turn without any slip, and no translation comes with it",
                       "the rotations they leave undecided hide the sign of the others",
                       "Hold the rotation of one disc of each such group, or restrain rotation");
  }

  const Assembly& assembly_;
  const ContactSprings& springs_;
  const CriticalRatioOptions& options_;
  ContactGraph graph_;
  DegreesOfFreedom unknowns_;
  std::shared_ptr<const SymbolicFactor> symbolic_;
  std::int64_t mechanisms_ = 0;
  std::int64_t negative_rotations_ = 0;
  std::int64_t factorizations_ = 0;
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
  x = pencil.first_motion();
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
  result.mechanisms = pencil.mechanisms();
  result.factorizations = pencil.factorizations();
  return result;
}

double critical_ratio(const Assembly& assembly, std::span<const Support> supports,
                      const CriticalRatioOptions& options) {
  return find_critical_ratio(assembly, ContactSprings(SpringConstants{1, 1}), supports, options).ratio;
}

}  // namespace equidem
