// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Which discs carry no load: cases that a human can check.
#include "equidem/statics/load_bearing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/core/random.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;

namespace {

/// Discs at given places in a cell (without a period where it is zero), touching where contacts say.
Assembly discs_at(std::vector<Vec2> centres, const std::vector<Contact>& contacts, Vec2 period = {}) {
  Assembly a;
  a.kind = "hand-made";
  a.centres = std::move(centres);
  a.radii.assign(a.centres.size(), 0.5);
  if (period.x > 0) a.period = period;
  for (Contact c : contacts) {
    c.lever_i = c.lever_j = 0.5 * norm(a.branch(c));
    a.contacts.push_back(c);
  }
  return a;
}

LoadBearingNetwork examine(const Assembly& assembly, double kT, Rotation rotation = Rotation::from_scene,
                           const std::vector<std::uint8_t>& held = {}) {
  const ContactSprings springs(SpringConstants{1, kT});
  return load_bearing_network(assembly, springs, derive_effects(springs, rotation), held);
}

}  // namespace

TEST_CASE("a_group_that_dangles_is_left_out_whole") {
  // A hexagonal block across the period in x, a triangle above it, joined as each case says.
  const double h = std::sqrt(3.0) / 2;
  const std::vector<Vec2> centres{{0, 0},   {1, 0},       {2, 0},       {3, 0},        {0.5, h},
                                  {1.5, h}, {0.5, h + 1}, {1.5, h + 1}, {1, 2 * h + 1}};
  std::vector<Contact> contacts{{0, 1, 0, 0, 0, 0}, {1, 2, 0, 0, 0, 0}, {2, 3, 0, 0, 0, 0}, {3, 0, 1, 0, 0, 0},
                                {0, 4, 0, 0, 0, 0}, {1, 4, 0, 0, 0, 0}, {1, 5, 0, 0, 0, 0}, {2, 5, 0, 0, 0, 0},
                                {4, 5, 0, 0, 0, 0}, {6, 7, 0, 0, 0, 0}, {7, 8, 0, 0, 0, 0}, {8, 6, 0, 0, 0, 0}};
  const auto join = [&](std::int32_t i, std::int32_t j) { contacts.push_back({i, j, 0, 0, 0, 0}); };
  const double kT = GENERATE(0.0, 0.5);
  const Rotation rotation = GENERATE(Rotation::free, Rotation::restrained);
  CAPTURE(kT, rotation == Rotation::free);
  const auto left_out = [&](const Assembly& assembly, const std::vector<std::uint8_t>& held = {}) {
    return examine(assembly, kT, rotation, held);
  };
  const Vec2 period{4, 8};
  SECTION("joined by nothing, it floats") {
    const LoadBearingNetwork found = left_out(discs_at(centres, contacts, period));
    CHECK(found.floating == 3);
    CHECK(found.dangling == 0);
    CHECK(found.spanned == 1);
    CHECK(found.pieces == 1);
    REQUIRE(found.sentences.size() == 1);
    CHECK(found.sentences[0] ==
          "3 floating discs (disc 6 at (0.5, 1.86603), disc 7 at (1.5, 1.86603), disc 8 at (1, 2.73205)) belong to "
          "pieces joined to none of their images and are left out");
  }
  SECTION("by a single contact") {
    join(4, 6);
    const LoadBearingNetwork found = left_out(discs_at(centres, contacts, period));
    CHECK(found.dangling == 3);
    CHECK(found.floating == 0);
    CHECK(found.pieces == 1);
  }
  SECTION("at a single disc") {
    join(4, 6);
    join(4, 7);
    Assembly assembly = discs_at(centres, contacts, period);
    CHECK(left_out(assembly).dangling == 3);
    for (Contact& c : assembly.contacts) c.lever_i *= 0.9;
    CAPTURE("levers that do not add up resist turning with the disc");
    CHECK(left_out(assembly).dangling == (kT != 0 && rotation == Rotation::free ? 0 : 3));
  }
  SECTION("at two discs, it carries where it is more than isostatic") {
    join(4, 6);
    join(5, 7);
    join(5, 6);
    CHECK(left_out(discs_at(centres, contacts, period)).removed() == (kT == 0 ? 3 : 0));
  }
  SECTION("held discs are kept with what joins them") {
    join(4, 6);
    join(4, 7);
    std::vector<std::uint8_t> held(centres.size(), 0);
    held[8] = 1;
    CHECK(left_out(discs_at(centres, contacts, period), held).removed() == 0);
  }
}

