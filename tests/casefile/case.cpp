// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/case.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

#include "equidem/casefile/assembly/build.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/casefile/packing/pack_case.hpp"
#include "equidem/casefile/study/study_case.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

#include "example.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("a_case_says_what_its_file_says") {
  const Case c = parsed(tension_case);

  CHECK(c.title == "Abe 1996, Fig. 6");
  CHECK(c.assembly.kind == AssemblyKind::lattice);
  CHECK(c.assembly.arrangement == find_lattice("hexagonal"));
  CHECK(c.assembly.lattice.columns == 21);
  CHECK(c.assembly.lattice.rows == 21);
  CHECK(c.assembly.lattice.radius == 0.005);
  CHECK_FALSE(c.assembly.lattice.periodic);
  REQUIRE(c.springs);
  CHECK(c.springs->kN == 1e9);
  CHECK(c.springs->kT == 0.5e9);
  CHECK(c.weighting == SpringWeighting::uniform);
  CHECK(c.rotation == Rotation::from_scene);
  REQUIRE(c.test);
  CHECK(c.test->stress == 1e6);
  CHECK(c.test->gauge == GaugePlacement::centre);
  CHECK(c.solver.method == SolverMethod::automatic);
}

TEST_CASE("supports_and_loads_keep_what_is_free_and_what_is_held") {
  const Case c = parsed(load_case);

  CHECK(c.assembly.delaunay.discs == 50);
  CHECK(c.assembly.delaunay.points == PointProcess::perturbed_hexagonal);
  CHECK(c.assembly.delaunay.disorder == 0.2);
  CHECK(c.assembly.delaunay.seed == 7);
  CHECK(c.assembly.delaunay.radii.smallest == 0.004);
  CHECK(c.assembly.delaunay.radii.largest == 0.006);
  REQUIRE(c.material);
  CHECK(c.material->moduli.shear_modulus == 1e9);
  CHECK(c.rotation == Rotation::free);
  REQUIRE(c.supports.size() == 1);
  CHECK(c.supports[0].ux == 0.0);
  CHECK(c.supports[0].uy == 1e-3);
  CHECK_FALSE(c.supports[0].rotation);
  REQUIRE(c.load_cases.size() == 2);
  CHECK(c.load_cases[0].name == "a");
  CHECK(c.load_cases[0].loads[0].kind == LoadKind::total);
  CHECK(c.load_cases[0].loads[0].force == Vec2{1, -2});
  CHECK(c.load_cases[1].loads[0].kind == LoadKind::per_disc);
  CHECK(c.load_cases[1].loads[0].moment == 3);
  CHECK(c.solver.method == SolverMethod::umfpack);
  CHECK(c.solver.max_refinements == 2);
  CHECK(c.solver.memory_limit == 4e9);
  CHECK_FALSE(c.output.picture);
  CHECK(c.output.vtk);
  const Case none = parsed(load_case, {"output.files=[]"});
  CHECK_FALSE((none.output.csv || none.output.vtk || none.output.picture));
}

TEST_CASE("homogenization_and_ensembles_say_what_their_file_says") {
  const Case c = parsed(ensemble_case);

  CHECK(c.assembly.density == 2650.0);
  CHECK(c.assembly.body == Body::disc);
  CHECK(parsed(ensemble_case, {"assembly.body=sphere"}).assembly.body == Body::sphere);
  CHECK(c.homogenize.boundary == Boundary::displacement);
  CHECK(c.homogenize.bounds == BoundsWanted::all);
  REQUIRE(c.ensemble);
  CHECK(c.ensemble->plan.discs == std::vector<std::int64_t>{30, 60, 120});
  CHECK(c.ensemble->plan.samples == 4);
  CHECK(c.ensemble->accuracy == 0.02);
}

TEST_CASE("a_load_without_a_case_acts_in_every_case") {
  const Case c = parsed(load_case + "[[load]]\ngroup = \"left\"\nforce = [5.0, 0.0]\n");

  REQUIRE(c.load_cases.size() == 2);
  for (const NamedLoads& loads : c.load_cases) {
    CAPTURE(loads.name);
    REQUIRE(loads.loads.size() == 2);
    CHECK(loads.loads[1].force.x == 5);
  }
}

