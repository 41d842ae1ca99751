// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/calibrate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/ratio_search.hpp"

namespace equidem {
namespace {

double bulk_part(const Matrix3& c) {
  return (c[0][0] + c[1][1] + 2 * c[0][1]) / 4;
}
double shear_part(const Matrix3& c) {
  return (c[0][0] + c[1][1] - 2 * c[0][1] + 4 * c[2][2]) / 8;
}

/// q = G/K -> nu, at least -1.
double poisson_ratio_of(double shear_to_bulk, Plane plane) {
  const double q = shear_to_bulk;
  if (plane == Plane::strain) return std::max(-1.0, (1 - q) / 2);
  return std::isfinite(q) ? (1 - q) / (1 + q) : -1;
}

template <std::size_t N>
void scale(SquareMatrix<N>& matrix, double factor) {
  for (auto& row : matrix)
    for (double& entry : row) entry *= factor;
}

/// The stiffness with all springs `factor` times as stiff: the motions stay.
void scale_springs(EffectiveStiffness& c, double factor) {
  scale(c.stiffness, factor);
  scale(c.tangential_part, factor);
  scale(c.normal_part, factor);
  scale(c.gradient_stiffness, factor);
  c.error_bound *= factor;
}

void check(const Assembly& assembly, const CalibrateOptions& options) {
  if (!(options.tolerance >= 1e-14 && options.tolerance <= 1e-2)) {
    bad_input(format("the tolerance of the calibration is {:.6g}", options.tolerance),
              "it is a relative error from 1e-14 to 1e-2", "Leave it at 1e-11");
  }
  if (!assembly.contact_kN.empty() || !assembly.contact_kT.empty()) {
    bad_input("the assembly file gives springs of its own", "calibration chooses the springs",
              "Remove \"springs\" from the assembly file");
  }
}

/// Homogenizes one assembly at many spring ratios and keeps the last result.
class Homogenizer {
 public:
  Homogenizer(const Assembly& assembly, const CalibrateOptions& options, double kN)
      : assembly_(assembly), weighting_(options.weighting), options_(options.homogenize), kN_(kN) {
    if (options_.boundary == Boundary::periodic && !assembly.periodic()) options_.boundary = Boundary::displacement;
  }

  RatioSample sample(double ratio) {
    stop_if_interrupted();
    ++factorizations_;
    springs_ = {kN_, ratio * kN_};
    try {
      last_ = effective_stiffness(assembly_, contact_springs(assembly_, springs_, weighting_), options_);
    } catch (const Error& error) {
      // Near a loss of stability, which only kT < 0 meets, K is singular.
      if (ratio < 0 && error.kind() == ErrorKind::computation_failed) return {.ratio = ratio, .stable = false};
      throw;
    }
    for (const auto& [stage, seconds] : last_.times.stages()) times_.add(stage, seconds);
    const double K = bulk_part(last_.stiffness), G = shear_part(last_.stiffness);
    const double K_T = bulk_part(last_.tangential_part), G_T = shear_part(last_.tangential_part);
    return {.ratio = ratio,
            .shear_to_bulk = G / K,
            .slope = (G_T * K - G * K_T) / (ratio * K * K),
            .stable = K > 0 && G > 0 && last_.unstable_modes == 0};
  }

  /// The last sample, with its springs scaled to the wanted G.
  void deliver(double shear_modulus, Calibration& result) {
    const double factor = shear_modulus / shear_part(last_.stiffness);
    scale_springs(last_, factor);
    result.springs = {factor * springs_.kN, factor * springs_.kT};
    result.achieved = std::move(last_);
    result.times = times_;
    result.factorizations = factorizations_;
  }

  [[nodiscard]] const EffectiveStiffness& last() const { return last_; }

