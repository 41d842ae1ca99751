// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/keys.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"

namespace equidem::casefile {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

bool Range::contains(double value) const {
  if (!std::isfinite(value) || (zero_excluded && value == 0)) return false;
  return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

std::string Range::text() const {
  const auto shown = [](double value) {
    const bool short_whole = std::abs(value) < 1e7 && value == std::floor(value);
    return short_whole ? fmt::format("{:.0f}", value) : fmt::format("{:g}", value);
  };
  if (zero_excluded) return "not 0";
  if (low == -infinity && high == infinity) return {};
  if (high == infinity) return fmt::format("{} {}", low_open ? ">" : ">=", shown(low));
  if (low == -infinity) return fmt::format("{} {}", high_open ? "<" : "<=", shown(high));
  if (low_open && high_open) return fmt::format("between {} and {}", shown(low), shown(high));
  if (!low_open && !high_open) return fmt::format("from {} to {}", shown(low), shown(high));
  return fmt::format("{} {} and {} {}", low_open ? ">" : ">=", shown(low), high_open ? "<" : "<=", shown(high));
}

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

constexpr std::size_t text_width = 100;
constexpr std::size_t name_width = 20;

/// Append words, broken into lines of text_width that begin with `indent` spaces.
void append_wrapped(std::string& out, const std::string& words, std::size_t indent) {
  std::size_t column = indent;
  std::string line(indent, ' ');
  std::size_t begin = 0;
  while (begin < words.size()) {
    std::size_t end = words.find(' ', begin);
    if (end == std::string::npos) end = words.size();
    const std::size_t length = end - begin;
    if (column > indent && column + 1 + length > text_width) {
      out += line + "\n";
      line.assign(indent, ' ');
      column = indent;
    }
    if (column > indent) {
      line += ' ';
      ++column;
    }
    line += words.substr(begin, length);
    column += length;
    begin = end + 1;
  }
  out += line + "\n";
}

std::string need_of(const KeySpec& key) {
  for (const KeyRelation& relation : key.relations)
    if (relation.kind == KeyRelation::Kind::exactly_one)
      return fmt::format("required, or {}", listed(relation.others, " or "));
  return key.is_required() ? "required" : key.has_default() ? fmt::format("default {}", key.fallback) : "optional";
}

std::string meaning_of(const KeySpec& key) {
  if (key.when_key.empty()) return key.help;
  return fmt::format("({} = {}) {}", key.when_key, joined(key.when), key.help);
}

/// A text whose characters have no meaning for Markdown.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view("|*<").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

void append_key(std::string& out, const KeySpec& key) {
  constexpr std::size_t indent = 2 + name_width + 1;
  const std::string& name = key.name;
  const std::size_t begin = out.size();
  append_wrapped(out, fmt::format("{}; {}", expected(key), need_of(key)), indent);
  if (name.size() > name_width) {
    out.insert(begin, "  " + name + "\n");
  } else {
    out.replace(begin + 2, name.size(), name);
  }
  const std::string meaning = meaning_of(key);
  if (!meaning.empty()) append_wrapped(out, meaning, indent);
}

}  // namespace

std::string describe_keys(const FileSpec& spec, std::string_view table) {
  std::string out;
  for (const KeySpec& key : spec.keys)
    if (key.table == table) append_key(out, key);
  return out;
}

std::string describe_table(const FileSpec& spec, const TableSpec& table) {
  return fmt::format("\n{}  {}{}\n", table.heading(), table.help, table.required ? "; required" : "") +
         describe_keys(spec, table.name);
}

std::string markdown_keys(const FileSpec& spec, std::string_view table) {
  if (std::ranges::none_of(spec.keys, [&](const KeySpec& key) { return key.table == table; })) return {};
  std::string out = "\n| key | value | default | meaning |\n|---|---|---|---|\n";
  for (const KeySpec& key : spec.keys)
    if (key.table == table)
      out +=
          fmt::format("| `{}` | {} | {} | {} |\n", key.name, escaped(expected(key)),
                      key.has_default() ? fmt::format("`{}`", key.fallback) : need_of(key), escaped(meaning_of(key)));
  return out;
}

std::string markdown_table(const FileSpec& spec, const TableSpec& table) {
  return fmt::format("\n### `{}`\n\n{}{}\n", table.heading(), escaped(table.help), table.required ? "; required" : "") +
         markdown_keys(spec, table.name);
}

}  // namespace equidem::casefile
