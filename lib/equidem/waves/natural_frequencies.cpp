// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/natural_frequencies.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/statics/stiffness_solver.hpp"
#include "equidem/waves/extreme_eigenvalues.hpp"

namespace equidem {
namespace {

constexpr std::size_t most_null = 60;  // zero-energy modes that are left out of the iterations

/// A = M^-1/2 K M^-1/2 over discs x block components, with rows and columns of zeros where components are held.
class VibrationOperator {
 public:
  VibrationOperator(const SpringNetwork& network, const std::vector<Inertia>& inertia) : network_(network) {
    const auto b = static_cast<std::size_t>(network.unknowns.per_disc);
    const double a = network.unknowns.rotation_scale;
    over_root_mass_.resize(network.unknowns.held.size());
    for (std::size_t k = 0; k < over_root_mass_.size(); ++k) {
      const Inertia& body = inertia[k / b];
      const double mass = k % b == 2 ? body.moment / (a * a) : body.mass;
      over_root_mass_[k] = network.unknowns.held[k] != 0 ? 0 : 1 / std::sqrt(mass);
    }
  }

  [[nodiscard]] std::size_t size() const { return over_root_mass_.size(); }
  [[nodiscard]] double over_root_mass(std::size_t k) const { return over_root_mass_[k]; }

  /// Forces come from stretch and slip of contacts, whose differences of motions keep the digits of soft motions.
  /// \param x vectors, one after another
  void multiply(std::span<const double> x, std::span<double> y) const {
    PreciseMotion motion(size());
    for (std::size_t first = 0; first < x.size(); first += size()) {
      for (std::size_t k = 0; k < size(); ++k) motion.high[k] = over_root_mass_[k] * x[first + k];
      internal_force(network_, motion, {}, y.subspan(first, size()));
      for (std::size_t k = 0; k < size(); ++k) y[first + k] *= over_root_mass_[k];
    }
  }

 private:
  const SpringNetwork& network_;
  std::vector<double> over_root_mass_;  // 0 where held
};

/// K with its zero-energy modes: those that follow from the graph are held in the unknowns of the solver.
class Vibration {
 public:
  Vibration(const Assembly& assembly, const ContactSprings& springs, const DegreesOfFreedom& unknowns)
      : assembly_(assembly), springs_(springs), graph_(assembly), unknowns_(unknowns), held_unknowns_(unknowns) {
    const auto b = static_cast<std::size_t>(unknowns.per_disc);
    for (const std::size_t component : hold_free_motions(assembly, graph_, springs, held_unknowns_).components) {
      if (!graph_.of(component / b).empty()) {
        held_.push_back(component);
      } else {  // of a disc that touches nothing
        unknowns_.held[component] = DegreesOfFreedom::without_stiffness;
        --unknowns_.unknowns;
        ++alone_;
      }
    }
  }

  [[nodiscard]] SpringNetwork network() const { return {assembly_, graph_, springs_, unknowns_}; }
  [[nodiscard]] std::size_t held() const { return held_.size(); }
  /// Components that discs without contacts have.
  [[nodiscard]] std::int64_t alone() const { return alone_; }

  void factorize(const SolverOptions& options) {
    StageTimes times;
    solver_.reset();
    solver_.emplace(assembly_, springs_, ContactGraph(assembly_), held_unknowns_, options, Mechanisms::hold, times);
  }
  [[nodiscard]] const StiffnessSolver& solver() const { return *solver_; }

  [[nodiscard]] std::size_t zero_energy_modes() const {
    return held_.size() + static_cast<std::size_t>(solver_->factor().report().zero_pivots);
  }
  /// Orthonormal in the product with M, one after another.
  [[nodiscard]] std::vector<double> zero_energy_modes_of(const VibrationOperator& a) {
    std::vector<double> null(a.size() * zero_energy_modes());
    for (std::size_t k = 0; k < zero_energy_modes(); ++k) {
      const std::vector<double> motion =
          k < held_.size() ? freed(held_[k])
                           : solver_->factor().null_motion(static_cast<std::int64_t>(k - held_.size()));
      for (std::size_t c = 0; c < a.size(); ++c) {
        null[k * a.size() + c] = a.over_root_mass(c) > 0 ? motion[c] / a.over_root_mass(c) : 0;
      }
    }
    if (!make_orthonormal(a.size(), null)) {
      computation_failed("zero-energy modes are alike to working precision", "they cannot be left out one by one",
                         "Hold what moves freely");
    }
    return null;
  }

  /// x := M^1/2 K^-1 M^1/2 x of vectors one after another, with what was held as it is.
  void solve(const VibrationOperator& a, std::span<double> x) {
    constexpr std::size_t at_once = 1 << 13;
    const auto scale = [&] {
      parallel_ranges(a.size(), at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          const double over = held_unknowns_.held[k] != 0 ? 0 : a.over_root_mass(k);
          for (std::size_t first = 0; first < x.size(); first += a.size()) {
            double& value = x[first + k];
            value = over > 0 ? value / over : 0;
          }
        }
      });
    };
    scale();
    solver_->factor().solve(x, static_cast<int>(x.size() / a.size()));
    scale();
  }

 private:
  /// The zero-energy mode that moves a held component by 1, and no other of those held.
  [[nodiscard]] std::vector<double> freed(std::size_t component) {
    RightHandSide given;
    given.prescribed.assign(unknowns_.held.size(), 0.0);
    given.prescribed[component] = 1;
    StageTimes times;
    return solver_->solve({&given, 1}, times).front().motion.high;
  }

  const Assembly& assembly_;
  const ContactSprings& springs_;
  ContactGraph graph_;
  DegreesOfFreedom unknowns_, held_unknowns_;
  std::vector<std::size_t> held_;
  std::int64_t alone_ = 0;
  std::optional<StiffnessSolver> solver_;
};

