// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The tables of the case file of colliding bodies, bound to a GrainCase and to data completed from several tables.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/casefile/motion_tables.hpp"
#include "equidem/grains/scene/shaking.hpp"

namespace equidem {

template <>
struct EnumNames<GrainOptions::Scheme> {
  using enum GrainOptions::Scheme;
  static constexpr const char* what = "integrator";
  static constexpr NamedValue<GrainOptions::Scheme> list[] = {{semi_implicit_euler, "semi_implicit_euler"},
                                                              {velocity_verlet, "velocity_verlet"},
                                                              {corrected_verlet, "corrected_verlet"}};
};

}  // namespace equidem

namespace equidem::casefile {

/// [grains].
struct CommonBodyTable {
  Body body = Body::disc;
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

/// [run].
struct GrainRunTable : RunTable {
  std::optional<double> steps_per_contact;
  GrainOptions::Scheme integrator = GrainOptions{}.scheme;
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

struct GrainTables : GrainCase, MotionTables {
  CommonBodyTable common;
  std::vector<GrainTable> grain_tables;
  PairOptions collisions;
  std::optional<double> young_modulus, poisson_ratio, shear_wave_speed;  ///< Pa, -, m/s
  BondsTable bonds;
  GrainRunTable run;
  std::optional<ShakingTable> shaking_table;
};

/// Whether a document describes colliding bodies.
/// \throws Error (bad_input) if it also has an [assembly]
bool describes_grains(const TomlValue& root);

/// The case file of colliding bodies, schema "equidem/1".
const File<GrainTables>& grain_file();

/// The keys of a contact. In [collisions] they have defaults and help; elsewhere they override those.
std::vector<Key<PairOptions>> contact_keys(bool base);
/// The dashpots and springs of a bond.
std::vector<Key<GrainBond>> bond_keys(bool base);

void bind_collisions(File<GrainTables>& file);
void bind_bonds(File<GrainTables>& file);
void bind_shaking(File<GrainTables>& file);

/// Read [shaking] and apply it to the walls, except those with shaken = false.
/// \param tables with walls and with [shaking]
/// \throws Error (bad_input) with line and key: no motion or two, a duration of no whole cycles, no wall that moves, a
///         wall that moves by itself as well, a record that is no table
Shaking read_shaking(const TomlValue& root, GrainTables& tables);

/// Read the bodies of [grains] and [[grain]].
/// \return group of each grain
/// \throws Error (bad_input) with line and key: no grains, no density, a file that is not a table of grains
std::vector<std::string> read_bodies(const TomlValue& root, GrainTables& tables);

/// Set the kinds of grains and walls, and the contact properties of every two kinds.
/// \param groups of each grain
/// \throws Error (bad_input) with line and key as set_kinds; also: keys that exclude one another, wave speeds with
///         several densities
void read_collisions(const TomlValue& root, const std::vector<std::string>& groups, GrainTables& tables);

/// The bonds of the file, then those of the case.
/// \param tables with bodies
/// \throws Error (bad_input) with line and key: as check_bonds, a file that is not a table of bonds
void read_bonds(const TomlValue& root, GrainTables& tables);

}  // namespace equidem::casefile

namespace equidem {

template <>
struct EnumNames<casefile::ShakingTable::Unit> {
  using enum casefile::ShakingTable::Unit;
  static constexpr const char* what = "unit of acceleration";
  static constexpr NamedValue<casefile::ShakingTable::Unit> list[] = {{m_per_s2, "m/s2"}, {gal, "gal"}, {g, "g"}};
};

}  // namespace equidem
