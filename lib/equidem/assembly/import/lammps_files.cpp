// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <map>

#include "equidem/assembly/import/particle_table.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// LAMMPS makes a box orthogonal only where its tilt is 0 (change_box ortho).
constexpr const char* rectangle_remedy =
    "Make the sample in a box without tilt, or shear it back in LAMMPS first (change_box all xy final 0 remap), which "
    "changes its contacts";

/// Columns of the section Atoms; three image flags may follow.
struct AtomStyle {
  std::string_view name;
  std::size_t columns, diameter, x;
};
constexpr AtomStyle atom_styles[] = {{"sphere", 7, 2, 4}, {"granular", 7, 2, 4}, {"bpm/sphere", 8, 3, 5}};

/// Sections with the count of the header that says how many lines they have.
struct DataSection {
  std::string_view name, count;
};
constexpr DataSection data_sections[] = {{"Atoms", "atoms"},
                                         {"Velocities", "atoms"},
                                         {"Bonds", "bonds"},
                                         {"Angles", "angles"},
                                         {"Dihedrals", "dihedrals"},
                                         {"Impropers", "impropers"},
                                         {"Masses", "atom types"},
                                         {"Pair Coeffs", "atom types"},
                                         {"Bond Coeffs", "bond types"},
                                         {"Angle Coeffs", "angle types"},
                                         {"Dihedral Coeffs", "dihedral types"},
                                         {"Improper Coeffs", "improper types"},
                                         {"Atom Type Labels", "atom types"},
                                         {"Bond Type Labels", "bond types"},
                                         {"Angle Type Labels", "angle types"}};

std::string_view without_comment(std::string_view line) {
  return trimmed(line.substr(0, line.find('#')));
}

class DataReader {
 public:
  explicit DataReader(std::string_view text) : lines_(text) {}

  ParticleRows read() {
    result_.format = "a LAMMPS data file";
    lines_.next();  // a title, in which write_data names the units
    const std::string_view title = lines_.line();
    if (const std::size_t at = title.find("units = "); at != std::string_view::npos) {
      result_.units = words_of(title.substr(at + 8)).empty() ? "" : words_of(title.substr(at + 8)).front();
      result_.unit = lammps_length_unit(result_.units);
    }
    std::string section = read_header();
    while (!section.empty()) section = read_section(section);
    if (!atoms_read_) lines_.fail("the file has no section Atoms", "its discs stand there", "Write it by write_data");
    if (counts_["bonds"] > 0 && !result_.contacts)
      lines_.fail(fmt::format("the section Bonds is missing, and the file has {} bonds", counts_["bonds"]),
                  "it was cut off", "Get the whole file");
    return std::move(result_);
  }

 private:
  /// The next line with text besides a comment; false at the end.
  bool next() {
    while (lines_.next()) {
      if (!lines_.is_whole())
        lines_.fail("the file ends within a line", "it was cut off", "Get the whole file, or end its last line");
      if (!without_comment(lines_.line()).empty()) return true;
    }
    return false;
  }

  /// Counts and bounds. \return the line of the first section
  std::string read_header() {
    std::map<std::string, std::array<double, 2>> bounds;
    while (next()) {
      const auto words = words_of(without_comment(lines_.line()));
      const std::string last(words.back());
      if (words.size() == 4 && last.ends_with("hi")) {
        bounds[last.substr(0, 1)] = {finite_number(words[0], "bound", lines_.number()),
                                     finite_number(words[1], "bound", lines_.number())};
      } else if (last == "yz") {
        for (std::size_t k = 0; k < 3 && k < words.size(); ++k) {
          if (finite_number(words[k], "tilt", lines_.number()) != 0) refuse_triclinic();
        }
      } else if (last == "avec" || last == "bvec" || last == "cvec") {
        refuse_triclinic();
      } else if (words[0].find_first_not_of("0123456789") == std::string_view::npos && words.size() > 1) {
        std::vector<std::string> rest(words.begin() + 1, words.end());
        counts_[joined(rest, " ")] = whole_number(words[0], "count", lines_.number());
      } else {
        take_box(bounds);
        return std::string(lines_.line());
      }
    }
    lines_.fail("the file ends before its sections", "it was cut off", "Get the whole file");
  }

  [[noreturn]] void refuse_triclinic() const {
    lines_.fail("the box is triclinic", "a cell here is a rectangle along x and y", rectangle_remedy);
  }

