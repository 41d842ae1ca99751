// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/time_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/contact/effects.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/layout.hpp"
#include "equidem/dynamics/scene_check.hpp"
#include "equidem/waves/vibration.hpp"

namespace equidem {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
/// Lanczos takes some hundred products with K, each the work of a few steps; the bound costs a quarter of the steps.
constexpr double steps_worth_lanczos = 2000;
/// Beyond, the highest modes lie so close together that Lanczos takes minutes.
constexpr std::size_t most_discs_of_lanczos = 100000;

/// Data of a scene for the stability limit.
struct Vibration {
  const Scene& scene;
  const SimulationOptions& options;
  Effects effects;
  DegreesOfFreedom unknowns;
  double walls = 0;  ///< the most that walls can add to any omega², whichever a disc touches

  Vibration(const Scene& scene_in, const SimulationOptions& options_in)
      : scene(scene_in),
        options(options_in),
        effects(derive_effects(scene.assembly, scene.springs, options.rotation)),
        unknowns(unknowns_at(scene, effects, 0)) {
    double xx = 0, xy = 0, yy = 0, lightest = infinite;
    for (const Wall& wall : scene.walls) {
      xx += wall.kN * wall.normal.x * wall.normal.x;
      xy += wall.kN * wall.normal.x * wall.normal.y;
      yy += wall.kN * wall.normal.y * wall.normal.y;
    }
    for (const Inertia& body : scene.inertia) lightest = std::min(lightest, body.mass);
    walls = (0.5 * (xx + yy) + std::hypot(0.5 * (xx - yy), xy)) / lightest;
  }

  [[nodiscard]] bool dashpots() const { return options.damping.dashpots(); }
  [[nodiscard]] SpringConstants dashpots(std::size_t c) const {
    const Contact& contact = scene.assembly.contacts[c];
    return dashpots_of(options.damping, scene.springs[c], scene.inertia[contact.i].mass, scene.inertia[contact.j].mass);
  }
  [[nodiscard]] double bending_dashpot(std::size_t c) const {
    const Contact& contact = scene.assembly.contacts[c];
    return bending_dashpot_of(options.damping, scene.springs.bending(c), scene.inertia[contact.i].moment,
                              scene.inertia[contact.j].moment);
  }
  /// The springs k + weight c.
  [[nodiscard]] ContactSprings with_dashpots(double springs, double weight) const {
    std::vector<SpringConstants> sum(scene.assembly.contacts.size());
    for (std::size_t c = 0; c < sum.size(); ++c) {
      const SpringConstants k = scene.springs[c], d = dashpots(c);
      sum[c] = {springs * k.kN + weight * d.kN, springs * k.kT + weight * d.kT};
    }
    if (!effects.bending) return ContactSprings(std::move(sum));
    std::vector<double> bending(sum.size());
    for (std::size_t c = 0; c < bending.size(); ++c)
      bending[c] = springs * scene.springs.bending(c) + weight * bending_dashpot(c);
    return ContactSprings(std::move(sum)).with_bending(std::move(bending));
  }

