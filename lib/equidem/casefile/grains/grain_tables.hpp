// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Binding of the case file of colliding bodies to a GrainCase.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/casefile/motion_case.hpp"
#include "equidem/casefile/springs_table.hpp"

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

/// [cell], without the tables in it.
struct CellTable {
  PeriodicCell cell;
};

/// [bonds].
struct BondsTable {
  GrainBond common;
  std::optional<std::filesystem::path> path;
};

/// [shaking].
struct ShakingTable {
  enum class Unit { m_per_s2, gal, g };
  Vec2 direction = {1, 0};
  HarmonicShaking harmonic;  ///< acceleration in `unit`
  Unit unit = Unit::m_per_s2;
  double start = 0;  ///< s
  std::optional<std::filesystem::path> record;
  RecordedShaking recorded;  ///< without its points; accelerations in `unit`
};

/// [[stage]], without the tables in it.
struct StageTable {
  std::string name;
  std::optional<double> duration;     ///< s
  std::optional<std::int64_t> steps;  ///< instead
  std::optional<Vec2> gravity;        ///< m/s²
};

/// A GrainCase and the tables from which it is completed.
struct GrainTables : GrainCase, MotionTables {
  CommonBodyTable common;
  std::vector<GrainTable> grain_tables;
  CollisionTable collisions;
  std::optional<SpringsTable> springs;
  BondsTable bonds;
  std::optional<StrengthOptions> strength;
  std::optional<CellTable> cell_table;
  std::optional<ShakingTable> shaking_table;
  std::vector<StageTable> stage_tables;
};

/// The case file of colliding bodies, schema "equidem/1".
const File<GrainTables>& grain_file();

void bind_collisions(File<GrainTables>& file);
void bind_bonds(File<GrainTables>& file);
void bind_cell(File<GrainTables>& file);
void bind_shaking(File<GrainTables>& file);
void bind_stages(File<GrainTables>& file);

/// The keys of a contact that may differ from [collisions].
std::vector<Key<PairOptions>> changed_contact_keys();
/// [[collisions.pair]].
std::vector<Key<PairOptions>> pair_keys();

/// Build the bodies of [grains] and [[grain]].
/// \return group of each grain
/// \throws Error (bad_input) with line and key: no grains, no density, a file that is not a table of grains
std::vector<std::string> complete_bodies(const TomlValue& root, GrainTables& tables);

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
/// \throws Error (bad_input) with line and key: a height that is missing, stages, [measures], spheres in a cell along x
///         and y, a deformation of one that repeats along x alone, a schedule that is not there
void complete_cell(const TomlValue& root, std::span<const NamedSchedule> schedules, GrainTables& tables);

/// The stages with their walls and gravity.
/// \param tables with walls
/// \return the walls of all stages, one of each name
/// \throws Error (bad_input) with line and key: a motion of walls outside of the stages, a wall that is not there or
///         needed by the servo of another, an end that names no wall
std::vector<Wall> read_stages(const TomlValue& root, std::span<const NamedSchedule> schedules, GrainTables& tables);

/// Bodies and contacts of the stages.
/// \param all walls of all stages
/// \param tables with stages and bodies
/// \throws Error (bad_input) as complete_collisions
void complete_stages(TomlValue root, const std::vector<std::string>& groups, const std::vector<Wall>& all,
                     GrainTables& tables);

/// Apply [shaking] to the walls, except those with shaken = false.
/// \param tables with walls and with [shaking]
/// \throws Error (bad_input) with line and key: a duration of no whole cycles, no wall that moves, a wall that moves by
///         itself as well, a record that is no table
void complete_shaking(const TomlValue& root, GrainTables& tables);

}  // namespace equidem::casefile

namespace equidem {

struct AccelerationUnit {
  casefile::ShakingTable::Unit value;
  const char* name;
  double size;  ///< m/s²
};

template <>
struct EnumNames<casefile::ShakingTable::Unit> {
  using enum casefile::ShakingTable::Unit;
  static constexpr const char* what = "unit of acceleration";
  static constexpr AccelerationUnit list[] = {
      {m_per_s2, "m/s2", 1}, {gal, "gal", equidem::gal}, {g, "g", standard_gravity}};
};

}  // namespace equidem