  void take_box(const std::map<std::string, std::array<double, 2>>& bounds) {
    if (!counts_.contains("atoms")) lines_.fail("the file has no number of atoms", "", "Write it by write_data");
    const auto x = bounds.find("x"), y = bounds.find("y");
    if (x == bounds.end() || y == bounds.end()) return;
    result_.box = ParticleRows::Box{
        .low = {x->second[0], y->second[0]}, .high = {x->second[1], y->second[1]}, .periodic_x = {}, .periodic_y = {}};
    if (const auto z = bounds.find("z"); z != bounds.end())
      result_.box->low_z = z->second[0], result_.box->high_z = z->second[1];
  }

  /// \return the line of the next section; empty at the end
  std::string read_section(const std::string& heading) {
    const std::string name(without_comment(heading));
    const std::string style = heading.find('#') == std::string::npos
                                  ? std::string()
                                  : std::string(trimmed(std::string_view(heading).substr(heading.find('#') + 1)));
    for (const char* bodies : {"Ellipsoids", "Lines", "Triangles", "Bodies"}) {
      if (name == bodies)
        lines_.fail(fmt::format("the section {} describes bodies that are no discs", name),
                    "discs have a centre and a radius", "Export spheres, of atom style sphere or bpm/sphere");
    }
    const auto section = std::ranges::find(data_sections, name, &DataSection::name);
    if (section == std::end(data_sections)) {
      const auto meant = nearest(name, names_in(data_sections));
      lines_.fail(fmt::format("'{}' begins no section of a data file that this reader knows", name),
                  "it knows those of LAMMPS up to 2025",
                  meant ? fmt::format("Did you mean '{}'?", *meant) : "Remove it");
    }
    const std::int64_t count = counts_[std::string(section->count)];
    const bool atoms = name == "Atoms", bonds = name == "Bonds";
    const AtomStyle* of_atoms = atoms ? &style_of(style) : nullptr;
    const int heading_line = lines_.number();
    bool sized = !style.empty();  // else the style is one of as many numbers
    if (bonds) result_.contacts.emplace();
    for (std::int64_t k = 0; k < count; ++k) {
      if (!next() || !is_row())
        lines_.fail(fmt::format("the section {} ends after {} of {} lines", name, k, count), "the file was cut off",
                    "Get the whole file");
      const auto cells = words_of(without_comment(lines_.line()));
      if (atoms) read_atom(*of_atoms, cells);
      sized = sized || (atoms && cells[of_atoms->diameter].find_first_of(".e") != std::string_view::npos);
      if (bonds) read_bond(cells);
    }
    if (atoms && !sized && count > 0) refuse_style(style, heading_line);
    atoms_read_ = atoms_read_ || atoms;
    if (!next()) return {};
    if (is_row())
      lines_.fail(fmt::format("the section {} has more than {} lines", name, count), "its header counts fewer",
                  "Correct the header, or get the file as LAMMPS wrote it");
    return std::string(lines_.line());
  }

  /// Rows begin with a number, headings with a letter.
  [[nodiscard]] bool is_row() const {
    const char first = lines_.line().front();
    return (first >= '0' && first <= '9') || first == '-' || first == '+';
  }

  /// Older files name no style: seven numbers are those of sphere, or of full, where the third one is whole.
  [[nodiscard]] const AtomStyle& style_of(const std::string& name) const {
    for (const AtomStyle& style : atom_styles)
      if (style.name == name || name.empty()) return style;
    refuse_style(name, lines_.number());
  }

  [[noreturn]] static void refuse_style(const std::string& name, int line) {
    bad_input_at(
        fmt::format("line {}", line),
        name.empty() ? "the section Atoms does not name its atom style"
                     : fmt::format("the atoms are of style {}, which has no diameter here", name),
        "every disc has a size, and columns differ from style to style",
        "Use atom style sphere or bpm/sphere, and begin the section by \"Atoms # sphere\", as write_data does");
  }

  void read_atom(const AtomStyle& style, const std::vector<std::string_view>& cells) {
    if (cells.size() != style.columns && cells.size() != style.columns + 3)
      lines_.fail(
          fmt::format("the atom has {}", counted(std::ssize(cells), "number")),
          fmt::format("atom style {} has {}, or {} with image flags", style.name, style.columns, style.columns + 3),
          "Get the file as LAMMPS wrote it");
    const int line = lines_.number();
    result_.particles.push_back({.id = whole_number(cells[0], "id", line),
                                 .x = finite_number(cells[style.x], "x", line),
                                 .y = finite_number(cells[style.x + 1], "y", line),
                                 .z = finite_number(cells[style.x + 2], "z", line),
                                 .radius = 0.5 * finite_number(cells[style.diameter], "diameter", line),
                                 .line = line});
  }