  /// Largest omega² of M^-1 K for given springs, exactly or a bound of it.
  [[nodiscard]] double squared(const ContactSprings& springs, bool exact) const {
    if (!exact) return element_bound(scene.assembly, springs, scene.inertia, effects.rotation) + walls;
    if (unknowns.unknowns == 0 || scene.assembly.contacts.empty()) return walls;
    const ExtremeEigenvalue highest =
        extreme_squared_frequency(scene.assembly, springs, unknowns, scene.inertia, SpectrumEnd::largest);
    return std::max(0.0, highest.value + highest.residual) + walls;
  }
};

/// 4 M - 2 h C - h² K = 4 M - h² K(k + 2 c/h): h = 2/omega(h), solved by secants on a logarithmic scale, where the
/// slope of the difference lies between -1 and -1/2. Local damping, which excludes dashpots, makes forces against the
/// velocity larger by its share, and at the limit every force is one.
double critical_of_leapfrog(const Vibration& vibration, bool exact, double omega) {
  const double h = 2 / (omega * std::sqrt(1 + vibration.options.damping.local));
  if (!vibration.dashpots() || omega == 0) return h;
  const auto excess = [&](double step) {
    return std::log(2 / (std::sqrt(vibration.squared(vibration.with_dashpots(1, 2 / step), exact)) * step));
  };
  double x = std::log(h), f = excess(h), slope = -1;
  for (int round = 0; round < 20 && std::abs(f) > 1e-11; ++round) {
    const double moved = -f / slope, next = excess(std::exp(x + moved));
    slope = std::clamp((next - f) / moved, -1.0, -0.5);
    x += moved;
    f = next;
  }
  return std::exp(x - std::abs(f));
}

/// v' = v - h M^-1 (C v + K u), u' = u + h (v + v')/2 requires h K < 2 C and h C < 2 M. The first holds where it does
/// at every contact, mass-proportional damping alpha M >= alpha/omega² K helping.
double critical_of_thesis(const Vibration& vibration, bool exact, double omega) {
  const double alpha = vibration.options.damping.mass;
  double slowest = vibration.scene.assembly.contacts.empty() ? 0 : infinite, fastest = 0;  // c/k, lambda of M^-1 C
  if (vibration.dashpots()) {
    for (std::size_t c = 0; c < vibration.scene.assembly.contacts.size(); ++c) {
      const SpringConstants k = vibration.scene.springs[c], d = vibration.dashpots(c);
      slowest = std::min(slowest, d.kN / k.kN);
      if (k.kT > 0 && vibration.effects.tangential_springs) slowest = std::min(slowest, d.kT / k.kT);
      const double kM = vibration.scene.springs.bending(c);
      if (kM > 0 && vibration.effects.bending) slowest = std::min(slowest, vibration.bending_dashpot(c) / kM);
    }
    fastest = vibration.squared(vibration.with_dashpots(0, 1), exact);
  } else {
    slowest = 0;
  }
  if (vibration.walls > 0) slowest = 0;
  return std::min(2 * slowest + 2 * alpha / (omega * omega), 2 / (alpha + fastest));
}

double critical_step(const Vibration& vibration, bool exact, double omega) {
  const IntegrationScheme& scheme = scheme_of(vibration.options.integrator);
  if (scheme.limit == StabilityLimit::central_differences) return critical_of_leapfrog(vibration, exact, omega);
  if (scheme.limit == StabilityLimit::thesis) return critical_of_thesis(vibration, exact, omega);
  return scheme.stability_limit(0) / omega;
}

/// The lowest omega² of discs that spin alone, an upper bound of the lowest of all.
double lowest_of_spins(const Vibration& vibration) {
  if (vibration.unknowns.per_disc < 3) return 0;
  const Scene& scene = vibration.scene;
  std::vector<double> stiffness(scene.assembly.size(), 0.0);
  for (std::size_t c = 0; c < scene.assembly.contacts.size(); ++c) {
    const Contact& contact = scene.assembly.contacts[c];
    const double kT = scene.springs[c].kT;
    if (contact.i == contact.j) {  // an image of the disc itself turns with it
      stiffness[contact.i] += kT * (contact.lever_i + contact.lever_j) * (contact.lever_i + contact.lever_j);
      continue;
    }
    stiffness[contact.i] += kT * contact.lever_i * contact.lever_i;
    stiffness[contact.j] += kT * contact.lever_j * contact.lever_j;
  }
  double lowest = 0;
  for (std::size_t d = 0; d < stiffness.size(); ++d) {
    if (vibration.unknowns.held[3 * d + 2] != DegreesOfFreedom::free) continue;
    lowest = std::min(lowest, stiffness[d] / scene.inertia[d].moment);
  }
  return lowest;
}

/// Motions that grow as exp(rate t), against mass-proportional damping: rate² + alpha rate + omega² = 0, omega² < 0.
/// Where kT is far below kN, Lanczos does not find the lowest omega² among many near 0 in reasonable time: then a bound
/// of it serves.
double growth_rate(const Vibration& vibration, double omega) {
  if (!vibration.scene.springs.any_negative() || vibration.unknowns.unknowns == 0) return 0;
  const LanczosOptions brief{.tolerance = 1e-9, .work = 2e7};
  double lowest = extreme_squared_frequency(vibration.scene.assembly, vibration.scene.springs, vibration.unknowns,
                                            vibration.scene.inertia, SpectrumEnd::smallest, brief)
                      .value;
  if (lowest > -1e-9 * omega * omega) lowest = 0;  // rounding
  lowest = std::min(lowest, lowest_of_spins(vibration));
  const double half = 0.5 * vibration.options.damping.mass;
  return std::sqrt(half * half - lowest) - half;
}

void check(const TimeStepOptions& wanted) {
  check_range(Range::above_zero_to(1), wanted.fraction, "fraction of the critical step");
  if (wanted.step) check_positive(*wanted.step, "time step", "s");
}

/// Mass-proportional damping scales a velocity by exp(-alpha h) in a step, in leapfrog by (1 - alpha h/2)/(1 + alpha
/// h/2): stable for every h, but past 2/alpha velocities change sign from step to step. The fourth-order
/// scheme goes back in time within a step, where velocities grow by exp(0.21 alpha h).
void respect_mass_damping(TimeStep& step, const SimulationOptions& options, const TimeStepOptions& wanted) {
  const double alpha = options.damping.mass, longest = 2 / alpha;
  const MassDamping damping_of_mass = scheme_of(options.integrator).mass_damping;
  if (!(alpha > 0) || damping_of_mass == MassDamping::one_sided || wanted.allow_unstable) return;
  if (wanted.step && *wanted.step > longest) {
    bad_input(fmt::format("the time step {:.6g} s is too long for the mass damping of {:.6g} 1/s", *wanted.step, alpha),
              fmt::format("past 2/damping = {:.6g} s it would turn velocities around", longest),
              "Give a smaller step, take \"auto\", or damp less");
  }
  if (!wanted.step && step.step > wanted.fraction * longest) {
    step.step = wanted.fraction * longest;
    step.notes.push_back(fmt::format(
        "Mass damping shortens the step: past 2/damping = {:.6g} s it would turn velocities around.", longest));
  }
  const double share = step.step / longest;
  if (damping_of_mass == MassDamping::exact || share * share < 0.05) return;
  step.notes.push_back(fmt::format(
      "What mass damping brings to rest slides too short by up to {:.0f} %, (damping step/2)².", 100 * share * share));
}

void refuse_unstable(const TimeStep& result, const SimulationOptions& options) {
  if (result.growth_rate > 0) {
    bad_input(fmt::format("motions grow at the rate {:.6g} 1/s, whatever the step", result.growth_rate),
              "some kT is negative, which is stable in statics only",
              "Solve the stiffness matrix for the state of rest, or allow an unstable run");
  }
  if (result.critical == 0) {
    bad_input(fmt::format("no time step is stable for the integrator \"{}\"", to_string(options.integrator)),
              "without damping of every contact its motions grow", "Use leapfrog, or damp by stiffness or mass");
  }
  if (result.step > result.critical * (1 + 1e-12)) {
    bad_input(fmt::format("the time step {:.6g} s ({}) is past the limit of {:.6g} s", result.step, result.rule,
                          result.critical),
              fmt::format("{} would grow without end at {:.4g} times the critical step", to_string(options.integrator),
                          result.ratio()),
              "Give a smaller step or take \"auto\" with step_rule = \"lanczos\", or allow an unstable run");
  }
}

}  // namespace

