// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/keys.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {

const TableSpec* FileSpec::table(std::string_view name) const {
  const auto found = std::ranges::find(tables, name, &TableSpec::name);
  return found == tables.end() ? nullptr : &*found;
}

const KeySpec* FileSpec::key(std::string_view table, std::string_view name) const {
  const auto found =
      std::ranges::find_if(keys, [&](const KeySpec& key) { return key.name == name && key.table == table; });
  return found == keys.end() ? nullptr : &*found;
}

namespace {

std::vector<std::string> segments_of(std::string_view path) {
  std::vector<std::string> segments(1);
  for (const char c : path) {
    if (c == '.')
      segments.emplace_back();
    else
      segments.back() += c;
  }
  return segments;
}

/// Whether a value is text without its quotes: it begins no text, list or table of TOML. Where a number is wanted the
/// check of the key says what is wrong with it.
bool is_bare(const std::string& text) {
  return !text.empty() && !has_controls(text) && std::string_view("\"'[{").find(text[0]) == std::string_view::npos;
}

void put_source(TomlValue& value, const std::shared_ptr<const std::string>& source) {
  value.source = source;
  value.line = 0;
  for (TomlValue& item : value.items) put_source(item, source);
  for (auto& [name, entry] : value.entries) put_source(entry, source);
}

TomlValue value_from(const std::string& text, const std::string& source) {
  TomlValue parsed;
  try {
    parsed = parse_toml("value = " + text, source);
  } catch (const Error& error) {
    if (is_bare(text)) return *parse_toml("value = " + toml_text(text), source).find("value");
    bad_input_at(source, fmt::format("'{}' is not a valid TOML value", text), error.why(),
                 "Write a number, true, false, [list] or \"text\"");
  }
  if (parsed.entries.size() != 1) {
    bad_input_at(source, "this is more than one value", "one key is set at a time", "Use one option for each key");
  }
  return parsed.entries.front().value;
}

/// Take the key, or one of several tables, out of the case.
void remove(TomlValue& parent, const std::string& segment, const std::string& source) {
  TomlValue* const found = parent.find(segment);
  if (found == nullptr)
    bad_input_at(source, fmt::format("there is no '{}' to take out", segment),
                 "'none' takes out a key of the case file", "Check its name");
  if (parent.is_array()) {
    parent.items.erase(parent.items.begin() + (found - parent.items.data()));
  } else {
    std::erase_if(parent.entries, [&](const auto& entry) { return entry.name == segment; });
  }
}

}  // namespace

void apply_override(TomlValue& root, const std::string& assignment, const std::string& option) {
  std::string shown = fmt::format("{} {}", option, assignment);
  std::replace(shown.begin(), shown.end(), '\n', ' ');
  const auto source = std::make_shared<const std::string>(std::move(shown));
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    bad_input_at(*source, "this sets nothing", "a key, '=' and a value are needed", "Write it as springs.kT=0.3e9");
  }
  const std::string given(trimmed(std::string_view(assignment).substr(equals + 1)));
  TomlValue value = value_from(given, *source);
  put_source(value, source);

  const auto segments = segments_of(trimmed(std::string_view(assignment).substr(0, equals)));
  TomlValue* at = &root;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const std::string& segment = segments[k];
    if (given == "none" && k + 1 == segments.size()) return remove(*at, segment, *source);
    if (!at->is_array() && !at->is_table()) {
      const bool of_file = at->type == TomlValue::Type::text && at->text.ends_with(".toml");
      bad_input_at(*source, fmt::format("there is nothing below '{}'", segments[k - 1]),
                   fmt::format("in the case file it is {}", at->shown()),
                   of_file ? fmt::format("Change the value in that file, or write [{}] with its keys in the case in "
                                         "place of the name of the file; a sweep varies kT/kN by --key ratio",
                                         segments[k - 1])
                           : "Set the key itself, or change the file");
    }
    TomlValue* next = at->find(segment);
    if (next == nullptr && at->is_array()) {
      bad_input_at(*source, fmt::format("there is no entry '{}'", segment),
                   fmt::format("the case file has {} of them, counted from 0", at->items.size()),
                   "Name one that exists");
    }
    if (next == nullptr) {
      at->entries.push_back({segment, {}});
      next = &at->entries.back().value;
      next->source = source;
    }
    at = next;
  }
  *at = std::move(value);
}