std::string too_many(std::size_t modes) {
  return fmt::format("{} zero-energy modes would have to be told apart from the lowest frequencies", modes);
}

LowestEigenvalues find_lowest(Vibration& vibration, const VibrationOperator& a, const NaturalFrequencyOptions& options,
                              NaturalFrequencies& result) {
  const std::int64_t unknowns = vibration.network().unknowns.unknowns;
  LowestOptions iterations{.tolerance = options.tolerance, .dense_limit = options.dense_limit};
  const std::size_t modes = vibration.zero_energy_modes();
  result.zero_energy_modes = vibration.alone() + static_cast<std::int64_t>(modes);
  if (modes > most_null) {
    result.why_none = too_many(modes);
    return {};
  }
  const std::int64_t others = unknowns - static_cast<std::int64_t>(modes);
  iterations.wanted = static_cast<std::size_t>(std::min<std::int64_t>(options.count, others));
  result.solver = vibration.solver().solver_name();
  if (iterations.wanted == 0) {
    result.why_none = "every motion that is free is a zero-energy mode";
    return {};
  }
  if (a.size() > options.dense_limit) {
    require_memory(
        sizeof(double) * vectors_of_frequencies(static_cast<double>(iterations.wanted)) * static_cast<double>(a.size()),
        "natural frequencies need about", "Ask for fewer frequencies, or take a machine with more memory");
  }
  const SymmetricOperator k{.size = a.size(),
                            .dimension = static_cast<std::size_t>(others),
                            .multiply = [&](std::span<const double> x, std::span<double> y) { a.multiply(x, y); },
                            .solve = [&](std::span<double> x) { vibration.solve(a, x); }};
  return lowest_eigenvalues(k, vibration.zero_energy_modes_of(a), iterations);
}

/// The mode a of modal mass 1 has d(omega²) = d(a . K a). Where x errs by e, the energy of what it has of another mode
/// j is
///
///   e.K e <= (bound² / omega²) max_j (omega_j²/(omega_j² - omega²))²
///
/// by the error bound of omega² (extreme_eigenvalues.hpp), and of the modes above the next one counts most.
std::vector<FrequencyDerivatives> derivatives_of(const Assembly& assembly, const ContactSprings& springs,
                                                 const NaturalFrequencies& found, std::size_t count) {
  constexpr double alike = 1e-6, parted = 0.05;
  std::vector<FrequencyDerivatives> result(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double squared = found.squared[k];
    double farthest = 1, nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < found.squared.size(); ++j) {
      if (j == k) continue;
      const double gap = std::abs(found.squared[j] - squared);
      nearest = std::min(nearest, gap);
      farthest = std::max(farthest, found.squared[j] / gap);
    }
    const double share = found.error_bounds[k] / squared * farthest;
    FrequencyDerivatives& of = result[k];
    of.error = share * (2 + share) / 2;
    of.simple = nearest > alike * squared && share <= parted;
    if (!of.simple) continue;
    static_cast<SpringAndPlaceDerivatives&>(of) =
        form_derivatives(assembly, springs, found.motions[k], found.motions[k]);
    const double half = 1 / (2 * std::sqrt(squared));
    for (std::vector<double>* each : {&of.by_kN, &of.by_kT, &of.by_kM})
      for (double& value : *each) value *= half;
    for (Vec2& value : of.by_position) value = half * value;
  }
  return result;
}

}  // namespace

NaturalFrequencies natural_frequencies(const Assembly& assembly, const ContactSprings& springs,
                                       const DegreesOfFreedom& unknowns, const std::vector<Inertia>& inertia,
                                       const NaturalFrequencyOptions& given) {
  assert(!springs.any_negative());
  NaturalFrequencyOptions options = given;
  if (given.derivatives) ++options.count;
  NaturalFrequencies result;
  Vibration vibration(assembly, springs, unknowns);
  const SpringNetwork network = vibration.network();
  result.zero_energy_modes = vibration.alone() + static_cast<std::int64_t>(vibration.held());
  if (vibration.held() > most_null) {
    result.why_none = too_many(vibration.held());
    return result;
  }
  const VibrationOperator a(network, inertia);
  SolverOptions solver = options.solver;
  solver.right_hand_sides = static_cast<int>(3 * lanczos_vectors(static_cast<std::size_t>(options.count)));
  LowestEigenvalues found;
  const auto attempt = [&] {
    vibration.factorize(solver);
    found = find_lowest(vibration, a, options, result);
  };
  try {
    try {
      attempt();
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::computation_failed || solver.method != SolverMethod::automatic) throw;
      solver.method = SolverMethod::multifrontal;
      attempt();
    }
  } catch (const Error& error) {
    if (!error.failed()) throw;
    result.why_none = error.problem();
    return result;
  }
  if (found.values.empty() && result.why_none.empty()) result.why_none = "the iterations broke down";
  result.squared = found.values;
  result.error_bounds = found.error_bounds;
  result.converged = found.converged;
  result.iterations = found.iterations;
  for (std::size_t k = 0; k < found.values.size(); ++k) {
    std::vector<double> x(a.size());
    for (std::size_t c = 0; c < x.size(); ++c) x[c] = found.vectors[k * a.size() + c] * a.over_root_mass(c);
    result.motions.push_back(disc_motions(unknowns, x));
  }
  if (!given.derivatives) return result;
  const std::size_t kept = std::min(result.squared.size(), static_cast<std::size_t>(given.count));
  result.derivatives = derivatives_of(assembly, springs, result, kept);
  result.squared.resize(kept), result.error_bounds.resize(kept), result.motions.resize(kept);
  return result;
}

}  // namespace equidem
