// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Supports and loads of an assembly.
/// Loads as forces on the components of discs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/linear/contact_graph.hpp"

namespace equidem {

/// Prescribed motion of the discs of a group; a component without a value stays free.
struct Support {
  std::string group;
  std::optional<double> ux;        ///< m
  std::optional<double> uy;        ///< m
  std::optional<double> rotation;  ///< rad, counter-clockwise
};

/// Meaning of the force of a load.
enum class LoadKind {
  per_disc,  ///< N/m on each disc of the group
  total,     ///< N/m on the whole group, equal shares
  traction,  ///< Pa on the side that the group forms, by the tributary length of each disc
};

template <>
struct EnumNames<LoadKind> {
  using enum LoadKind;
  static constexpr const char* what = "kind of load";
  static constexpr NamedValue<LoadKind> list[] = {{per_disc, "per_disc"}, {total, "total"}, {traction, "traction"}};
};

/// Force and moment on the discs of a group.
struct Load {
  std::string group;
  LoadKind kind = LoadKind::per_disc;
  Vec2 force;         ///< N/m, or Pa for a traction
  double moment = 0;  ///< N (N m per metre of depth); on each disc, or in equal shares
};

/// Force and moment on a disc.
struct DiscForce {
  Vec2 force;         ///< N/m
  double moment = 0;  ///< N
};

/// Loads that act together.
using LoadCase = std::vector<Load>;

/// Whether the points of three contacts, of which each shares a disc with the next, lie in line: the sine of the angle
/// between the two chords is at most 1e-6.
bool points_in_line(const Assembly& assembly, const std::array<std::size_t, 3>& contacts);

/// Force on every component: N/m; moments over a.
/// \throws Error (bad_input) where a load is not finite, names no group or an empty one, is a traction on a group that
///         is no side, or gives a moment where rotations are no unknowns
std::vector<double> assemble_loads(const Assembly& assembly, const DegreesOfFreedom& unknowns, const LoadCase& loads);
/// \param loads one for each disc
std::vector<double> assemble_loads(const DegreesOfFreedom& unknowns, std::span<const DiscForce> loads);

/// Adds one load to these forces.
/// \param discs its group, or that part of it which belongs to the discs of `f`
/// \param count discs of the whole group
/// \throws Error (bad_input)
void add_load(const Load& load, const DiscGroup& discs, std::int64_t count, const DegreesOfFreedom& unknowns,
              std::span<double> f);

/// Refuses a moment on a disc that no contact keeps from turning, and no support either: it could not be balanced.
/// \throws Error (bad_input)
void check_inert_loads(const Assembly& assembly, const DegreesOfFreedom& unknowns, std::span<const double> f);

}  // namespace equidem
