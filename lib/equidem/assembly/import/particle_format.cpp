// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/import/particle_rows.hpp"
#include "equidem/assembly/import/text_lines.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// "1000 atoms", a line of the header of a LAMMPS data file.
bool counts_atoms(std::string_view line) {
  const auto words = words_of(line.substr(0, line.find('#')));
  return words.size() == 2 && words[1] == "atoms" && words[0].find_first_not_of("0123456789") == std::string_view::npos;
}

struct LammpsUnits {
  std::string_view name;
  double metres;
};
constexpr LammpsUnits lammps_units[] = {{"si", 1}, {"cgs", 0.01}, {"micro", 1e-6}, {"nano", 1e-9}};

}  // namespace

std::optional<double> lammps_length_unit(std::string_view name) {
  for (const LammpsUnits& units : lammps_units)
    if (units.name == name) return units.metres;
  return {};
}

ParticleFormat particle_format(std::string_view text) {
  constexpr int lines_of_header = 30;
  text = without_byte_order_mark(text);
  TextLines lines(text);
  std::string_view first;
  for (int k = 0; k < lines_of_header && lines.next(); ++k) {
    if (first.empty()) first = lines.line();
    if (first.starts_with("ITEM:")) return ParticleFormat::lammps_dump;
    if (counts_atoms(lines.line())) return ParticleFormat::lammps_data;
  }
  const bool other = first.empty() || first.front() == '{' || first.front() == '[' ||
                     text.substr(0, first.size() + 1).find('\0') != std::string_view::npos;
  return other ? ParticleFormat::none : ParticleFormat::table;
}

}  // namespace equidem