TomlValue parse_document(std::string_view text, const std::string& source, std::span<const std::string> overrides) {
  TomlValue root = parse_toml(text, source);
  for (const std::string& assignment : overrides) apply_override(root, assignment);
  set_paths(root);
  return root;
}

TomlValue read_document(const std::filesystem::path& path, std::span<const std::string> overrides) {
  return parse_document(read_file(path), path.string(), overrides);
}

const KeySpec* known_key(const FileSpec& spec, std::string_view path) {
  std::string without_indices;
  for (const std::string& segment : segments_of(path))
    if (!number_from<std::size_t>(segment)) without_indices += (without_indices.empty() ? "" : ".") + segment;
  const auto found = std::ranges::find(spec.keys, without_indices, &KeySpec::path);
  return found == spec.keys.end() ? nullptr : &*found;
}

double number_of(const TomlValue& value) {
  if (value.type == TomlValue::Type::boolean) return 0;
  return bytes_of(value).value_or(0);
}

std::filesystem::path path_of(TomlValue& value, const std::filesystem::path& folder) {
  const std::filesystem::path path = opened(value.text, folder);
  value.text = path.string();
  value.is_path = true;
  return path;
}

const std::vector<TomlValue>& repeated(const TomlValue& root, const char* name) {
  static const std::vector<TomlValue> none;
  const TomlValue* list = root.find(name);
  return list == nullptr ? none : list->items;
}

std::filesystem::path opened(const std::filesystem::path& written, const std::filesystem::path& folder) {
  return (written.is_absolute() ? written : folder / written).lexically_normal();
}

std::string place_of(const TomlValue& table, const std::string& key) {
  const TomlValue* value = table.find(key);
  return fmt::format("{}: {}{}{}", (value == nullptr ? table : *value).where(), table.path,
                     table.path.empty() ? "" : ".", key);
}

void check_names(const TomlValue& root, const char* list) {
  std::map<std::string_view, const TomlValue*> known;
  for (const TomlValue& table : repeated(root, list)) {
    const TomlValue& name = *table.find("name");
    if (name.text.empty()) fail_at(name, "the name is empty", fmt::format("a name means one {}", list), "Name it");
    if (const auto [other, is_new] = known.try_emplace(name.text, &table); !is_new)
      fail_at(name, fmt::format("there are two {}s '{}'", list, name.text),
              fmt::format("the other is at {}", other->second->where()), "Give each its own name");
  }
}

void check_plain_name(const TomlValue& value, const std::string& what, const std::string& use) {
  if (is_plain_name(value.text)) return;
  fail_at(value, fmt::format("{} cannot name {}", value.shown(), what), use, "Use letters, digits, '_' and '-' only");
}

void check_box(const TomlValue& given, Vec2 low, Vec2 high) {
  if (low.x >= high.x || low.y >= high.y)
    fail_at(given, fmt::format("the box {} is empty", given.shown()), "it is [x_min, y_min, x_max, y_max]",
            "Put the smaller numbers first");
}

