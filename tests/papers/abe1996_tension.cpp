// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Abe (1996), section 3: the tension test of Fig. 6, nu of eq. (35) against (1 - kT/kN)/4 (Fig. 7) and the stiffness
/// of eq. (36) against eq. (37) (Fig. 8).
///
/// A strip with free top and bottom is in uniform strain away from its ends, but its top and bottom rows lack the
/// contacts to a next row: of R rows, R - 2r/(3(1 + r)) bear the stress of the bulk, r = kT/kN. The error of eq.
/// (36) on a block of n rows is therefore of order 1/n, and none where kT = 0.
#include <cmath>
#include <numbers>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/material/spring_relations.hpp"

#include "homogenize/samples.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace samples;
using std::numbers::sqrt3;

namespace {

constexpr double disc_radius = 0.005;
constexpr double stiffness = 1e9;
constexpr double pull = 1e6;

struct Run {
  Assembly assembly;
  TensionSetup setup;
  Equilibrium equilibrium;
  TensionResult result;
};

Run run_tension(int columns, int rows, double ratio, GaugePlacement gauge = GaugePlacement::centre,
                Rotation rotation = Rotation::from_scene) {
  Run run;
  run.assembly = hexagonal_lattice({.columns = columns, .rows = rows, .radius = disc_radius, .periodic = false});
  const TensionTest test{.stress = pull, .gauge = gauge};
  const ContactSprings springs(SpringConstants{stiffness, ratio * stiffness});
  run.setup = tension_setup(run.assembly, test);
  run.equilibrium = solve_equilibrium(run.assembly, springs, run.setup.supports, run.setup.loads,
                                      {.rotation = rotation, .solver = {}});
  run.result = evaluate_tension(run.assembly, springs, test, run.setup, run.equilibrium);
  return run;
}

/// Slope of log(error) over log(size): least squares.
double convergence_order(const std::vector<double>& sizes, const std::vector<double>& errors) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const double count = static_cast<double>(sizes.size());
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    x += std::log(sizes[k]) / count;
    y += std::log(errors[k]) / count;
  }
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    const double dx = std::log(sizes[k]) - x;
    xx += dx * dx;
    xy += dx * (std::log(errors[k]) - y);
  }
  return xy / xx;
}

/// Rows of the bulk that are as stiff as a strip of `rows`.
double bearing_rows(int rows, double ratio) {
  return rows - 2 * ratio / (3 * (1 + ratio));
}

}  // namespace

TEST_CASE("without_tangential_springs_the_tension_test_is_exact_at_every_size_and_gauge") {
  struct Size {
    int columns, rows;
  };
  for (const Size size : {Size{5, 5}, Size{7, 9}, Size{8, 6}, Size{11, 11}, Size{20, 13}, Size{21, 21}}) {
    for (const GaugePlacement gauge : {GaugePlacement::centre, GaugePlacement::quarter, GaugePlacement::ends}) {
      const Run run = run_tension(size.columns, size.rows, 0, gauge);
      CAPTURE(size.columns, size.rows, to_string(gauge), run.equilibrium.relative_residual);
      CHECK(run.result.poisson_ratio == Approx(poisson_ratio_of_ratio(0)).epsilon(1e-12));
      CHECK(run.result.stiffness_ratio == Approx(hexagonal_stiffness_ratio(0)).epsilon(1e-12));
      CHECK(run.result.fitted_poisson_ratio == Approx(poisson_ratio_of_ratio(0)).epsilon(1e-12));
    }
  }
}

TEST_CASE("poisson_ratio_and_stiffness_of_the_tension_test_converge_to_theory_as_one_over_size") {
  const GaugePlacement gauge = GENERATE(GaugePlacement::centre, GaugePlacement::quarter);
  const std::vector<double> sizes = {33, 65, 129};
  for (int tenth = 1; tenth <= 10; ++tenth) {
    const double ratio = tenth / 10.0;
    std::vector<double> poisson_errors, stiffness_errors;
    for (const double size : sizes) {
      const int n = static_cast<int>(size);
      const TensionResult result = run_tension(n, n, ratio, gauge).result;
      poisson_errors.push_back(std::abs(result.poisson_ratio - poisson_ratio_of_ratio(ratio)));
      stiffness_errors.push_back(std::abs(result.stiffness_ratio / hexagonal_stiffness_ratio(ratio) - 1));
    }
    const double poisson_order = convergence_order(sizes, poisson_errors);
    const double stiffness_order = convergence_order(sizes, stiffness_errors);
    CAPTURE(to_string(gauge), ratio, poisson_errors, stiffness_errors, poisson_order, stiffness_order);
    CHECK(poisson_order == Approx(-1).margin(0.1));
    CHECK(stiffness_order == Approx(-1).margin(0.1));
    CHECK(poisson_errors.back() < 0.2 / sizes.back());
    CHECK(stiffness_errors.back() < 1 / sizes.back());
  }
}

