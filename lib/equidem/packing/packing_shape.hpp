// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Shapes to pack: discs, ellipses, pairs of discs, clumps.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "equidem/core/names.hpp"
#include "equidem/geometry/shapes.hpp"
#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

/// All bodies of a packing have one shape, in sizes and directions of their own. The radius drawn for a body is that of
/// the disc of equal area, of a pair that of its discs.
struct PackingShape {
  enum class Kind {
    disc,
    ellipse,
    bonded_pair,  ///< two equal discs tied by dashpots (Sukegawa 2010, chapter 5)
    rigid_pair,   ///< the same, rigidly
    clump,        ///< discs tied rigidly
  } kind = Kind::disc;
  double aspect = 2;  ///< ellipse: long over short half-axis; of area pi r² are a = r aspect^(1/2), b = r²/a
  std::vector<Clump::Disc> discs = {};  ///< clump: in any place and unit; they may overlap

  [[nodiscard]] bool is_disc() const { return kind == Kind::disc; }
};

/// A body for the radius 1 at the angle 0, its centre of mass in the origin.
struct UnitBody {
  double a = 1, b = 1;                  ///< half-axes of a disc or an ellipse
  std::vector<Clump::Disc> discs = {};  ///< pairs and clumps: instead
  double reach = 1;                     ///< radius of the circle round the centre that holds it
  /// The longest arm of a force along the normal, a tenth of the reach at least: 0 of a disc, which it never turns.
  double lever = 0;
  double area = 0;      ///< times r²
  double gyration = 0;  ///< I/m, times r²

  [[nodiscard]] bool is_disc() const { return discs.empty() && a == b; }
  /// Of a radius, m, at an angle over 2 pi; the body outlives it.
  [[nodiscard]] Outline outline(double radius, double turns) const {
    return {a * radius, b * radius, is_disc() ? Vec2{1, 0} : axis_of_turns(turns), discs, radius};
  }
};
struct PackingShapeEntry {
  PackingShape::Kind value;
  const char* name;
  const char* noun;  ///< for reports; plural with s
};

template <>
struct EnumNames<PackingShape::Kind> {
  using Kind = PackingShape::Kind;
  static constexpr const char* what = "shape to pack";
  static constexpr PackingShapeEntry list[] = {{Kind::disc, "disc", "disc"},
                                               {Kind::ellipse, "ellipse", "ellipse"},
                                               {Kind::bonded_pair, "bonded_pair", "pair"},
                                               {Kind::rigid_pair, "rigid_pair", "pair"},
                                               {Kind::clump, "clump", "clump"}};
};

inline std::string noun_of(PackingShape::Kind kind) {
  return entry_of(kind).noun;
}

/// \throws Error (bad_input) on an aspect below 1 or above 1000, a clump without discs or with discs that have no area
UnitBody unit_body_of(const PackingShape& shape);

/// The area of all bodies, m².
double area_of(const PackingShape& shape, std::span<const double> radii);

/// Bodies where they lie.
struct Bodies {
  std::vector<Vec2> centres;  ///< m
  std::vector<double> radii;  ///< m
  std::vector<double> turns;  ///< angles over 2 pi; of discs none

  [[nodiscard]] double turn(std::size_t k) const { return turns.empty() ? 0 : turns[k]; }
  [[nodiscard]] std::size_t size() const { return centres.size(); }
};

}  // namespace equidem
