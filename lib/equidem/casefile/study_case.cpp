// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/study_case.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "equidem/casefile/keys.hpp"
#include "equidem/casefile/read_value.hpp"
#include "equidem/casefile/study_keys.hpp"
#include "equidem/core/file.hpp"

namespace equidem {
namespace {

/// "a, b" as {"a", "b"}.
std::vector<std::string> listed(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream in(text);
  for (std::string word; std::getline(in >> std::ws, word, ',');) {
    while (word.ends_with(' ')) word.pop_back();
    words.push_back(word);
  }
  return words;
}

VariedKey read_varied(const TomlValue& table) {
  VariedKey varied{.keys = listed(text(table, "key")), .values = {}};
  for (const std::string& key : varied.keys) {
    if (key.find('.') == std::string::npos)
      fail_at(*table.find("key"), "vary.key", fmt::format("'{}' is no key of a case", key),
              "a key has a table and a name", "Write it as in assembly.rows");
  }
  if (varied.keys.empty())
    fail_at(*table.find("key"), "vary.key", "it is not said what varies", "the key is empty", "Name a key of the case");
  for (const TomlValue& value : table.find("values")->items) varied.values.push_back(value.real);
  const std::set<double> different(varied.values.begin(), varied.values.end());
  if (different.size() != varied.values.size() || varied.values.empty())
    fail_at(*table.find("values"), "vary.values",
            varied.values.empty() ? "there are no values" : "a value is given twice",
            "each is one setting of the study", varied.values.empty() ? "Give at least one" : "Leave it out once");
  const std::string& refines = text(table, "refines");
  using enum VariedKey::Refines;
  varied.refines = refines == "larger" ? larger : refines == "smaller" ? smaller : not_at_all;
  if (varied.refines != not_at_all && *different.begin() <= 0)
    fail_at(*table.find("values"), "vary.values", fmt::format("{} is among values that refine", *different.begin()),
            "orders are read off their logarithms", "Give positive values, or set refines = \"not\"");
  return varied;
}

/// A number as TOML, whole ones without a point: keys that count take nothing else.
std::string as_toml(double value) {
  return value == std::floor(value) && std::abs(value) < 1e15 ? fmt::format("{:.0f}", value) : toml_number(value);
}

}  // namespace

StudyCase parse_study_case(std::string_view content, const std::string& name, const std::filesystem::path& folder) {
  TomlValue root = parse_toml(content, name);
  check_and_complete(root, study_file_spec());
  const TomlValue& study = *root.find("study");
  StudyCase result;
  result.title = text(root, "title");
  result.verb = text(study, "verb");
  result.case_file = opened(text(study, "case"), folder);
  result.measure = text(study, "measure");
  const std::string& truth = text(study, "truth");
  result.truth = truth == "known" ? Truth::known : truth == "finest" ? Truth::finest : Truth::richardson;
  result.value = optional_number(study, "value").value_or(0);
  result.order = optional_number(study, "order");
  result.relative = flag(study, "relative");
  if (result.truth == Truth::richardson && !result.order)
    fail_at(study, "study.order", "the order is missing", "the limit is extrapolated by it",
            "Give order, or truth = \"finest\"");
  if (result.truth == Truth::known && result.relative && result.value == 0)
    fail_at(*study.find("value"), "study.value", "errors are relative to 0", "they would be infinite",
            "Set relative = false");
  for (const TomlValue& table : repeated(root, "vary")) result.varied.push_back(read_varied(table));
  if (result.varied.empty())
    fail_at(study, "study", "nothing is varied", "a study compares settings", "Add [[vary]] with key and values");
  const auto refining = std::count_if(result.varied.begin(), result.varied.end(), [](const VariedKey& varied) {
    return varied.refines != VariedKey::Refines::not_at_all;
  });
  if (refining > 1)
    fail_at(repeated(root, "vary").back(), "vary.refines", fmt::format("{} keys refine", refining),
            "errors are ordered by one", "Set refines = \"not\" of the others");
  if (refining == 0 && result.truth != Truth::known)
    fail_at(study, "study.truth", "no key refines, and the truth is that of the finest level", "there is none",
            "Set refines of one [[vary]], or truth = \"known\" with value");
  result.document = std::move(root);
  return result;
}

StudyCase read_study_case(const std::filesystem::path& path) {
  return parse_study_case(read_file(path), path.string(), path.parent_path());
}

std::vector<StudyPoint> points_of(const StudyCase& study) {
  std::vector<StudyPoint> points(1);
  for (const VariedKey& varied : study.varied) {
    std::vector<StudyPoint> more;
    for (const StudyPoint& point : points) {
      for (const double value : varied.values) {
        StudyPoint next = point;
        for (const std::string& key : varied.keys) next.overrides.push_back(key + "=" + as_toml(value));
        if (varied.refines == VariedKey::Refines::not_at_all) {
          next.setting.method +=
              fmt::format("{}{} = {:.6g}", next.setting.method.empty() ? "" : ", ", varied.keys.front(), value);
        } else {
          next.setting.values.emplace_back(varied.keys.front(), value);
          next.setting.resolution = varied.refines == VariedKey::Refines::larger ? 1 / value : value;
        }
        more.push_back(std::move(next));
      }
    }
    points = std::move(more);
  }
  return points;
}

}  // namespace equidem
