// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <utility>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/casefile/packing/pack_case.hpp"
#include "equidem/casefile/study/study_case.hpp"
#include "equidem/casefile/texts.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// One kind of case file in help and page.
struct Part {
  const char* title;
  const char* introduction;
  const casefile::FileSpec& spec;
  bool describes_top = false;
  std::vector<std::string_view> left_out = {};  ///< tables that another part describes
};

std::vector<Part> parts() {
  const std::vector<std::string_view> packing = {"packing", "packing.shape", "packing.radii", "settling"};
  return {{"Assemblies of discs", assemblies_txt, casefile::case_file().spec(), true, packing},
          {"Bodies that collide", colliding_txt, casefile::grain_file().spec(), false, {"schedule", "output"}},
          {"Packings", packings_txt, pack_file_spec()},
          {"Studies", studies_txt, study_file_spec()}};
}

using Describe = std::string(const casefile::FileSpec&, const casefile::TableSpec&);

std::string tables_of(const Part& part, Describe& describe) {
  std::string out;
  for (const casefile::TableSpec& table : part.spec.tables)
    if (std::ranges::find(part.left_out, table.name) == part.left_out.end()) out += describe(part.spec, table);
  return out;
}

/// The introduction with its example, the lines indented by two spaces, as a block of code.
std::string markdown_introduction(std::string_view introduction) {
  std::string out;
  bool in_example = false;
  if (introduction.starts_with('\n')) introduction.remove_prefix(1);
  while (!introduction.empty()) {
    const std::size_t end = introduction.find('\n');
    std::string_view line = introduction.substr(0, end);
    introduction.remove_prefix(end == std::string_view::npos ? introduction.size() : end + 1);
    if (line.starts_with("  ") != in_example) {
      out += in_example ? "```\n" : "```toml\n";
      in_example = !in_example;
    }
    if (in_example) line.remove_prefix(2);
    out += fmt::format("{}\n", line);
  }
  return in_example ? out + "```\n" : out;
}

/// "load.0.moment" for the key "moment" of [[load]].
std::string path_of_first_entry(const casefile::FileSpec& spec, const casefile::KeySpec& key) {
  const std::string path = key.path();
  std::string out;
  for (std::size_t begin = 0, dot = 0; begin < path.size(); begin = dot + 1) {
    dot = std::min(path.find('.', begin), path.size());
    const casefile::TableSpec* table = spec.table(path.substr(0, dot));
    out += path.substr(begin, dot - begin) + (table != nullptr && table->repeated ? ".0" : "");
    if (dot < path.size()) out += '.';
  }
  return out;
}

}  // namespace

std::string describe_case_file() {
  std::string out;
  for (const Part& part : parts()) {
    out += part.introduction;
    if (part.describes_top) out += "At the top of the file\n" + describe_keys(part.spec, "");
    out += tables_of(part, casefile::describe_table);
  }
  return out;
}

std::string describe_case_table(const std::string& given) {
  std::string name = given;
  std::erase_if(name, [](char c) { return c == '[' || c == ']'; });
  std::string out;
  std::vector<std::string> names;
  for (const Part& part : parts()) {
    const casefile::TableSpec* table = part.spec.table(name);
    for (const casefile::KeySpec& key : part.spec.keys)
      if (table == nullptr && key.path() == name) table = part.spec.table(name.substr(0, name.rfind('.')));
    for (const casefile::TableSpec& other : part.spec.tables) names.push_back(other.name);
    const bool left_out = table != nullptr && std::ranges::find(part.left_out, table->name) != part.left_out.end();
    if (table == nullptr || left_out) continue;
    out += fmt::format("{}{}:\n{}", out.empty() ? "" : "\n", part.title, describe_table(part.spec, *table));
  }
  if (!out.empty()) return out;
  const auto meant = nearest(name, names);
  bad_input(fmt::format("there is no table [{}] of a case file", name), "",
            meant ? fmt::format("Did you mean '{}'?", *meant) : "'equidem help case' lists all tables");
}

std::string case_file_page() {
  std::string out = page_txt;
  for (const Part& part : parts()) {
    out += fmt::format("\n## {}\n\n{}", part.title, markdown_introduction(part.introduction));
    if (part.describes_top) out += "### Top of the file\n" + markdown_keys(part.spec, "");
    out += tables_of(part, casefile::markdown_table);
  }
  return out;
}

std::vector<CaseKey> case_keys() {
  std::vector<CaseKey> keys;
  for (const Part& part : parts()) {
    if (&part.spec == &study_file_spec()) continue;
    for (const casefile::KeySpec& key : part.spec.keys) {
      CaseKey found{path_of_first_entry(part.spec, key), key.choices};
      if (key.type == casefile::KeyType::flag) found.words = {"true", "false"};
      if (key.type == casefile::KeyType::number_or_auto) found.words = {"auto"};
      const auto same = std::ranges::find(keys, found.path, &CaseKey::path);
      if (same == keys.end()) {
        keys.push_back(std::move(found));
        continue;
      }
      for (std::string& word : found.words)
        if (std::ranges::find(same->words, word) == same->words.end()) same->words.push_back(std::move(word));
    }
  }
  return keys;
}

std::optional<std::string> unit_of_case_key(std::string_view path) {
  for (const Part& part : parts())
    if (const casefile::KeySpec* key = casefile::known_key(part.spec, path)) return key->unit;
  return std::nullopt;
}

}  // namespace equidem
