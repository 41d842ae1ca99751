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

TEST_CASE("bad_cases_say_where_what_and_why") {
  check_wrong(tension_case, case_text("tension.wrong.txt"), error_of);
  check_wrong(load_case, case_text("loads.wrong.txt"), error_of);
  check_wrong(ensemble_case, case_text("ensemble.wrong.txt"), error_of);
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
