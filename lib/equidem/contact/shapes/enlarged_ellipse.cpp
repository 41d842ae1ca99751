// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/shapes/enlarged_ellipse.hpp"

#include <cassert>
#include <cmath>

namespace equidem {

MappedEllipse mapped_ellipse(const Ellipse& i, const Ellipse& j, Vec2 branch) {
  assert(i.b > 0 && j.b > 0);
  const double c = dot(i.axis, j.axis), s = cross(j.axis, i.axis);  // of theta_i - theta_j
  const double n_x = j.a * c, n_y = -j.a * s, p_x = j.b * s, p_y = j.b * c;
  const double o_x = dot(i.axis, branch), o_y = cross(i.axis, branch);
  const double x = 1 / (i.a * i.a), y = 1 / (i.b * i.b);
  const double A = n_x * n_x * x + n_y * n_y * y, B = p_x * p_x * x + p_y * p_y * y;
  const double D = 2 * (n_x * p_x * x + n_y * p_y * y), E = 2 * (o_x * n_x * x + o_y * n_y * y);
  const double F = 2 * (p_x * o_x * x + p_y * o_y * y), G = o_x * o_x * x + o_y * o_y * y - 1;

  MappedEllipse image;
  const double determinant = D * D - 4 * A * B;
  image.h = (F * D - 2 * E * B) / determinant;
  image.k = (E * D - 2 * A * F) / determinant;
  const double K =
      A * image.h * image.h + B * image.k * image.k + D * image.h * image.k - E * image.h - F * image.k + G;
  image.theta = std::atan2(D, B - A) / 2;
  const double cosine = std::cos(image.theta), sine = std::sin(image.theta);
  image.a = std::sqrt(-K / (A * cosine * cosine + B * sine * sine - D * sine * cosine));
  image.b = std::sqrt(-K / (A * sine * sine + B * cosine * cosine + D * sine * cosine));
  return image;
}

EnlargedEllipseContact enlarged_ellipse_contact(const Ellipse& i, const Ellipse& j, Vec2 branch) {
  const MappedEllipse image = mapped_ellipse(i, j, branch);
  const Vec2 along = {std::cos(image.theta), -std::sin(image.theta)}, across = perpendicular(along);
  const Vec2 centre = {-image.h, -image.k};
  const double cos_a = -dot(centre, along) / (image.a + 1), sin_b = -dot(centre, across) / (image.b + 1);
  const auto back = [&](Vec2 x) { return x.x * j.a * j.axis + x.y * j.b * perpendicular(j.axis) + branch; };

  EnlargedEllipseContact contact;
  contact.judgement = cos_a * cos_a + sin_b * sin_b - 1;
  contact.point = back(-(cos_a * along + sin_b * across));
  const double phi = std::atan2(sin_b, cos_a);  // (4.44)-(4.45), in every quadrant
  contact.surface_point = back(image.a * std::cos(phi) * along + image.b * std::sin(phi) * across + centre);
  const double p = dot(i.axis, contact.surface_point), q = cross(i.axis, contact.surface_point);
  const Vec2 outward = i.b * i.b * p * i.axis + i.a * i.a * q * perpendicular(i.axis);
  contact.angle = std::atan2(-outward.x, outward.y);  // (4.49), outwards of ellipse i
  contact.normal = {-std::sin(contact.angle), std::cos(contact.angle)};
  return contact;
}

}  // namespace equidem
