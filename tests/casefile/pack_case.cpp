// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/packing/pack_case.hpp"

#include <filesystem>
#include <string>
#include <vector>

#include "equidem/core/error.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

constexpr const char* example = R"(schema = "equidem/1"
[packing]
method = "growth"
grains = 50
box    = [0.2, 0.1]
[packing.radii]
smallest = 0.005
largest  = 0.01
[springs]
kN = 1.0e8
kT = 0.5e8
)";

PackCase parsed_packing(const std::vector<std::string>& overrides = {}) {
  return parse_pack_case(example, "case.toml", "", overrides);
}

}  // namespace

TEST_CASE("two_of_grains_box_and_solid_fraction_give_the_third") {
  const PackCase both = parsed_packing();
  CHECK(both.packing.radii.size() == 50);
  CHECK(both.packing.box.size == Vec2{0.2, 0.1});
  const PackCase no_box = parsed_packing({"packing.box=none", "packing.solid_fraction=0.7"});
  CHECK(area_of(no_box.packing.shape, no_box.packing.radii) / no_box.packing.box.area() == Approx(0.7).epsilon(1e-13));
  const PackCase no_count = parsed_packing({"packing.grains=none", "packing.solid_fraction=0.7"});
  CHECK(area_of(no_count.packing.shape, no_count.packing.radii) / no_count.packing.box.area() ==
        Approx(0.7).epsilon(1e-13));
  CHECK(parsed_packing({"packing.solid_fraction=auto"}).packing.as_dense_as_possible);
}

TEST_CASE("shapes_are_read_and_the_box_counts_their_area") {
  const PackCase ellipses = parsed_packing({"packing.shape.kind=ellipse", "packing.shape.aspect=3.0"});
  CHECK(ellipses.packing.shape.kind == PackingShape::Kind::ellipse);
  CHECK(ellipses.packing.shape.aspect == 3);
  const PackCase clumps = parsed_packing({"packing.shape.kind=clump", "packing.shape.discs=[[0, 0, 1], [1, 0, 0.5]]"});
  REQUIRE(clumps.packing.shape.discs.size() == 2);
  CHECK(clumps.packing.shape.discs[1].radius == 0.5);
  // A pair of discs has twice the area of one: half as many of them fill the box.
  const std::vector<std::string> filled = {"packing.grains=none", "packing.solid_fraction=0.6"};
  auto pairs = filled;
  pairs.push_back("packing.shape.kind=rigid_pair");
  CHECK(2 * parsed_packing(pairs).packing.radii.size() ==
        Approx(parsed_packing(filled).packing.radii.size()).margin(1));
  const auto wrong = [](const std::vector<std::string>& overrides) {
    CAPTURE(overrides);
    CHECK_THROWS_AS(parsed_packing(overrides), Error);
  };
  wrong({"packing.shape.kind=elipse"});
  wrong({"packing.shape.aspect=2.0"});
  wrong({"packing.shape.kind=clump"});
  wrong({"packing.shape.kind=clump", "packing.shape.discs=[[0, 0]]"});
  wrong({"packing.shape.kind=ellipse", "packing.shape.aspect=0.5"});
}

TEST_CASE("every_packing_of_the_data_folder_is_valid") {
  namespace fs = std::filesystem;
  int cases = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(EQUIDEM_SOURCE_DIR) / "data/cases")) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("pack_") || !name.ends_with(".toml")) continue;
    CAPTURE(name);
    CHECK(read_pack_case(entry.path()).packing.radii.size() >= 3);
    ++cases;
  }
  CHECK(cases >= 3);
}

TEST_CASE("springs_come_from_wave_speeds_or_are_given") {
  CHECK(parsed_packing().packing.settling.springs.kT == 0.5e8);
  const PackCase soil = parsed_packing(
      {"springs.kN=none", "springs.kT=none", "springs.shear_wave_speed=150.0", "springs.poisson_ratio=0.25"});
  CHECK(soil.packing.settling.springs.kN == Approx(131475652.55273284).epsilon(1e-14));
}

TEST_CASE("the_resolved_packing_reads_back_to_the_same_discs") {
  const PackCase first = parsed_packing({"packing.seed=9"});
  const PackCase again = parse_pack_case(to_toml(first.document, ""), "again.toml", "");
  CHECK(first.packing.radii == again.packing.radii);
  CHECK(first.packing.settling.time_step == again.packing.settling.time_step);
}

TEST_CASE("contradictions_of_a_packing_are_told_with_their_line") {
  struct Wrong {
    std::vector<std::string> overrides;
    const char* word;
  };
  const std::vector<Wrong> all = {
      {{"packing.solid_fraction=0.5"}, "all given"},
      {{"packing.grains=none"}, "amount to pack is missing"},
      {{"packing.method=falling", "packing.solid_fraction=auto"}, "falling"},
      {{"packing.method=falling", "packing.sides=periodic"}, "never come to rest"},
      {{"packing.method=local_moves", "packing.solid_fraction=auto"}, "local_moves"},
      {{"packing.method=grow"}, "growth"},
      {{"springs.shear_wave_speed=150.0"}, "how stiff"},
      {{"springs.kT=none"}, "how stiff"},
      {{"packing.radii.largest=0.001"}, "below the smallest"},
      {{"packing.radii.median=0.001"}, "median"},
      {{"packing.box=[0.2, -0.1]"}, "no area"},
      {{"packing.grains=none", "packing.solid_fraction=0.5", "packing.box=[1e3, 1e3]"}, "fill the box"},
      {{"packing.radii=none"}, "packing.radii"},
      {{"settling.frictoin=0.1"}, "friction"},
  };
  for (const Wrong& wrong : all) {
    CAPTURE(wrong.overrides);
    try {
      parsed_packing(wrong.overrides);
      FAIL_CHECK("accepted");
    } catch (const Error& error) {
      CHECK(error.kind() == ErrorKind::bad_input);
      CHECK_THAT(error.what(), Catch::Contains(wrong.word));
      CHECK_FALSE(error.where().empty());
    }
  }
}
