// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [grains] and [[grain]].
#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/casefile/engine/value.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/grains/scene/grain_file.hpp"

namespace equidem::casefile {
namespace {

/// Disc, ellipse or clump.
void read_shape(const TomlValue& table, const std::string& path, const GrainTable& read, double density,
                GrainShapes& shapes, Grain& grain) {
  const char* key = read.radius ? "radius" : read.half_axes ? "half_axes" : "discs";
  with_key(table, path, key, [&] {
    if (read.radius) return shapes.make_disc(grain, *read.radius, density);
    if (read.half_axes) return shapes.make_ellipse(grain, read.half_axes->x, read.half_axes->y, density);
    shapes.make_clump(grain, read.discs, density);
  });
}

/// \param path of the table: "grain", "stage.grain"
void add_grain(const TomlValue& table, const std::string& path, const GrainTable& read,
               std::optional<double> common_density, GrainShapes& shapes, GrainRows& bodies) {
  if (!read.density && !common_density) {
    fail_at(table, path + ".density", "the density is missing", "motion needs the mass of the grains",
            fmt::format("Add density = ... in kg/m³ to [grains], or to each [[{}]]", path));
  }
  check_group_name(*table.find("group"), path + ".group");
  Grain grain = read.grain;
  bodies.densities.push_back(read.density ? *read.density : *common_density);
  read_shape(table, path, read, bodies.densities.back(), shapes, grain);
  bodies.grains.push_back(grain);
  bodies.groups.push_back(read.group);
}

/// Springs that were made for discs of one density belong to those discs.
void check_density_of_springs(const TomlValue& root, const GrainTables& tables, const std::filesystem::path& path,
                              const GrainRows& file) {
  constexpr double tolerance = 1e-6;
  const std::optional<double> stated = tables.springs ? tables.springs->density : std::nullopt;
  if (!stated) return;
  for (std::size_t k = 0; k < file.densities.size(); ++k) {
    const double own = file.densities[k];
    if (std::abs(own - *stated) <= tolerance * *stated) continue;
    fail_at(
        *root.find("springs")->find("density"), "springs.density",
        fmt::format("it is {:.9g} kg/m³ here and {:.9g} kg/m³ at {}:{}", *stated, own, path.string(), file.lines[k]),
        "both are the density of the discs themselves",
        "Pack with these springs, which carry it, or take the column of densities out of the file of grains");
  }
}

}  // namespace

void check_group_name(const TomlValue& group, const std::string& key) {
  if (group.text.empty()) fail_at(group, key, "the name is empty", "a group is known by its name", "Name it");
  check_plain_name(group, key, "a group", "it stands in tables");
  if (group.text == name_of_all_walls)
    fail_at(group, key, "a group of grains is called 'walls'", "the name stands for all of them", "Name it otherwise");
}

void check_names_of_walls(const TomlValue& holder, const std::string& path, const std::vector<std::string>& groups) {
  const auto check = [&](const TomlValue& name, const std::string& key) {
    if (name.text == name_of_all_walls)
      fail_at(name, key, "a wall is called 'walls'", "the name stands for all of them", "Name it otherwise");
    if (std::find(groups.begin(), groups.end(), name.text) != groups.end())
      fail_at(name, key, fmt::format("a wall and a group of grains are both called '{}'", name.text),
              "[[collisions.pair]] chooses them by name", "Rename one of them");
  };
  for (const TomlValue& wall : repeated(holder, "wall")) check(*wall.find("name"), path + ".name");
  for (const TomlValue& renaming : repeated(holder, "rename"))
    if (renaming.find("wall") != nullptr) check(*renaming.find("to"), "stage.rename.to");
}

GrainRows bodies_of(const TomlValue& root, const TomlValue& holder, const std::string& prefix,
                    const CommonBodyTable& common, const std::vector<GrainTable>& read, GrainShapes& shapes,
                    const GrainTables& tables) {
  GrainRows bodies;
  if (common.path) {
    std::optional<Vec2> cell;
    if (tables.cell_table && tables.cell_table->cell.along == PeriodicCell::Along::xy)
      cell = Vec2{tables.cell_table->cell.width, tables.cell_table->cell.height};
    bodies = with_key(*holder.find("grains"), prefix + "grains", "path",
                      [&] { return read_grains(*common.path, common.density, shapes, cell); });
    check_density_of_springs(root, tables, *common.path, bodies);
  }
  for (std::size_t k = 0; k < read.size(); ++k)
    add_grain(repeated(holder, "grain")[k], prefix + "grain", read[k], common.density, shapes, bodies);
  return bodies;
}

std::vector<std::string> complete_bodies(const TomlValue& root, GrainShapes& shapes, GrainTables& tables) {
  GrainRows bodies = bodies_of(root, root, "", tables.common, tables.grain_tables, shapes, tables);
  if (tables.common.path) tables.grain_file = tables.common.path->string();
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
