// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Binding of the case file of colliding bodies to a GrainCase.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/casefile/contact_tables.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/casefile/motion_case.hpp"
#include "equidem/grains/scene/grain_file.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"

namespace equidem::casefile {

/// [grains].
struct CommonBodyTable {
  std::optional<double> density;  ///< kg/m³
  std::optional<std::filesystem::path> path;
};

/// [[grain]]: one of radius, half_axes and discs is given.
struct GrainTable {
  Grain grain;
  std::optional<double> radius;    ///< m
  std::optional<Vec2> half_axes;   ///< m, the long one first
  std::vector<Clump::Disc> discs;  ///< m
  std::optional<double> density;   ///< kg/m³
  std::string group = "grains";
};

/// [collisions], besides the law and its options.
struct CollisionTable {
  PairOptions contact;
  std::optional<double> young_modulus, poisson_ratio, shear_wave_speed;  ///< Pa, -, m/s
};

/// [bonds].
struct BondsTable {
  GrainBond common;
  std::optional<std::filesystem::path> path;
};

/// A GrainCase and the tables from which it is completed.
struct GrainTables : GrainCase, MotionTables {
  CommonBodyTable common;
  std::vector<GrainTable> grain_tables;
  RunTable run;
  CollisionTable collisions;
  std::optional<SpringsTable> springs;
  BondsTable bonds;
  std::optional<StrengthOptions> strength;
  std::optional<PeriodicCell> cell_table;  ///< without the tables in it
  std::optional<ShakingOptions> shaking_table;
};

/// The case file of colliding bodies, schema "equidem/1".
const File<GrainTables>& grain_file();

void bind_collisions(File<GrainTables>& file);
void bind_stage_cell(File<GrainTables>& file);
void bind_stages(File<GrainTables>& file);

/// The keys of a contact that may differ from [collisions].
std::vector<Key<PairOptions>> changed_contact_keys();
/// [[collisions.pair]].
std::vector<Key<PairOptions>> pair_keys();

/// [grains], without `body`.
std::vector<Key<CommonBodyTable>> common_body_keys();
/// [[grain]].
std::vector<Key<GrainTable>> grain_keys();

/// Stands for all walls where a group and a wall meet.
inline constexpr const char* name_of_all_walls = "walls";
/// \throws Error (bad_input) with line and key: a name that is empty, not plain, or that of all walls
void check_group_name(const TomlValue& group);
/// Names by which pairs are chosen mean one thing each.
/// \param holder the case, or a stage
/// \throws Error (bad_input) with line and key: a wall that is called like a group, or like all walls
void check_names_of_walls(const TomlValue& holder, const std::vector<std::string>& groups);

/// Build the bodies of [grains] and [[grain]], or of those of a stage.
/// \param holder the table that has them: the case, a stage
/// \param common, read what is read of them
/// \throws Error (bad_input) with line and key: no density, a file that is not a table of grains
GrainRows bodies_of(const TomlValue& root, const TomlValue& holder, const CommonBodyTable& common,
                    const std::vector<GrainTable>& read, GrainShapes& shapes, const GrainTables& tables);

/// Set the bodies of the case.
/// \return group of each grain
/// \throws Error (bad_input) with line and key as bodies_of; no grains
std::vector<std::string> complete_bodies(const TomlValue& root, GrainShapes& shapes, GrainTables& tables);

/// Set the kinds of grains and walls, and the contact properties of every two kinds.
/// \param groups of each grain
/// \throws Error (bad_input) with line and key as set_kinds; also: wave speeds with several densities,
///         [springs] beside a stiffness of [collisions], or that no grain has the density of
void complete_collisions(const TomlValue& root, const std::vector<std::string>& groups, GrainTables& tables);

/// The bonds of the file, then those of the case, and their strengths.
/// \param tables with bodies
/// \throws Error (bad_input) with line and key: as check_bonds, a file that is not a table of bonds;
///         as bond_strengths
void complete_bonds(const TomlValue& root, GrainTables& tables);

/// [stage.bonds].
std::vector<Key<StageBonds>> stage_bond_keys();
/// \param stage its number: each draws its own strengths
/// \throws Error (bad_input) with line and key
StageBonds read_stage_bonds(const TomlValue& table, const GrainTables& tables, std::size_t stage);

/// Set the periodic cell of the scene.
/// \throws Error (bad_input) with line and key: a height that is missing, [measures], spheres in a cell along x and y,
///         a deformation of one that repeats along x alone, a schedule that is not there
void complete_cell(const TomlValue& root, std::span<const NamedSchedule> schedules, GrainTables& tables);

/// The cell of a stage, from that of the stage before: rates end with their stage; a component keeps its stress unless
/// the stage gives it a rate or another stress.
/// \throws Error (bad_input) with line and key as complete_cell; a stage that deforms a cell that is not there
std::optional<PeriodicCell> cell_of_stage(const TomlValue& stage, std::span<const NamedSchedule> schedules,
                                          std::optional<PeriodicCell> cell);

/// The stages with their walls and gravity.
/// \param tables with walls
/// \return the walls of all stages, one of each name
/// \throws Error (bad_input) with line and key: a motion of walls outside of the stages, a wall that is not there or
///         needed by the servo of another, an end that names no wall
std::vector<Wall> read_stages(const TomlValue& root, std::span<const NamedSchedule> schedules, GrainTables& tables);

/// Bodies and contacts of the stages.
/// \param[in,out] root paths in its stages become those that the program opens
/// \param[in,out] groups of the bodies of the case; then of those of the run
/// \param all walls of all stages
/// \param tables with stages and bodies
/// \throws Error (bad_input) as complete_collisions; with line and key: bodies as complete_bodies, a choice of bodies
///         that is empty or names no group
void complete_stages(TomlValue& root, const std::filesystem::path& folder, std::vector<std::string>& groups,
                     const std::vector<Wall>& all, GrainShapes& shapes, GrainTables& tables);

/// Apply [shaking] to the walls, except those with shaken = false.
/// \param tables with walls and with [shaking]
/// \throws Error (bad_input) with line and key: a duration of no whole cycles, no wall that moves, a wall that moves by
///         itself as well
void complete_shaking(const TomlValue& root, GrainTables& tables);

}  // namespace equidem::casefile
