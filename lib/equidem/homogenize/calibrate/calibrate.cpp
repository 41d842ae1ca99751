// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/calibrate/calibrate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/calibrate/ratio_search.hpp"

namespace equidem {
namespace {

/// Boundary::periodic is taken as displacement where the assembly is not periodic.
HomogenizeOptions homogenize_options(const Assembly& assembly, const CalibrateOptions& options) {
  HomogenizeOptions result = options.homogenize;
  if (result.boundary == Boundary::periodic && !assembly.periodic()) result.boundary = Boundary::displacement;
  constexpr double share = 0.4;  // of the tolerance, for the error of moduli; it is the square of that of motions
  if (result.solver.accuracy == 0) result.solver.accuracy = std::sqrt(share * options.tolerance);
  return result;
}

ContactSprings springs_of(const Assembly& assembly, const SpringConstants& springs, const CalibrateOptions& options) {
  return bending_springs(assembly, contact_springs(assembly, springs, options.weighting),
                         {.bond_width = options.bond_width});
}

void check(const Assembly& assembly, const CalibrateOptions& options) {
  if (options.bond_width && options.static_only) {
    bad_input("kT < 0 is allowed, and bonds resist bending", "moduli then have poles at ratios kT/kN below 0",
              "Remove static_only, or bond_width");
  }
  if (!(options.tolerance >= 1e-14 && options.tolerance <= 1e-2)) {
    bad_input(fmt::format("the tolerance of the calibration is {:.6g}", options.tolerance),
              "it is a relative error from 1e-14 to 1e-2", "Leave it at 1e-11");
  }
  if (!assembly.contact_kN.empty() || !assembly.contact_kT.empty()) {
    bad_input("the assembly file gives springs of its own", "calibration chooses the springs",
              "Remove \"springs\" from the assembly file, or set assembly.own_springs = false");
  }
}

void judge(const ElasticModuli& target, Calibration& result) {
  result.moduli = effective_moduli(result.achieved.stiffness);
  const auto error = [](double reached, double wanted) { return std::abs(reached - wanted) / wanted; };
  result.relative_error = std::max(error(result.moduli.shear_modulus, target.shear_modulus),
                                   error(result.moduli.bulk_modulus_2d, target.bulk_modulus_2d()));
}

/// Homogenizes one assembly with kN = 1 Pa at many spring ratios; keeps the last result and that nearest to the target.
class Homogenizer {
 public:
  Homogenizer(const Assembly& assembly, const ElasticModuli& target, const CalibrateOptions& options)
      : assembly_(assembly), target_(target), how_(options), options_(homogenize_options(assembly, options)) {}

  /// Not stable where the network cannot be homogenized at this ratio: a mechanism, or too near a loss of stability.
  RatioSample sample(double ratio) {
    stop_if_interrupted();
    ++factorizations_;
    ratio_ = ratio;
    try {
      last_ = effective_stiffness(assembly_, springs_of(assembly_, {1, ratio}, how_), options_);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::interrupted || error.kind() == ErrorKind::out_of_memory) throw;
      failure_ = error;
      return {.ratio = ratio, .stable = false};
    }
    last_.fluctuations = {};
    times_.add(last_.times);
    const auto [K, G] = isotropic_part(last_.stiffness);
    const auto [K_T, G_T] = isotropic_part(last_.tangential_part);
    const RatioSample made{.ratio = ratio,
                           .shear_to_bulk = G / K,
                           .slope = (G_T * K - G * K_T) / (ratio * K * K),
                           .bulk_growth = K_T / K,
                           .stable = last_.unstable_modes == 0 && eigenstrains(last_.stiffness).values[0] > 0};
    if (made.stable) keep(made);
    return made;
  }

  /// The last sample, with springs `kN` times as stiff.
  void deliver(double kN, Calibration& result) {
    last_.scale(kN);
    result.springs = {kN, ratio_ * kN};
    result.achieved = std::move(last_);
    result.times = times_;
    result.factorizations = factorizations_;
  }

