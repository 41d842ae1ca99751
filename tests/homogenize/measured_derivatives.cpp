// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Derivatives of what is measured of an equilibrium against differences of fourth order, along a random direction in
/// the space of all springs, and against Euler's theorem.
#include "equidem/homogenize/measured_derivatives.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/random.hpp"
#include "equidem/homogenize/stress.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

using Springs = std::vector<SpringConstants>;

Springs random_constants(std::size_t contacts, double kN, double kT, double spread, std::uint64_t seed) {
  Random random(seed);
  Springs springs(contacts);
  for (SpringConstants& k : springs) k = {kN + spread * random.uniform(-1, 1), kT + spread * random.uniform(-1, 1)};
  return springs;
}

ContactSprings moved_along(const Springs& at, const Springs& along, double t) {
  Springs springs = at;
  for (std::size_t c = 0; c < at.size(); ++c) springs[c].kN += t * along[c].kN, springs[c].kT += t * along[c].kT;
  return ContactSprings(springs);
}

/// Sum over all springs of derivative times step, and of its magnitudes.
struct Sums {
  double sum = 0, magnitude = 0;
};
Sums along_direction(const SpringDerivatives& by, const Springs& along) {
  Sums sums;
  for (std::size_t c = 0; c < along.size(); ++c) {
    for (const double term : {by.by_kN[c] * along[c].kN, by.by_kT[c] * along[c].kT})
      sums.sum += term, sums.magnitude += std::abs(term);
  }
  return sums;
}

/// Numbers of a scene at its springs moved along the direction by t.
template <typename Numbers>
void check_against_differences(const Springs& along, const Numbers& numbers, double solver_error) {
  constexpr double h = 2e-3, of_differences = 1e-7;  // h⁴, and rounding over h
  const std::vector<MeasuredNumber> found = numbers(0);
  const std::vector<MeasuredNumber> near[] = {numbers(h / 2), numbers(-h / 2)}, far[] = {numbers(h), numbers(-h)};
  REQUIRE_FALSE(found.empty());
  for (std::size_t k = 0; k < found.size(); ++k) {
    const double inner = (near[0][k].value - near[1][k].value) / h,
                 outer = (far[0][k].value - far[1][k].value) / (2 * h), slope = (4 * inner - outer) / 3;
    const Sums all = along_direction(found[k], along);
    CAPTURE(found[k].symbol, found[k].value, slope, all.sum, all.magnitude);
    CHECK(all.magnitude > 0);
    CHECK(std::abs(slope - all.sum) <=
          of_differences * all.magnitude + solver_error * (found[k].scale / h + all.magnitude));
  }
}

}  // namespace

TEST_CASE("moduli_of_a_tension_test_change_with_springs_as_their_derivatives_say") {
  const SolverMethod method = GENERATE(SolverMethod::automatic, SolverMethod::multigrid);
  const Assembly block = hexagonal_lattice({.columns = 15, .rows = 13, .radius = 1});
  const TensionTest test{.stress = 0.01};
  const TensionSetup setup = tension_setup(block, test);
  const Springs at = random_constants(block.contacts.size(), 1, 0.5, 0.2, 3),
                along = random_constants(block.contacts.size(), 0, 0, 1, 4);
  const bool iterative = method == SolverMethod::multigrid;
  const SolverOptions solver_options{.method = method, .accuracy = iterative ? 1e-11 : SolverOptions{}.accuracy};
  const auto numbers = [&](double t) {
    const ContactSprings springs = moved_along(at, along, t);
    EquilibriumSolver solver(block, springs, setup.supports, {.solver = solver_options});
    const Equilibrium state = solver.solve(setup.loads);
    const TensionResult result = evaluate_tension(block, springs, test, setup, state);
    const std::vector<MeasuredNumber> found = tension_derivatives(solver, state, test, setup);
    CHECK(found[0].value == Approx(result.stress.xx / result.strain.xx).epsilon(1e-12));
    CHECK(found[1].value == Approx(result.poisson_ratio / (1 - result.poisson_ratio)).epsilon(1e-12));
    return found;
  };
  CAPTURE(iterative);
  check_against_differences(along, numbers, iterative ? 1e-9 : 0);
  const std::vector<MeasuredNumber> found = numbers(0);
  const double error = iterative ? 1e-8 : 1e-10;
  CHECK(along_direction(found[0], at).sum == Approx(found[0].value).epsilon(error));  // Euler: E of degree 1, nu of 0
  const Sums of_nu = along_direction(found[1], at);
  CHECK(std::abs(of_nu.sum) <= error * of_nu.magnitude);
}

TEST_CASE("displacements_and_stresses_change_with_springs_as_their_derivatives_say") {
  DelaunayOptions options;
  options.discs = 80;
  options.seed = 3;
  const Assembly block = delaunay_assembly(options);
  const Springs at = random_constants(block.contacts.size(), 1, 0.5, 0.2, 5),
                along = random_constants(block.contacts.size(), 0, 0, 1, 6);
  const double moved = GENERATE(0.0, 1e-3), pull = GENERATE(0.0, 0.01);
  if (moved == 0 && pull == 0) return;
  const std::vector<Support> supports{{.group = "left", .ux = 0.0, .uy = {}, .rotation = {}},
                                      {.group = "bottom", .ux = {}, .uy = 0.0, .rotation = {}},
                                      {.group = "top", .ux = {}, .uy = moved, .rotation = {}}};
  const LoadCase loads{{.group = "right", .kind = LoadKind::per_disc, .force = {pull, -0.5 * pull}},
                       {.group = "top", .kind = LoadKind::per_disc, .force = {0.3 * pull, 0}}};
  const auto both = [&](const ContactSprings& springs) {
    EquilibriumSolver solver(block, springs, supports);
    const Equilibrium state = solver.solve(loads);
    std::vector<MeasuredNumber> found = displacement_derivatives(solver, state, loads);
    const std::vector<MeasuredNumber> stresses = stress_derivatives(solver, state);
    const Voigt stress = voigt_stress(macroscopic_stress(block, state.contact_forces));
    const double components[] = {stress.xx, stress.yy, stress.xy};
    REQUIRE(stresses.size() == 3);
    for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(stresses[k].value - components[k]) <= 1e-12 * stresses[k].scale);
    found.insert(found.end(), stresses.begin(), stresses.end());
    return found;
  };
  CAPTURE(moved, pull);
  check_against_differences(
      along, [&](double t) { return both(moved_along(at, along, t)); }, 0);
  const std::vector<MeasuredNumber> found = both(ContactSprings(at));
  std::vector<std::string> symbols;
  for (const MeasuredNumber& number : found) {
    symbols.push_back(number.symbol);
    const bool stress = number.symbol.starts_with("stress");
    const Sums all = along_direction(number, at);
    CAPTURE(number.symbol, number.value, all.sum, all.magnitude);
    // Euler: under loads displacements are of degree -1 and stresses of 0, under motions of 0 and 1
    if (moved == 0) CHECK(std::abs(all.sum - (stress ? 0 : -number.value)) <= 1e-9 * all.magnitude);
    if (pull == 0) CHECK(std::abs(all.sum - (stress ? number.value : 0)) <= 1e-9 * all.magnitude);
  }
  // uy of the top is held
  CHECK(symbols == std::vector<std::string>{"right_ux", "right_uy", "top_ux", "stress_xx", "stress_yy", "stress_xy"});
}