TEST_CASE("a_long_strip_bears_its_load_on_a_known_share_of_its_height") {
  const int rows = GENERATE(5, 6, 9);
  for (const double ratio : {0.1, 0.5, 1.0}) {
    const Run run = run_tension(20 * rows, rows, ratio);
    const double height = sqrt3 * disc_radius * bearing_rows(rows, ratio);
    const double stiffness = run.result.stiffness_ratio * run.setup.height / height;
    CAPTURE(rows, ratio, run.result.poisson_ratio, stiffness, run.equilibrium.relative_residual);
    CHECK(run.result.poisson_ratio == Approx(poisson_ratio_of_ratio(ratio)).margin(1e-10));
    // plane stress, section 2: nu/(1 + nu) = (1 - r)/4
    CHECK(-run.result.strain.yy / run.result.strain.xx == Approx((1 - ratio) / (3 + ratio)).margin(1e-10));
    CHECK(stiffness == Approx(hexagonal_stiffness_ratio(ratio)).epsilon(1e-10));
  }
}

TEST_CASE("the_loads_of_the_uniform_state_make_the_tension_test_exact_on_a_block") {
  // The loads stand for the contacts that the rim lacks. Per row, mean f_h + f_d: f_h at short, f_h + 2 f_d at long
  // ones and f_h + f_d at the corners, f_d/(f_h + f_d) = 2r/(3(1 + r)); the equal loads of the paper bend the field.
  const int size = GENERATE(7, 21);
  for (const double ratio : {-0.2, 0.1, 0.5, 1.0}) {
    Assembly block = hexagonal_lattice({.columns = size, .rows = size, .radius = disc_radius});
    const ContactSprings springs(SpringConstants{stiffness, ratio * stiffness});
    const TensionTest test{.stress = pull};
    TensionSetup setup = tension_setup(block, test);
    const double e11 = pull / (stiffness * hexagonal_stiffness_ratio(ratio));
    const Tensor2 strain{e11, 0, 0, -(1 - ratio) / (3 + ratio) * e11};
    const auto missing = contact_resultants(block, affine_contact_forces(block, springs, strain, 0));
    const double row = pull * sqrt3 * disc_radius;
    setup.loads.clear();
    for (std::size_t disc = 0; disc < block.size(); ++disc) {
      if (norm(missing[disc].force) < 1e-9 * row && std::abs(missing[disc].moment) < 1e-9 * row * disc_radius) continue;
      const std::string name = "disc " + std::to_string(disc);
      block.groups[name] = {.discs = {static_cast<std::int32_t>(disc)}, .tributary_lengths = {}};
      setup.loads.push_back({.group = name, .force = -missing[disc].force, .moment = -missing[disc].moment});
    }
    const std::vector<std::int32_t>& right = group(block, "right").discs;
    const double diagonal = 2 * ratio / (3 * (1 + ratio));
    CAPTURE(size, ratio, missing[right[0]].force.x / row, missing[right[1]].force.x / row);
    CHECK(-missing[right[0]].force.x / row == Approx(1).epsilon(1e-12));
    CHECK(-missing[right[1]].force.x / row == Approx(1 - diagonal).epsilon(1e-12));
    CHECK(-missing[right[2]].force.x / row == Approx(1 + diagonal).epsilon(1e-12));

    const Equilibrium rest = solve_equilibrium(block, springs, setup.supports, setup.loads);
    const TensionResult exact = evaluate_tension(block, springs, test, setup, rest);
    CHECK(exact.poisson_ratio == Approx(poisson_ratio_of_ratio(ratio)).margin(1e-11));
    CHECK(exact.stiffness_ratio == Approx(hexagonal_stiffness_ratio(ratio)).epsilon(1e-11));
    const double equal_loads = run_tension(size, size, ratio).result.poisson_ratio;
    CHECK(std::abs(equal_loads - poisson_ratio_of_ratio(ratio)) > 0.01 * std::abs(ratio) / size);
  }
}

