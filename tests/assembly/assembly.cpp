// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/assembly.hpp"

#include <cmath>
#include <functional>
#include <limits>

#include "equidem/assembly/lattices.hpp"
#include "equidem/assembly/touching.hpp"
#include "equidem/core/error.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// Two discs side by side, and what `spoil` does to them.
Assembly pair_of_discs(const std::function<void(Assembly&)>& spoil = [](Assembly&) {}) {
  Assembly a;
  a.centres = {{0, 0}, {2, 0}};
  a.radii = {1, 1};
  a.contacts = {{.i = 0, .j = 1, .lever_i = 1, .lever_j = 1}};
  a.cell_areas = {4, 4};
  a.facet_lengths = {2};
  a.contact_kN = {1};
  a.contact_kT = {-1};
  a.groups["ends"] = {.discs = {0, 1}, .tributary_lengths = {2, 2}};
  spoil(a);
  return a;
}

}  // namespace

TEST_CASE("a_sound_assembly_passes") {
  CHECK_NOTHROW(check(pair_of_discs()));
  CHECK_NOTHROW(check(hexagonal_lattice({})));
  CHECK_NOTHROW(check(square_lattice({.columns = 1, .rows = 1, .periodic = true})));
  CHECK_NOTHROW(check(pair_of_discs([](Assembly& a) { a.groups["empty"] = {}; })));
}

