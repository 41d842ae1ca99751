// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Lines of a text that another program wrote, with their numbers for messages.
/// Particles and contacts as other programs write them: LAMMPS data files and dumps, text exports of YADE, tables with
/// named columns.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/core/vector.hpp"

namespace equidem {

/// Reads a text line by line:
///
///   TextLines lines(text);
///   while (lines.next()) use(lines.line());
class TextLines {
 public:
  /// \param text must outlive the object
  explicit TextLines(std::string_view text) : rest_(text) {}

  /// Whether there is another line, which the functions below are about.
  bool next();
  /// Whether the line ends in a line break: LAMMPS ends every line in one, so that the last line of a file without it
  /// was cut off.
  [[nodiscard]] bool is_whole() const { return is_whole_; }
  [[nodiscard]] std::string_view line() const { return line_; }  ///< trimmed
  [[nodiscard]] int number() const { return number_; }           ///< from 1
  /// Throw an Error (bad_input) at the line.
  [[noreturn]] void fail(std::string problem, std::string why, std::string remedy) const;

 private:
  std::string_view rest_, line_;
  int number_ = 0;
  bool is_whole_ = true;
};

/// A finite number. \throws Error (bad_input) at "line N", naming the column
double finite_number(std::string_view text, std::string_view column, int line);
/// A whole number. \throws Error as above
std::int64_t whole_number(std::string_view text, std::string_view column, int line);

enum class ParticleFormat { none, lammps_data, lammps_dump, table };

/// The format of a text, by its first lines; none: none of them.
ParticleFormat particle_format(std::string_view text);

/// Metres of the unit of length of LAMMPS' systems of units: si, cgs, micro, nano; none of others, whose length is the
/// user's (lj) or not that of grains.
std::optional<double> lammps_length_unit(std::string_view units);

/// Two particles that touch, by their ids.
struct ContactRow {
  std::int64_t i = 0, j = 0;
  int line = 0;
  std::optional<std::int64_t> shift_x = {}, shift_y = {};  ///< periods; none: the nearest image of j
  std::optional<double> lever_i = {}, lever_j = {};        ///< in the unit of the file, see Contact
  std::optional<Vec2> normal = {};                         ///< with offsets, see ContactArms
  double offset_i = 0, offset_j = 0;
  std::optional<double> unit = {};  ///< m, of levers and offsets where their columns name it
};

/// Lengths are in the unit of the file.
struct ParticleRows {
  struct Particle {
    std::int64_t id = 0;
    double x = 0, y = 0, z = 0, radius = 0;
    int line = 0;
  };
  struct Box {
    Vec2 low, high;
    std::optional<bool> periodic_x, periodic_y;  ///< none: the file does not say
    double low_z = 0, high_z = 0;
    std::optional<bool> periodic_z = {};
  };
  std::string format;                    ///< "a LAMMPS dump", for messages
  std::vector<Particle> particles = {};  ///< in the order of the file
  std::optional<double> unit = {};       ///< m, where the file says it
  std::string units = {};                ///< the system of units that it names, "lj"
  std::optional<Box> box = {};
  std::optional<std::vector<ContactRow>> contacts = {};  ///< bonds of the file, at the middle of the line of centres
};

/// \param frame the time step wanted; none: the last
/// \throws Error (bad_input) at "line N": another version, a frame cut off, a column missing, a triclinic box, no such
///         time step (with those that are there)
ParticleRows read_lammps_dump(std::string_view text, std::optional<std::int64_t> frame);
/// The sections Atoms, of a style with a diameter, and Bonds.
/// \throws Error (bad_input) likewise; an atom style without a diameter, one that is not named
ParticleRows read_lammps_data(std::string_view text);
/// A table (TableFile) with the columns x, y and radius or diameter, also z and id, named in its first line, in a
/// comment before the rows, or by "#format" of YADE; without names x y r or x y z r. The columns period_x and period_y
/// are the period. \throws Error (bad_input) likewise; bodies that are no discs
ParticleRows read_particle_table(std::string_view text);

/// A table with the columns i and j, also shift_x, shift_y, lever_i, lever_j, normal_x, normal_y, offset_i, offset_j;
/// without names i and j. Also a local dump of LAMMPS with two columns.
/// \throws Error (bad_input) likewise
std::vector<ContactRow> read_contact_rows(std::string_view text);

}  // namespace equidem