 private:
  const Assembly& assembly_;
  SpringWeighting weighting_;
  HomogenizeOptions options_;
  double kN_;
  SpringConstants springs_;
  EffectiveStiffness last_;
  StageTimes times_;
  int factorizations_ = 0;
};

void judge(const ElasticModuli& target, Calibration& result) {
  result.moduli = effective_moduli(result.achieved.stiffness);
  const auto error = [](double reached, double wanted) { return std::abs(reached - wanted) / wanted; };
  result.relative_error = std::max(error(result.moduli.shear_modulus, target.shear_modulus),
                                   error(result.moduli.bulk_modulus_2d, target.bulk_modulus_2d()));
}

/// Six decimals of nu, at least half of the last inside a limit.
double below(double limit) {
  return std::floor(limit * 1e6 - 0.5) / 1e6;
}
double above(double limit) {
  return -below(-limit);
}

[[noreturn]] void refuse_outside(const ElasticModuli& target, const Calibration& range, bool static_only) {
  const double nu = target.poisson_ratio;
  const double lowest = range.lowest_poisson_ratio(target.plane), highest = range.highest_poisson_ratio(target.plane);
  const bool too_high = nu > highest;
  const std::string remedy = too_high ? format("Ask for a Poisson's ratio of at most {:.6f}{}", below(highest),
                                               static_only ? "" : ", or allow kT < 0 with static_only = true")
                                      : format("Ask for a Poisson's ratio of at least {:.6f}", above(lowest));
  bad_input(format("Poisson's ratio {:.6g} in plane {} is out of the range of this assembly, {:.6g} to {:.6g}", nu,
                   to_string(target.plane), lowest, highest),
            "its ends are those of kT = 0 and of tangential springs much stiffer than the normal ones", remedy);
}

/// \param limit the stable sample with the highest nu
[[noreturn]] void refuse_unstable(const ElasticModuli& target, const RatioSample& limit) {
  const double highest = poisson_ratio_of(limit.shear_to_bulk, target.plane);
  bad_input(format("Poisson's ratio {:.6g} in plane {} is beyond the static limit of this assembly",
                   target.poisson_ratio, to_string(target.plane)),
            limit.ratio > 0 ? "the assembly gives way however little kT lies below 0"
                            : format("it is {:.6g} at kT/kN = {:.4g}, and a little below the assembly gives way",
                                     highest, limit.ratio),
            format("Ask for a Poisson's ratio of at most {:.6f}", below(highest)));
}

Calibration search(const Assembly& assembly, const ElasticModuli& target, const CalibrateOptions& options) {
  const double wanted = target.shear_modulus / target.bulk_modulus_2d();
  Homogenizer homogenizer(assembly, options, target.bulk_modulus_2d());
  const RatioSampler sample = [&](double ratio) { return homogenizer.sample(ratio); };

  Calibration result;
  const RatioRange range = sample_range(sample);
  result.smallest_shear_to_bulk = range.at_zero;
  result.largest_shear_to_bulk = range.at_infinity;
  result.method = "Newton on kT/kN";
  const bool negative = wanted < range.at_zero * (1 - options.tolerance);
  if ((negative && !options.static_only) || wanted >= range.at_infinity) refuse_outside(target, result, false);

  const FoundRatio found = negative ? find_negative_ratio(sample, range, wanted, options.tolerance)
                                    : find_ratio(sample, range, wanted, options.tolerance);
  if (!found.reached) refuse_unstable(target, found.at);
  homogenizer.deliver(target.shear_modulus, result);
  result.iterations = found.steps;
  result.rising = found.rising;
  judge(target, result);
  return result;
}

[[noreturn]] void refuse_unstable_lattice(const ElasticModuli& target, double ratio) {
  bad_input(format("Poisson's ratio {:.6g} in plane {} is beyond the static limit of the hexagonal lattice",
                   target.poisson_ratio, to_string(target.plane)),
            format("it needs kT/kN = {:.6g}, and the infinite lattice gives way at -1/3", ratio),
            format("Ask for a Poisson's ratio below {}", target.plane == Plane::strain ? "1/3" : "1/2"));
}

Calibration solve_lattice(const Assembly& assembly, const ElasticModuli& target, const CalibrateOptions& options) {
  const Packing packing = *options.lattice;
  if (options.weighting != SpringWeighting::uniform) {
    bad_input(format("the weighting is \"{}\" on a lattice", to_string(options.weighting)),
              "its relations to moduli (Abe 1996, eqs. 31 and 34) are for equal springs",
              "Use weighting = \"uniform\"");
  }
  Calibration result;
  result.springs = springs_for(target, packing, {},
                               options.static_only ? NegativeTangential::static_only : NegativeTangential::refuse);
  const double ratio = result.springs.ratio();
  if (packing == Packing::hexagonal && ratio <= -1.0 / 3) refuse_unstable_lattice(target, ratio);
  result.smallest_shear_to_bulk = packing == Packing::square ? 1 : 0.5;  // hexagonal: q = (1 + r)/2
  if (packing == Packing::square) result.largest_shear_to_bulk = 1;
  result.method = format("closed form, Abe 1996, eq. ({})", packing == Packing::square ? 31 : 34);
  result.verified = assembly.periodic();
  if (result.verified) {
    Homogenizer homogenizer(assembly, options, result.springs.kN);
    if (!homogenizer.sample(ratio).stable) refuse_unstable_lattice(target, ratio);
    // Not scaled: the closed form is tried as it is.
    homogenizer.deliver(shear_part(homogenizer.last().stiffness), result);
  } else {
    result.achieved.stiffness = isotropic_stiffness(target.bulk_modulus_2d(), target.shear_modulus);
  }
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
  Calibration result = options.lattice ? solve_lattice(assembly, target, options) : search(assembly, target, options);
  // Rounding of the homogenization itself, which the tolerance may lie below.
  const double accepted = std::max(options.tolerance, 1e-10);
  if (!(result.relative_error <= accepted)) {
    computation_failed(format("the moduli reached are off by {:.2g}", result.relative_error),
                       result.verified ? "the springs do not give them on this assembly" : "",
                       "Check that the assembly is the lattice that it is said to be");
  }
  return result;
}

}  // namespace equidem
