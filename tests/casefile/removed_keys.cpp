// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/removed_keys.hpp"

#include <algorithm>
#include <string>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/casefile/packing/pack_case.hpp"
#include "equidem/casefile/study/study_case.hpp"

#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using casefile::RemovedKey;

namespace {

std::string heading(const std::string& table) {
  return table.empty() ? "" : "[" + table + "]\n";
}

/// A file with the key of the row, checked by rules that have its table and nothing of the row.
std::string sentence_on(const RemovedKey& row) {
  const std::string table(row.table), name(row.name), value(row.value);
  casefile::FileSpec spec{.schema = "equidem/1", .noun = "case file"};
  spec.keys.push_back({.table = "", .name = "schema", .type = casefile::KeyType::text});
  if (!table.empty()) {
    if (const auto dot = table.find('.'); dot != std::string::npos)
      spec.tables.push_back({.name = table.substr(0, dot)});
    spec.tables.push_back({.name = table});
  }
  if (!value.empty())
    spec.keys.push_back(
        {.table = table, .name = name, .type = casefile::KeyType::choice, .choices = {"another", value + "s"}});
  const std::string text =
      "schema = \"equidem/1\"\n" + heading(table) + name + " = " + (value.empty() ? "1" : "\"" + value + "\"") + "\n";
  TomlValue root = casefile::parse_document(text, "a.toml", {});
  const test::Refusal refused = test::refusal_of(
      [&] { check_and_complete(root, spec, {.table = [](const auto&) {}, .key = [](const auto&, auto&) {}}); });
  return refused.message.empty() ? "nothing is refused" : refused.message;
}

}  // namespace

TEST_CASE("each_removed_key_is_refused_with_what_to_use_instead") {
  for (const RemovedKey& row : casefile::removed_keys()) {
    const std::string path = (row.table.empty() ? "" : std::string(row.table) + ".") + std::string(row.name);
    const std::string sentence = sentence_on(row);
    CAPTURE(path, row.value, sentence);
    CHECK(sentence.starts_with("a.toml:" + std::to_string(row.table.empty() ? 2 : 3) + ": " + path + ": "));
    CHECK(sentence.find(row.remedy) != std::string::npos);
    CHECK_FALSE(row.remedy.ends_with("."));
  }
}

TEST_CASE("removed_keys_are_those_of_no_file") {
  for (const casefile::FileSpec* spec :
       {&casefile::case_file().spec(), &casefile::grain_file().spec(), &pack_file_spec(), &study_file_spec()})
    for (const RemovedKey& row : casefile::removed_keys()) {
      CAPTURE(spec->noun, row.table, row.name, row.value);
      const casefile::KeySpec* key = spec->key(row.table, row.name);
      if (row.value.empty())
        CHECK(key == nullptr);
      else if (key != nullptr)
        CHECK(std::ranges::find(key->choices, row.value) == key->choices.end());
    }
}

TEST_CASE("a_stage_refuses_the_removed_keys_of_the_case") {
  for (const RemovedKey& row : casefile::removed_keys())
    CHECK(casefile::removed_key("stage." + std::string(row.table), row.name, row.value) == &row);
  CHECK(casefile::removed_key("", "schema") == nullptr);
}
