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

using namespace casefile;

/// One kind of case file in help and page.
struct Part {
  const char* title;
  const char* introduction;
  const FileSpec& spec;
};

const std::vector<Part>& parts() {
  static const std::vector<Part> all = {{"Assemblies of discs", assemblies_txt, case_file().spec()},
                                        {"Bodies that collide", colliding_txt, grain_file().spec()},
                                        {"Packings", packings_txt, pack_file_spec()},
                                        {"Studies", studies_txt, study_file_spec()}};
  return all;
}

/// A key or table that files of some kinds have, with its specification in each.
template <class Spec>
struct OfKinds {
  std::vector<std::pair<const FileSpec*, const Spec*>> specs;

  [[nodiscard]] const Spec& first() const { return *specs.front().second; }
  [[nodiscard]] std::string kinds() const {
    return joined(specs, [](const auto& of) { return to_string(of.first->kind); });
  }
  /// A text on it; where that differs from kind to kind, "TEXT; KIND: TEXT".
  template <class TextOf>
  [[nodiscard]] std::string text(const TextOf& text_of) const {
    const std::string usual = text_of(*specs.front().first, first());
    std::string all = usual;
    for (const auto& [file, spec] : specs)
      if (const std::string own = text_of(*file, *spec); own != usual)
        all += fmt::format("; {}: {}", to_string(file->kind), own);
    return all;
  }
};

/// A key, or several of one meaning.
struct Row {
  std::string names;      ///< that of a table inside the table of the section comes before its keys: "damping.mass"
  std::string holder;     ///< heading of a table like that of the section that alone has it; else empty
  std::string selectors;  ///< keys on which it depends whether they apply, "normal, tangential"
  OfKinds<KeySpec> of;
};

/// A table with those inside it and those like it; the top of the file.
struct Section {
  std::string name;
  OfKinds<TableSpec> of;                      ///< empty: the top of the file
  std::vector<OfKinds<TableSpec>> more = {};  ///< inside it, and like it or one of these
  std::vector<Row> rows = {};
};

/// The table that describes the keys of this one.
const TableSpec& described_by(const FileSpec& spec, const TableSpec& table) {
  return table.like.empty() ? table : described_by(spec, *spec.table(table.like));
}

/// The table of the section: a table inside another one belongs to that, unless it is a list.
const TableSpec& table_of_section(const FileSpec& spec, const TableSpec& table) {
  const TableSpec& base = described_by(spec, table);
  const std::size_t dot = base.name.rfind('.');
  return dot == std::string::npos || base.repeated ? base
                                                   : table_of_section(spec, *spec.table(base.name.substr(0, dot)));
}

/// Whether the table that this one is like, or that which that one is like, describes the key.
bool is_described_elsewhere(const FileSpec& spec, const TableSpec& table, const KeySpec& key) {
  if (table.like.empty()) return false;
  const KeySpec* there = spec.key(table.like, key.name);
  return (there != nullptr && there->help == key.help) || is_described_elsewhere(spec, *spec.table(table.like), key);
}

template <class Spec>
void add_to(std::vector<OfKinds<Spec>>& all, const FileSpec& file, const Spec& spec) {
  const auto same = std::ranges::find_if(all, [&](const auto& other) { return other.first().name == spec.name; });
  (same == all.end() ? all.emplace_back() : *same).specs.emplace_back(&file, &spec);
}

void add_keys(Section& section, const FileSpec& file, const TableSpec& table) {
  const std::string& base = described_by(file, table).name;
  const std::string prefix = base == section.name ? "" : base.substr(section.name.size() + 1) + ".";
  const std::string holder = table.like.empty() ? "" : table.heading();
  for (const KeySpec& key : file.keys) {
    if (key.table != table.name || is_described_elsewhere(file, table, key)) continue;
    const std::string name = prefix + key.name;
    const auto same = std::ranges::find_if(section.rows, [&](const Row& row) {
      return row.names == name && row.holder == holder && row.of.first().help == key.help;
    });
    Row& row = same == section.rows.end() ? section.rows.emplace_back(Row{name, holder, {}, {}}) : *same;
    row.of.specs.emplace_back(&file, &key);
    if (!key.when_key.empty()) row.selectors = key.when_key;
  }
}

std::string need_of(const FileSpec& file, const KeySpec& key) {
  for (const KeyRelation& relation : key.relations) {
    if (relation.kind != KeyRelation::Kind::exactly_one) continue;
    std::vector<std::string> others = relation.others;
    std::erase_if(others, [&](const std::string& other) {
      return file.key(key.table, other) == nullptr && file.table(key.table + "." + other) == nullptr;
    });
    return others.empty() ? "required" : fmt::format("required, or {}", listed(others, " or "));
  }
  return key.is_required() ? "required" : key.has_default() ? fmt::format("default {}", key.fallback) : "optional";
}

