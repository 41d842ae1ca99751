// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The integrators of bonded bodies: each is a sequence of stages with its order and its limit of stability, a constant
/// of type IntegrationScheme and its name in the list of Integrator.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "equidem/core/names.hpp"
#include "equidem/dynamics/kernels/step_kernel.hpp"

namespace equidem {

/// Method to find the longest stable step.
enum class StabilityLimit {
  central_differences,  ///< with all damping, from the energy of the highest mode and its dashpots
  thesis,               ///< with all damping, for the scheme of Sukegawa (2010)
  undamped,             ///< stability_limit(0) over the highest frequency
};

/// Effect of mass-proportional damping, an acceleration -alpha v, over a step h.
enum class MassDamping {
  central,    ///< factor (1 - alpha h/2)/(1 + alpha h/2)
  one_sided,  ///< factor 1 - alpha h
  exact,      ///< exp(-alpha h), exact under a constant force
};

struct IntegrationScheme {
  int order = 2;                 ///< where forces depend on positions, and for mass-proportional damping
  bool half_step_start = false;  ///< initial half kick before the first step
  bool takes_dashpots = true;    ///< forces may depend on velocities
  StabilityLimit limit = StabilityLimit::undamped;
  MassDamping mass_damping = MassDamping::central;
  /// Largest stable omega dt of the oscillator u'' + 2 zeta omega u' + omega² u = 0; 0: never stable.
  double (*stability_limit)(double zeta);
  /// Stages of one step, motion by motion; keep, kick and drift as in step_kernel.hpp.
  /// \param h time step, s
  /// \param alpha mass-proportional damping, 1/s
  std::vector<Stage> (*stages)(double h, double alpha);
  double first_drift = 0;  ///< time by which motions are stored ahead between steps, in time steps
};

namespace integrators {

/// Central differences: v(t + h/2) = v(t - h/2) + h a(t), u(t + h) = u(t) + h v(t + h/2).
/// Mass-proportional damping is central and does not change the limit omega h = 2; a contact dashpot (zeta > 0, from
/// relative velocities) is evaluated half a step behind: 2 (sqrt(1 + zeta²) - zeta).
inline constexpr IntegrationScheme leapfrog{
    .half_step_start = true,
    .limit = StabilityLimit::central_differences,
    .stability_limit = [](double zeta) { return 2 * (std::sqrt(1 + zeta * zeta) - zeta); },
    .stages =
        [](double h, double alpha) {
          const double damped = alpha * h;
          return std::vector<Stage>{
              {.keep = (1 - damped / 2) / (1 + damped / 2), .kick = h / (1 + damped / 2), .drift = h, .duration = h}};
        },
};

/// Sukegawa (2010), eqs. (3.14) to (3.17) as printed: v' = v + h a, x' = x + (v + v')/2 h.
/// Order 1; unstable without damping: omega h < min(4 zeta, 1/zeta), zeta of all damping.
inline constexpr IntegrationScheme thesis{
    .order = 1,
    .limit = StabilityLimit::thesis,
    .mass_damping = MassDamping::one_sided,
    .stability_limit = [](double zeta) { return zeta > 0 ? std::min(4 * zeta, 1 / zeta) : 0.0; },
    .stages =
        [](double h, double alpha) {
          return std::vector<Stage>{
              {.keep = 1 - alpha * h, .kick = h, .drift = h / 2, .drift_before = h / 2, .duration = h}};
        },
};

/// Velocity Verlet: the motion of leapfrog, with velocities at full steps.
inline constexpr IntegrationScheme velocity_verlet = leapfrog;

/// The position-extended Forest-Ruth-like scheme of Omelyan, Mryglod & Folk (2002): symplectic, order 4. Drifts xi,
/// chi, 1 - 2(chi + xi), chi, xi around kicks (1 - 2 lambda)/2, lambda, lambda, (1 - 2 lambda)/2.
namespace omelyan {

inline constexpr double xi = 0.1786178958448091, lambda = -0.2123418310626054, chi = -0.06626458266981849;
inline constexpr std::array<double, 4> kicks = {0.5 - lambda, lambda, lambda, 0.5 - lambda};
/// Drift after each kick; the last one includes the drift before the first kick of the next step.
inline constexpr std::array<double, 4> drifts = {chi, 1 - 2 * (chi + xi), chi, 2 * xi};

/// Half the trace of the matrix of one step of an oscillator with w = omega h; stable while in [-1, 1].
inline double half_trace(double w) {
  double a = 1, b = 0, c = 0, d = 1;  // (u, v/omega) after = [a b; c d] (u, v/omega) before
  for (std::size_t k = 0; k < kicks.size(); ++k) {
    c -= kicks[k] * w * a;
    d -= kicks[k] * w * b;
    a += drifts[k] * w * c;
    b += drifts[k] * w * d;
  }
  return 0.5 * (a + d);
}

inline double limit() {
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

/// Mass-proportional damping is exact for constant forces: v' = F/m - alpha v.
inline std::vector<Stage> stages(double h, double alpha) {
  std::vector<Stage> stages;
  for (std::size_t k = 0; k < kicks.size(); ++k) {
    const double part = kicks[k] * (alpha * h);
    const double weight = std::abs(part) > 1e-12 ? -std::expm1(-part) / part : 1.0;
    stages.push_back(
        {.keep = std::exp(-part), .kick = kicks[k] * h * weight, .drift = drifts[k] * h, .duration = kicks[k] * h});
  }
  return stages;
}

}  // namespace omelyan

/// Between steps, motions are stored ahead by the first drift: a step begins and ends with the same short drift, and
/// two successive ones are merged.
inline constexpr IntegrationScheme fourth_order{
    .order = 4,
    .takes_dashpots = false,
    .mass_damping = MassDamping::exact,
    .stability_limit =
        [](double) {
          static const double limit = omelyan::limit();
          return limit;
        },
    .stages = omelyan::stages,
    .first_drift = omelyan::xi,
};

}  // namespace integrators

enum class Integrator { leapfrog, velocity_verlet, thesis, fourth_order };

template <>
struct EnumNames<Integrator> {
  struct Entry {
    Integrator value;
    const char* name;
    const IntegrationScheme* scheme;
  };
  static constexpr const char* what = "integrator";
  static constexpr Entry list[] = {
      {Integrator::leapfrog, "leapfrog", &integrators::leapfrog},
      {Integrator::velocity_verlet, "velocity_verlet", &integrators::velocity_verlet},
      {Integrator::thesis, "thesis", &integrators::thesis},
      {Integrator::fourth_order, "fourth_order", &integrators::fourth_order},
  };
};

inline const IntegrationScheme& scheme_of(Integrator integrator) {
  return *entry_of(integrator).scheme;
}

}  // namespace equidem