TEST_CASE("what_breaks_an_assembly_is_named") {
  const double infinity = std::numeric_limits<double>::infinity();
  struct Case {
    std::function<void(Assembly&)> spoil;
    const char* sentence;
  };
  const std::vector<Case> cases = {
      {[](Assembly& a) { a = {}; }, "the assembly has no discs (there is nothing to solve for). Give it discs."},
      {[](Assembly& a) { a.radii.pop_back(); },
       "1 radii are given for 2 discs (there must be one for each). Give 2 radii, or none."},
      {[](Assembly& a) { a.radii[1] = 0; }, "disc 1 has the radius 0 (radii must be positive and finite). Correct it."},
      {[](Assembly& a) { a.radii[0] = -2.5; },
       "disc 0 has the radius -2.5 (radii must be positive and finite). Correct it."},
      {[](Assembly& a) { a.radii[0] = NAN; },
       "disc 0 has the radius nan (radii must be positive and finite). Correct it."},
      {[&](Assembly& a) { a.centres[1].y = infinity; },
       "disc 1 has its centre at (2, inf) (centres must be finite). Correct its coordinates."},
      {[](Assembly& a) {
         a.cell_areas = {1, -1};
       },
       "disc 1 has the cell area -1 (cell areas must be finite and not negative). Measure the cells anew."},
      {[](Assembly& a) { a.cell_areas = {1}; },
       "1 cell areas are given for 2 discs (there must be one for each). Give 2 cell areas, or none."},
      {[](Assembly& a) { a.contacts[0].j = 7; },
       "contact 0 names disc 7 (the discs are numbered from 0 to 1). Correct the contact or add the disc."},
      {[](Assembly& a) { a.contacts[0].i = -1; },
       "contact 0 names disc -1 (the discs are numbered from 0 to 1). Correct the contact or add the disc."},
      {[](Assembly& a) { a.contacts[0].j = 0; },
       "contact 0 joins disc 0 to itself (a disc can only touch another disc or its own image across a "
       "period). "
       "Remove the contact or give it a shift."},
      {[](Assembly& a) { a.contacts[0].shift_x = 1; },
       "contact 0, of disc 0 and the image of disc 1 shifted by (1, 0) periods, reaches across a period (the "
       "assembly "
       "has no period). Give the cell its period, or set the shift of the contact to 0."},
      {[](Assembly& a) { a.centres[1] = a.centres[0]; },
       "contact 0, of discs 0 and 1, spans the branch (0, 0) (its length must be finite and positive, or it "
       "has no "
       "direction). Move one of the discs."},
      {[](Assembly& a) { a.contacts[0].lever_j = -0.1; },
       "contact 0, of discs 0 and 1, has the lever arm -0.1 (lever arms must be finite and not negative). "
       "Correct "
       "it."},
      {[](Assembly& a) {
         a.facet_lengths = {2, 2};
       },
       "2 facet lengths are given for 1 contacts (there must be one for each). Give 1 facet lengths, or "
       "none."},
      {[](Assembly& a) { a.facet_lengths[0] = NAN; },
       "contact 0, of discs 0 and 1, has the facet length nan (facet lengths must be finite and not "
       "negative). "
       "Measure the cells anew."},
      {[](Assembly& a) { a.contact_kT.clear(); },
       "0 tangential springs are given for 1 contacts (there must be one for each). Give 1 tangential "
       "springs, or "
       "none."},
      {[](Assembly& a) { a.contact_kN[0] = 0; },
       "contact 0, of discs 0 and 1, has kN = 0 Pa (a normal spring must be positive and finite). Correct it "
       "or remove "
       "the contact."},
      {[&](Assembly& a) { a.contact_kT[0] = infinity; },
       "contact 0, of discs 0 and 1, has kT = inf Pa (a tangential spring must be finite). Correct it."},
      {[](Assembly& a) {
         a.contact_curvature_i = {2};
         a.contact_curvature_j = {-2};
       },
       "contact 0, of discs 0 and 1, has the curvatures 2 and -2 1/m (they must be finite, and two flat or two "
       "congruent "
       "surfaces have no normal of their own). Correct them."},
      {[](Assembly& a) { a.contact_normal_force = {-1}; },
       "0 tangential forces are given for 1 contacts (there must be one for each). Give 1 tangential forces, or none."},
      {[](Assembly& a) {
         a.contact_normal_force = {NAN};
         a.contact_tangential_force = {0};
       },
       "contact 0, of discs 0 and 1, carries the forces nan and 0 N/m at rest (they must be finite). Correct them."},
      {[](Assembly& a) {
         a.period = Vec2{4, 0};
       },
       "the period is (4, 0) m (both lengths of a periodic cell must be positive and finite). Correct the "
       "cell."},
      {[](Assembly& a) {
         a.groups["ends"].discs = {0, 2};
       },
       "group 'ends' names disc 2 (the discs are numbered from 0 to 1). Correct the group or add the disc."},
      {[](Assembly& a) {
         a.groups["ends"].discs = {1, 1};
       },
       "group 'ends' names disc 1 after disc 1 (the discs of a group must ascend, each once). Sort them and "
       "drop "
       "repetitions."},
      {[](Assembly& a) { a.groups["ends"].tributary_lengths = {1}; },
       "1 tributary lengths of group 'ends' are given for 2 discs of it (there must be one for each). Give 2 "
       "tributary "
       "lengths of group 'ends', or none."},
      {[](Assembly& a) { a.groups["ends"].tributary_lengths[1] = -3; },
       "disc 1 of group 'ends' has the tributary length -3 (tributary lengths must be finite and not "
       "negative). Correct "
       "it."},
  };
  for (const Case& broken : cases) {
    const Assembly a = pair_of_discs(broken.spoil);
    CHECK_THROWS_WITH(check(a), broken.sentence);
    try {
      check(a);
    } catch (const Error& error) {
      CHECK(error.kind() == ErrorKind::bad_input);
    }
  }
}

TEST_CASE("groups_are_found_by_name") {
  const Assembly a = pair_of_discs([](Assembly& spoilt) { spoilt.groups["empty"] = {}; });
  CHECK(group(a, "ends").discs.size() == 2);
  CHECK(group(a, "empty").discs.empty());
  CHECK_THROWS_WITH(group(a, "end"), "the assembly has no group 'end' (its groups are empty, ends). Name one of them.");
  CHECK_THROWS_WITH(group(Assembly{}, "left"),
                    Catch::Matchers::StartsWith("the assembly has no group 'left' (it has no groups at all)"));
}

