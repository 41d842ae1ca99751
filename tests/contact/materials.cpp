// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/materials.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/random.hpp"

#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const std::vector<GroupShare> minerals = {{"quartz", 0.3}, {"feldspar", 0.4}, {"mica", 0.3}};

Assembly cell(bool periodic) {
  DelaunayOptions options;
  options.discs = 500;
  options.radii = {1e-3, 1e-3};
  options.seed = 4;
  options.periodic = periodic;
  return delaunay_assembly(options);
}

std::set<std::int32_t> discs_of(const Assembly& assembly, const std::string& name) {
  const std::vector<std::int32_t>& discs = group(assembly, name).discs;
  CHECK(std::ranges::is_sorted(discs));
  return {discs.begin(), discs.end()};
}

/// The group of a disc; "" for none.
std::string group_of(const Assembly& assembly, std::int32_t disc) {
  for (const GroupShare& mineral : minerals)
    if (discs_of(assembly, mineral.name).contains(disc)) return mineral.name;
  return "";
}

std::int32_t cell_of(const Assembly& assembly, std::int32_t disc) {
  std::int32_t number = 0;
  for (const auto& [name, discs] : assembly.groups) {
    if (!name.starts_with("cell_")) continue;
    if (std::ranges::binary_search(discs.discs, disc)) return number;
    ++number;
  }
  return -1;
}

}  // namespace

TEST_CASE("groups_with_shares_have_no_disc_in_common_and_the_numbers_that_were_asked_for") {
  const bool periodic = GENERATE(false, true);
  const std::uint64_t seed = GENERATE(1, 2, 3);
  Assembly assembly = cell(periodic);
  draw_groups(assembly, minerals, {.seed = seed});
  std::set<std::int32_t> all;
  std::size_t sum = 0;
  for (const auto& [name, share] : minerals) {
    const std::set<std::int32_t> discs = discs_of(assembly, name);
    CAPTURE(name, discs.size());
    CHECK(std::abs(static_cast<double>(discs.size()) - share * static_cast<double>(assembly.size())) <= 1);
    all.insert(discs.begin(), discs.end());
    sum += discs.size();
  }
  CHECK(all.size() == assembly.size());
  CHECK(sum == assembly.size());

  Assembly again = cell(periodic), other = cell(periodic);
  draw_groups(again, minerals, {.seed = seed});
  draw_groups(other, minerals, {.seed = seed + 1});
  CHECK(discs_of(again, "quartz") == discs_of(assembly, "quartz"));
  CHECK(discs_of(other, "quartz") != discs_of(assembly, "quartz"));
}

TEST_CASE("a_cell_holds_the_discs_nearest_to_its_point_and_a_group_holds_whole_cells") {
  const bool periodic = GENERATE(false, true);
  const std::int64_t count = GENERATE(1, 7, 40);
  constexpr std::uint64_t seed = 9;
  Assembly assembly = cell(periodic);
  draw_groups(assembly, {{{"quartz", 1}}}, {.cells = count, .seed = seed});

  // These are the same points; each disc belongs to the one with the nearest image.
  Vec2 low = assembly.centres.front(), high = low;
  for (const Vec2& x : assembly.centres) {
    low = {std::min(low.x, x.x), std::min(low.y, x.y)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y)};
  }
  const Vec2 size = periodic ? *assembly.period : high - low;
  Random random(seed);
  std::vector<Vec2> points;
  for (std::int64_t k = 0; k < count; ++k) {
    const double x = random.uniform(low.x, low.x + size.x);
    points.push_back({x, random.uniform(low.y, low.y + size.y)});
  }
  std::vector<std::int32_t> nearest(assembly.size(), -1);
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < points.size(); ++k) {
      for (int image = 0; image < (periodic ? 9 : 1); ++image) {
        const Vec2 shift = periodic ? Vec2{(image % 3 - 1) * size.x, (image / 3 - 1) * size.y} : Vec2{};
        const double distance = norm(points[k] + shift - assembly.centres[disc]);
        if (distance < least) least = distance, nearest[disc] = static_cast<std::int32_t>(k);
      }
    }
  }
  std::size_t in_cells = 0;
  std::set<std::int32_t> of_points;
  for (const auto& [name, discs] : assembly.groups) {
    if (!name.starts_with("cell_")) continue;
    CAPTURE(name);
    for (const std::int32_t disc : discs.discs)
      CHECK(nearest[static_cast<std::size_t>(disc)] == nearest[static_cast<std::size_t>(discs.discs.front())]);
    CHECK(of_points.insert(nearest[static_cast<std::size_t>(discs.discs.front())]).second);
    in_cells += discs.discs.size();
  }
  CHECK(in_cells == assembly.size());

  Assembly three = cell(periodic);
  if (count < 40) return;
  draw_groups(three, minerals, {.cells = count, .seed = seed});
  for (const auto& [name, discs] : three.groups) {
    if (!name.starts_with("cell_")) continue;
    std::set<std::string> groups;
    for (const std::int32_t disc : discs.discs) groups.insert(group_of(three, disc));
    CAPTURE(name, groups);
    CHECK(groups.size() == 1);
    CHECK(*groups.begin() != "");
  }
}