TEST_CASE("stress_is_uniform_and_uniaxial_in_a_strip_away_from_its_ends") {
  const int rows = 9, columns = 180;
  for (const double ratio : {0.0, 0.3, 1.0}) {
    const Run run = run_tension(columns, rows, ratio);
    const auto stresses = disc_stresses(run.assembly, run.equilibrium.contact_forces);
    const Tensor2 expected{pull * rows / bearing_rows(rows, ratio), 0, 0, 0};
    const double middle = columns * disc_radius;
    const auto near_middle = [&](std::size_t disc) {
      return std::abs(run.assembly.centres[disc].x - middle) < 10 * disc_radius;
    };
    const double lowest = 1.01 * run.assembly.centres.front().y;
    const double highest = run.assembly.centres.back().y - 0.01 * disc_radius;
    double worst = 0;
    for (std::size_t disc = 0; disc < stresses.size(); ++disc) {
      const double y = run.assembly.centres[disc].y;
      if (near_middle(disc) && y > lowest && y < highest) worst = std::max(worst, difference(stresses[disc], expected));
    }
    CAPTURE(ratio, expected.xx, worst);
    CHECK(worst < 1e-9 * pull);
  }
}

TEST_CASE("stress_of_the_block_is_that_of_its_loads_and_reactions") {
  const Rotation rotation = GENERATE(Rotation::free, Rotation::restrained);
  const Run run = run_tension(14, 11, 0.6, GaugePlacement::centre, rotation);
  Tensor2 outer_stress;
  for (const Load& load : run.setup.loads) {
    const DiscGroup& side = group(run.assembly, load.group);
    for (std::size_t k = 0; k < side.discs.size(); ++k)
      outer_stress += side.tributary_lengths[k] * outer(load.force, run.assembly.centres[side.discs[k]]);
  }
  for (const Reaction& reaction : run.equilibrium.reactions)
    outer_stress += outer(reaction.force, run.assembly.centres[reaction.disc]);
  outer_stress *= 1 / run.assembly.area();
  const Tensor2 inner_stress = macroscopic_stress(run.assembly, run.equilibrium.contact_forces);
  CAPTURE(shown(outer_stress), shown(inner_stress));
  CHECK(difference(outer_stress, inner_stress) < 1e-11 * pull);
}

TEST_CASE("stress_of_a_solved_block_is_symmetric_where_discs_turn_freely_and_else_balanced_by_moments") {
  const Run free = run_tension(14, 11, 0.6, GaugePlacement::centre, Rotation::free);
  double worst = 0;
  for (const Tensor2& s : disc_stresses(free.assembly, free.equilibrium.contact_forces))
    worst = std::max(worst, std::abs(asymmetry(s)));
  CAPTURE(worst);
  CHECK(worst < 1e-10 * pull);
  CHECK(free.equilibrium.rotation_moments.empty());

  const Run held = run_tension(14, 11, 0.6, GaugePlacement::centre, Rotation::restrained);
  const auto stresses = disc_stresses(held.assembly, held.equilibrium.contact_forces);
  const std::vector<double>& moments = held.equilibrium.rotation_moments;
  REQUIRE(moments.size() == held.assembly.size());
  double unbalanced = 0, strongest = 0;
  for (std::size_t disc = 0; disc < moments.size(); ++disc) {
    const double density = moments[disc] / held.assembly.cell_areas[disc];
    unbalanced = std::max(unbalanced, std::abs(asymmetry(stresses[disc]) - density));
    strongest = std::max(strongest, std::abs(density));
  }
  CAPTURE(unbalanced, strongest);
  CHECK(unbalanced < 1e-11 * pull);
  CHECK(strongest > 1e-3 * pull);
}

TEST_CASE("restrained_rotation_does_not_change_nu_of_the_tension_test_of_a_long_strip") {
  // Not nu' = (1 - 5r)/(4(1 - r)) of eq. (53), which describes the displacement operator.
  const double ratio = 0.15;
  const Run run = run_tension(120, 6, ratio, GaugePlacement::centre, Rotation::restrained);
  CAPTURE(run.result.poisson_ratio, (1 - 5 * ratio) / (4 * (1 - ratio)));
  CHECK(run.result.poisson_ratio == Approx(poisson_ratio_of_ratio(ratio)).margin(1e-10));
}