TEST_CASE("two_contacts_carry_force_where_they_are_in_line_or_both_resist_slip") {
  const auto bead = [](double height) {  // disc 1 between two held ones
    return discs_at({{0, 0}, {1, height}, {2, 0}}, {{0, 1, 0, 0, 0, 0}, {1, 2, 0, 0, 0, 0}});
  };
  const std::vector<std::uint8_t> held{1, 0, 1};
  const auto carries = [&](const Assembly& assembly, SpringConstants first, SpringConstants second, Rotation rotation) {
    const ContactSprings springs(std::vector<SpringConstants>{first, second});
    return load_bearing_network(assembly, springs, derive_effects(springs, rotation), held).removed() == 0;
  };
  for (const Rotation rotation : {Rotation::free, Rotation::restrained}) {
    CAPTURE(rotation == Rotation::free);
    CHECK(carries(bead(0), {1, 0}, {1, 0}, rotation));
    CHECK(!carries(bead(0.1), {1, 0}, {1, 0}, rotation));
    CHECK(carries(bead(0.1), {1, 0.5}, {1, 0.5}, rotation));
    CHECK(carries(bead(0), {1, 0.5}, {1, 0}, rotation));
    // Nothing balances the moment of a single tangential force, unless rotation is held or it has no lever.
    CHECK(carries(bead(0.1), {1, 0.5}, {1, 0}, rotation) == (rotation == Rotation::restrained));
    Assembly no_lever = bead(0.1);
    no_lever.contacts[0].lever_j = 0;
    CHECK(carries(no_lever, {1, 0.5}, {1, 0}, rotation));
  }
}

TEST_CASE("chains_and_rattlers") {
  const Assembly chain = test::chain_of_discs(12, 0.003);
  std::vector<std::uint8_t> held(12, 0);
  SECTION("a chain that nothing holds carries nothing") {
    const LoadBearingNetwork found = examine(chain, 0.5);
    CHECK(found.dangling == 12);
    CHECK(found.pieces == 0);
    REQUIRE(found.part);
    CHECK(found.part->assembly.size() == 0);
  }
  SECTION("held at its ends it carries; held inside, the ends dangle") {
    held[0] = held[11] = 1;
    CHECK(examine(chain, 0.5, Rotation::free, held).removed() == 0);
    held = std::vector<std::uint8_t>(12, 0);
    held[3] = held[7] = 1;
    const LoadBearingNetwork found = examine(chain, 0.0, Rotation::free, held);
    CHECK(found.dangling == 7);
    REQUIRE(found.part);
    CHECK(found.part->discs == std::vector<std::int32_t>{3, 4, 5, 6, 7});
  }
  SECTION("across the period it spans one direction") {
    const LoadBearingNetwork found = examine(test::assembly_kind("pair touching twice").assembly, 0.5);
    CHECK(found.removed() == 0);
    CHECK(found.spanned == 1);
  }
  SECTION("a disc that touches its own image carries, and what hangs on it dangles") {
    const double kT = GENERATE(0.0, 0.5);
    Assembly cell = discs_at({{0, 0}, {0, 1}}, {{0, 0, 1, 0, 0, 0}, {0, 1, 0, 0, 0, 0}}, {1, 3});
    const LoadBearingNetwork found = examine(cell, kT);
    CAPTURE(kT, found.sentences);
    CHECK(found.dangling == 1);
    CHECK(found.pieces == 1);
    CHECK(found.spanned == 1);
    REQUIRE(found.part);
    CHECK(found.part->discs == std::vector<std::int32_t>{0});
    CHECK(found.part->contacts == std::vector<std::int32_t>{0});
    // Two such discs joined by one contact, as rows that nothing else joins.
    cell.contacts.push_back({1, 1, 1, 0, 0.5, 0.5});
    CHECK(examine(cell, kT).removed() == 0);
    CHECK(examine(cell, kT).spanned == 1);
  }
  SECTION("rattlers are counted and named") {
    Assembly loose = chain;
    held[0] = held[11] = 1;
    for (int k = 0; k < 4; ++k) {
      loose.centres.push_back({0.1 + 0.01 * k, 0.5});
      loose.radii.push_back(0.001);
      held.push_back(0);
      const LoadBearingNetwork found = examine(loose, 0.0, Rotation::free, held);
      CHECK(found.rattlers == k + 1);
      REQUIRE(found.sentences.size() == 1);
      if (k == 0) CHECK(found.sentences[0] == "1 rattler (disc 12 at (0.1, 0.5)) touches nothing and is left out");
    }
    const LoadBearingNetwork found = examine(loose, 0.0, Rotation::free, held);
    CHECK(found.sentences[0] ==
          "4 rattlers (disc 12 at (0.1, 0.5), disc 13 at (0.11, 0.5), disc 14 at (0.12, 0.5), ...) touch nothing and "
          "are left out");
  }
}

