// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Grains as shapes: outline, parts between which contacts are found, and mass and moment of inertia from lengths and
/// density.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "equidem/geometry/shape_contact.hpp"
#include "equidem/geometry/shapes.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

/// A grain at its angle. \param clumps outlive it
inline Outline outline_of(const Grain& grain, std::span<const Clump> clumps) {
  switch (grain.shape()) {
    case GrainShape::clump:
      return {.axis = axis_at(grain.angle), .discs = clumps[grain.clump].discs};
    case GrainShape::ellipse:
      return {.a = grain.radius, .b = grain.short_half_axis, .axis = axis_at(grain.angle)};
    case GrainShape::disc:
      break;
  }
  return {.a = grain.radius, .b = grain.radius};
}

/// Area of a grain, m².
inline double area_of(const Grain& grain, std::span<const Clump> clumps) {
  return area_of(outline_of(grain, clumps));
}
/// Area of all grains within a rectangle, m²; where two overlap the overlap counts twice, as their solid does.
double clipped_area(std::span<const Grain> grains, std::span<const Clump> clumps, const Rectangle& region);

/// Mass and moment of inertia of the union of the discs about its centroid, exact to rounding.
/// \param density kg/m³
/// \throws Error (bad_input) if the density is not positive and finite
Inertia inertia_of_clump(const Clump& clump, double density);

/// A part in the frame of its body: a disc (a = b) or an ellipse whose long half-axis a lies along x.
struct GrainPart {
  Vec2 offset;          ///< of the centre, m
  double a = 0, b = 0;  ///< half-axes, m
  double size = 0;      ///< radius of the disc of equal area, m
  [[nodiscard]] bool is_round() const { return a == b; }
};

/// Whether any body is an ellipse or a clump.
bool has_shapes(const GrainScene& scene);

/// Parts of a grain; those of a clump sorted by position, so that results do not depend on the caller's order.
std::vector<GrainPart> parts_of(const Grain& grain, const std::vector<Clump>& clumps);

/// Smallest inscribed_radius of all grains, m; infinite without grains.
double smallest_inscribed_radius(const GrainScene& scene);

/// From the centre of mass of a body to the centre of a part.
inline Vec2 offset_of(const GrainPart& part, Vec2 axis) {
  return part.offset.x * axis + part.offset.y * perpendicular(axis);
}

/// Sets the shapes of bodies and stores each distinct clump once (GrainScene::clumps).
class GrainShapes {
 public:
  explicit GrainShapes(Body body) : body_(body) {}

  /// Each function sets radius, half-axis or clump, and inertia of a grain.
  /// \param density kg/m³
  /// \throws Error (bad_input): lengths that are not positive, a short half-axis longer than the long one, no discs;
  ///         ellipses and clumps of spheres
  void make_disc(Grain& grain, double radius, double density) const;
  void make_ellipse(Grain& grain, double long_half_axis, double short_half_axis, double density) const;
  /// \param discs in the frame of the body, in any position; shifted so that the centroid of their union is the origin
  void make_clump(Grain& grain, std::vector<Clump::Disc> discs, double density);

  [[nodiscard]] const std::vector<Clump>& clumps() const { return clumps_; }

 private:
  void check_body(const char* shape) const;

  Body body_;
  std::vector<Clump> clumps_;
  std::vector<Inertia> inertias_;                                 ///< of clumps_, density 1
  std::map<std::vector<std::array<double, 3>>, int> known_ = {};  ///< discs as given
};

}  // namespace equidem