  void read_bond(const std::vector<std::string_view>& cells) {
    if (cells.size() != 4)
      lines_.fail(fmt::format("the bond has {}", counted(std::ssize(cells), "number")), "it is: number, type, i, j",
                  "Get the file as LAMMPS wrote it");
    ContactRow bond{.line = lines_.number()};
    bond.i = whole_number(cells[2], "id", bond.line);
    bond.j = whole_number(cells[3], "id", bond.line);
    result_.contacts->push_back(bond);
  }

  TextLines lines_;
  std::map<std::string, std::int64_t> counts_;
  ParticleRows result_;
  bool atoms_read_ = false;
};

}  // namespace

ParticleRows read_lammps_data(std::string_view text) {
  return DataReader(text).read();
}

namespace {

constexpr const char* dump_cut_off = "Get the whole file, or name an earlier time step: assembly.frame";

/// One frame before its rows.
struct DumpFrame {
  std::int64_t step = -1, atoms = -1;
  std::string units;
  ParticleRows::Box box;
  std::vector<std::string_view> columns;
  TextLines rows{""};  ///< before the first row
};

/// Along one axis: plain (x, xu) or in shares of the box (xs, xsu).
struct AxisColumn {
  std::size_t column = 0;
  double low = 0, length = 1;

  [[nodiscard]] double of(double value) const { return low + value * length; }
};

class DumpReader {
 public:
  explicit DumpReader(std::string_view text) : lines_(text) {}

  /// The frame of a time step, or the last; frames before it are passed over.
  DumpFrame find(std::optional<std::int64_t> wanted) {
    std::vector<std::int64_t> steps;
    std::optional<DumpFrame> found;
    while (next_item()) {
      DumpFrame frame = read_header();
      steps.push_back(frame.step);
      const bool is_wanted = !wanted || frame.step == *wanted;
      if (is_wanted) found = frame;
      for (std::int64_t k = 0; k < frame.atoms; ++k) {
        if (lines_.next() && lines_.is_whole() && !lines_.line().starts_with("ITEM:")) continue;
        if (wanted && !is_wanted) break;
        lines_.fail(fmt::format("the frame of time step {} ends after {} of {} atoms", frame.step, k, frame.atoms),
                    "the dump was cut off", dump_cut_off);
      }
      if (wanted && is_wanted) break;
    }
    if (found) return *found;
    if (steps.empty()) lines_.fail("the dump has no frame", "", "Write it again");
    std::string known = joined(steps, [](std::int64_t step) { return fmt::format("{}", step); });
    bad_input_at("", fmt::format("the dump has no frame of time step {}", wanted.value_or(0)),
                 "its time steps are " + known, "Name one of them in assembly.frame");
  }

 private:
  /// The next line that begins an item; blank lines are passed over.
  bool next_item() {
    while (lines_.next())
      if (!lines_.line().empty()) return true;
    return false;
  }

  std::string_view value_line(std::string_view item) {
    if (!lines_.next()) lines_.fail(fmt::format("the dump ends within {}", item), "it was cut off", dump_cut_off);
    return lines_.line();
  }

  DumpFrame read_header() {
    DumpFrame frame;
    bool boxed = false;
    do {
      const std::string_view line = lines_.line();
      if (!line.starts_with("ITEM: ")) {
        lines_.fail(fmt::format("'{}' stands where an ITEM of a dump is expected", line),
                    "a frame has as many rows as its NUMBER OF ATOMS says", "Get the whole file, as LAMMPS wrote it");
      }
      const std::string_view item = trimmed(line.substr(5));
      if (item == "TIMESTEP") {
        frame.step = whole_number(value_line(item), "time step", lines_.number());
      } else if (item == "NUMBER OF ATOMS") {
        frame.atoms = whole_number(value_line(item), "number of atoms", lines_.number());
        if (frame.atoms < 0) lines_.fail("the number of atoms is negative", "", "Get the file as LAMMPS wrote it");
      } else if (item == "UNITS") {
        units_ = value_line(item);  // once at the begin of a file
      } else if (item == "TIME") {
        value_line(item);
      } else if (item.starts_with("BOX BOUNDS")) {
        read_box(words_of(item), frame);
        boxed = true;
      } else if (item.starts_with("ATOMS")) {
        frame.columns = words_of(item);
        frame.columns.erase(frame.columns.begin());
        if (frame.step < 0 || frame.atoms < 0 || !boxed)
          lines_.fail("the frame has no TIMESTEP, NUMBER OF ATOMS or BOX BOUNDS", "they stand before the atoms",
                      "Get the file as LAMMPS wrote it");
        frame.rows = lines_;
        frame.units = units_;
        return frame;
      } else {
        lines_.fail(fmt::format("'ITEM: {}' is not known", item),
                    "this reader knows the text dumps of styles atom and custom of LAMMPS up to 2025",
                    "Dump by \"dump 1 all custom N FILE id x y z radius\"");
      }
    } while (next_item());
    lines_.fail("the last frame has no atoms", "the dump was cut off", dump_cut_off);
  }

