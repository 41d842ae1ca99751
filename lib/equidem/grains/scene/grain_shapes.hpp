// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Clumps: discs tied rigidly, with mass, centre of mass and moment of inertia.
///
/// The parts of bodies, between which contacts are found: one for a disc or an ellipse, the discs of a clump.
///
/// Shape, mass and moment of inertia of a body from its lengths and its density.
///
/// Exact areas of bodies and of their parts within a rectangle.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/shapes/ellipse_contact.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

/// Area of the intersection of a disc and a rectangle, m².
double clipped_area(Vec2 centre, double radius, const Rectangle& region);
/// Area of the intersection of an ellipse and a rectangle, m².
double clipped_area(const Ellipse& ellipse, Vec2 centre, const Rectangle& region);
/// Area of the intersection of a union of discs and a rectangle, m².
double clipped_area(std::span<const Clump::Disc> discs, const Rectangle& region);
/// Area of the intersection of a grain and a rectangle, m².
double clipped_area(const Grain& grain, std::span<const Clump> clumps, const Rectangle& region);
/// That of all grains; where two overlap the overlap counts twice, as their solid does.
double clipped_area(std::span<const Grain> grains, std::span<const Clump> clumps, const Rectangle& region);

/// Area moments of a union of discs.
struct DiscUnion {
  double area = 0;          ///< m²
  Vec2 centre;              ///< centroid, m
  double polar_moment = 0;  ///< integral of the squared distance from the centroid, m⁴
};
DiscUnion union_of(std::span<const Clump::Disc> discs);

/// Area of a grain, m².
double area_of(const Grain& grain, std::span<const Clump> clumps);

/// The discs, shifted so that the centroid of their union is the origin.
/// \param discs in any position, overlapping or not
/// \throws Error (bad_input) on no discs, a radius that is not positive, numbers that are not finite, a disc within
///         another
Clump centred_clump(std::vector<Clump::Disc> discs);

/// Mass and moment of inertia of the union of the discs about its centroid, exact to rounding.
/// \param density kg/m³
/// \throws Error (bad_input) if the density is not positive and finite
Inertia inertia_of_clump(const Clump& clump, double density);

/// Radius of the circle round the origin that contains all discs, m.
double radius_of(const Clump& clump);

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

/// Radius of the smallest circle that is inscribed in a part of a grain, m.
double inscribed_radius(const Grain& grain, std::span<const Clump> clumps);
/// The smallest of all grains, m; infinite without grains.
double smallest_inscribed_radius(const GrainScene& scene);

/// The x-axis of a body as unit vector, to 1e-15; bit-identical on every machine.
Vec2 axis_at(double angle);
Vec2 axis_of_turns(double turns);  ///< angle over 2 pi

/// From the centre of mass of a body to the centre of a part.
inline Vec2 offset_of(const GrainPart& part, Vec2 axis) {
  return part.offset.x * axis + part.offset.y * perpendicular(axis);
}

/// Whether a point lies in a part.
/// \param branch from the centre of the part to the point
inline bool holds(const GrainPart& part, Vec2 axis, Vec2 branch) {
  const double x = dot(axis, branch) / part.a, y = cross(axis, branch) / part.b;
  return x * x + y * y < 1;
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
