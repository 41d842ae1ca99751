// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Supports and loads of an assembly.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"

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

}  // namespace equidem