TEST_CASE("measures_of_an_assembly_are_means_over_its_discs") {
  const Assembly a = pair_of_discs([](Assembly& unequal) { unequal.radii = {1, 0.5}; });
  CHECK(a.area() == 8);
  CHECK(a.mean_radius() == 0.75);
  CHECK(a.coordination_number() == 1);
  CHECK(a.solid_fraction() == Approx(std::acos(-1.0) * 1.25 / 8));
  CHECK_THROWS_WITH(pair_of_discs([](Assembly& bare) { bare.cell_areas.clear(); }).area(),
                    Catch::Matchers::StartsWith("the assembly has no cell areas"));
}

TEST_CASE("discs_in_a_box_have_their_centre_inside_or_on_its_sides") {
  Assembly row;
  row.centres = {{0, 0}, {1, 0}, {2, 0}};
  CHECK(discs_in(row, {{1, -1}, {2, 1}}).discs == std::vector<std::int32_t>{1, 2});
  CHECK_THROWS_WITH(discs_in(row, {{3, -1}, {4, 1}}), Catch::Contains("the centres lie in [0, 0, 2, 0]"));
}

TEST_CASE("gaps_at_contacts_are_those_of_the_discs") {
  const GapRange touching = gaps_at_contacts(hexagonal_lattice({.columns = 4, .rows = 4, .radius = 0.5}));
  CHECK(std::abs(touching.smallest) < 1e-14);
  CHECK(std::abs(touching.largest) < 1e-14);
  Assembly three;
  three.centres = {{0, 0}, {3, 0}, {3, 4}};
  three.radii = {1, 1, 4};
  three.contacts = {{.i = 0, .j = 1}, {.i = 1, .j = 2}};
  CHECK(gaps_at_contacts(three).largest == Approx(0.5));    // 3/(1 + 1) - 1
  CHECK(gaps_at_contacts(three).smallest == Approx(-0.2));  // 4/(1 + 4) - 1
  three.sections.resize(3);
  CHECK(gaps_at_contacts(three).largest == 0);
}

TEST_CASE("advice_names_a_larger_tolerance_where_one_found_the_contacts") {
  Assembly found;
  CHECK(by_larger_tolerance(found).empty());
  found.gap_tolerance = 0.05;
  CHECK(by_larger_tolerance(found) == " by a gap_tolerance above 0.05");
}

TEST_CASE("discs_that_are_found_touch_where_their_radii_meet_and_larger_gaps_join_more_of_them") {
  // In a row the gaps are 0, 1.5, 4 and 30 % of the sum of the two radii, and 44 % across the third disc.
  Assembly row;
  row.radii = {1, 2, 1, 3, 1};
  row.centres = {{0, 0}, {3, 0}, {6.045, 0}, {10.205, 0}, {15.405, 0}};
  for (const auto& [tolerance, found] : {std::pair{0.0, 1}, {0.01, 1}, {0.02, 2}, {0.05, 3}, {0.2, 3}, {0.5, 5}}) {
    CAPTURE(tolerance);
    const std::vector<Contact> contacts = touching_discs(row, tolerance);
    CHECK(std::ssize(contacts) == found);
    for (const Contact& c : contacts) {
      const double share = row.radii[c.i] / (row.radii[c.i] + row.radii[c.j]);
      CHECK(c.lever_i + c.lever_j == Approx(norm(row.branch(c))));
      CHECK(c.lever_i == Approx(share * norm(row.branch(c))));
    }
    for (const BondCount& count : bond_counts(row))
      if (count.gap_tolerance == tolerance) CHECK(count.contacts == found);
  }
  CHECK(suggested_tolerance(bond_counts(row), 0.02).find("gap_tolerance = 0.5 would find 5 contacts (z = 2)") == 0);
}
