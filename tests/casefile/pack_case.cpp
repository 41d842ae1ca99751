// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/packing/pack_case.hpp"

#include <filesystem>
#include <string>
#include <vector>

#include "equidem/assembly/files.hpp"
#include "equidem/casefile/assembly/build.hpp"
#include "equidem/core/error.hpp"
#include "equidem/packing/measures.hpp"

#include "example.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "support/temporary_folder.hpp"

using namespace equidem;
using equidem::test::TemporaryFolder;

namespace {

const std::string example = test::case_text("growth.toml");

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
  const auto files = test::cases_of_the_data_folder("pack_");
  CHECK(files.size() >= 3);
  for (const auto& file : files) {
    CAPTURE(file);
    CHECK(read_pack_case(file).packing.radii.size() >= 3);
  }
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
      {{"packing.grains=none", "packing.solid_fraction=auto"}, "solid_fraction = \"auto\" without grains"},
      {{"packing.method=falling", "packing.solid_fraction=auto"}, "falling"},
      {{"packing.method=falling", "packing.sides=periodic"}, "never come to rest"},
      {{"packing.method=local_moves", "packing.solid_fraction=auto"}, "local_moves"},
      {{"packing.method=grow"}, "growth"},
      {{"springs.shear_wave_speed=150.0"}, "how stiff"},
      {{"springs.kT=none"}, "how stiff"},
      {{"packing.radii.largest=0.001"}, "below the smallest"},
      {{"packing.radii.median=0.001"}, "median"},
      {{"packing.box=[0.2, -0.1]"}, "width and height are positive"},
      {{"packing.grains=none", "packing.solid_fraction=0.5", "packing.box=[1e3, 1e3]"}, "fill the box"},
      {{"packing.radii=none"}, "packing.radii"},
      {{"settling.frictoin=0.1"}, "friction"},
  };
  for (const Wrong& wrong : all) {
    CAPTURE(wrong.overrides);
    CHECK_FALSE(test::check_refused([&] { parsed_packing(wrong.overrides); }, {wrong.word}).where.empty());
  }
}

namespace {

const std::string rock = test::case_text("packed_rock.toml");

Assembly assembly_of(const std::vector<std::string>& overrides) {
  return build_assembly(parse_case(rock, "rock.toml", "", overrides));
}

std::string refusal(const std::vector<std::string>& overrides) {
  return test::refusal_of([&] { static_cast<void>(assembly_of(overrides)); }).message;
}

}  // namespace

TEST_CASE("an_assembly_that_is_a_packing_is_the_one_that_pack_writes") {
  const std::vector<std::string> overrides{
      GENERATE(as<std::string>{}, "packing.sides=periodic", "packing.sides=walls"),
      GENERATE(as<std::string>{}, "packing.shape.kind=disc", "packing.shape.kind=ellipse")};
  CAPTURE(overrides);
  const PackCase packed = parse_pack_case(rock, "rock.toml", "", overrides);
  const TemporaryFolder folder;
  write_assembly(folder / "a.json", network_of(pack(packed.packing), packed.network), false);

  const Assembly written = read_assembly(folder / "a.json"), built = assembly_of(overrides);

  CHECK(built.centres == written.centres);
  CHECK(built.radii == written.radii);
  REQUIRE(built.contacts.size() == written.contacts.size());
  for (std::size_t k = 0; k < built.contacts.size(); ++k) {
    CHECK(built.contacts[k].j == written.contacts[k].j);
    CHECK(built.contacts[k].lever_i == written.contacts[k].lever_i);
  }
  CHECK(built.cell_areas == written.cell_areas);
  CHECK(built.groups.size() == written.groups.size());
  CHECK(written.contact_kN == std::vector<double>(written.contacts.size(), 1e8));
}

