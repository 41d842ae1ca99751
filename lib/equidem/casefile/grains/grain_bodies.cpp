// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [grains] and [[grain]].
#include <cmath>

#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/grains/scene/grain_file.hpp"

namespace equidem::casefile {
namespace {

/// Disc, ellipse or clump.
void read_shape(const TomlValue& table, const GrainTable& read, double density, GrainShapes& shapes, Grain& grain) {
  const char* key = read.radius ? "radius" : read.half_axes ? "half_axes" : "discs";
  with_key(table, "grain", key, [&] {
    if (read.radius) return shapes.make_disc(grain, *read.radius, density);
    if (read.half_axes) return shapes.make_ellipse(grain, read.half_axes->x, read.half_axes->y, density);
    shapes.make_clump(grain, read.discs, density);
  });
}

void add_grain(const TomlValue& table, const GrainTable& read, std::optional<double> common_density,
               GrainShapes& shapes, GrainRows& bodies) {
  if (!read.density && !common_density) {
    fail_at(table, "grain.density", "the density is missing", "motion needs the mass of the grains",
            "Add density = ... in kg/m³ to [grains], or to each [[grain]]");
  }
  const TomlValue& group = *table.find("group");
  if (read.group.empty()) fail_at(group, "grain.group", "the name is empty", "a group is known by its name", "Name it");
  check_plain_name(group, "grain.group", "a group", "it stands in tables");
  Grain grain = read.grain;
  bodies.densities.push_back(read.density ? *read.density : *common_density);
  read_shape(table, read, bodies.densities.back(), shapes, grain);
  bodies.grains.push_back(grain);
  bodies.groups.push_back(read.group);
}

/// Springs that were made for discs of one density belong to those discs.
void check_density_of_springs(const TomlValue& root, const GrainTables& tables, const GrainRows& file) {
  constexpr double tolerance = 1e-6;
  const std::optional<double> stated = tables.springs ? tables.springs->density : std::nullopt;
  if (!stated) return;
  for (std::size_t k = 0; k < file.densities.size(); ++k) {
    const double own = file.densities[k];
    if (std::abs(own - *stated) <= tolerance * *stated) continue;
    fail_at(*root.find("springs")->find("density"), "springs.density",
            fmt::format("it is {:.9g} kg/m³ here and {:.9g} kg/m³ at {}:{}", *stated, own, tables.grain_file,
                        file.lines[k]),
            "both are the density of the discs themselves",
            "Pack with these springs, which carry it, or take the column of densities out of the file of grains");
  }
}

}  // namespace

std::vector<std::string> complete_bodies(const TomlValue& root, GrainTables& tables) {
  const CommonBodyTable& common = tables.common;
  GrainShapes shapes(tables.body);
  GrainRows bodies;
  if (common.path) {
    bodies = with_key(*root.find("grains"), "grains", "path",
                      [&] { return read_grains(*common.path, common.density, shapes); });
    tables.grain_file = common.path->string();
    check_density_of_springs(root, tables, bodies);
  }
  for (std::size_t k = 0; k < tables.grain_tables.size(); ++k)
    add_grain(repeated(root, "grain")[k], tables.grain_tables[k], common.density, shapes, bodies);
  if (bodies.grains.empty()) {
    fail_at(root, "grain", "there are no grains", "something has to move",
            "Add [[grain]] with position and radius, or [grains] with path");
  }
  tables.scene.grains = std::move(bodies.grains);
  tables.scene.clumps = shapes.clumps();
  tables.densities = std::move(bodies.densities);
  tables.grain_lines = std::move(bodies.lines);
  return std::move(bodies.groups);
}

}  // namespace equidem::casefile