TEST_CASE("a_contact_has_the_springs_of_the_groups_of_its_two_discs") {
  Assembly assembly = cell(GENERATE(false, true));
  draw_groups(assembly, minerals, {.cells = 30, .seed = 2});
  const SpringConstants elsewhere{1e9, 2e8}, quartz{5e9, 1e9}, mixed{3e9, 0}, boundary{4e8, 1e8}, soft{2e8, 5e7};
  const std::vector<OfPair<SpringConstants>> pairs = {{{"quartz", "quartz"}, false, quartz},
                                                      {{"feldspar", "quartz"}, false, mixed},
                                                      {{"quartz", "quartz"}, true, boundary},
                                                      {{"mica", "mica"}, true, soft}};
  const std::vector<SpringConstants> found = Materials(assembly, pairs).of_contacts(elsewhere, pairs, in_series);
  std::set<std::string> met;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const auto [a, b] = std::minmax({group_of(assembly, contact.i), group_of(assembly, contact.j)});
    const bool across = cell_of(assembly, contact.i) != cell_of(assembly, contact.j);
    const std::string pair = a + " " + b;
    // Half a contact of each in series; mica inside a cell and feldspar have the springs of elsewhere.
    const auto half = [](double of_a, double of_b) { return 1 / (0.5 / of_a + 0.5 / of_b); };
    SpringConstants right = elsewhere;
    if (pair == "quartz quartz") right = across ? boundary : quartz;
    if (pair == "feldspar quartz") right = mixed;
    if (pair == "mica mica" && across) right = soft;
    if (pair == "mica quartz" && across) right = {half(boundary.kN, soft.kN), half(boundary.kT, soft.kT)};
    if (pair == "mica quartz" && !across) right = {half(quartz.kN, elsewhere.kN), half(quartz.kT, elsewhere.kT)};
    CAPTURE(c, pair, across);
    CHECK_THAT(found[c].kN, Catch::Matchers::WithinRel(right.kN, 1e-14));
    CHECK_THAT(found[c].kT, Catch::Matchers::WithinRel(right.kT, 1e-14));
    met.insert(pair + (across ? " across" : ""));
  }
  // Cells are of one mineral each, so that only these pairs are there; all of them are.
  CHECK(met == std::set<std::string>{"feldspar feldspar", "feldspar feldspar across", "feldspar mica across",
                                     "feldspar quartz across", "mica mica", "mica mica across", "mica quartz across",
                                     "quartz quartz", "quartz quartz across"});
}

TEST_CASE("what_gives_a_contact_its_springs_is_one_pair_or_two_that_are_joined") {
  // Discs 0 to 3 touch in a row; 0, 1 are quartz and 2, 3 mica, in one cell each but for disc 3.
  Assembly row;
  row.centres = {{0, 0}, {2, 0}, {4, 0}, {6, 0}};
  row.radii = {1, 1, 1, 1};
  row.contacts = {{.i = 0, .j = 1}, {.i = 1, .j = 2}, {.i = 2, .j = 3}};
  row.groups = {{"quartz", {{0, 1}, {}}},
                {"mica", {{2, 3}, {}}},
                {"cell_0", {{0, 1}, {}}},
                {"cell_1", {{2}, {}}},
                {"cell_2", {{3}, {}}}};
  std::vector<OfPair<SpringConstants>> pairs = {
      {{"quartz", "mica"}, false, {7, 7}}, {{"quartz", "quartz"}, true, {2, 2}}, {{"mica", "mica"}, true, {6, 6}}};
  const auto springs = [&] { return Materials(row, pairs).of_contacts(SpringConstants{1, 1}, pairs, in_series); };
  const auto pair_of = [&](std::size_t contact) { return Materials(row, pairs).pair_of(contact); };
  CHECK(springs()[0].kN == 1);
  CHECK_FALSE(pair_of(0));
  CHECK_THAT(springs()[1].kN, Catch::Matchers::WithinRel(3.0, 1e-15));  // those across cells come first: 2 * 2 * 6/8
  CHECK_FALSE(pair_of(1));
  CHECK(springs()[2].kN == 6);
  CHECK(pair_of(2) == 2);
  pairs.pop_back();
  CHECK(springs()[1].kN == 7);
  CHECK(pair_of(1) == 0);
  // A negative spring is joined with no other where its group touches none without a pair of its own.
  pairs = {{{"quartz", "quartz"}, false, {3, -1}}, {{"quartz", "mica"}, false, {7, 7}}};
  CHECK(springs()[0].kT == -1);
}

TEST_CASE("groups_that_are_no_materials_are_refused") {
  Assembly assembly = cell(true);
  const auto draw = [&](const std::vector<GroupShare>& shares, const GroupDraw& how) {
    return [sample = assembly, shares, how]() mutable { draw_groups(sample, shares, how); };
  };
  check_refused(draw({{"a", 0.7}, {"b", 0.4}}, {}), {"'a', 'b'", "1.1 together"});
  check_refused(draw({{"a", 1e-9}}, {}), {"'a' gets no disc", "larger share"});
  check_refused(draw({{"a", 1e-3}}, {.cells = 3}), {"'a' gets no disc", "more cells"});
  check_refused(draw({{"a", 1}}, {.cells = 501}), {"501 cells", "fewer cells"});

  check_refused(draw({{"cell_2", 1}}, {.cells = 5}), {"has a group 'cell_2'", "another name"});
  assembly.groups["cell_1"] = {{0}, {}};
  check_refused(draw({{"a", 1}}, {.cells = 5}), {"has a group 'cell_1'", "another name"});
  assembly.groups = {{"a", {{0, 1, 2}, {}}}, {"b", {{2, 3}, {}}}};
  const auto pairs = [&](const GroupPair& groups, bool across = false) {
    return [&assembly, groups, across] { Materials(assembly, {{groups, across}}); };
  };
  check_refused(pairs({"a", "b"}), {"disc 2 is in the groups 'a' and 'b'", "do not overlap"});
  check_refused(pairs({"a", "c"}), {"no group 'c'"});
  check_refused(pairs({"a", "a"}, true), {"across cells", "Give cells"});
  check_refused([] { in_series({1, -0.1}, {1, 1}); }, {"negative", "Name the pair"});
}
