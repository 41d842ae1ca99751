// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/study_keys.hpp"

#include <string_view>

namespace equidem {
namespace {

using enum KeyType;

constexpr const char* none = KeySpec::none;

std::vector<KeySpec> keys_of_study() {
  return {
      {.table = "study",
       .name = "verb",
       .type = choice,
       .fallback = "\"solve\"",
       .choices = {"solve", "homogenize", "calibrate", "stability", "pack", "run"},
       .help = "what is done at each setting"},
      {.table = "study", .name = "case", .type = path, .help = "the case file of the verb"},
      {.table = "study",
       .name = "measure",
       .type = text,
       .help = "a number of the result (--json), such as poisson_ratio or poisson_ratio.plane_strain"},
      {.table = "study",
       .name = "truth",
       .type = choice,
       .fallback = "\"finest\"",
       .choices = {"finest", "richardson", "known"},
       .help = "finest: the value at the last level; richardson: the limit of the last two by the order; known: value"},
      {.table = "study",
       .name = "value",
       .type = number,
       .when_key = "truth",
       .when = {"known"},
       .help = "the truth itself"},
      {.table = "study",
       .name = "order",
       .type = number,
       .fallback = none,
       .range = Range::positive(),
       .help = "that theory expects: errors fall as h^order; richardson needs it"},
      {.table = "study",
       .name = "relative",
       .type = flag,
       .fallback = "true",
       .help = "errors are divided by the truth"},

      {.table = "vary",
       .name = "key",
       .type = text,
       .help = "a key of the case, such as assembly.rows; several that take the same value: separated by commas"},
      {.table = "vary", .name = "values", .type = numbers, .help = "that it takes"},
      {.table = "vary",
       .name = "refines",
       .type = choice,
       .fallback = "\"larger\"",
       .choices = {"larger", "smaller", "not"},
       .help =
           "larger, smaller: larger or smaller values are finer levels (one [[vary]] at most); not: another method"},
  };
}

}  // namespace

const FileSpec& study_file_spec() {
  static const FileSpec spec = [] {
    FileSpec file{.schema = case_file_spec().schema,
                  .noun = "study file",
                  .tables = {{.name = "study", .required = true, .help = "error against time: what is measured"},
                             {.name = "vary", .repeated = true, .help = "what is varied; all combinations are tried"}},
                  .keys = {}};
    for (const KeySpec& key : case_file_spec().keys) {
      const std::string_view table = key.table, name = key.name;
      if (table.empty() && name != "springs") file.keys.push_back(key);
    }
    const auto own = keys_of_study();
    file.keys.insert(file.keys.end(), own.begin(), own.end());
    return file;
  }();
  return spec;
}

}  // namespace equidem
