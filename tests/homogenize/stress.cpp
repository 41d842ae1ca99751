// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Stress from contact forces: what holds for any forces on any assembly.
#include "equidem/homogenize/stress.hpp"

#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "equidem/core/threads.hpp"

#include "homogenize/samples.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace samples;

TEST_CASE("disc_stresses_weighted_by_their_cells_are_the_macroscopic_stress") {
  const bool periodic = GENERATE(false, true);
  for (const auto& [name, assembly] : assemblies(periodic)) {
    CAPTURE(name, periodic);
    const auto forces = random_forces(assembly, 1);
    const auto stresses = disc_stresses(assembly, forces);
    const Tensor2 whole = macroscopic_stress(assembly, forces);
    const double scale = scaled_stress(assembly, forces).scale;
    const auto all = [](std::size_t) { return true; };
    CAPTURE(shown(whole));
    CHECK(difference(average_stress(assembly, stresses, all), whole) < 1e-13 * scale);
    CHECK(largest(whole) > 1e-3 * scale);  // a test of zero would prove nothing

    // Two halves, weighted by their areas, make the whole.
    double left_area = 0;
    const double middle = 0.5 * (assembly.centres.front().x + assembly.centres.back().x);
    const auto left = [&, &assembly = assembly](std::size_t disc) { return assembly.centres[disc].x < middle; };
    for (std::size_t disc = 0; disc < assembly.size(); ++disc)
      if (left(disc)) left_area += assembly.cell_areas[disc];
    const double share = left_area / assembly.area();
    const Tensor2 halves =
        share * average_stress(assembly, stresses, left) +
        (1 - share) * average_stress(assembly, stresses, [&](std::size_t disc) { return !left(disc); });
    CAPTURE(share);
    CHECK(difference(halves, whole) < 1e-12 * scale);
  }
}

TEST_CASE("stress_of_a_free_block_is_the_stress_of_the_outer_forces_that_balance_it") {
  // Love and Weber: sum_contacts F_i l_j = sum_discs f_i x_j for the outer forces f = -(contact forces).
  for (const auto& [name, assembly] : assemblies(false)) {
    const auto forces = random_forces(assembly, 2);
    const auto resultants = contact_resultants(assembly, forces);
    Tensor2 outer_stress;
    for (std::size_t disc = 0; disc < assembly.size(); ++disc)
      outer_stress += outer(-resultants[disc].force, assembly.centres[disc]);
    outer_stress *= 1 / assembly.area();
    const Tensor2 inner_stress = macroscopic_stress(assembly, forces);
    CAPTURE(name, shown(inner_stress), shown(outer_stress));
    CHECK(difference(inner_stress, outer_stress) < 1e-12 * scaled_stress(assembly, forces).scale);
  }
}

TEST_CASE("asymmetry_of_stress_is_the_outer_moment_per_area_disc_by_disc_and_as_a_whole") {
  const bool periodic = GENERATE(false, true);
  for (const auto& [name, assembly] : assemblies(periodic)) {
    const auto forces = random_forces(assembly, 3);
    const auto stresses = disc_stresses(assembly, forces);
    const auto resultants = contact_resultants(assembly, forces);
    std::vector<double> holding(assembly.size());
    double worst = 0;
    for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
      holding[disc] = -resultants[disc].moment;
      worst = std::max(worst, std::abs(asymmetry(stresses[disc]) - holding[disc] / assembly.cell_areas[disc]));
    }
    const double scale = scaled_stress(assembly, forces).scale;
    const double difference = asymmetry(macroscopic_stress(assembly, forces));
    const double density = std::accumulate(holding.begin(), holding.end(), 0.0) / assembly.area();
    CAPTURE(name, periodic, worst, difference, density);
    CHECK(worst < 1e-13 * scale);
    CHECK(std::abs(difference - density) < 1e-13 * scale);
    CHECK(std::abs(difference) > 1e-4 * scale);
  }
}

TEST_CASE("normal_forces_alone_make_symmetric_stress") {
  for (const auto& [name, assembly] : assemblies(true)) {
    auto forces = random_forces(assembly, 4);
    for (ContactForce& f : forces) f.tangential = 0;
    CAPTURE(name);
    for (const Tensor2& s : disc_stresses(assembly, forces))
      REQUIRE(std::abs(asymmetry(s)) <= 1e-14 * scaled_stress(assembly, forces).scale);
  }
}

