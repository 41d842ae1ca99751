// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The exact contact of two ellipses: closest points and common normal.
///
/// gap = max over unit vectors n of f(n) = branch . n - h_i(n) - h_j(n), h the support functions; the normal is the n
/// that attains it, the contact points are the points of the ellipses that reach farthest along n and -n. Apart, the
/// gap is the distance and they are the closest points; overlapping, -gap is the shortest way along which one can be
/// moved out of the other, and gap and normal stay continuous through touching. For discs it is the disc law.
///
/// f'' = -(f + R) with R the sum of the radii of curvature. As long as -f is below the sum of the sharpest radii,
/// b_i²/a_i + b_j²/a_j, a maximum is the only one that deep (its ellipses shrunk by discs of these radii are apart);
/// deeper, up to four are compared. There the normal jumps where two separating displacements are equally short; either
/// is returned.
#pragma once

#include "equidem/contact/shapes/ellipse.hpp"

namespace equidem {

/// Relative position of two ellipses.
enum class EllipseState {
  apart,     ///< gap > 0
  touching,  ///< gap <= 0, also with a centre inside the other ellipse
  /// One lies in the other: gap, normal and points are those of the shortest separating displacement, but no contact
  /// force follows from them.
  nested,
  concentric,  ///< the centres coincide: as nested, and the sign of the normal is arbitrary
};

/// Result required for ellipses that are apart.
enum class WhenApart {
  distance,         ///< closest points
  only_that_it_is,  ///< a normal that separates them, and as gap a lower bound of the distance, > 0; arms are not
                    ///< filled
};

struct EllipseContact {
  EllipseState state = EllipseState::apart;
  double gap = 0;     ///< m; negative: overlap
  Vec2 normal;        ///< unit, from i to j
  Vec2 arm_i, arm_j;  ///< from the centre to the contact point of each, m: branch + arm_j - arm_i = gap normal

  [[nodiscard]] bool is_contact() const { return state == EllipseState::touching; }
};

/// The error of the gap is of the order of round-off of the sizes, that of the points R/(R + gap) times as large.
/// Swapping i and j mirrors the result bit by bit. Finite numbers give finite numbers. \param branch from the centre of
/// i to that of j, m
/// \param last_normal of the same pair a moment ago, unit: from it the way is short; {} where unknown. It does not
///         change what is found.
EllipseContact contact_of_ellipses(const Ellipse& i, const Ellipse& j, Vec2 branch, Vec2 last_normal = {},
                                   WhenApart when_apart = WhenApart::distance);

/// Within this angle of a maximum its place follows by Taylor's series, to round-off.
double angle_of_arrival(const Ellipse& i, const Ellipse& j);

/// Ellipse i against the half-plane behind a line.
/// \param to_line from the centre of the ellipse to any point of the line, m
/// \param normal of the line, unit, towards the ellipse; that of the result is opposite. Never nested: gap is the
///        distance of the nearest point from the line, however deep
/// \return arm_j from the given point of the line
EllipseContact contact_with_line(const Ellipse& i, Vec2 to_line, Vec2 normal);

/// Ellipse i against a thin segment, its sides or an end: as two ellipses, the segment a flat one.
/// \param to_start, to_end from the centre of the ellipse to the ends, m; distinct
/// \return arm_j from the middle of the segment
EllipseContact contact_with_segment(const Ellipse& i, Vec2 to_start, Vec2 to_end, Vec2 last_normal = {});

}  // namespace equidem
