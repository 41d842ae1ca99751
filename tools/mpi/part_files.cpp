// SPDX-License-Identifier: GPL-3.0-or-later
#include "part_files.hpp"

#include <algorithm>

#include "equidem/output/files/vtk.hpp"

namespace equidem {

bool cells_are_known(const petsc::Part& part) {
  const auto& areas = part.assembly.cell_areas;
  return static_cast<std::int64_t>(areas.size()) >= part.owned &&
         std::all_of(areas.begin(), areas.begin() + part.owned, [](double area) { return area > 0; });
}

void expect_part_files(const OutputPlan& plan, const petsc::Ranks& ranks, const std::string& name) {
  plan.expect(name + ".vtm");
  for (int rank = 0; rank < ranks.count(); ++rank) {
    for (const std::string& file : vtk_piece_names(name, rank)) plan.expect(file);
  }
}

void write_part_files(const std::filesystem::path& folder, const std::string& name, const petsc::Ranks& ranks,
                      const petsc::Part& part, std::span<const DiscMotion> motions,
                      std::span<const ContactForce> forces, bool overwrite) {
  const AssemblyState state{.assembly = part.assembly, .motions = motions, .contact_forces = forces};
  const std::span<const std::int64_t> numbers(part.names.data(), static_cast<std::size_t>(part.owned));
  write_vtk_piece(folder, name, ranks.rank(), state, numbers, overwrite);
  if (ranks.first()) write_vtk_index(folder, name, ranks.count(), overwrite);
}

}  // namespace equidem