TEST_CASE("the_resolved_case_reads_back_as_the_same_case") {
  const std::string& example = example_cases[GENERATE(range(std::size_t{0}, example_cases.size()))];
  const Case first = parsed(example, {R"(title="a \"quoted\" \\ title, äöü")"});
  const std::string echoed = to_toml(first, ".");
  CAPTURE(echoed);
  const Case second = parsed(echoed);

  CHECK(to_toml(second, ".") == echoed);
  CHECK(second.supports.size() == first.supports.size());
  CHECK(second.load_cases.size() == first.load_cases.size());
  CHECK(second.solver.memory_limit == first.solver.memory_limit);
  CHECK(second.assembly.delaunay.radii.largest == first.assembly.delaunay.radii.largest);
  CHECK(second.assembly.density == first.assembly.density);
  CHECK(second.homogenize.boundary == first.homogenize.boundary);
  REQUIRE(second.ensemble.has_value() == first.ensemble.has_value());
  if (first.ensemble) CHECK(second.ensemble->plan.discs == first.ensemble->plan.discs);
}

TEST_CASE("paths_are_relative_to_the_case_file_and_follow_the_echo") {
  const std::string text = R"(schema = "equidem/1"
[assembly]
kind = "file"
path = "own/truss.json"
)";
  const Case c = parse_case(text, "cases/a.toml", "cases", {});
  CHECK(c.assembly.path == std::filesystem::path("cases/own/truss.json"));
  CHECK(to_toml(c, "out").find("path = \"../cases/own/truss.json\"") != std::string::npos);
}

TEST_CASE("every_number_survives_the_echo_bit_by_bit") {
  const double kT = GENERATE(1.0 / 3.0, 5e-324, 1.7976931348623157e308, -0.1, 1e9 + 1e-7);
  const Case c = parsed(tension_case, {"springs.kT=" + toml_number(kT)});
  REQUIRE(c.springs);
  CHECK(c.springs->kT == kT);
  CHECK(parsed(to_toml(c, ".")).springs->kT == kT);
}

TEST_CASE("overrides_replace_add_and_reach_into_lists") {
  CHECK(parsed(tension_case, {"springs.kT=0.3e9"}).springs->kT == 0.3e9);
  CHECK(parsed(tension_case, {"springs.kT = 0.3e9", "springs.kT=1"}).springs->kT == 1);
  CHECK(parsed(tension_case, {"assembly.rows=11"}).assembly.lattice.rows == 11);
  CHECK(parsed(tension_case, {"solver.method=cholmod"}).solver.method == SolverMethod::cholmod);
  CHECK(parsed(tension_case, {"solver.method=\"cholmod\""}).solver.method == SolverMethod::cholmod);
  CHECK(parsed(tension_case, {"solver.method=cholmod", "solver.ordering=amd"}).solver.ordering == CholmodOrdering::amd);
  CHECK(parsed(tension_case, {"effects.rotation=restrained"}).rotation == Rotation::restrained);
  CHECK(parsed(load_case, {"load.1.moment=9"}).load_cases[1].loads[0].moment == 9);
  CHECK(parsed(load_case, {"load.0.force=[7, 8]"}).load_cases[0].loads[0].force == Vec2{7, 8});
  CHECK(parsed(tension_case, {"springs={kN = 1, kT = 2}"}).springs->kT == 2);
}

TEST_CASE("every_case_of_the_data_folder_is_valid_and_can_be_built_with_the_scene_of_its_run") {
  int cases = 0, runs = 0;
  for (const auto& file : cases_of_the_data_folder("")) {
    CAPTURE(file);
    const Case c = read_case(file);
    const Assembly assembly = build_assembly(c);
    const BuiltSprings springs = build_springs(c, assembly);
    INFO(springs.report);
    CHECK(assembly.size() >= 3);
    CHECK(springs.springs.largest() > 0);
    ++cases;
    if (!c.run) continue;
    CHECK(build_scene(c, assembly, springs.springs).inertia.size() == assembly.size());
    ++runs;
  }
  CHECK(cases >= 5);
  CHECK(runs >= 4);
}