TEST_CASE("a_gap_tolerance_that_bonds_nothing_or_too_much_is_refused_with_one_that_serves") {
  const std::string nothing = refusal({"packing.gap_tolerance=0", "packing.solid_fraction=0.4"});
  CAPTURE(nothing);
  CHECK(nothing.find("gap_tolerance = 0 joins none of the 80 bodies") != std::string::npos);
  CHECK(nothing.find("would find") != std::string::npos);
  const std::string too_much = refusal({"packing.gap_tolerance=0.9"});
  CAPTURE(too_much);
  CHECK(too_much.find("contacts cross") != std::string::npos);
  CHECK(too_much.find("Take a smaller one: gap_tolerance = ") != std::string::npos);
}

TEST_CASE("the_bodies_of_a_packing_have_one_density") {
  const auto case_of = [](const std::vector<std::string>& overrides) {
    return parse_case(rock, "rock.toml", "", overrides);
  };
  CHECK(case_of({"assembly.density=2600"}).assembly.packing->settling.density == 2600);
  CHECK(case_of({"packing.density=2700"}).assembly.density == 2700);
  CHECK(!case_of({}).assembly.density);
  const Case both = case_of({"assembly.density=2600"});
  CHECK(parse_case(to_toml(both, "."), "case.toml", "").assembly.packing->settling.density == 2600);
  CHECK(refusal({"assembly.density=2600", "packing.density=2700"}).find("2700 kg/m³ here and 2600") !=
        std::string::npos);
}

TEST_CASE("the_density_of_a_continuum_gives_that_of_its_packed_discs") {
  const std::string sides = GENERATE("walls", "periodic");
  std::vector<std::string> overrides{
      "springs=none", "material={shear_modulus = 1e9, poisson_ratio = 0.2, plane = \"strain\", density = 2300.0}",
      "packing.sides=" + sides};
  const Case whole = parse_case(rock, "rock.toml", "", overrides);
  const double expected = *disc_density(whole, build_assembly(whole));
  CAPTURE(sides, expected);
  CHECK(expected > 2300 / 0.85);

  const PackCase packed = parse_pack_case(rock, "rock.toml", "", overrides);
  const Assembly network = network_of(pack(packed.packing), packed.network);
  CHECK(body_density(packed, network) == expected);
  const Case again = parse_case(to_toml(whole, "."), "echo.toml", "");
  CHECK(disc_density(again, build_assembly(again)) == expected);

  overrides.push_back("packing.density=2480");
  const PackCase other = parse_pack_case(rock, "rock.toml", "", overrides);
  CHECK_THROWS_WITH(body_density(other, network),
                    Catch::Contains("material.density: density = 2300 kg/m³ contradicts"));
  CHECK(body_density(parse_pack_case(rock, "rock.toml", ""), network) == SettlingOptions{}.density);
}

TEST_CASE("an_ensemble_of_packings_needs_no_number_of_grains_besides_its_sizes") {
  const Case sampled = parse_case(rock, "rock.toml", "",
                                  std::vector<std::string>{"packing.grains=none", "packing.sides=periodic",
                                                           "ensemble={discs = [40, 80], samples = 3}"});
  CHECK(sampled.assembly.random());
  CHECK(sampled.assembly.periodic());
  CHECK(sampled.assembly.packing->radii.size() == 40);
}

TEST_CASE("a_packing_that_no_assembly_names_is_refused_by_name") {
  const std::string error = refusal({"assembly=none"});
  CAPTURE(error);
  CHECK(error.find("Use 'equidem pack'") != std::string::npos);
  CHECK(refusal({"packing.method=falling", "packing.solid_fraction=none", "packing.box=[0.02, 0.02]", "springs=none",
                 "material={shear_modulus = 1e9, poisson_ratio = 0.2, plane = "
                 "\"strain\"}"})
            .find("bodies fall, and the case gives no springs") != std::string::npos);
}

TEST_CASE("a_clump_with_a_disc_within_another_is_refused_at_its_key") {
  const test::Refusal refusal = test::check_refused(
      [] { parsed_packing({"packing.shape={kind = \"clump\", discs = [[0.0, 0.0, 1.0], [0.1, 0.0, 0.1]]}"}); },
      {"disc 1 of a clump lies within disc 0"}, ErrorKind::bad_input);
  CHECK_THAT(refusal.where, Catch::Contains("packing.shape.discs"));
}
