// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "equidem/casefile/assembly/build.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/names.hpp"

#include "example.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "wrong.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Rows of check_wrong().
constexpr std::string_view wrong_tension_cases = R"(
# schema
schema = "equidem/1"\n => | schema | missing key | schema = "equidem/1"
equidem/1 => equidem/2 | schema | "equidem/2" | "equidem/1"
"equidem/1" => 1 | schema | 1 is not the schema
# TOML itself
[springs] => [springs | | not TOML
rows    = 21 => rows    = 21\nrows = 3 | | not TOML | rows
rows    = 21 => rows    = | | not TOML
# unknown keys and tables
columns => colums | assembly.colums | unknown key | Did you mean 'columns'?
kN => KN_ | springs.KN_ | unknown key | 'kN'
[springs] => [sprigns] | sprigns | unknown table | 'springs'
rows    = 21 => rows    = 21\ntitle = "x" | assembly.title | unknown key | at the top of the file
rows    = 21 => rows    = 21\nkT = 1.0 | assembly.kT | It belongs to [springs]
rows    = 21 => rows    = 21\nfluffiness = 1.0 | assembly.fluffiness | Known here: kind, columns
rows    = 21 => rows    = 21\nseed = 3 | assembly.seed | does not apply to kind = "hexagonal" | delaunay
rows    = 21 => rows    = 21\nradii = {smallest = 1.0, largest = 2.0} | assembly.radii | does not apply
# missing keys and tables
columns = 21\n => | @[assembly] | assembly.columns | missing key | [assembly]
radius  = 0.005\n => | @[assembly] | assembly.radius | missing key
kind    = "hexagonal"\n => | @[assembly] | assembly.kind | missing key | "square", "hexagonal"
kT = 0.5e9\n => | @[springs] | springs.kT | missing key
[springs]\nkN = 1.0e9\nkT = 0.5e9\n => | @schema = "equidem/1" | springs | springs are missing | [material]
kind   = "uniaxial_tension"\n => | @[test] | test.kind | missing key
# wrong type
= 21 => = "21" | assembly.columns | "21" is text | Leave out the quotes
= 21 => = 21.0 | assembly.columns | 21.0 is a number | Write columns = 21
= 21 => = 21.5 | assembly.columns | 21.5 | whole number
1.0e9 => true | springs.kN | true is true or false | a number in Pa
1.0e9 => [1.0] | springs.kN | [1.0] is an array
1.0e9 => 1979-05-27 | springs.kN | a date
"hexagonal" => 3 | assembly.kind | 3 is a whole number | "square"
[springs]\nkN = 1.0e9\nkT = 0.5e9\n => [[springs]]\nkN = 1.0e9\nkT = 0.5e9\n | @[[springs]] | springs | [[springs]]
  | Write [springs]
title  = => load = 3\ntitle  = | @load = 3 | load | Write [[load]]
title  = => springs = 3\ntitle  = | @[springs] | | not TOML
# numbers out of range
= 21 => = 0 | assembly.columns | 0 is out of range
= 21 => = -3 | assembly.columns | -3 is out of range
0.005 => 0.0 | assembly.radius | out of range | > 0
0.005 => -0.005 | assembly.radius | -0.005 is out of range | > 0
1.0e9 => 0 | springs.kN | 0 is out of range | > 0
1.0e9 => -1.0e9 | springs.kN | out of range | > 0
1.0e9 => nan | springs.kN | nan is not a finite number
0.5e9 => inf | springs.kT | inf is not a finite number
0.5e9 => -inf | springs.kT | -inf is not a finite number
0.5e9 => nan | springs.kT | nan is not a finite number
1.0e6 => 0.0 | test.stress | not 0
= 21 => = nan | assembly.columns | not a finite number
# choices
"hexagonal" => "hexagnal" | assembly.kind | Did you mean "hexagonal"?
"centre" => "center" | test.gauge | Did you mean "centre"?
# contradictions
[test] => [material]\nshear_modulus = 1.0\npoisson_ratio = 0.1\nplane = "strain"\n[test] | @[material] | material
  | both given
[test] => [material]\n[test] | @[material] | material | both given
[test] => [[support]]\ngroup = "left"\nux = true\n[test] | @[[support]] | support
  | [test] and [[support]] are both given
[test] => [[load]]\ngroup = "left"\nforce = [1.0, 0.0]\n[test] | @[[load]] | load | [test] and [[load]] are both given
rows    = 21 => rows    = 21\nperiodic = true | assembly.periodic | no sides to pull
[test] => [ensemble]\n[test] | @[ensemble] | ensemble | kind = "hexagonal" | delaunay
# overrides
--set springs.kTT=1 | springs.kTT | unknown key | 'kT'
--set sprigs.kT=1 | sprigs | unknown table | 'springs'
--set springs.kN=-1 | springs.kN | out of range
--set springs.kN=lots | springs.kN | "lots" is text
--set springs.kN | | sets nothing | springs.kT=0.3e9
--set =3 | | sets nothing
--set springs.kN= | | not a valid TOML value
--set springs.kN={a=1 | | not a valid TOML value
--set springs.kN.x=1 | | nothing below 'kN'
--set assembly.seed=3 | assembly.seed | does not apply
--set assembly.rows=x | assembly.rows | "x" is text
)";

constexpr std::string_view wrong_load_cases = R"(
# unknown keys and tables
"perturbed_hexagonal" => "random" | @disorder = 0.2 | assembly.disorder | points = "random" | perturbed_hexagonal
# missing keys and tables
plane = "strain"\n => | @[material] | material.plane | missing key
shear_modulus = 1.0e9\n => | @[material] | material | poisson_ratio alone does not describe | shear_modulus is missing
  | young_modulus and poisson_ratio
shear_modulus = 1.0e9\npoisson_ratio = 0.2\n => | @[material] | material | moduli are missing
poisson_ratio = 0.2\n => | @[material] | material | shear_modulus alone does not | poisson_ratio is missing
  | bulk_modulus_2d and shear_modulus
[assembly.radii]\nsmallest = 0.004\nlargest = 0.006\n => | @[assembly] | assembly | neither radius nor radii
  | size of the discs
name = "some"\n => | @[[group]] | group.name | missing key | [[group]]
# wrong type
[[load]] => [load] | @[[load]] | | not TOML
files = ["csv", "vtk"] => picture = false | output.picture | earlier version | files = ['csv', 'vtk']
files = ["csv", "vtk"] => files = ["cvs"] | output.files | Did you mean "csv"?
[1.0, -2.0] => [1.0] | load.force | 1 entry | two numbers
[1.0, -2.0] => [1.0, "a"] | load.force | "a" is text
ux = true => ux = false | support.ux | false is not allowed | free
[0, 1, 2] => [0, 1.5] | group.discs | 1.5
[0, 1, 2] => [0, -1] | group.discs | -1 is no number of a disc
[0, 1, 2] => [] | group.discs | empty
"4 GB" => "4 parsecs" | solver.memory_limit | "4 GB"
# numbers out of range
disorder = 0.2 => disorder = 0.5 | assembly.disorder | < 0.5
seed = 7 => seed = -7 | assembly.seed | -7 is out of range
discs = 50 => discs = 2 | assembly.discs | 2 is out of range
smallest = 0.004 => smallest = 0.04 | @[assembly.radii] | assembly.radii | larger than | Exchange
poisson_ratio = 0.2 => poisson_ratio = 0.7 | @[material] | material | 0.7
max_refinements = 2 => max_refinements = -1 | solver.max_refinements | out of range
"4 GB" => -1 | solver.memory_limit | out of range
[0.0, 0.0, 0.02, 0.02] => [0.02, 0.0, 0.0, 0.02] | group.box | the box | empty
# choices
"umfpack" => "magic" | solver.method | "magic" is no known method | "cholmod"
"umfpack" => "umfpack"\nordering = "metis" | solver.ordering | does not apply to method = "umfpack"
  | it is for cholmod
# contradictions
shear_modulus = 1.0e9 => shear_modulus = 1.0e9\nyoung_modulus = 1.0e9 | material.young_modulus
  | young_modulus is too much
poisson_ratio = 0.2 => p_wave_speed = 9.0 | material.p_wave_speed | poisson_ratio is missing, p_wave_speed is too much
poisson_ratio = 0.2 => bulk_modulus_2d = 1.0e8 | @[material] | material | no reading in plane strain
seed = 7 => seed = 7\nradius = 0.1 | @[assembly.radii] | assembly.radii | both given
ux = true\nuy = 1e-3\n => | @[[support]] | support | holds nothing
force = [1.0, -2.0]\n => | @[[load]] | load | neither force nor moment
"total"\nforce = [1.0, -2.0] => "traction"\nmoment = 1.0 | load.moment | a traction has no moment
name = "inside" => name = "some" | group.name | two groups 'some'
case = "a" => case = "../a" | load.case | cannot name a load case
# overrides
--set load.7.moment=1 | | no entry '7'
--set load.0.force=[1] | load.force | 1 entry
)";