std::string expected_of(const Row& row) {
  return row.of.text([](const FileSpec&, const KeySpec& key) { return expected(key); });
}

/// \param selectors of the row
std::string meaning_of(const Section& section, const Row& row, const std::string& selectors) {
  std::vector<std::string> conditions;
  if (row.of.specs.size() < section.of.specs.size()) conditions.push_back(row.of.kinds());
  if (!row.holder.empty()) conditions.push_back(row.holder);
  const auto conditional =
      std::ranges::find_if(row.of.specs, [](const auto& of) { return !of.second->when_key.empty(); });
  if (conditional != row.of.specs.end())
    conditions.push_back(fmt::format("{} = {}", selectors, joined(conditional->second->when)));
  const std::string& help = row.of.first().help;
  return conditions.empty() ? help : fmt::format("({}) {}", joined(conditions, "; "), help);
}

/// Rows in turn that differ in their names alone become one.
void join_rows(Section& section) {
  const auto without_name = [&](const Row& row) {
    return expected_of(row) + row.of.text(need_of) +
           (row.of.first().help.empty() ? row.names : meaning_of(section, row, ""));
  };
  std::vector<Row> joined_rows;
  for (Row& row : section.rows) {
    if (joined_rows.empty() || without_name(joined_rows.back()) != without_name(row)) {
      joined_rows.push_back(std::move(row));
      continue;
    }
    Row& whole = joined_rows.back();
    whole.names += ", " + row.names;
    if (whole.selectors != row.selectors) whole.selectors += ", " + row.selectors;
  }
  section.rows = std::move(joined_rows);
}

const std::vector<Section>& sections() {
  static const std::vector<Section> all = [] {
    static const TableSpec top;
    std::vector<Section> made;
    const auto add = [&](const FileSpec& file, const TableSpec& table) {
      const TableSpec& of = table.name.empty() ? table : table_of_section(file, table);
      auto found = std::ranges::find(made, of.name, &Section::name);
      Section& section = found == made.end() ? made.emplace_back(Section{of.name, {}}) : *found;
      if (&table == &of)
        section.of.specs.emplace_back(&file, &table);
      else
        add_to(section.more, file, table);
      add_keys(section, file, table);
    };
    for (const Part& part : parts()) {
      add(part.spec, top);
      for (const TableSpec& table : part.spec.tables) add(part.spec, table);
    }
    for (Section& section : made) join_rows(section);
    return made;
  }();
  return all;
}

std::string table_help(const OfKinds<TableSpec>& table) {
  OfKinds<TableSpec> requiring = table;
  std::erase_if(requiring.specs, [](const auto& of) { return !of.second->required; });
  const bool by_all = requiring.specs.size() == table.specs.size();
  return table.first().help + (requiring.specs.empty() ? ""
                               : by_all                ? "; required"
                                                       : "; " + requiring.kinds() + ": required");
}

/// "[wall.servo]: HELP", "[stage.collisions]: HELP (without law, ...)", with a mark around names.
std::string further_table(const Section& section, const OfKinds<TableSpec>& table, const char* mark) {
  const auto marked = [&](const std::string& name) { return mark + name + mark; };
  const auto& [file, spec] = table.specs.front();
  std::string text = fmt::format("{}: {}", marked(spec->heading()), table_help(table));
  if (spec->like.empty()) return text;
  if (spec->like != section.name) return fmt::format("{}; like {}", text, marked(file->table(spec->like)->heading()));
  std::vector<std::string> missing;
  for (const KeySpec& key : file->keys)
    if (key.table == spec->like && file->key(spec->name, key.name) == nullptr) missing.push_back(marked(key.name));
  return missing.empty() ? text : fmt::format("{} (without {})", text, joined(missing));
}

constexpr std::size_t text_width = 100;

/// Append words, broken into lines of text_width that begin with `indent` spaces.
void append_wrapped(std::string& out, std::string_view words, std::size_t indent) {
  std::string line(indent, ' ');
  for (const std::string_view word : parts_of(words, ' ')) {
    if (line.size() > indent && line.size() + 1 + word.size() > text_width) {
      out += line + "\n";
      line.assign(indent, ' ');
    }
    line += (line.size() > indent ? " " : "") + std::string(word);
  }
  out += line + "\n";
}

void append_row(std::string& out, const Section& section, const Row& row) {
  constexpr std::size_t name_width = 20, indent = 2 + name_width + 1;
  const std::size_t begin = out.size();
  append_wrapped(out, fmt::format("{}; {}", expected_of(row), row.of.text(need_of)), indent);
  if (row.names.size() > name_width)
    out.insert(begin, "  " + row.names + "\n");
  else
    out.replace(begin + 2, row.names.size(), row.names);
  if (const std::string meaning = meaning_of(section, row, row.selectors); !meaning.empty())
    append_wrapped(out, meaning, indent);
}