  [[nodiscard]] const EffectiveStiffness& last() const { return last_; }
  /// Throws the error of the last sample that could not be homogenized.
  [[noreturn]] void fail() const {
    if (failure_) throw *failure_;
    computation_failed("the stiffness of the assembly is not positive at any spring ratio tried", "",
                       "Ask equidem homogenize about it");
  }
  [[nodiscard]] bool failed() const { return failure_.has_value(); }

  [[nodiscard]] bool has_best() const { return best_.shear_to_bulk > 0; }
  /// Throws an error that ends the search, with the best springs, which are there.
  [[noreturn]] void end_search(const Error& error) {
    ratio_ = best_.ratio;
    last_ = std::move(at_best_);
    Calibration result;
    result.smallest_shear_to_bulk = least_;
    result.largest_shear_to_bulk = greatest_;
    result.method = "search on kT/kN, ended before it converged";
    deliver(target_.shear_modulus / isotropic_part(last_.stiffness).shear, result);
    judge(target_, result);
    const std::string why = fmt::format("not converged: with the best springs of {} the moduli are off by {:.2g}",
                                        counted(factorizations_, "factorization"), result.relative_error);
    throw ErrorWith(error, why, std::move(result));
  }

 private:
  void keep(const RatioSample& made) {
    const double wanted = target_.shear_modulus / target_.bulk_modulus_2d();
    const auto off = [&](const RatioSample& one) { return std::abs(std::log(one.shear_to_bulk / wanted)); };
    if (made.ratio >= 0) {
      least_ = std::min(least_, made.shear_to_bulk);
      greatest_ = std::max(greatest_, made.shear_to_bulk);
    }
    if (has_best() && off(made) >= off(best_)) return;
    best_ = made;
    at_best_ = last_;
  }

  const Assembly& assembly_;
  const ElasticModuli& target_;
  const CalibrateOptions& how_;
  HomogenizeOptions options_;
  double ratio_ = 0;
  EffectiveStiffness last_, at_best_;
  RatioSample best_;  ///< nearest to the target of those that are stable
  double least_ = std::numeric_limits<double>::infinity(), greatest_ = 0;  ///< G/K of those with kT >= 0
  std::optional<Error> failure_;
  StageTimes times_;
  int factorizations_ = 0;
};

/// Does what refuses a Poisson's ratio. \throws InfeasibleModuli with the range of G/K of the assembly
template <typename Task>
auto with_range(double least, double greatest, const Task& task) {
  try {
    return task();
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::bad_input) throw;
    Calibration range;
    range.smallest_shear_to_bulk = least;
    range.largest_shear_to_bulk = greatest;
    range.scanned = true;
    throw InfeasibleModuli(error, std::move(range));
  }
}

/// Six decimals of nu, at least half of the last inside a limit.
double below(double limit) {
  return std::floor(limit * 1e6 - 0.5) / 1e6;
}
double above(double limit) {
  return -below(-limit);
}

/// \param negative kT < 0 would have been tried with static_only
[[noreturn]] void refuse_outside(const ElasticModuli& target, const RatioRange& range, bool negative) {
  const std::string plane = to_string(target.plane);
  const double nu = target.poisson_ratio;
  const double lowest = poisson_ratio_of(range.greatest, target.plane);
  const double highest = poisson_ratio_of(range.least, target.plane);
  const std::string why =
      fmt::format("found for kT/kN from {} to {:.4g}", range.closed ? "0" : fmt::format("{:.4g}", range.smallest.ratio),
                  range.largest.ratio);
  if (highest <= -1) {
    bad_input(fmt::format("this assembly shows no Poisson's ratio in plane {}", plane),
              "its G is at least three times its K, " + why + ", and no isotropic solid has that",
              "Ask in plane stress, or for another assembly");
  }
  const std::string remedy = nu > highest ? fmt::format("Ask for a Poisson's ratio of at most {:.6f}{}", below(highest),
                                                        negative ? ", or allow kT < 0 with static_only = true" : "")
                                          : fmt::format("Ask for a Poisson's ratio of at least {:.6f}", above(lowest));
  bad_input(fmt::format("Poisson's ratio {:.9g} in plane {} is out of the range of this assembly, {:.6g} to {:.6g}", nu,
                        plane, lowest, highest),
            why, remedy);
}