TimeStep choose_time_step(const Scene& scene, const SimulationOptions& options, const TimeStepOptions& wanted) {
  check(wanted);
  check_contacts(scene.assembly);
  check_magnitudes(scene.assembly, scene.springs, scene.inertia);
  const Vibration vibration(scene, options);
  TimeStep result;
  result.rule = wanted.step ? "given" : to_string(wanted.rule);

  const double bound_omega = std::sqrt(vibration.squared(scene.springs, false));
  const double guaranteed = critical_step(vibration, false, bound_omega);
  const double first_step = wanted.step ? *wanted.step : wanted.fraction * guaranteed;
  bool use_bound = wanted.rule == TimeStepRule::bound && (!wanted.step || wanted.step_of_rule);
  const auto let_bound_serve = [&](const std::string& why) {
    use_bound = true;
    if (!wanted.step && wanted.rule == TimeStepRule::lanczos) result.rule = "bound";
    result.notes.push_back("The guaranteed bound serves for the critical step: " + why);
  };
  if (!use_bound && first_step <= guaranteed) {
    const double steps = wanted.duration / first_step;
    if (wanted.duration > 0 && steps < steps_worth_lanczos) {
      let_bound_serve(fmt::format("the run takes about {}, fewer than finding the exact one is worth.",
                                  counted(std::llround(std::ceil(steps)), "step")));
    } else if (scene.assembly.size() > most_discs_of_lanczos) {
      let_bound_serve(fmt::format("with more than {} discs the exact one is not sought.", most_discs_of_lanczos));
    }
  }
  result.omega_max = use_bound ? bound_omega : std::sqrt(vibration.squared(scene.springs, true));
  result.critical = use_bound              ? guaranteed
                    : result.omega_max > 0 ? critical_step(vibration, true, result.omega_max)
                                           : infinite;
  result.exact = !use_bound && scene.walls.empty() &&
                 !(scheme_of(options.integrator).limit == StabilityLimit::thesis &&
                   (options.damping.contact > 0 || options.damping.normal_time != options.damping.tangential_time));
  result.growth_rate = growth_rate(vibration, result.omega_max);

  if (wanted.step) {
    result.step = *wanted.step;
  } else if (std::isinf(result.critical)) {
    bad_input("the time step is left to the highest frequency, but nothing vibrates",
              "no contact joins discs that are free", "Give a step in seconds");
  } else if (wanted.rule == TimeStepRule::thesis) {
    result.step =
        time_step_rules(scene.assembly, scene.springs, scene.inertia, vibration.effects.rotation).eighth_of_period;
    result.notes.emplace_back(
        "The step is an eighth of the period 2 pi sqrt(m/kN) of one disc on one normal spring, the shortest of "
        "all (Sukegawa 2010): no guarantee of stability.");
  } else {
    result.step = wanted.fraction * result.critical;
  }
  respect_mass_damping(result, options, wanted);
  if (options.motion == LoopKind::Motion::finite) {
    result.notes.emplace_back(
        "The critical step is that of the reference state; contacts that turn and stretch change it.");
  }
  if (!scene.walls.empty()) {
    result.notes.emplace_back(
        "Walls are counted as if every disc touched all of them: the critical step is no shorter than this bound.");
  }
  if (wanted.allow_unstable) {
    if (result.growth_rate > 0) {
      result.notes.push_back(
          fmt::format("Motions grow at the rate {:.6g} 1/s, whatever the step.", result.growth_rate));
    } else if (result.step > result.critical) {
      result.notes.emplace_back("The step is past the critical one: motions will grow.");
    }
  } else {
    refuse_unstable(result, options);
  }
  return result;
}

std::string TimeStep::report() const {
  std::string text = fmt::format("time step {:.6g} s ({}), {} {:.6g} s, ratio {:.4g}", step, rule,
                                 exact ? "critical step" : "guaranteed step", critical, ratio());
  for (const std::string& note : notes) text += "\n  " + note;
  return text;
}

}  // namespace equidem