TEST_CASE("the_description_names_every_key_and_its_example_is_valid") {
  const std::string text = describe_case_file();
  std::string words = text;  // "ux, uy" and "damping.mass" are names of keys
  std::ranges::replace_if(
      words, [](char c) { return c == ',' || c == '.' || c == '\n'; }, ' ');
  for (const casefile::FileSpec* spec :
       {&casefile::case_file().spec(), &casefile::grain_file().spec(), &pack_file_spec(), &study_file_spec()}) {
    for (const casefile::KeySpec& key : spec->keys) {
      CAPTURE(key.table, key.name);
      CHECK(words.find(" " + key.name + " ") != std::string::npos);
    }
    for (const casefile::TableSpec& table : spec->tables) {
      CAPTURE(table.name);
      CHECK(text.find("[" + table.name + "]") != std::string::npos);
    }
  }
  const auto begin = text.find("  schema = ");
  const auto end = text.find("Any key can be set");
  REQUIRE(begin != std::string::npos);
  REQUIRE(end != std::string::npos);
  CHECK(error_of(text.substr(begin, end - begin)).empty());
}

TEST_CASE("the_reference_page_has_each_key_once") {
  const std::string page = case_file_page();
  std::set<std::string> headings, rows;
  std::string heading;
  for (const std::string_view line : parts_of(page, '\n')) {
    if (line.starts_with("### ")) CHECK(headings.insert(heading = line).second);
    if (!line.starts_with("| `")) continue;
    CAPTURE(heading, line);
    CHECK(rows.insert(fmt::format("{} {}", heading, line)).second);
  }
  CHECK(headings.size() <= 40);
  CHECK(rows.size() <= 280);
}

TEST_CASE("a_key_of_another_kind_of_case_is_refused_with_where_it_belongs") {
  const auto refused = [](const std::string& where, const std::string& kind, const auto& parse) {
    const std::string sentence = test::refusal_of(parse).message;
    CAPTURE(sentence);
    CHECK(sentence.find(where) != std::string::npos);
    CHECK(sentence.find("(it is for " + kind + ")") != std::string::npos);
  };
  const std::string grains = "schema = \"equidem/1\"\n[[grain]]\nposition = [0, 0]\nradius = 1\n[collisions]\n[run]\n";
  const auto of_grains = [&](const std::string& more) {
    return [=] { static_cast<void>(parse_grain_case(grains + more, "a.toml", "")); };
  };
  refused("a.toml:7: run.until_rest: until_rest does not apply to colliding bodies", "assemblies",
          of_grains("until_rest = 1e-9"));
  refused("a.toml:7: viscoelastic: viscoelastic does not apply to colliding bodies", "assemblies",
          of_grains("[viscoelastic]"));
  refused("--set springs.shear_wave_speed=1: springs.shear_wave_speed: shear_wave_speed does not apply to assemblies",
          "packings", [] { parsed(tension_case, {"springs.shear_wave_speed=1"}); });
  refused("--set measures.cell=1: measures: measures does not apply to assemblies", "colliding bodies",
          [] { parsed(tension_case, {"measures.cell=1"}); });
}

TEST_CASE("the_reference_page_is_what_the_program_says") {
  const std::string written = read_file(std::filesystem::path(EQUIDEM_SOURCE_DIR) / "docs/case_file.md");
  const std::string page = case_file_page();
  const auto [in_file, in_page] = std::ranges::mismatch(written, page);
  INFO("docs/case_file.md is stale; make it again: build/dev/tools/equidem help case --markdown > docs/case_file.md");
  INFO("first difference in line " << 1 + std::count(page.begin(), in_page, '\n'));
  CHECK(std::string(in_file, std::find(in_file, written.end(), '\n')) ==
        std::string(in_page, std::find(in_page, page.end(), '\n')));
  CHECK(written.size() == page.size());
}