TEST_CASE("the_part_keeps_what_belongs_to_its_discs_and_contacts") {
  Random random(33);
  Assembly whole = delaunay_assembly({.discs = 60, .seed = 5, .radii = {.smallest = 0.004, .largest = 0.006}});
  for (const Contact& c : whole.contacts) {
    whole.contact_kN.push_back(random.uniform(1, 2));
    whole.contact_kT.push_back(c.i % 7 == 0 ? 0.0 : random.uniform(0, 1));
  }
  std::erase_if(whole.groups, [](const auto& group) { return group.second.discs.size() < 3; });
  REQUIRE(!whole.groups.empty());
  // Cut every contact of some discs.
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < whole.contacts.size(); ++k) {
    const Contact& c = whole.contacts[k];
    if (c.i % 5 != 0 && c.j % 5 != 0) order.push_back(k);
  }
  Assembly cut = whole;
  cut.contacts.clear(), cut.facet_lengths.clear(), cut.contact_kN.clear(), cut.contact_kT.clear();
  for (const std::size_t k : order) {
    cut.contacts.push_back(whole.contacts[k]);
    cut.facet_lengths.push_back(whole.facet_lengths[k]);
    cut.contact_kN.push_back(whole.contact_kN[k]);
    cut.contact_kT.push_back(whole.contact_kT[k]);
  }
  const ContactSprings springs = contact_springs(cut, {}, SpringWeighting::uniform);
  const LoadBearingNetwork found = load_bearing_network(cut, springs, derive_effects(springs, Rotation::free));
  CAPTURE(found.sentences);
  CHECK(found.rattlers >= 12);
  REQUIRE(found.part);
  const Assembly& rest = found.part->assembly;
  CHECK_NOTHROW(check(rest));
  CHECK(rest.size() > 20);
  double area = 0;
  for (std::size_t d = 0; d < rest.size(); ++d) {
    const auto was = static_cast<std::size_t>(found.part->discs[d]);
    CHECK(rest.centres[d] == cut.centres[was]);
    CHECK(rest.radii[d] == cut.radii[was]);
    CHECK(rest.cell_areas[d] == cut.cell_areas[was]);
    area += rest.cell_areas[d];
  }
  CHECK(rest.area() == area);
  CHECK(area < cut.area());
  for (std::size_t k = 0; k < rest.contacts.size(); ++k) {
    const auto was = static_cast<std::size_t>(found.part->contacts[k]);
    CHECK(rest.branch(rest.contacts[k]) == cut.branch(cut.contacts[was]));
    CHECK(rest.facet_lengths[k] == cut.facet_lengths[was]);
    CHECK(rest.contact_kN[k] == cut.contact_kN[was]);
    CHECK(rest.contact_kT[k] == cut.contact_kT[was]);
    CHECK(found.part->springs[k].kN == springs[was].kN);
    CHECK(found.part->springs[k].kT == springs[was].kT);
  }
  for (const auto& [name, discs] : cut.groups) {
    const DiscGroup& kept = group(rest, name);
    CAPTURE(name, discs.discs.size(), kept.discs.size());
    std::size_t k = 0;
    for (std::size_t m = 0; m < discs.discs.size(); ++m) {
      const auto& numbers = found.part->discs;
      if (!std::binary_search(numbers.begin(), numbers.end(), discs.discs[m])) continue;
      REQUIRE(k < kept.discs.size());
      CHECK(numbers[kept.discs[k]] == discs.discs[m]);
      CHECK(kept.tributary_lengths[k++] == discs.tributary_lengths[m]);
    }
    CHECK(k == kept.discs.size());
  }
}

