// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/giving_way/unresisted_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/breakage/unbonded/rate_branches.hpp"
#include "equidem/breakage/unbonded/rate_path.hpp"

namespace equidem {
namespace {

constexpr double stiff_ground = 10, soft_ground = 1e-6, factor = 0.1;  // over the stiffest spring
constexpr int halvings = 30;
constexpr double grown = 1e3;          // times the load is c v where it grows without bound
constexpr double least_change = 0.03;  // by how much c v of a mechanism differs from one c to the next, over its size

/// c v; empty: the rates are not found.
std::vector<double> force_of_ground(const RateProblem& problem, const std::vector<ContactStatus>& status, double c) {
  std::vector<double> force = motion_on_ground(problem, status, c);
  for (double& f : force) f *= c;
  return force;
}

double largest_component(const std::vector<double>& x) {
  double most = 0;
  for (const double a : x) most = std::max(most, std::abs(a));
  return most;
}

bool is_settled(const std::vector<double>& before, const std::vector<double>& now) {
  double change = 0;
  for (std::size_t k = 0; k < now.size(); ++k) change = std::max(change, std::abs(now[k] - before[k]));
  return change < least_change * largest_component(now);
}

}  // namespace

std::optional<UnresistedMotion> unresisted_motion(const RateProblem& problem,
                                                  const std::vector<ContactStatus>& status) {
  if (problem.driving.by_motion || problem.limits.empty() || problem.limits.size() > most_on_limits) return {};
  double high = stiff_ground, low = 0;
  std::vector<double> force = force_of_ground(problem, status, high);
  const double load = largest_component(force);  // such springs take nearly all of it
  if (!(load > 0)) return {};
  bool drives = false;
  while (high > soft_ground && low == 0) {
    std::vector<double> next = force_of_ground(problem, status, high * factor);
    if (next.empty()) {
      low = high * factor;
      break;
    }
    drives = is_settled(force, next);
    high *= factor;
    force = std::move(next);
  }
  if (low == 0) {
    if (!drives || largest_component(force) < 1e-4 * load) return {};
    return UnresistedMotion{std::move(force), 0};
  }
  for (int k = 0; k < halvings && largest_component(force) < grown * load; ++k) {
    const double c = std::sqrt(low * high);
    std::vector<double> next = force_of_ground(problem, status, c);
    if (next.empty()) {
      low = c;
    } else {
      high = c;
      force = std::move(next);
    }
  }
  if (largest_component(force) < grown * load) return {};
  return UnresistedMotion{std::move(force), high};
}

}  // namespace equidem