constexpr std::string_view wrong_ensemble_cases = R"(
# missing keys and tables
density = 2200.0\n => | @[material] | material | p_wave_speed and s_wave_speed do not describe | density is missing
s_wave_speed = 900.0\n => | @[material] | material | s_wave_speed is missing
# numbers out of range
2650.0 => 0.0 | assembly.density | out of range | kg/m³
density = 2200.0 => density = -1 | material.density | -1 is out of range
[30, 60, 120] => [30, 120, 60] | ensemble.discs | 60 comes after 120 | ascending
[30, 60, 120] => [30, 30] | ensemble.discs | 30 comes after 30
[30, 60, 120] => [2, 60] | ensemble.discs | 2 is out of range | from 3
[30, 60, 120] => [30, 60.5] | ensemble.discs | 60.5 is a number
[30, 60, 120] => [] | ensemble.discs | empty
[30, 60, 120] => 30 | ensemble.discs | [100, 400, 1600]
samples = 4 => samples = 1 | ensemble.samples | 1 is out of range
accuracy = 0.02 => accuracy = 1.0 | ensemble.accuracy | between 0 and 1
accuracy = 0.02 => accuracy = 0.02\nconfidence = 0.5 | ensemble.confidence | earlier version | 95 %
# choices
"displacement" => "displacements" | homogenize.boundary | Did you mean "displacement"?
"all" => "some" | homogenize.bounds | "affine"
body = "disc" => body = "cube" | assembly.body | "sphere"
# contradictions
p_wave_speed => poisson_ratio = 0.2\np_wave_speed | @poisson_ratio = 0.2 | material.poisson_ratio
  | poisson_ratio is too much
