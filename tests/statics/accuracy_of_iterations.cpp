// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Iterations that end at the accuracy asked for.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "support/catch.hpp"
#include "support/motions.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

EquilibriumOptions solver_of(SolverMethod method, double accuracy = 0) {
  EquilibriumOptions options;
  options.solver.method = method;
  options.solver.accuracy = accuracy;
  return options;
}

struct Request {
  Assembly assembly;
  ContactSprings springs;
  std::vector<Support> supports;
  LoadCase loads;
};

Request random_request(Random& random) {
  const auto size = static_cast<int>(random.uniform(24, 45));
  Assembly assembly = random.uniform() < 0.3
                          ? hexagonal_lattice({.columns = size, .rows = size})
                          : delaunay_assembly({.discs = size * size,
                                               .seed = static_cast<std::uint64_t>(random.uniform(1, 1e6)),
                                               .radii = {.smallest = 0.004, .largest = random.uniform(0.004, 0.008)}});
  if (random.uniform() < 0.3) {
    std::vector<Contact> kept;
    for (const Contact& contact : assembly.contacts) {
      if (random.uniform() > 0.02) kept.push_back(contact);
    }
    assembly.contacts = kept;
    assembly.facet_lengths.clear();
  }
  std::vector<SpringConstants> springs(assembly.contacts.size());
  const double scatter = random.uniform() < 0.5 ? 0 : random.uniform(0, 1.5), ratio = random.uniform(0.1, 1);
  for (SpringConstants& k : springs) {
    k.kN = 1e9 * std::exp(scatter * random.uniform(-1, 1));
    k.kT = ratio * k.kN;
  }
  LoadCase loads;
  if (random.uniform() < 0.5) {
    loads.push_back(
        {.group = "right", .kind = LoadKind::per_disc, .force = {random.uniform(-1, 1), random.uniform(-1, 1)}});
  } else {
    auto& few = assembly.groups["few"].discs;
    for (int k = 0; k < 3; ++k)
      few.push_back(static_cast<std::int32_t>(random.uniform(0, static_cast<double>(assembly.size()))));
    std::sort(few.begin(), few.end());
    few.erase(std::unique(few.begin(), few.end()), few.end());
    loads.push_back({.group = "few", .kind = LoadKind::per_disc, .force = {random.uniform(-1, 1), 1}});
  }
  return {
      std::move(assembly), ContactSprings(springs), {{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}}, loads};
}

}  // namespace

TEST_CASE("motions_are_as_accurate_as_asked_for_in_95_of_100_random_requests") {
  Random random(12);
  constexpr int requests = 200;
  int within = 0, solved = 0;
  double worst = 0;
  std::string beyond;
  std::int64_t iterations = 0, few_iterations = 0, to_the_end = 0;
  for (int k = 0; k < requests; ++k) {
    const Request given = random_request(random);
    const double accuracy = std::pow(10.0, random.uniform(-9, -1));
    const auto solve = [&](const EquilibriumOptions& options) {
      return solve_equilibrium(given.assembly, given.springs, given.supports, given.loads, options);
    };
    Equilibrium exact;
    try {
      exact = solve(solver_of(SolverMethod::multifrontal));
    } catch (const Error&) {
      continue;  // what was left out makes it a mechanism
    }
    const Equilibrium result = solve(solver_of(SolverMethod::multigrid, accuracy));
    ++solved;
    iterations += result.iterations;
    if (k % 20 == 0) {
      few_iterations += result.iterations;
      to_the_end += solve(solver_of(SolverMethod::multigrid)).iterations;
    }
    const double over = relative_difference(given.assembly, result, exact) / accuracy;
    worst = std::max(worst, over);
    within += over <= 1 ? 1 : 0;
    if (over > 1) beyond += fmt::format("{:.1e}: {:.1f}; ", accuracy, over);
    CAPTURE(accuracy, result.error_bound, over);
    CHECK(result.error_bound > 0);
    CHECK(result.error_bound <= accuracy * 1.001);
  }
  CAPTURE(within, solved, worst, beyond, iterations, to_the_end);
  CHECK(within >= 0.95 * solved);
  CHECK(worst < 10);
  CHECK(solved > 0.8 * requests);
  CHECK(static_cast<double>(few_iterations) < 0.7 * static_cast<double>(to_the_end));
}

TEST_CASE("moduli_are_as_accurate_as_asked_for") {
  Random random(3);
  constexpr int requests = 40;
  int within = 0;
  for (int k = 0; k < requests; ++k) {
    const Assembly cell =
        delaunay_assembly({.discs = 900, .seed = static_cast<std::uint64_t>(k + 1), .periodic = true});
    const ContactSprings springs({1e9, random.uniform(0.05, 0.9) * 1e9});
    const double accuracy = std::pow(10.0, random.uniform(-10, -1));
    HomogenizeOptions options;
    options.solver.method = SolverMethod::multifrontal;
    const EffectiveStiffness exact = effective_stiffness(cell, springs, options);
    options.solver.method = SolverMethod::multigrid;
    options.solver.accuracy = std::sqrt(0.1 * accuracy);
    const EffectiveStiffness result = effective_stiffness(cell, springs, options);
    double off = 0;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) off = std::max(off, std::abs(result.stiffness[a][b] - exact.stiffness[a][b]));
    }
    const double size = largest_entry(exact.stiffness);
    within += off <= accuracy * size ? 1 : 0;
    CAPTURE(accuracy, off / size, result.error_bound / size);
    CHECK(off <= result.error_bound + exact.error_bound);
    CHECK(result.error_bound <= accuracy * size);
  }
  CHECK(within >= 0.95 * requests);
}
