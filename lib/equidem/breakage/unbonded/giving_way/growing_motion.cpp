// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/giving_way/growing_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/breakage/unbonded/rate_path.hpp"

namespace equidem {
namespace {

constexpr double least_ground = 1e-7, factor = 0.1;  // over the stiffest spring
constexpr int halvings = 30;
constexpr double grown = 1e3;  // times as large as with hardly any contact stiffness beside the ground

double size_of_motion(const std::vector<double>& motion) {
  double most = 0;
  for (const double u : motion) most = std::max(most, std::abs(u));
  return most;
}

}  // namespace

std::optional<GrowingMotion> growing_motion(const RateProblem& problem, const std::vector<ContactStatus>& status) {
  if (problem.driving.by_motion || problem.limits.empty()) return {};
  // The motion times the ground is a force, that of the load where contacts resist nothing.
  double high = 10, low = 0;
  std::vector<double> motion = motion_on_ground(problem, status, high);
  const double load = high * size_of_motion(motion);
  if (!(load > 0)) return {};
  for (double ground = high * factor; ground > least_ground && low == 0; ground *= factor) {
    std::vector<double> next = motion_on_ground(problem, status, ground);
    if (next.empty()) {
      low = ground;
    } else {
      high = ground;
      motion = std::move(next);
    }
  }
  if (low == 0) return {};
  for (int k = 0; k < halvings && high * size_of_motion(motion) < grown * load; ++k) {
    const double ground = std::sqrt(low * high);
    std::vector<double> next = motion_on_ground(problem, status, ground);
    if (next.empty()) {
      low = ground;
    } else {
      high = ground;
      motion = std::move(next);
    }
  }
  if (high * size_of_motion(motion) < grown * load) return {};
  return GrowingMotion{std::move(motion), high};
}

}  // namespace equidem
