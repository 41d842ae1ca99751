// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <charconv>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/core/error.hpp"
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

std::optional<std::size_t> index_of(const std::string& segment) {
  std::size_t index = 0;
  const auto [end, problem] = std::from_chars(segment.data(), segment.data() + segment.size(), index);
  if (problem != std::errc() || end != segment.data() + segment.size()) return {};
  return index;
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
    if (is_bare_word(text)) {
      TomlValue word;
      word.type = TomlValue::Type::text;
      word.text = text;
      return word;
    }
    throw Error(ErrorKind::bad_input, fmt::format("'{}' is no TOML value", text), error.why(),
                "Write a number, true, false, [list] or text", source);
  }
  if (parsed.entries.size() != 1) {
    throw Error(ErrorKind::bad_input, "this is more than one value", "one key is set at a time",
                "Use one option for each key", source);
  }
  return parsed.entries.front().second;
}

/// Take the key, or one of several tables, out of the case.
void remove(TomlValue& parent, const std::string& segment, const std::string& source) {
  const auto index = parent.is_array() ? index_of(segment) : std::nullopt;
  if (index && *index < parent.items.size()) {
    parent.items.erase(parent.items.begin() + static_cast<std::ptrdiff_t>(*index));
    return;
  }
  const std::size_t removed = std::erase_if(parent.entries, [&](const auto& entry) { return entry.first == segment; });
  if (removed > 0) return;
  throw Error(ErrorKind::bad_input, fmt::format("there is no '{}' to take out", segment),
              "'none' takes out a key of the case file", "Check its name", source);
}

}  // namespace

void apply_override(TomlValue& root, const std::string& assignment, const std::string& option) {
  std::string shown = fmt::format("{} {}", option, assignment);
  std::replace(shown.begin(), shown.end(), '\n', ' ');
  const auto source = std::make_shared<const std::string>(std::move(shown));
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw Error(ErrorKind::bad_input, "this sets nothing", "a key, '=' and a value are needed",
                "Write it as springs.kT=0.3e9", *source);
  }
  const auto trimmed = [](std::string text) {
    text.erase(0, std::min(text.find_first_not_of(" \t"), text.size()));
    text.erase(text.find_last_not_of(" \t") + 1);
    return text;
  };
  const std::string given = trimmed(assignment.substr(equals + 1));
  TomlValue value = value_from(given, *source);
  put_source(value, source);

  const auto segments = segments_of(trimmed(assignment.substr(0, equals)));
  TomlValue* at = &root;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const std::string& segment = segments[k];
    if (given == "none" && k + 1 == segments.size()) return remove(*at, segment, *source);
    TomlValue* next = nullptr;
    if (at->is_array()) {
      const auto index = index_of(segment);
      if (!index || *index >= at->items.size()) {
        throw Error(ErrorKind::bad_input, fmt::format("there is no entry '{}'", segment),
                    fmt::format("the case file has {} of them, counted from 0", at->items.size()),
                    "Name one that exists", *source);
      }
      next = &at->items[*index];
    } else if (at->is_table()) {
      next = at->find(segment);
      if (next == nullptr) {
        TomlValue made;
        made.source = source;
        at->entries.emplace_back(segment, std::move(made));
        next = &at->entries.back().second;
      }
    } else {
      throw Error(ErrorKind::bad_input, fmt::format("there is nothing below '{}'", segments[k - 1]),
                  fmt::format("in the case file it is {}", at->shown()), "Set the key itself, or change the file",
                  *source);
    }
    at = next;
  }
  *at = std::move(value);
}

bool is_known_key(const FileSpec& spec, std::string_view path) {
  std::string without_indices;
  for (const std::string& segment : segments_of(path))
    if (!index_of(segment)) without_indices += (without_indices.empty() ? "" : ".") + segment;
  return std::ranges::any_of(spec.keys, [&](const KeySpec& key) { return without_indices == key.path(); });
}

}  // namespace equidem::casefile

namespace equidem {

const TomlValue& value_at(const TomlValue& root, std::string_view path) {
  const TomlValue* at = &root;
  for (const std::string& segment : casefile::segments_of(path)) {
    const TomlValue* next = nullptr;
    if (at->is_table()) next = at->find(segment);
    if (at->is_array()) {
      const auto index = casefile::index_of(segment);
      if (index && *index < at->items.size()) next = &at->items[*index];
    }
    if (next == nullptr) return *at;
    at = next;
  }
  return *at;
}

}  // namespace equidem