TEST_CASE("loose_bodies_are_those_that_no_contact_holds_in_place") {
  // A triangle, held at 0 and 1; beside it a disc on one contact (3), a disc on two (4), a pair that floats (5, 6), a
  // disc alone (7), and a chain of two (8, 9).
  const double h = std::sqrt(0.75);
  const Assembly a =
      discs_at({{0, 0}, {1, 0}, {0.5, h}, {-0.5, -h}, {1.5, h}, {5, 0}, {6, 0}, {9, 9}, {0.5, h + 1}, {0.5, h + 2}},
               {{.i = 0, .j = 1},
                {.i = 1, .j = 2},
                {.i = 0, .j = 2},
                {.i = 0, .j = 3},
                {.i = 1, .j = 4},
                {.i = 2, .j = 4},
                {.i = 5, .j = 6},
                {.i = 2, .j = 8},
                {.i = 8, .j = 9}});
  const std::vector<std::uint8_t> held{1, 1, 0, 0, 0, 0, 0, 0, 0, 0};
  const auto left = [&](double kT, Rotation rotation) {
    const ContactSprings springs(SpringConstants{1, kT});
    const auto found = load_bearing_network(a, springs, derive_effects(springs, rotation), held, LeaveOut::loose);
    return found.part ? found.part->discs : std::vector<std::int32_t>{};
  };
  CHECK(left(0.5, Rotation::free) == std::vector<std::int32_t>{0, 1, 2, 4});
  CHECK(left(0, Rotation::from_scene) == std::vector<std::int32_t>{0, 1, 2, 4});
  // A contact with kT joins a disc that cannot turn firmly.
  CHECK(left(0.5, Rotation::restrained) == std::vector<std::int32_t>{0, 1, 2, 3, 4, 8, 9});
}

TEST_CASE("a_bent_bridge_of_two_discs_is_loose_and_a_straight_one_carries") {
  // Between the corners 0 and 1 of two held pairs the bridge 2, 3: bent by `rise` it rolls under a load, straight it
  // carries a force along itself.
  const auto left = [](double rise, Rotation rotation) {
    const Assembly a =
        discs_at({{0, 0}, {3, 0}, {1, rise}, {2, rise}, {-1, 0}, {4, 0}},
                 {{.i = 0, .j = 2}, {.i = 2, .j = 3}, {.i = 1, .j = 3}, {.i = 0, .j = 4}, {.i = 1, .j = 5}});
    const ContactSprings springs(SpringConstants{1, 0.5});
    const std::vector<std::uint8_t> held{1, 1, 0, 0, 1, 1};
    const auto found = load_bearing_network(a, springs, derive_effects(springs, rotation), held, LeaveOut::loose);
    return found.part ? found.part->discs : std::vector<std::int32_t>{0, 1, 2, 3, 4, 5};
  };
  CHECK(left(0.2, Rotation::free) == std::vector<std::int32_t>{0, 1, 4, 5});
  CHECK(left(0, Rotation::free) == std::vector<std::int32_t>{0, 1, 2, 3, 4, 5});
  CHECK(left(0.2, Rotation::restrained) == std::vector<std::int32_t>{0, 1, 2, 3, 4, 5});
}
