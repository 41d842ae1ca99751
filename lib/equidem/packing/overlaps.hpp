// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies that overlap push each other apart until nothing does, or nothing moves any more.
///
/// Exact contacts of two bodies, or of a body and a side of the box; clumps may have several.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "equidem/contact/shapes/ellipse_contact.hpp"
#include "equidem/geometry/neighbours.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/packing/packing.hpp"
#include "equidem/packing/packing_shape.hpp"

namespace equidem {

/// A body without its place.
struct Outline {
  double a = 0, b = 0;                      ///< half-axes of a disc or an ellipse, m
  Vec2 axis = {1, 0};                       ///< where its x axis points
  std::span<const Clump::Disc> discs = {};  ///< a clump: instead of half-axes, times `scale`
  double scale = 1;

  [[nodiscard]] std::size_t parts() const { return discs.empty() ? 1 : discs.size(); }
  /// A part is an ellipse or a disc about a centre of its own.
  [[nodiscard]] Vec2 offset(std::size_t part) const {
    if (discs.empty()) return {};
    const Vec2 x = scale * discs[part].offset;
    return {axis.x * x.x - axis.y * x.y, axis.y * x.x + axis.x * x.y};
  }
  [[nodiscard]] Ellipse part(std::size_t part) const {
    if (discs.empty()) return {a, b, axis};
    const double radius = scale * discs[part].radius;
    return {radius, radius, axis};
  }
};

/// \param body stays where it is while the outline is used
inline Outline outline_of(const UnitBody& body, double radius, double turns) {
  return {body.a * radius, body.b * radius, axis_of_turns(turns), body.discs, radius};
}
inline Outline outline_of(const Grain& grain, std::span<const Clump> clumps) {
  const Vec2 axis = axis_at(grain.angle);
  switch (grain.shape()) {
    case GrainShape::clump:
      return {.axis = axis, .discs = clumps[grain.clump].discs};
    case GrainShape::ellipse:
      return {.a = grain.radius, .b = grain.short_half_axis, .axis = axis};
    case GrainShape::disc:
      break;
  }
  return {.a = grain.radius, .b = grain.radius};
}

/// Reach of a body from its centre in a direction, m.
inline double reach_along(const Outline& outline, Vec2 direction) {
  double reach = -INFINITY;
  for (std::size_t p = 0; p < outline.parts(); ++p)
    reach = std::max(reach, dot(outline.offset(p), direction) + support(outline.part(p), direction).reach);
  return reach;
}

/// A contact of body i with body j or a wall.
struct Touch {
  double overlap = 0;  ///< m; negative: a gap
  Vec2 normal;         ///< unit, from i
  Vec2 arm_i, arm_j;   ///< from the centres to the contact point
  double share = 1;  ///< of the overlap that lies in i, in proportion to the radii of (discs of the area of) the parts
  std::size_t part_i = 0, part_j = 0;
};

/// Call body(touch) for all contacts of two bodies whose gap is smaller than `gap` >= 0.
/// \param branch from the centre of i to that of j, m
template <typename Body>
void for_touches(const Outline& i, const Outline& j, Vec2 branch, double gap, const Body& body) {
  for (std::size_t p = 0; p < i.parts(); ++p) {
    const Ellipse one = i.part(p);
    const Vec2 from = i.offset(p);
    for (std::size_t q = 0; q < j.parts(); ++q) {
      const Ellipse other = j.part(q);
      const Vec2 to = j.offset(q), way = branch + to - from;
      const double reach = one.a + other.a + gap, square = dot(way, way);
      if (square >= reach * reach) continue;
      if (one.a == one.b && other.a == other.b) {
        const double distance = std::sqrt(square), overlap = one.a + other.a - distance;
        const Vec2 normal = distance > 0 ? way / distance : Vec2{1, 0};
        body(Touch{overlap, normal, from + (one.a - overlap / 2) * normal, to - (other.a - overlap / 2) * normal,
                   one.a / (one.a + other.a), p, q});
        continue;
      }
      const EllipseContact found =
          contact_of_ellipses(one, other, way, {}, gap > 0 ? WhenApart::distance : WhenApart::only_that_it_is);
      if (!(found.gap < gap)) continue;
      const double size = std::sqrt(one.a * one.b), other_size = std::sqrt(other.a * other.b);
      body(Touch{-found.gap, found.normal, from + found.arm_i, to + found.arm_j, size / (size + other_size), p, q});
    }
  }
}

/// A side of a box: `place` in front of it has the distance place . inwards + offset.
struct BoxSide {
  Vec2 inwards;
  double offset = 0;
};
/// 0 floor, 1 left, 2 right, 3 lid: as many as the box has.
inline std::array<BoxSide, 4> sides_of(const PackingBox& box) {
  return {BoxSide{{0, 1}, 0}, BoxSide{{1, 0}, 0}, BoxSide{{-1, 0}, box.size.x}, BoxSide{{0, -1}, box.size.y}};
}
inline std::size_t count_of_sides(const PackingBox& box) {
  return box.periodic() ? 0 : box.sides == PackingBox::Sides::open_top ? 3 : 4;
}

/// Call body(side, touch) for all contacts with the sides of the box whose gap is smaller than `gap`.
template <typename Body>
void for_wall_touches(const Outline& i, Vec2 place, const PackingBox& box, double gap, const Body& body) {
  const auto sides = sides_of(box);
  for (std::size_t w = 0; w < count_of_sides(box); ++w) {
    const Vec2 out = -sides[w].inwards;
    const double distance = sides[w].offset - dot(place, out);
    for (std::size_t p = 0; p < i.parts(); ++p) {
      const EllipseSupport far = support(i.part(p), out);
      const Vec2 arm = i.offset(p) + support_point(far, out);
      const double overlap = dot(arm, out) - distance;
      if (overlap > -gap) body(static_cast<int>(w), Touch{overlap, out, arm, {}, 1, p});
    }
  }
}

/// Unit springs between overlapping bodies, and between bodies and walls: energy sum overlap²/2 (- weight . x).
struct PushingOptions {
  double overlap = 1e-9;     ///< done where no overlap exceeds this, of the mean radius
  double unbalanced = 1e-7;  ///< or where the mean unbalanced force is this share of the mean contact force
  Vec2 weight = {};  ///< of a body of the mean area, over unit stiffness times mean radius; in proportion to the area
  std::int64_t most = 20000;  ///< evaluations of all overlaps
};

struct PushingReport {
  bool apart = false;                            ///< no overlap beyond what is allowed
  bool balanced = false;                         ///< forces are
  double largest_overlap = 0, mean_overlap = 0;  ///< of those in contact, over the mean radius
  double unbalanced = 0;  ///< of forces and of moments over the longest lever of a body (UnitBody::lever)
  std::int64_t evaluations = 0;
};

/// Minimize the energy by FIRE (Bitzek et al. 2006, Phys. Rev. Lett. 97, 170201): motion with unit masses that is
/// stopped where it goes uphill, in steps that grow while it does not. Bodies turn by an angle whose arc at their
/// longest lever counts as their motion. \param bodies moved and turned
PushingReport push_apart(const PackingBox& box, const UnitBody& shape, const PushingOptions& options,
                         PairFinder& finder, Bodies& bodies);

}  // namespace equidem