/// \param found where find_negative_ratio ended
[[noreturn]] void refuse_unstable(const ElasticModuli& target, const FoundRatio& found) {
  const double highest = poisson_ratio_of(found.at.shear_to_bulk, target.plane);
  bad_input(fmt::format("Poisson's ratio {:.9g} in plane {} is beyond the static limit of this assembly",
                        target.poisson_ratio, to_string(target.plane)),
            fmt::format("short of it the highest is {:.6g}, at kT/kN = {:.4g}; it lies at {:.3g}", highest,
                        found.at.ratio, found.limit),
            fmt::format("Ask for a Poisson's ratio of at most {:.6f}", below(highest)));
}

Calibration search(Homogenizer& homogenizer, const ElasticModuli& target, const CalibrateOptions& options) {
  const double wanted = target.shear_modulus / target.bulk_modulus_2d();
  const RatioSampler sample = [&](double ratio) { return homogenizer.sample(ratio); };

  RatioRange range = sample_range(sample);
  if (!range.smallest.stable || !range.largest.stable) homogenizer.fail();
  const bool between = wanted >= range.least * (1 - options.tolerance) && wanted <= range.greatest;
  const bool below_zero = range.closed && range.smallest.slope > 0 && wanted < range.at_zero;
  Calibration result;
  FoundRatio found, negative;
  const auto try_negative = [&] {
    if (below_zero && options.static_only)
      found = negative = find_negative_ratio(sample, range, wanted, options.tolerance);
  };
  if (range.rising && between) {
    found = find_ratio(sample, range, wanted, options.tolerance);
  } else if (range.rising) {
    try_negative();
  }
  if (!found.reached) {
    found = find_by_scan(sample, range, wanted, options.tolerance);
    result.scanned = true;
  }
  if (!found.reached && !range.rising) try_negative();
  if (!found.reached) {
    with_range(range.least, range.greatest, [&] {
      if (negative.at.ratio < 0 && negative.at.shear_to_bulk < range.least) refuse_unstable(target, negative);
      refuse_outside(target, range, below_zero && !options.static_only);
    });
  }
  homogenizer.deliver(target.shear_modulus / isotropic_part(homogenizer.last().stiffness).shear, result);
  result.smallest_shear_to_bulk = range.least;
  result.largest_shear_to_bulk = range.greatest;
  result.method = "search on kT/kN";
  result.iterations = found.steps;
  result.rising = found.rising;
  judge(target, result);
  return result;
}

[[noreturn]] void refuse_unstable_lattice(const ElasticModuli& target, const Lattice& lattice, double ratio,
                                          bool static_only) {
  const double highest = poisson_ratio_of(shear_to_bulk(lattice.relation, lattice.critical_ratio), target.plane);
  const double positive = poisson_ratio_of(shear_to_bulk_range(lattice.relation).least, target.plane);
  bad_input(fmt::format("Poisson's ratio {:.9g} in plane {} is beyond the static limit of the {} lattice",
                        target.poisson_ratio, to_string(target.plane), lattice.name),
            fmt::format("it needs kT/kN = {:.6g}, and the infinite lattice is unstable at {:.6g} and below", ratio,
                        lattice.critical_ratio),
            static_only
                ? fmt::format("Ask for a Poisson's ratio below {:.6g}", highest)
                : fmt::format("Ask for a Poisson's ratio of at most {:.6g}, or below {:.6g} with static_only = true",
                              positive, highest));
}