TEST_CASE("a_box_gives_a_triangulation_its_number_of_discs_and_reads_back") {
  const std::string text = changed(load_case, "discs = 50\n", "box = [0.2, 0.1]\n");
  const Case c = parsed(text);
  CHECK(c.assembly.delaunay.box == Vec2{0.2, 0.1});
  CHECK(c.assembly.delaunay.discs == 231);  // 0.02/(2 sqrt3 0.005²)
  CHECK(c.assembly.delaunay.aspect == 2);
  CHECK(parsed(to_toml(c, ".")).assembly.delaunay.discs == 231);
  CHECK(error_of(text, {"assembly.discs=50"}).find("box and discs are both given") != std::string::npos);
  CHECK(error_of(text, {"assembly.aspect=2"}).find("box and aspect are both given") != std::string::npos);
  CHECK(error_of(text, {"assembly.box=[1e-4, 1e-4]"}).find("assembly.box: 0") != std::string::npos);
}

TEST_CASE("groups_with_a_share_and_what_is_between_them_read_back_and_are_refused_where_they_contradict") {
  const std::string mica = "[[group]]\nname = \"mica\"\nshare = 0.5\ncells = 9\nseed = 4\n",
                    quartz = "[[group]]\nname = \"quartz\"\nshare = 0.5\ncells = 9\nseed = 4\n",
                    between =
                        "[[springs.between]]\ngroups = [\"mica\", \"quartz\"]\nacross = true\nkN = 3.0\nkT = 1.0\n",
                    weak =
                        "[strength]\ntension = 2.0\nshear = 4.0\n[[strength.between]]\n"
                        "groups = [\"mica\", \"mica\"]\ntension = 1.0\nshear = 0.0\n";
  const std::string text = tension_case + mica + quartz + between + weak;
  for (const Case& c : {parsed(text), parsed(to_toml(parsed(text), "."))}) {
    REQUIRE(c.groups.size() == 2);
    CHECK(c.groups[1].share == 0.5);
    CHECK(c.groups[1].draw == GroupDraw{.cells = 9, .seed = 4});
    REQUIRE(c.springs_between.size() == 1);
    CHECK(c.springs_between[0].groups == GroupPair{"mica", "quartz"});
    CHECK(c.springs_between[0].across);
    CHECK(c.springs_between[0].property.kN == 3);
    REQUIRE(c.strength->between.size() == 1);
    CHECK_FALSE(c.strength->between[0].across);
    CHECK(c.strength->between[0].property.tension == 1);
  }
  const auto refused = [&](const std::string& more, const std::string& words) {
    const std::string error = error_of(text + more, {});
    CAPTURE(more, words, error);
    CHECK(error.find(words) != std::string::npos);
  };
  refused("[[springs.between]]\ngroups = [\"quartz\", \"mica\"]\nacross = true\nkN = 1.0\nkT = 1.0\n",
          "the pair 'quartz', 'mica' is named twice");
  refused("[[strength.between]]\ngroups = [\"mica\", \"mica\"]\ntension = 1.0\nshear = 1.0\n",
          "strength.between.groups: the pair 'mica', 'mica' is named twice");
  refused("[[group]]\nname = \"gold\"\nshare = 0.1\n", "'mica' and 'gold' have shares of different cells or seeds");
  refused("[[group]]\nname = \"gold\"\ncells = 9\ndiscs = [1]\n", "it is how the share is drawn");
  refused("[[group]]\nname = \"gold\"\nshare = 0.1\ndiscs = [1]\n", "share and discs are both given");
  refused("[[springs.between]]\ngroups = \"mica\"\nkN = 1.0\nkT = 1.0\n", "two names in quotes");
  refused("[[springs.between]]\ngroups = [\"mica\"]\nkN = 1.0\nkT = 1.0\n", "two names in quotes");
  refused("[[springs.between]]\ngroups = [\"mica\", 3]\nkN = 1.0\nkT = 1.0\n", "two names in quotes");
  refused("[[springs.between]]\ngroups = [\"mica\", \"mica\"]\nkT = 1.0\n", "springs.between.kN: missing key");
}
