// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/integrator.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// Position-extended Forest-Ruth-like scheme (Omelyan, Mryglod & Folk 2002): drifts xi, chi, 1 - 2(chi + xi), chi, xi
/// around kicks (1 - 2 lambda)/2, lambda, lambda, (1 - 2 lambda)/2.
constexpr double xi = 0.1786178958448091, lambda = -0.2123418310626054, chi = -0.06626458266981849;
constexpr std::array<double, 4> kicks = {0.5 - lambda, lambda, lambda, 0.5 - lambda};
/// After each kick; the last one holds that before the first kick of the next step, too.
constexpr std::array<double, 4> drifts = {chi, 1 - 2 * (chi + xi), chi, 2 * xi};

constexpr std::array all_integrators = {Integrator::leapfrog, Integrator::velocity_verlet, Integrator::thesis,
                                        Integrator::fourth_order};

/// Half the trace of what one step of the fourth-order scheme does to an oscillator with W = omega dt; stable while in
/// [-1, 1].
double half_trace(double w) {
  double a = 1, b = 0, c = 0, d = 1;  // (u, v/omega) after = [a b; c d] (u, v/omega) before
  for (std::size_t k = 0; k < kicks.size(); ++k) {
    c -= kicks[k] * w * a;
    d -= kicks[k] * w * b;
    a += drifts[k] * w * c;
    b += drifts[k] * w * d;
  }
  return 0.5 * (a + d);
}

double fourth_order_limit() {
  constexpr double step = 1e-3;
  double stable = step;
  while (std::abs(half_trace(stable + step)) <= 1) stable += step;
  double unstable = stable + step;
  while (unstable - stable > 1e-14) {
    const double middle = 0.5 * (stable + unstable);
    (std::abs(half_trace(middle)) <= 1 ? stable : unstable) = middle;
  }
  return stable;
}

}  // namespace

Integrator integrator_from(const std::string& name) {
  std::string known;
  for (const Integrator integrator : all_integrators) {
    if (name == to_string(integrator)) return integrator;
    known += (known.empty() ? "" : ", ") + to_string(integrator);
  }
  bad_input(fmt::format("'{}' is no integrator", name), "", fmt::format("Choose one of {}", known));
}

std::string to_string(Integrator integrator) {
  switch (integrator) {
    case Integrator::leapfrog:
      return "leapfrog";
    case Integrator::velocity_verlet:
      return "velocity_verlet";
    case Integrator::thesis:
      return "thesis";
    case Integrator::fourth_order:
      return "fourth_order";
  }
  return "";
}

IntegratorFacts facts_of(Integrator integrator) {
  switch (integrator) {
    case Integrator::leapfrog:
      return {.order = 2, .force_evaluations = 1, .velocities_lag = true};
    case Integrator::velocity_verlet:
      return {.order = 2, .force_evaluations = 1, .velocities_lag = false};
    case Integrator::thesis:
      return {.order = 1, .force_evaluations = 1, .velocities_lag = false};
    case Integrator::fourth_order:
      return {.order = 4, .force_evaluations = 4, .velocities_lag = false};
  }
  return {};
}

double stability_limit(Integrator integrator, double zeta) {
  switch (integrator) {
    case Integrator::leapfrog:
    case Integrator::velocity_verlet:
      return 2 * (std::sqrt(1 + zeta * zeta) - zeta);
    case Integrator::thesis:
      return zeta > 0 ? std::min(4 * zeta, 1 / zeta) : 0.0;
    case Integrator::fourth_order: {
      static const double limit = fourth_order_limit();
      return limit;
    }
  }
  return 0;
}

std::vector<Stage> stages_of(Integrator integrator, double time_step, double mass_damping) {
  const double h = time_step, damped = mass_damping * h;
  switch (integrator) {
    case Integrator::leapfrog:
    case Integrator::velocity_verlet:
      return {{.keep = (1 - damped / 2) / (1 + damped / 2), .kick = h / (1 + damped / 2), .drift = h, .duration = h}};
    case Integrator::thesis:
      return {{.keep = 1 - damped, .kick = h, .drift = h / 2, .drift_before = h / 2, .duration = h}};
    case Integrator::fourth_order: {
      std::vector<Stage> stages;
      for (std::size_t k = 0; k < kicks.size(); ++k) {
        // Exact for constant forces: v' = F/m - alpha v.
        const double part = kicks[k] * damped;
        const double weight = std::abs(part) > 1e-12 ? -std::expm1(-part) / part : 1.0;
        stages.push_back(
            {.keep = std::exp(-part), .kick = kicks[k] * h * weight, .drift = drifts[k] * h, .duration = kicks[k] * h});
      }
      return stages;
    }
  }
  return {};
}

double first_drift(Integrator integrator, double time_step) {
  return integrator == Integrator::fourth_order ? xi * time_step : 0.0;
}

}  // namespace equidem
