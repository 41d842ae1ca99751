// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/grain_tables.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>

#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"

namespace equidem {

namespace {

std::string discs_in_a_cell(const Clump& clump) {
  const auto numbers = [](const Clump::Disc& d) { return fmt::format("{} {} {}", d.offset.x, d.offset.y, d.radius); };
  return joined(clump.discs, numbers, "; ");
}

}  // namespace

void write_grain_csv(const std::filesystem::path& path, const GrainRows& rows, bool overwrite) {
  const auto& [grains, clumps, groups, densities] = rows;
  assert(groups.size() == grains.size() && densities.size() == grains.size());
  const auto any = [&](GrainShape shape) {
    return std::ranges::any_of(rows.grains, [&](const Grain& grain) { return grain.shape() == shape; });
  };
  const bool ellipses = any(GrainShape::ellipse), any_clumps = any(GrainShape::clump);
  std::vector<std::string> columns{"grain", "group", "x_m", "y_m", "radius_m"};
  if (ellipses) columns.emplace_back("short_half_axis_m");
  columns.insert(columns.end(), {"vx_m_per_s", "vy_m_per_s", "spin_rad_per_s", "angle_rad", "density_kg_per_m3"});
  if (any_clumps) columns.emplace_back("discs_m");
  CsvText text(columns, grains.size());
  for (std::size_t g = 0; g < grains.size(); ++g) {
    const Grain& grain = grains[g];
    text.cell(static_cast<std::int64_t>(g));
    text.cell(std::string_view(groups[g]));
    for (const double value : {grain.position.x, grain.position.y, grain.radius}) text.cell(value);
    if (grain.shape() == GrainShape::ellipse) {
      text.cell(grain.short_half_axis);
    } else if (ellipses) {
      text.empty_cell();
    }
    for (const double value : {grain.velocity.x, grain.velocity.y, grain.spin, grain.angle, densities[g]})
      text.cell(value);
    if (grain.shape() == GrainShape::clump) {
      text.cell(std::string_view(discs_in_a_cell(clumps[static_cast<std::size_t>(grain.clump)])));
    } else if (any_clumps) {
      text.empty_cell();
    }
    text.end_row();
  }
  write_file(path, text.text(), overwrite);
}

void write_grain_contact_csv(const std::filesystem::path& path, std::span<const GrainContact> contacts,
                             std::span<const Wall> walls, Body body, bool overwrite) {
  const std::string depth = per_depth(body);
  CsvText text({"i", "j", "wall", "overlap_m", "closing_m_per_s", "normal_x", "normal_y", "normal_force_N" + depth,
                "tangential_force_N" + depth, "mode", "steps"},
               contacts.size());
  for (const GrainContact& contact : contacts) {
    text.cell(std::int64_t{contact.i});
    if (contact.j >= 0) {
      text.cell(std::int64_t{contact.j});
      text.empty_cell();
    } else {
      text.empty_cell();
      text.cell(std::string_view(walls[static_cast<std::size_t>(~contact.j)].name));
    }
    for (const double value : {contact.overlap, contact.closing, contact.normal.x, contact.normal.y,
                               contact.normal_force, contact.tangential_force})
      text.cell(value);
    text.cell(std::int64_t{contact.mode});
    text.cell(contact.steps);
    text.end_row();
  }
  write_file(path, text.text(), overwrite);
}

void write_bond_csv(const std::filesystem::path& path, std::span<const GrainBond> bonds,
                    std::span<const BondDrift> drifts, bool overwrite) {
  assert(drifts.empty() || drifts.size() == bonds.size());
  std::vector<std::string> columns{
      "i", "j", "normal_dashpot", "tangential_dashpot", "rolling_dashpot", "normal_spring", "tangential_spring"};
  if (!drifts.empty())
    for (const char* name : {"distance_drift", "slip_drift", "roll_rad"}) columns.emplace_back(name);
  CsvText text(columns, bonds.size());
  for (std::size_t b = 0; b < bonds.size(); ++b) {
    const GrainBond& bond = bonds[b];
    text.cell(static_cast<std::int64_t>(bond.i));
    text.cell(static_cast<std::int64_t>(bond.j));
    for (const double value : {bond.normal_dashpot, bond.tangential_dashpot, bond.rolling_dashpot, bond.normal_spring,
                               bond.tangential_spring})
      text.cell(value);
    if (!drifts.empty())
      for (const double value : {drifts[b].distance, drifts[b].slip, drifts[b].roll}) text.cell(value);
    text.end_row();
  }
  write_file(path, text.text(), overwrite);
}

}  // namespace equidem
