// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/contact_geometry.hpp"

#include <cmath>

namespace equidem {
namespace {

EllipseContact contact_with_wall(const GrainSystem& system, std::size_t i, const GrainPart& part, std::size_t w,
                                 Vec2 last_normal) {
  const Wall& wall = system.scene.walls[w];
  const Ellipse ellipse{part.a, part.b, system.shapes.axes[i]};
  const Vec2 to_point = wall.point + system.walls.places[w].displacement - system.bodies.motions[i].position;
  if (wall.shape == Wall::Shape::line) return contact_with_line(ellipse, to_point, wall.normal);
  return contact_with_segment(ellipse, to_point, to_point + (wall.end - wall.point), last_normal);
}

/// Conservative test without a square root.
bool is_clear_of_line(const GrainSystem& system, std::size_t i, const GrainPart& part, std::size_t w) {
  const Wall& wall = system.scene.walls[w];
  if (wall.shape != Wall::Shape::line) return false;
  const double height =
      dot(system.bodies.motions[i].position - (wall.point + system.walls.places[w].displacement), wall.normal);
  const double x = part.a * dot(system.shapes.axes[i], wall.normal),
               y = part.b * cross(system.shapes.axes[i], wall.normal);
  return height > 0 && height * height * (1 - 1e-9) > x * x + y * y;
}

}  // namespace

PartGeometry geometry_of_parts(const GrainSystem& system, const Partners& of, bool touching, Vec2 normal) {
  const auto i = static_cast<std::size_t>(of.i), j = static_cast<std::size_t>(of.j);
  const GrainPart& part_i = system.shapes.parts[of.part_i];
  const GrainPart& part_j = system.shapes.parts[of.part_j];
  const Vec2 to_i = offset_of(part_i, system.shapes.axes[i]), to_j = offset_of(part_j, system.shapes.axes[j]);
  const Vec2 branch = system.branch(of) + (to_j - to_i);
  const double reach = part_i.a + part_j.a, square = dot(branch, branch);
  const bool gaps = system.range > 0;
  if (square >= reach * reach && !gaps) return {};
  const double share = part_i.size / (part_i.size + part_j.size);
  if (part_i.is_round() && part_j.is_round()) {
    const double distance = std::sqrt(square), lever = share * distance, overlap = reach - distance;
    normal = distance > 0 ? branch / distance : Vec2{1, 0};
    return {overlap,
            normal,
            to_i + lever * normal,
            to_j - (distance - lever) * normal,
            part_i.a - lever,
            part_j.a - (distance - lever)};
  }
  const Ellipse e_i{part_i.a, part_i.b, system.shapes.axes[i]}, e_j{part_j.a, part_j.b, system.shapes.axes[j]};
  if (system.options.ellipse_law != GrainOptions::EllipseLaw::exact) {
    const EllipseContact contact = contact_by_enlarged_ellipse(e_i, e_j, branch);
    if (!contact.is_contact()) return {};
    return {-contact.gap, contact.normal, to_i + contact.arm_i, to_j + contact.arm_j, 0, 0};
  }
  const EllipseContact contact = contact_of_parts(e_i, e_j, branch, touching, normal, system.range);
  if (contact.gap > 0 && !gaps) return {};
  const double overlap = -contact.gap, sunk_i = share * overlap, sunk_j = overlap - sunk_i;
  return {overlap,
          contact.normal,
          to_i + contact.arm_i - sunk_i * contact.normal,
          to_j + contact.arm_j + sunk_j * contact.normal,
          sunk_i,
          sunk_j};
}

PartGeometry geometry_with_wall(const GrainSystem& system, std::int32_t number, std::size_t w, Vec2 normal) {
  const bool discs = system.shapes.parts.empty(), gaps = system.range > 0;
  const auto i = static_cast<std::size_t>(discs ? number : system.shapes.body_of_part[number]);
  Vec2 offset;
  double radius = system.bodies.constants[i].radius;
  if (!discs) {
    const GrainPart& part = system.shapes.parts[number];
    if (!part.is_round()) {
      if (!gaps && is_clear_of_line(system, i, part, w)) return {};
      const EllipseContact contact = contact_with_wall(system, i, part, w, normal);
      if (contact.gap >= 0 && !gaps) return {};
      return {-contact.gap, contact.normal, contact.arm_i, {}, 0, 0, cross(contact.arm_i, contact.normal)};
    }
    offset = offset_of(part, system.shapes.axes[i]);
    radius = part.a;
  }
  const WallContact contact =
      nearest(system.scene.walls[w], system.walls.places[w].displacement, system.bodies.motions[i].position + offset);
  const double overlap = radius - contact.distance;
  if (!(overlap > 0) && !gaps) return {};
  normal = -contact.normal;
  const Vec2 arm = radius * normal;  // as restored from a saved state of discs
  return {overlap, normal, discs ? arm : offset + arm, {}, 0, 0, cross(offset, normal)};
}

EllipseContact contact_by_enlarged_ellipse(const Ellipse& i, const Ellipse& j, Vec2 branch) {
  struct Symmetric {
    double xx, xy, yy;
  };
  const auto shape = [](const Ellipse& e) {
    const double a = e.a * e.a, b = e.b * e.b, x = e.axis.x, y = e.axis.y;
    return Symmetric{a * x * x + b * y * y, (a - b) * x * y, a * y * y + b * x * x};
  };
  const Symmetric p = shape(i), q = shape(j);
  const double area_i = i.a * i.b, area_j = j.a * j.b;
  const Symmetric t{p.xx / area_i + q.xx / area_j, p.xy / area_i + q.xy / area_j, p.yy / area_i + q.yy / area_j};
  const double mean = 2 * std::sqrt(area_i * area_j / (t.xx * t.yy - t.xy * t.xy));
  const Symmetric s{p.xx + q.xx + mean * t.xx, p.xy + q.xy + mean * t.xy, p.yy + q.yy + mean * t.yy};
  const double determinant = s.xx * s.yy - s.xy * s.xy;
  const auto product = [&](Vec2 x, Vec2 y) {
    return (s.yy * x.x * y.x - s.xy * (x.x * y.y + x.y * y.x) + s.xx * x.y * y.y) / determinant;
  };
  const double room = 1 - product(branch, branch);
  if (!(room >= 0)) return {EllipseState::apart, -room, {}, {}, {}};
  const EnlargedEllipseContact contact = enlarged_ellipse_contact(i, j, branch);
  const double square = product(contact.normal, contact.normal), half = product(contact.normal, branch);
  const double root = std::sqrt(half * half + square * room);
  EllipseContact result;
  result.state = EllipseState::touching;
  result.gap = half > 0 ? -room / (half + root) : -(root - half) / square;
  result.normal = contact.normal;
  result.arm_i = contact.surface_point;
  result.arm_j = contact.surface_point - branch;
  return result;
}

/// As long as the pair was not touching a step ago nothing of the past may enter: lists made anew would not know it.
EllipseContact contact_of_parts(const Ellipse& i, const Ellipse& j, Vec2 branch, bool touching, Vec2 normal,
                                double range) {
  const WhenApart quick = range > 0 ? WhenApart::distance : WhenApart::only_that_it_is;
  if (touching) return contact_of_ellipses(i, j, branch, normal, quick);
  if (normal != Vec2{}) {
    const double gap = separation_along(i, j, branch, normal);
    if (gap > range) return {EllipseState::apart, gap, normal, {}, {}};
    const EllipseContact contact = contact_of_ellipses(i, j, branch, normal, quick);
    if (contact.gap > range) return contact;
  }
  return contact_of_ellipses(i, j, branch, {}, quick);
}

Vec2 viewpoint_on(const GrainSystem& system, std::int32_t grain, std::int32_t part_index, std::int32_t wall) {
  const auto i = static_cast<std::size_t>(grain);
  const Vec2 position = system.bodies.motions[i].position;
  if (system.shapes.parts.empty()) return position;
  const GrainPart& part = system.shapes.parts[part_index];
  if (part.is_round()) return position + offset_of(part, system.shapes.axes[i]);
  const EllipseContact contact = contact_with_wall(system, i, part, static_cast<std::size_t>(wall), {});
  return position + contact.arm_i + contact.gap * contact.normal;
}

}  // namespace equidem