s_wave_speed = 900.0 => s_wave_speed = 1500.0 | material.s_wave_speed | 1500 is not below | K = density
s_wave_speed = 900.0 => s_wave_speed = 1400.0 | @[material] | material | no reading in plane strain
# overrides
--set ensemble.discs=[3, 2] | ensemble.discs | 2 is out of range
--set homogenize.boundary=open | homogenize.boundary | "open" is no known boundary
)";

}  // namespace

TEST_CASE("bad_cases_say_where_what_and_why") {
  check_wrong(tension_case, wrong_tension_cases, error_of);
  check_wrong(load_case, wrong_load_cases, error_of);
  check_wrong(ensemble_case, wrong_ensemble_cases, error_of);
  check_sentence(error_of("schema = \"equidem/1\"\n"), {"a.toml:1", "[assembly]", {"missing table"}});
  check_sentence(error_of(""), {"a.toml:1", "schema", {"missing key"}});
}

TEST_CASE("the_key_one_letter_off_is_suggested_for_every_key") {
  for (const casefile::KeySpec& key : casefile::case_file().spec().keys) {
    std::vector<std::string> here;
    for (const casefile::KeySpec& other : casefile::case_file().spec().keys)
      if (other.table == key.table) here.emplace_back(other.name);
    const std::string& name = key.name;
    const std::set<std::string> misspelt = {name + "s", name.substr(0, name.size() - 1) + "_", "x" + name};
    for (const std::string& wrong : misspelt) {
      if (std::find(here.begin(), here.end(), wrong) != here.end()) continue;
      CAPTURE(key.table, key.name, wrong);
      const auto meant = nearest(wrong, here);
      REQUIRE(meant);
      CHECK(edit_distance(wrong, *meant) <= edit_distance(wrong, name));
    }
  }
}

