// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/choice/method_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/multigrid/multigrid_solver.hpp"

namespace equidem {
namespace {

// Multigrid is faster from some thousand discs on; up to here it saves less than 50 ms.
constexpr double few_discs = 2e4;

/// Discs across the shorter side of a rectangle around the sample.
double discs_across(const Assembly& assembly) {
  Vec2 extent;
  if (assembly.periodic()) {
    extent = *assembly.period;
  } else {
    Vec2 low = assembly.centres.front(), high = low;
    for (const Vec2 x : assembly.centres) {
      low = {std::min(low.x, x.x), std::min(low.y, x.y)};
      high = {std::max(high.x, x.x), std::max(high.y, x.y)};
    }
    extent = high - low;
  }
  const double longer = std::max(extent.x, extent.y), shorter = std::min(extent.x, extent.y);
  return std::max(2.0, std::sqrt(static_cast<double>(assembly.size()) * shorter / longer));
}

/// Standard deviation of the logarithm of the normal springs.
double scatter_of(const ContactSprings& springs, std::size_t contacts) {
  if (springs.uniform() || contacts == 0) return 0;
  double sum = 0, squares = 0;
  for (std::size_t c = 0; c < contacts; ++c) {
    const double value = std::log(springs[c].kN);
    sum += value;
    squares += value * value;
  }
  const auto n = static_cast<double>(contacts);
  return std::sqrt(std::max(0.0, squares / n - sum / n * (sum / n)));
}

}  // namespace

MethodForecast forecast(const SpringNetwork& network, int right_hand_sides) {
  const Assembly& assembly = network.assembly;
  const auto discs = static_cast<double>(assembly.size()), contacts = static_cast<double>(assembly.contacts.size());
  const double across = discs_across(assembly), sides = right_hand_sides;
  const double unknowns = network.unknowns.per_disc / 3.0;
  // Entries of L a disc and operations of the factorization, fitted to blocks and strips of 1e4 to 1e6 discs;
  // separators of a periodic cell come in pairs.
  const double entries = (60 + 40 * std::log2(across)) * unknowns * unknowns * (assembly.periodic() ? 1.4 : 1);
  const double operations = 500 * across * std::pow(unknowns, 3) * (assembly.periodic() ? 2.5 : 1);
  // s, of a factor in single precision: a solution takes several steps of conjugate gradients.
  constexpr double per_entry = 4.3e-9, per_operation = 5.2e-12, per_solution = 2e-9;
  MethodForecast result;
  result.elimination = discs * (entries * (per_entry + sides * per_solution) + operations * per_operation);
  result.elimination_bytes = discs * (entries * 4.5 + 400) + contacts * 100;
  constexpr double grids = 0.6e-6, iterations = 0.9e-6;  // s a disc
  const double more_iterations = 1 + 1.2 * scatter_of(network.springs, assembly.contacts.size());
  result.multigrid = network.springs.may_be_indefinite() ? std::numeric_limits<double>::infinity()
                                                         : discs * (grids + sides * iterations * more_iterations);
  result.multigrid_bytes = bytes_of_multigrid(discs, contacts);
  return result;
}

MethodChoice choose_method(const SpringNetwork& network, const SolverOptions& options) {
  if (options.method != SolverMethod::automatic) return {options.method, {}};
  if (options.precision != FactorPrecision::automatic) return {};
  if (static_cast<double>(network.assembly.size()) < few_discs || network.springs.may_be_indefinite()) return {};
  const MethodForecast costs = forecast(network, options.right_hand_sides);
  const double memory = options.memory_limit > 0 ? options.memory_limit : available_memory();
  if (costs.elimination_bytes > memory && costs.multigrid_bytes < memory) {
    return {SolverMethod::multigrid,
            fmt::format("elimination would take about {}", readable_bytes(costs.elimination_bytes))};
  }
  constexpr double clearly = 1.25;
  const double ratio = costs.elimination / costs.multigrid;
  if (ratio > clearly) {
    return {SolverMethod::multigrid, fmt::format("elimination is estimated to take {:.1f} times as long", ratio)};
  }
  return {SolverMethod::multifrontal,
          ratio < 1 / clearly ? fmt::format("multigrid is estimated to take {:.1f} times as long", 1 / ratio)
                              : "multigrid is estimated to take about as long"};
}

}  // namespace equidem