TEST_CASE("tension_of_one_contact_is_positive_stress_along_it_and_none_across") {
  Assembly pair;
  pair.centres = {{0, 0}, {3, 0}};
  pair.radii = {1, 2};
  pair.contacts = {{0, 1, 0, 0, 1, 2}};
  pair.cell_areas = {4, 16};
  const auto stresses = disc_stresses(pair, std::vector<ContactForce>{{.normal = 8, .tangential = 0}});
  CHECK(stresses[0].xx == Approx(8.0 * 1 / 4));
  CHECK(stresses[1].xx == Approx(8.0 * 2 / 16));
  CHECK(stresses[0].yy == 0);
}

TEST_CASE("naming_the_other_disc_of_a_contact_first_changes_no_stress") {
  const bool periodic = GENERATE(false, true);
  for (const auto& [name, assembly] : assemblies(periodic)) {
    const auto forces = random_forces(assembly, 5);
    Assembly turned = assembly;
    for (Contact& c : turned.contacts) {
      std::swap(c.i, c.j);
      std::swap(c.lever_i, c.lever_j);
      c.shift_x = -c.shift_x;
      c.shift_y = -c.shift_y;
    }
    const auto before = disc_stresses(assembly, forces);
    const auto after = disc_stresses(turned, forces);
    CAPTURE(name, periodic);
    for (std::size_t disc = 0; disc < before.size(); ++disc) {
      CAPTURE(disc, shown(before[disc]), shown(after[disc]));
      REQUIRE(difference(before[disc], after[disc]) < 1e-12 * scaled_stress(assembly, forces).scale);
    }
  }
}

TEST_CASE("stress_turns_with_the_assembly") {
  constexpr double angle = 0.7;
  const Tensor2 turn{std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)};
  const Tensor2 back{turn.xx, turn.yx, turn.xy, turn.yy};
  const auto product = [](const Tensor2& a, const Tensor2& b) {
    return Tensor2{a.xx * b.xx + a.xy * b.yx, a.xx * b.xy + a.xy * b.yy, a.yx * b.xx + a.yy * b.yx,
                   a.yx * b.xy + a.yy * b.yy};
  };
  for (const auto& [name, assembly] : assemblies(false)) {
    const auto forces = random_forces(assembly, 6);
    Assembly turned = assembly;
    for (Vec2& x : turned.centres) x = turn * x;
    const Tensor2 expected = product(product(turn, macroscopic_stress(assembly, forces)), back);
    const Tensor2 found = macroscopic_stress(turned, forces);
    CAPTURE(name, shown(expected), shown(found));
    CHECK(difference(expected, found) < 1e-12 * scaled_stress(assembly, forces).scale);
  }
}

TEST_CASE("macroscopic_stress_has_the_same_bits_for_every_number_of_threads") {
  const Assembly assembly = hexagonal_lattice({.columns = 80, .rows = 80, .radius = 0.005, .periodic = true});
  const auto forces = random_forces(assembly, 7);
  const int before = thread_count();
  set_thread_count(1);
  const Tensor2 one = macroscopic_stress(assembly, forces);
  set_thread_count(3);
  const Tensor2 three = macroscopic_stress(assembly, forces);
  set_thread_count(before);
  CHECK(one.xx == three.xx);
  CHECK(one.xy == three.xy);
  CHECK(one.yx == three.yx);
  CHECK(one.yy == three.yy);
}

TEST_CASE("stress_needs_cells") {
  Assembly assembly = square_lattice({.columns = 3, .rows = 3, .radius = 1, .periodic = false});
  const auto forces = random_forces(assembly, 8);
  assembly.cell_areas[4] = 0;
  const std::string empty_cell = message_of([&] { static_cast<void>(disc_stresses(assembly, forces)); });
  CAPTURE(empty_cell);
  CHECK(contains(empty_cell, "disc 4 has the cell area 0 m²"));
  assembly.cell_areas.clear();
  const std::string no_cells = message_of([&] { static_cast<void>(disc_stresses(assembly, forces)); });
  CAPTURE(no_cells);
  CHECK(contains(no_cells, "the discs have no cell areas"));
}