TEST_CASE("an_override_is_one_value") {
  const std::string sentence = error_of(tension_case, {"springs.kN=1\nfoo=2"});
  CAPTURE(sentence);
  CHECK(sentence.find("more than one value") != std::string::npos);
  CHECK(sentence.find('\n') == std::string::npos);
}

TEST_CASE("an_override_of_none_takes_a_key_out") {
  CHECK(parsed(tension_case, {"solver.method=cholmod", "solver.method=none"}).solver.method == SolverMethod::automatic);
  CHECK(parsed(load_case, {"load.0=none"}).load_cases.size() + 1 == parsed(load_case).load_cases.size());
  CHECK(parsed(motion_case, {"run.duration=none", "run.until_rest=1e-9"}).run->until_rest == 1e-9);
  const std::string missing = error_of(tension_case, {"springs.kV=none"});
  CAPTURE(missing);
  CHECK(missing.find("there is no 'kV' to take out") != std::string::npos);
  CHECK(error_of(tension_case, {"springs.kN=none"}).find("kN") != std::string::npos);
}

TEST_CASE("edit_distance_counts_single_changes") {
  CHECK(edit_distance("kT", "kT") == 0);
  CHECK(edit_distance("kt", "kT") == 0);
  CHECK(edit_distance("colums", "columns") == 1);
  CHECK(edit_distance("sprigns", "springs") == 1);
  CHECK(edit_distance("", "abc") == 3);
  CHECK(edit_distance("abc", "") == 3);
  CHECK(edit_distance("kitten", "sitting") == 3);
  const std::vector<std::string> verbs = {"solve", "sweep"};
  CHECK(nearest("slove", verbs) == "solve");
  CHECK(nearest("sweeps", verbs) == "sweep");
  CHECK_FALSE(nearest("integrate", verbs));
  CHECK_FALSE(nearest(std::string(100000, 'x'), verbs));
}

TEST_CASE("groups_that_do_not_fit_the_assembly_are_refused_with_their_line") {
  const std::string block =
      "schema = \"equidem/1\"\n[assembly]\nkind = \"hexagonal\"\ncolumns = 5\nrows = 5\nradius = 0.005\n" +
      load_case.substr(load_case.find("[material]"));
  const auto sentence = [](const std::string& text, const std::vector<std::string>& overrides = {}) {
    const Case c = parsed(text, overrides);
    return refusal_of([&] { static_cast<void>(build_assembly(c)); }).message;
  };
  REQUIRE(sentence(block).empty());
  check_wrong(block, R"(
discs = [0, 1, 2] => discs = [0, 99] | group.0.discs | names disc 99
box = [0.0, 0.0, 0.02, 0.02] => box = [5.0, 5.0, 6.0, 6.0] | group.1.box | no disc has its centre
name = "some" => name = "left" | group.0.name | of its own
group = "left" => group = "lift" | support.0.group | no group 'lift'
group = "some" => group = "sum" | load.0.group | no group 'sum'
)",
              sentence);
}