namespace {

constexpr const char* chain_of_segments = "Give a chain of walls of shape = \"segment\": ends that meet are joined";
constexpr const char* table_of_displacement =
    "Integrate the record by a script, and let walls follow a [[schedule]] of kind = \"table\" by displacement and "
    "schedule of [[wall]]";
constexpr const char* end_of_law =
    "Leave it out: contacts end where their law says (linear_dashpot at zero force, hertz_dashpot at zero overlap)";
constexpr const char* falls_in_time = "Leave it out: bodies fall in time; method = \"growth\" begins dense";
constexpr const char* both_limited = "Leave it out: friction limits spring and dashpot together";

/// Keys and tables, in the order of the reference page.
constexpr std::array keys_of_earlier_versions{
    RemovedKey{"springs", "ks", "", "Write kT instead"},
    RemovedKey{"probe", "grains", "", "Write bodies instead"},
    RemovedKey{"run", "scheme", "", "Write integrator instead"},
    RemovedKey{"viscoelastic", "per_decade", "",
               "Leave it out, or list the frequencies that are wanted in frequencies"},
    RemovedKey{"ensemble", "confidence", "",
               "Leave it out: intervals are those of 95 %, and samples.csv has every sample"},
    RemovedKey{"output", "csv", "", "Name what is written in files, such as files = ['vtk', 'picture']"},
    RemovedKey{"output", "vtk", "", "Name what is written in files, such as files = ['csv', 'picture']"},
    RemovedKey{"output", "picture", "", "Name what is written in files, such as files = ['csv', 'vtk']"},
    RemovedKey{"wall", "shape", "arc", chain_of_segments},
    RemovedKey{"wall", "centre", "", chain_of_segments},
    RemovedKey{"wall", "radius", "", chain_of_segments},
    RemovedKey{"wall", "from", "", chain_of_segments},
    RemovedKey{"wall", "to", "", chain_of_segments},
    RemovedKey{"shaking", "unit", "", "Leave it out: accelerations are in m/s² (1 gal = 0.01, 1 g = 9.80665)"},
    RemovedKey{"shaking", "record", "", table_of_displacement},
    RemovedKey{"shaking", "quantity", "", table_of_displacement},
    RemovedKey{"shaking", "baseline", "", table_of_displacement},
    RemovedKey{"shaking", "scale", "", table_of_displacement},
    RemovedKey{"schedule", "kind", "smooth_table", "Write kind = \"table\" with points close enough"},
    RemovedKey{"measures", "thrown_gap", "", "Find bodies that lie apart in grains.csv or in the frames"},
    RemovedKey{"measures", "columns", "", "Leave it out: columns are two largest diameters wide"},
    RemovedKey{"collisions", "contact_end", "", end_of_law},
    RemovedKey{"collisions", "friction_cap", "", both_limited},
    RemovedKey{"collisions", "ellipse_contact", "enlarged_as_printed", "Write \"enlarged\""},
    RemovedKey{"run", "integrator", "corrected_verlet", "Write \"velocity_verlet\""},
    RemovedKey{"strength", "after_breaking", "rubs", "Write \"frictional\""},
    RemovedKey{"settling", "start", "", falls_in_time},
    RemovedKey{"packing", "relax_first", "", falls_in_time},
    RemovedKey{"packing", "from_grid", "", "Leave it out: local moves start from places at random"},
    RemovedKey{"run", "confirm_rest", "",
               "Leave it out: 'unbalanced' says when bodies rest, and 'equidem solve' answers for what is at rest"},
    RemovedKey{"solver", "method", "single",
               "Write \"auto\": elimination is in double precision, and multigrid is the fast way for many discs"},
};

/// Options and verbs of the command line.
struct RemovedWord {
  std::string_view word, remedy;
};

constexpr std::array words_of_earlier_versions{
    RemovedWord{"pfc", "Take kn and ks of PFC from the table of 'equidem calibrate'"},
    RemovedWord{"--without-critical-ratio", "Leave it out: the critical ratio is always sought"},
    RemovedWord{"reproduce", "Run tools/papers/PAPER.py of the source"},
    RemovedWord{"--list", "Give a study of data/studies"},
    RemovedWord{"--quick", "Vary fewer values in the file of the study"},
    RemovedWord{"--discs", "Give the number of discs in the case"},
};

/// The table whose keys another one takes for what differs: "collisions" of "stage.collisions" and of "stage.pair".
std::string_view of_the_case(std::string_view table) {
  constexpr std::string_view stage = "stage.";
  for (const std::string_view contacts : {"collisions.walls", "collisions.pair", "stage.pair"})
    if (table == contacts) return "collisions";
  return table.starts_with(stage) ? table.substr(stage.size()) : table;
}

}  // namespace

std::span<const RemovedKey> removed_keys() {
  return keys_of_earlier_versions;
}

const RemovedKey* removed_key(std::string_view table, std::string_view name, std::string_view value) {
  const auto found = std::ranges::find_if(keys_of_earlier_versions, [&](const RemovedKey& row) {
    return (row.table == table || row.table == of_the_case(table)) && row.name == name && row.value == value;
  });
  return found == keys_of_earlier_versions.end() ? nullptr : &*found;
}

void refuse_removed_word(std::string_view word, std::string_view taker) {
  const auto found = std::ranges::find(words_of_earlier_versions, word, &RemovedWord::word);
  if (found == words_of_earlier_versions.end()) return;
  bad_input(fmt::format("'{}' is of an earlier version", word), fmt::format("{} has it no longer", taker),
            std::string(found->remedy));
}

}  // namespace equidem::casefile
