// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The approximate contact of two ellipses after Sukegawa (2010), (4.1)-(4.49).
///
/// The plane is stretched until ellipse j is a unit circle. The image of ellipse i with both half-axes longer by one,
/// a' + 1 and b' + 1, then stands for all places where the circle would touch it, and the ellipses count as touching
/// where it holds the circle's centre. It lies within the true curve of such places: contacts are never invented, but
/// shallow ones are missed, and which depends on the aspects. The normal is that of ellipse i near the contact point:
/// not the common one, even at first touch. Exact for discs.
#pragma once

#include "equidem/contact/shapes/ellipse.hpp"

namespace equidem {

/// OBE_i': the image of ellipse i where ellipse j is the unit circle round the origin. Half-axes a' and b', centre
/// (-h', -k'), turned by -theta' (4.34).
struct MappedEllipse {
  double a = 0, b = 0, theta = 0, h = 0, k = 0;
};

/// (4.12)-(4.28), theta' by atan2 in (4.27), which as printed is undefined for A = B.
/// \param branch from the centre of i to that of j, m
MappedEllipse mapped_ellipse(const Ellipse& i, const Ellipse& j, Vec2 branch);

struct EnlargedEllipseContact {
  double judgement = 0;  ///< JDG (4.32): at most 0 in contact
  Vec2 point;            ///< (x_c, y_c) (4.43) from the centre of i, m
  Vec2 surface_point;    ///< (x_cn, y_cn) (4.47) from the centre of i, m
  double angle = 0;      ///< omega (4.49) of the tangent, rad
  Vec2 normal;           ///< unit, from i to j: (-sin omega, cos omega)

  [[nodiscard]] bool is_contact() const { return judgement <= 0; }
};

/// Points and angle are meaningful only in or near contact, but always finite. Only the judgement is symmetric in i and
/// j.
EnlargedEllipseContact enlarged_ellipse_contact(const Ellipse& i, const Ellipse& j, Vec2 branch);

}  // namespace equidem
