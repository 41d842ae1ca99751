// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/study/study_case.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/file.hpp"

namespace equidem {
namespace {

/// "a, b" as {"a", "b"}.
std::vector<std::string> separated(const std::string& text) {
  std::vector<std::string> words;
  for (const std::string_view word : parts_of(text, ','))
    if (!word.empty()) words.emplace_back(word);
  return words;
}

const casefile::File<StudyCase>& study_file() {
  using namespace casefile;
  static const File<StudyCase> file = [] {
    using S = StudyCase;
    using V = VariedKey;
    File<S> made(case_schema, "study file", CaseKind::study);
    made.table("study", required, "error against time: what is measured")
        .keys({key("verb", &S::verb, choices({"solve", "homogenize", "calibrate", "stability", "pack", "run"}),
                   "what is done at each setting"),
               key("case", &S::case_file, required, "the case file of the verb"),
               key("measure", &S::measure, required,
                   "a number of the result (--json), such as poisson_ratio or poisson_ratio.plane_strain"),
               key("truth", &S::truth,
                   "finest: the value at the last level; richardson: the limit of the last two by the order; known: "
                   "value"),
               key("value", &S::value, required, when("truth", {"known"}), "the truth itself"),
               key("order", &S::order, positive, "that theory expects: errors fall as h^order; richardson needs it"),
               key("relative", &S::relative, "errors are divided by the truth")});
    made.table("vary", &S::varied, "what is varied; all combinations are tried")
        .keys({key_with<V, std::string>(
                   "key", [](V& varied, const std::string& text) { varied.keys = separated(text); }, required,
                   "a key of the case, such as assembly.rows; several that take the same value: separated by commas"),
               key("values", &V::values, or_instead({"names"}, "a setting has a value or a name"),
                   "values that it takes"),
               key_with<V, std::string>(
                   "names", [](V& varied, const std::string& text) { varied.names = separated(text); }, optional,
                   "words that it takes, separated by commas, such as names of integrators: each is another method"),
               key("orders", &V::orders, only_with({"names"}, "they are those of methods"),
                   "that theory expects with each of the names; left out: study.order"),
               key("refines", &V::refines,
                   "larger, smaller: larger or smaller values are finer levels (one [[vary]] at most); not: another "
                   "method")});
    return made;
  }();
  return file;
}

void check_varied(const TomlValue& table, const VariedKey& varied) {
  using casefile::fail_at;
  for (const std::string& key : varied.keys) {
    if (key.find('.') == std::string::npos)
      fail_at(*table.find("key"), fmt::format("'{}' is no key of a case", key), "a key has a table and a name",
              "Write it as in assembly.rows");
  }
  if (varied.keys.empty())
    fail_at(*table.find("key"), "it is not said what varies", "the key is empty", "Name a key of the case");
  if (!varied.names.empty()) {
    if (std::set<std::string>(varied.names.begin(), varied.names.end()).size() != varied.names.size())
      fail_at(*table.find("names"), "a name is given twice", "each is one setting of the study", "Leave it out once");
    if (!varied.orders.empty() && varied.orders.size() != varied.names.size())
      fail_at(*table.find("orders"),
              fmt::format("there are {} orders of {} names", varied.orders.size(), varied.names.size()),
              "each name has one", "Give as many");
    return;
  }
  const std::set<double> different(varied.values.begin(), varied.values.end());
  if (different.size() != varied.values.size())
    fail_at(*table.find("values"), "a value is given twice", "each is one setting of the study", "Leave it out once");
  if (varied.refines != VariedKey::Refines::not_at_all && *different.begin() <= 0)
    fail_at(*table.find("values"), fmt::format("{} is among values that refine", *different.begin()),
            "orders are read off their logarithms", "Give positive values, or set refines = \"not\"");
}

/// A number as TOML, whole ones without a point: keys that count take nothing else.
std::string as_toml(double value) {
  return value == std::floor(value) && std::abs(value) < 1e15 ? fmt::format("{:.0f}", value) : toml_number(value);
}

}  // namespace

const casefile::FileSpec& study_file_spec() {
  return study_file().spec();
}

StudyCase parse_study_case(std::string_view content, const std::string& name, const std::filesystem::path& folder) {
  using casefile::fail_at;
  using casefile::repeated;
  TomlValue root = parse_toml(content, name);
  StudyCase result = study_file().read(root, folder);
  const TomlValue& study = *root.find("study");
  const bool has_orders = result.order || std::ranges::any_of(result.varied, [](const VariedKey& varied) {
                            return !varied.orders.empty();
                          });
  if (result.truth == Truth::richardson && !has_orders)
    fail_at(study, "order", "the order is missing", "the limit is extrapolated by it",
            "Give order, or truth = \"finest\"");
  if (result.truth == Truth::known && result.relative && result.value == 0)
    fail_at(*study.find("value"), "errors are relative to 0", "they would be infinite", "Set relative = false");
  for (std::size_t k = 0; k < result.varied.size(); ++k) check_varied(repeated(root, "vary")[k], result.varied[k]);
  std::set<std::string> keys;
  for (std::size_t k = 0; k < result.varied.size(); ++k)
    for (const std::string& key : result.varied[k].keys)
      if (!keys.insert(key).second)
        fail_at(repeated(root, "vary")[k], "key", fmt::format("{} is varied twice", key),
                "one setting has one value of it", "Leave it out once");
  if (result.varied.empty())
    fail_at(study, "nothing is varied", "a study compares settings", "Add [[vary]] with key and values");
  const auto refining = std::count_if(result.varied.begin(), result.varied.end(), [](const VariedKey& varied) {
    return varied.names.empty() && varied.refines != VariedKey::Refines::not_at_all;
  });
  if (refining > 1)
    fail_at(repeated(root, "vary").back(), "refines", fmt::format("{} keys refine", refining),
            "errors are ordered by one", "Set refines = \"not\" of the others");
  if (refining == 0 && result.truth != Truth::known)
    fail_at(study, "truth", "no key refines, and the truth is that of the finest level", "there is none",
            "Set refines of one [[vary]], or truth = \"known\" with value");
  result.document = std::move(root);
  return result;
}

StudyCase read_study_case(const std::filesystem::path& path) {
  return parse_study_case(read_file(path), path.string(), path.parent_path());
}

std::vector<StudyPoint> points_of(const StudyCase& study) {
  std::vector<StudyPoint> points(1);
  points[0].setting.order = study.order;
  for (const VariedKey& varied : study.varied) {
    std::vector<StudyPoint> more;
    for (const StudyPoint& point : points) {
      const auto add = [&](const std::string& value) -> Setting& {
        more.push_back(point);
        for (const std::string& key : varied.keys) more.back().overrides.push_back(key + "=" + value);
        return more.back().setting;
      };
      const auto add_method = [&](Setting& setting, const std::string& name) {
        setting.method += (setting.method.empty() ? "" : ", ") + name;
      };
      for (std::size_t k = 0; k < varied.names.size(); ++k) {
        Setting& setting = add(varied.names[k]);
        add_method(setting, varied.names[k]);
        if (!varied.orders.empty()) setting.order = varied.orders[k];
      }
      for (const double value : varied.values) {
        Setting& setting = add(as_toml(value));
        if (varied.refines == VariedKey::Refines::not_at_all) {
          add_method(setting, fmt::format("{} = {:.6g}", varied.keys.front(), value));
        } else {
          setting.values.emplace_back(varied.keys.front(), value);
          setting.resolution = varied.refines == VariedKey::Refines::larger ? 1 / value : value;
        }
      }
    }
    points = std::move(more);
  }
  return points;
}

}  // namespace equidem