Calibration solve_lattice(Homogenizer& homogenizer, bool periodic, const ElasticModuli& target,
                          const CalibrateOptions& options) {
  const Lattice& lattice = *options.lattice;
  const SpringRelation& relation = lattice.relation;
  if (options.weighting != SpringWeighting::uniform) {
    bad_input(fmt::format("the weighting is \"{}\" on a lattice", to_string(options.weighting)),
              fmt::format("its relation to moduli ({}) is for equal springs", relation.source),
              "Use weighting = \"uniform\"");
  }
  if (relation.equal_springs != nullptr) static_cast<void>(springs_for(target, relation));  // refuses other nu than 0
  const ShearToBulkRange range = shear_to_bulk_range(relation);
  const SpringConstants springs = with_range(range.least, range.greatest, [&] {
    const SpringConstants k = springs_for(target, relation, {}, NegativeTangential::static_only);
    if (k.ratio() <= lattice.critical_ratio) refuse_unstable_lattice(target, lattice, k.ratio(), options.static_only);
    return options.static_only ? k : springs_for(target, relation);  // refuses kT < 0
  });
  Calibration result;
  result.smallest_shear_to_bulk = range.least;
  result.largest_shear_to_bulk = range.greatest;
  result.scanned = true;
  result.method = fmt::format("closed form, {}", relation.source);
  result.verified = false;
  result.springs = springs;
  result.achieved.stiffness = isotropic_stiffness(target.bulk_modulus_2d(), target.shear_modulus);
  judge(target, result);
  if (!periodic) return result;
  RatioSample made;
  try {
    made = homogenizer.sample(springs.ratio());
  } catch (const Error& stopped) {
    throw ErrorWith(stopped, "the closed form was not tried on this cell", result);
  }
  if (!made.stable) {
    if (homogenizer.failed()) homogenizer.fail();
    refuse_unstable_lattice(target, lattice, springs.ratio(), options.static_only);
  }
  // Not scaled to the wanted moduli: the closed form is tried as it is.
  homogenizer.deliver(springs.kN, result);
  result.springs = springs;
  result.verified = true;
  judge(target, result);
  return result;
}

}  // namespace

double Calibration::lowest_poisson_ratio(Plane plane) const {
  return poisson_ratio_of(largest_shear_to_bulk, plane);
}

double Calibration::highest_poisson_ratio(Plane plane) const {
  return poisson_ratio_of(smallest_shear_to_bulk, plane);
}

Calibration calibrate(const Assembly& assembly, const ElasticModuli& target, const CalibrateOptions& options) {
  check(target);
  check(assembly, options);
  Homogenizer homogenizer(assembly, target, options);
  const bool closed_form = options.lattice != nullptr && (options.weighting == SpringWeighting::uniform ||
                                                          options.lattice->relation.equal_springs != nullptr);
  Calibration result = [&] {
    try {
      return closed_form ? solve_lattice(homogenizer, assembly.periodic(), target, options)
                         : search(homogenizer, target, options);
    } catch (const ErrorWith<Calibration>&) {
      throw;
    } catch (const Error& error) {
      if (homogenizer.has_best() && error.kind() != ErrorKind::bad_input) homogenizer.end_search(error);
      throw;
    }
  }();
  // Rounding of the homogenization itself, which the tolerance may lie below.
  const double accepted = std::max(options.tolerance, 1e-10);
  if (!(result.relative_error <= accepted)) {
    const Error off(ErrorKind::computation_failed,
                    fmt::format("the moduli reached are off by {:.2g}", result.relative_error),
                    result.verified ? "the springs do not give them on this assembly" : "",
                    "Check that the assembly is this lattice");
    throw ErrorWith(off, std::move(result));
  }
  return result;
}

std::optional<MeanFieldGuess> mean_field_guess(const Assembly& assembly, const ElasticModuli& target,
                                               const CalibrateOptions& options) {
  const NegativeTangential negative =
      options.static_only ? NegativeTangential::static_only : NegativeTangential::refuse;
  MeanFieldGuess guess;
  try {
    const ChosenRelation chosen = spring_relation(assembly, options.weighting, options.lattice);
    if (!chosen.relation.needs_measures) return {};
    guess.springs = springs_for(target, chosen.relation, chosen.measures, negative);
    const EffectiveStiffness c = effective_stiffness(assembly, springs_of(assembly, guess.springs, options),
                                                     homogenize_options(assembly, options));
    if (c.unstable_modes == 0) {
      guess.moduli = effective_moduli(c.stiffness);
    } else {
      guess.missing = "the assembly is unstable with these springs";
    }
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    guess.missing = error.what();
  }
  return guess;
}

}  // namespace equidem
