// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/check_value.hpp"
#include "equidem/casefile/grain_keys.hpp"
#include "equidem/casefile/keys.hpp"
#include "equidem/casefile/pack_keys.hpp"
#include "equidem/casefile/study_keys.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
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

void append_key(std::string& out, const KeySpec& key) {
  constexpr std::size_t indent = 2 + name_width + 1;
  const std::string name = key.name;
  const std::size_t begin = out.size();
  const std::string need = key.is_required()   ? "required"
                           : key.has_default() ? fmt::format("default {}", key.fallback)
                                               : "optional";
  append_wrapped(out, fmt::format("{}; {}", expected(key), need), indent);
  if (name.size() > name_width) {
    out.insert(begin, "  " + name + "\n");
  } else {
    out.replace(begin + 2, name.size(), name);
  }
  std::string help = key.help;
  if (*key.when_key != '\0') help = fmt::format("({} = {}) {}", key.when_key, joined(key.when), help);
  if (!help.empty()) append_wrapped(out, help, indent);
}

void append_table(std::string& out, const FileSpec& spec, const TableSpec& table) {
  const std::string heading = table.repeated ? fmt::format("[[{}]]", table.name) : fmt::format("[{}]", table.name);
  out += fmt::format("\n{}  {}{}\n", heading, table.help, table.required ? "; required" : "");
  for (const KeySpec& key : spec.keys)
    if (std::string_view(key.table) == table.name) append_key(out, key);
}

constexpr const char* example =
    R"(The case file is TOML and says what is computed. It is strict: an unknown key is an error that names
its line. SI units, per metre of depth; tension positive; angles in radians, counter-clockwise.
Paths are relative to the folder of the case file.

An example:

  schema = "equidem/1"
  title  = "Abe 1996, Fig. 6"
  [assembly]
  kind    = "hexagonal"
  columns = 21
  rows    = 21
  radius  = 0.005
  [springs]
  kN = 1.0e9
  kT = 0.5e9
  [test]
  kind = "uniaxial_tension"

Any key can be set on the command line: --set springs.kT=0.3e9 --set assembly.rows=11

)";

constexpr const char* grain_example =
    R"(
Bodies that meet, rebound and part, for 'equidem run': a case with [grains] or [[grain]] in place of
[assembly]. The top of the file, [[schedule]] and [output] are as above, without output.vtk; the
rest is below. An example:

  schema = "equidem/1"
  [grains]
  body    = "sphere"
  density = 2500.0
  [[grain]]
  position = [0.0, 1.0]
  radius   = 0.02
  [collisions]
  restitution      = 0.8
  contact_duration = 1.0e-3
  [[wall]]
  name   = "floor"
  point  = [0.0, 0.0]
  normal = [0.0, 1.0]
  [run]
  duration = 2.0
  gravity  = [0.0, -9.81]
)";

constexpr const char* pack_example =
    R"(
Discs that fill a box, for 'equidem pack': a case with [packing] in place of [assembly]. An example:

  schema = "equidem/1"
  [packing]
  method = "growth"
  box    = [0.3, 0.2]
  solid_fraction = 0.8
  [packing.radii]
  smallest = 0.002
  largest  = 0.004
  [springs]
  kN = 1.0e8
  kT = 0.5e8
)";

constexpr const char* study_example =
    R"(
A study, for 'equidem study': error against time over the keys of a case. An example:

  schema = "equidem/1"
  [study]
  verb    = "solve"
  case    = "abe1996_fig6.toml"
  measure = "poisson_ratio"
  truth   = "known"
  value   = 0.125
  order   = 1.0
  [[vary]]
  key    = "assembly.rows, assembly.columns"
  values = [9, 17, 33, 65]
)";

}  // namespace

std::string describe_case_file() {
  const FileSpec& spec = case_file_spec();
  std::string out = example;
  out += "At the top of the file\n";
  for (const KeySpec& key : spec.keys)
    if (*key.table == '\0') append_key(out, key);
  for (const TableSpec& table : spec.tables) append_table(out, spec, table);
  out += grain_example;
  const FileSpec& grains = grain_file_spec();
  for (const TableSpec& table : grains.tables)
    if (std::string_view(table.name) != "schedule" && std::string_view(table.name) != "output")
      append_table(out, grains, table);
  out += pack_example;
  for (const TableSpec& table : pack_file_spec().tables) append_table(out, pack_file_spec(), table);
  out += study_example;
  for (const TableSpec& table : study_file_spec().tables) append_table(out, study_file_spec(), table);
  return out;
}

}  // namespace equidem
