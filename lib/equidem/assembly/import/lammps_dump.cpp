// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>

#include "equidem/assembly/import/particle_rows.hpp"
#include "equidem/assembly/import/text_lines.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
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
        lines_.fail("the box is triclinic", "a cell here is a rectangle along x and y",
                    "Bring it to a rectangle in LAMMPS: change_box all ortho");
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