  /// "BOX BOUNDS pp pp pp", with "xy xz yz" before the flags where it is triclinic.
  void read_box(const std::vector<std::string_view>& words, DumpFrame& frame) {
    std::vector<std::string_view> flags(words.begin() + 2, words.end());
    const bool tilted = flags.size() >= 3 && flags[0] == "xy";
    if (flags.size() == 1 || (!flags.empty() && flags[0] == "abc"))
      lines_.fail("the box is a general triclinic one", "a cell here is a rectangle along x and y",
                  "Dump without \"triclinic/general\", with an orthogonal box");
    if (tilted) flags.erase(flags.begin(), flags.begin() + 3);
    std::array<double, 3> low{}, high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto cells = words_of(value_line("BOX BOUNDS"));
      if (cells.size() != (tilted ? 3 : 2))
        lines_.fail(fmt::format("'{}' are no bounds of a box", lines_.line()), "", "Get the file as LAMMPS wrote it");
      low[axis] = finite_number(cells[0], "bound", lines_.number());
      high[axis] = finite_number(cells[1], "bound", lines_.number());
      if (tilted && finite_number(cells[2], "tilt", lines_.number()) != 0)
        lines_.fail("the box is triclinic", "a cell here is a rectangle along x and y", rectangle_remedy);
    }
    frame.box.low = {low[0], low[1]};
    frame.box.high = {high[0], high[1]};
    frame.box.low_z = low[2];
    frame.box.high_z = high[2];
    if (flags.size() != 3) return;
    frame.box.periodic_x = flags[0] == "pp";
    frame.box.periodic_y = flags[1] == "pp";
    frame.box.periodic_z = flags[2] == "pp";
  }

  TextLines lines_;
  std::string units_;
};

std::optional<std::size_t> dump_column(const DumpFrame& frame, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const auto found = std::ranges::find(frame.columns, name);
    if (found != frame.columns.end()) return found - frame.columns.begin();
  }
  return {};
}

[[noreturn]] void fail_missing(const DumpFrame& frame, const std::string& name, const std::string& why) {
  frame.rows.fail(fmt::format("the dump has no column '{}'", name), why,
                  "Dump by \"dump 1 all custom N FILE id x y z radius\"");
}

std::optional<AxisColumn> find_place(const DumpFrame& frame, const std::string& axis, double low, double length) {
  if (const auto plain = dump_column(frame, {axis, axis + "u"})) return AxisColumn{*plain};
  if (const auto scaled = dump_column(frame, {axis + "s", axis + "su"})) return AxisColumn{*scaled, low, length};
  return {};
}

}  // namespace

ParticleRows read_lammps_dump(std::string_view text, std::optional<std::int64_t> wanted) {
  DumpFrame frame = DumpReader(text).find(wanted);
  ParticleRows result{.format = "a LAMMPS dump"};
  result.units = frame.units;
  result.unit = lammps_length_unit(frame.units);
  result.box = frame.box;
  const Vec2 size = frame.box.high - frame.box.low;
  const auto x = find_place(frame, "x", frame.box.low.x, size.x), y = find_place(frame, "y", frame.box.low.y, size.y),
             z = find_place(frame, "z", frame.box.low_z, frame.box.high_z - frame.box.low_z);
  if (!x) fail_missing(frame, "x", "every particle has a place");
  if (!y) fail_missing(frame, "y", "every particle has a place");
  const auto radius = dump_column(frame, {"radius"}), diameter = dump_column(frame, {"diameter"});
  if (!radius && !diameter) fail_missing(frame, "radius", "every disc has a size");
  const auto id = dump_column(frame, {"id"});
  TextLines rows = frame.rows;
  for (std::int64_t k = 0; k < frame.atoms; ++k) {
    rows.next();
    const auto cells = words_of(rows.line());
    if (cells.size() != frame.columns.size())
      rows.fail(fmt::format("the row has {}", counted(std::ssize(cells), "cell")),
                fmt::format("ITEM: ATOMS names {}", counted(std::ssize(frame.columns), "column")), dump_cut_off);
    const auto number = [&](std::size_t column) {
      return finite_number(cells[column], frame.columns[column], rows.number());
    };
    result.particles.push_back({.id = id ? whole_number(cells[*id], "id", rows.number()) : k,
                                .x = x->of(number(x->column)),
                                .y = y->of(number(y->column)),
                                .z = z ? z->of(number(z->column)) : 0,
                                .radius = radius ? number(*radius) : 0.5 * number(*diameter),
                                .line = rows.number()});
  }
  return result;
}

}  // namespace equidem