TEST_CASE("numbers_as_people_write_them_are_answered_with_what_toml_wants") {
  struct Typed {
    const char* text;
    std::vector<std::string> words;
  };
  const std::vector<Typed> all = {{".7e8", {"a digit stands before the point", "Write 0.7e8"}},
                                  {"-.5", {"a digit stands before the point", "Write -0.5"}},
                                  {"+.5", {"a digit stands before the point", "Write 0.5"}},
                                  {"7.e8", {"a digit stands behind the point", "Write 7.0e8"}},
                                  {"7.", {"a digit stands behind the point", "Write 7.0"}},
                                  {"1,5e8", {"a decimal point, not a comma", "Write 1.5e8"}},
                                  {"0,25", {"a decimal point, not a comma", "Write 0.25"}},
                                  {"1e8 Pa", {"without its unit, here Pa", "Write 1e8"}},
                                  {"1e8 N/m", {"without its unit, here N/m", "Write 1e8"}}};
  const auto refusal = [](const std::string& file, const std::vector<std::string>& set) -> std::string {
    const test::Refusal refused = test::refusal_of([&] { parse_case(file, "case.toml", ".", set); });
    return refused.message.empty() ? "(accepted)" : refused.message;
  };
  const std::string head =
      "schema = \"equidem/1\"\nassembly = {kind = \"hexagonal\", columns = 2, rows = 2, radius = 1.0}\n"
      "\n[springs]\nkN = 1e8\n";
  for (const Typed& typed : all) {
    for (const std::string& sentence :
         {refusal(head + "kT = " + typed.text + "  # soft\n", {}),
          refusal(head + "kT = 0\n", {std::string("springs.kT=") + typed.text}),
          refusal("schema = \"equidem/1\"\n\n\n\n\nsprings = {kN = 1e8, kT = " + std::string(typed.text) + "}\n",
                  {})}) {
      CAPTURE(typed.text, sentence);
      CHECK((sentence.starts_with("case.toml:6: ") || sentence.starts_with("--set springs.kT=")));
      for (const std::string& word : typed.words) CHECK(sentence.find(word) != std::string::npos);
    }
  }
  CHECK(refusal(head + "kT = 1 2\n", {}).find("unit") == std::string::npos);
  CHECK(refusal("schema = \"equidem/1\"\n[assembly]\nkind = \"hexagonal\"\nradius = 1.0\ncolumns = 2\nrows = "
                "2\n[springs]\nkN = 1e8\nks = 1e8\n",
                {})
            .find("kT") != std::string::npos);
}

TEST_CASE("no_number_is_proposed_where_none_is_wanted_or_none_was_meant") {
  using casefile::KeyType;
  for (const casefile::KeySpec& key : casefile::case_file().spec().keys) {
    const bool is_text = key.type == KeyType::text || key.type == KeyType::path || key.type == KeyType::choice;
    for (const std::string value : {".", "-.", ".e5", ",", "3 discs", ".5", "1.", "1,5"}) {
      if (!is_text && value.find_first_of("0123456789") != std::string::npos) continue;
      const std::string sentence = error_of(tension_case, {key.path() + "=" + value});
      CAPTURE(key.path(), value, sentence);
      CHECK(sentence.find("Write 0") == std::string::npos);
      if (is_text) CHECK(sentence.find("TOML") == std::string::npos);
    }
  }
  CHECK(error_of(tension_case, {"springs.kT=."}).find("kT is a number in Pa") != std::string::npos);
  CHECK(error_of(tension_case, {"springs.kT=3 GPa"}).find("Write 3") == std::string::npos);
  CHECK(parsed(tension_case, {"title=3 discs, 1.5 mm: Stütze"}).title == "3 discs, 1.5 mm: Stütze");
}

TEST_CASE("deep_and_long_documents_are_refused") {
  const std::string head = "schema = \"equidem/1\"\n";
  for (const std::string& text : {head + "x = " + std::string(100000, '['), head + std::string(100000, 'a') + " = 1\n",
                                  head + "[assembly]\nkind = \"" + std::string(100000, 'h') + "\"\n",
                                  std::string(1000, '\0'), std::string("\xff\xfe")}) {
    const std::string sentence = error_of(text);
    CHECK(sentence.starts_with("a.toml"));
    CHECK(sentence.find('\n') == std::string::npos);
  }
  CHECK(error_of("\xef\xbb\xbf" + tension_case).empty());
}