std::string description(const Section& section) {
  std::string out = "\nAt the top of the file\n";
  if (!section.name.empty()) {
    out = "\n";
    append_wrapped(
        out, fmt::format("{}  {} ({})", section.of.first().heading(), table_help(section.of), section.of.kinds()), 0);
    for (const auto& table : section.more) append_wrapped(out, further_table(section, table, ""), 2);
  }
  for (const Row& row : section.rows) append_row(out, section, row);
  return out;
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

std::string markdown(const Section& section) {
  std::string out = "\n### Top of the file\n";
  if (!section.name.empty()) {
    out = fmt::format("\n### `{}`\n\n{} ({})\n", section.of.first().heading(), escaped(table_help(section.of)),
                      section.of.kinds());
    if (!section.more.empty()) out += '\n';
    for (const auto& table : section.more) out += fmt::format("- {}\n", escaped(further_table(section, table, "`")));
  }
  out += "\n| key | value | default | meaning |\n|---|---|---|---|\n";
  for (const Row& row : section.rows) {
    const auto need = [](const FileSpec& file, const KeySpec& key) {
      return key.has_default() ? fmt::format("`{}`", key.fallback) : need_of(file, key);
    };
    const auto quoted = [](std::string_view name) { return fmt::format("`{}`", name); };
    out += fmt::format("| {} | {} | {} | {} |\n", joined(parts_of(row.names, ','), quoted), escaped(expected_of(row)),
                       row.of.text(need), escaped(meaning_of(section, row, row.selectors)));
  }
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
std::string path_of_first_entry(const FileSpec& spec, const KeySpec& key) {
  const std::string path = key.path();
  std::string out;
  for (std::size_t begin = 0, dot = 0; begin < path.size(); begin = dot + 1) {
    dot = std::min(path.find('.', begin), path.size());
    const TableSpec* table = spec.table(path.substr(0, dot));
    out += path.substr(begin, dot - begin) + (table != nullptr && table->repeated ? ".0" : "");
    if (dot < path.size()) out += '.';
  }
  return out;
}

}  // namespace

std::string describe_case_file() {
  std::string out;
  for (const Part& part : parts()) out += part.introduction;
  for (const Section& section : sections()) out += description(section);
  return out;
}

std::string describe_case_table(const std::string& given) {
  std::string name = given;
  std::erase_if(name, [](char c) { return c == '[' || c == ']'; });
  std::vector<std::string> wanted, names;
  for (const Part& part : parts()) {
    const TableSpec* table = part.spec.table(name);
    for (const KeySpec& key : part.spec.keys)
      if (table == nullptr && key.path() == name) table = part.spec.table(key.table);
    if (table != nullptr) wanted.push_back(table_of_section(part.spec, *table).name);
    for (const TableSpec& other : part.spec.tables) names.push_back(other.name);
  }
  std::string out;
  for (const Section& section : sections())
    if (std::ranges::find(wanted, section.name) != wanted.end())
      out += description(section).substr(out.empty() ? 1 : 0);
  if (!out.empty()) return out;
  const auto meant = nearest(name, names);
  bad_input(fmt::format("there is no table [{}] of a case file", name), "",
            meant ? fmt::format("Did you mean '{}'?", *meant) : "'equidem help case' lists all tables");
}

std::string case_file_page() {
  std::string out = page_txt;
  for (const Part& part : parts())
    out += fmt::format("\n## {}\n\n{}", part.title, markdown_introduction(part.introduction));
  out += "\n## Tables and keys\n";
  for (const Section& section : sections()) out += markdown(section);
  return out;
}

std::vector<CaseKey> case_keys() {
  std::vector<CaseKey> keys;
  for (const Part& part : parts()) {
    if (&part.spec == &study_file_spec()) continue;
    for (const KeySpec& key : part.spec.keys) {
      CaseKey found{path_of_first_entry(part.spec, key), key.choices};
      if (key.type == KeyType::flag) found.words = {"true", "false"};
      if (key.type == KeyType::number_or_auto) found.words = {"auto"};
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

std::vector<CaseKind> kinds_with(std::string_view path) {
  std::vector<CaseKind> kinds;
  for (const Part& part : parts())
    if (part.spec.table(path) != nullptr ||
        std::ranges::find(part.spec.keys, path, &KeySpec::path) != part.spec.keys.end())
      kinds.push_back(part.spec.kind);
  return kinds;
}

std::optional<std::string> unit_of_case_key(std::string_view path) {
  for (const Part& part : parts())
    if (const KeySpec* key = known_key(part.spec, path)) return key->unit;
  return std::nullopt;
}

}  // namespace equidem
