// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {
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

bool is_bare_word(const std::string& text) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '.' || c == '/' || c == ' ';
  };
  return !text.empty() && !(text[0] >= '0' && text[0] <= '9') && text[0] != '-' && text[0] != ' ' &&
         std::all_of(text.begin(), text.end(), allowed);
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
    if (const auto advice = number_advice(text))
      bad_input_at(source, fmt::format("'{}' is not a valid TOML value", text), advice->why, advice->remedy);
    if (is_bare_word(text)) {
      TomlValue word;
      word.type = TomlValue::Type::text;
      word.text = text;
      return word;
    }
    bad_input_at(source, fmt::format("'{}' is not a valid TOML value", text), error.why(),
                 "Write a number, true, false, [list] or text");
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

}  // namespace equidem::casefile
