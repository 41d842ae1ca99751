// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/crossing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/geometry/shape_contact.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"

namespace equidem {
namespace {

struct Pose {
  GrainPart part;
  Vec2 centre, axis;
  [[nodiscard]] Ellipse ellipse() const { return {part.a, part.b, axis}; }
};

/// Within a step, `share` of it gone: ways and turns are uniform.
Pose pose_at(const GrainSystem& system, const PeriodicImage& body, std::int32_t part_index, double share) {
  const GrainMotion &before = system.bodies.motions[body.body], &after = system.bodies.next[body.body];
  const Vec2 from = before.position + system.cell.now.shift(body), to = after.position + system.cell.next.shift(body);
  const Vec2 place = share == 1 ? to : from + share * (to - from);
  const GrainPart part = system.part(body.body, part_index);
  if (part.is_round() && part.offset == Vec2{}) return {part, place, {1, 0}};
  const Vec2 axis = axis_at(before.angle + share * (after.angle - before.angle));
  return {part, place + offset_of(part, axis), axis};
}

/// Branch from part i to part j, or position of part i if j is a wall, before and after the step.
struct PartWay {
  Vec2 before, after;
  double radius_i = 0, radius_j = 0;  ///< radii of the inscribed circles, m
};

PartWay way_of_parts(const GrainSystem& system, const Partners& of) {
  const Pose start_i = pose_at(system, {of.i}, of.part_i, 0), end_i = pose_at(system, {of.i}, of.part_i, 1);
  if (of.j < 0) return {start_i.centre, end_i.centre, start_i.part.b, 0};
  const Pose start_j = pose_at(system, of.image(), of.part_j, 0), end_j = pose_at(system, of.image(), of.part_j, 1);
  return {start_j.centre - start_i.centre, end_j.centre - end_i.centre, start_i.part.b, start_j.part.b};
}

/// Whether a part of a pair is an ellipse.
bool has_ellipse(const GrainSystem& system, const Partners& of) {
  if (system.shapes.parts.empty()) return false;
  if (!system.shapes.parts[of.part_i].is_round()) return true;
  return of.j >= 0 && !system.shapes.parts[of.part_j].is_round();
}

/// How far a part turns in the step, rad; a disc about its centre does not.
double turn_of(const GrainSystem& system, std::int32_t body, std::int32_t part_index) {
  const GrainPart part = system.part(body, part_index);
  if (part.is_round() && part.offset == Vec2{}) return 0;
  return std::abs(system.bodies.next[body].angle - system.bodies.motions[body].angle);
}

/// How far points of the parts of a pair go against each other in the step, at most, m.
double reach_of_parts(const GrainSystem& system, const Partners& of) {
  const auto way_of = [&](std::int32_t body, std::int32_t part_index) {
    const GrainPart part = system.part(body, part_index);
    return turn_of(system, body, part_index) * (norm(part.offset) + part.a);
  };
  const PartWay way = way_of_parts(system, of);
  return norm(way.after - way.before) + way_of(of.i, of.part_i) + (of.j < 0 ? 0 : way_of(of.j, of.part_j));
}

/// The error of two ellipses in the step: one approaches with its centre in the other, the normal of an overlap
/// reverses, an overlap of more than half the smaller short half-axis occurs undetected between the two instants, or
/// one larger than that half-axis occurs without a contact before. \return nullptr: no error
const char* crossing_of_ellipses(const GrainSystem& system, const Partners& of) {
  const auto contact_at = [&](double share) {
    const Pose i = pose_at(system, {of.i}, of.part_i, share), j = pose_at(system, of.image(), of.part_j, share);
    return contact_of_ellipses(i.ellipse(), j.ellipse(), j.centre - i.centre);
  };
  const Pose i = pose_at(system, {of.i}, of.part_i, 1), j = pose_at(system, of.image(), of.part_j, 1);
  const Vec2 branch = j.centre - i.centre;
  const PartWay way = way_of_parts(system, of);
  const bool inside = holds(i.ellipse(), branch) || holds(j.ellipse(), branch);
  if (inside && norm(branch) < norm(way.before)) return "be pressed into";
  const EllipseContact before = contact_at(0), after = contact_at(1);
  if (before.gap < 0 && after.gap < 0 && dot(before.normal, after.normal) < 0) return "pass through";
  if (before.gap < 0) return nullptr;
  const double reach = reach_of_parts(system, of);
  const double small = std::min(i.part.b, j.part.b);
  if (std::min(before.gap, after.gap) > reach) return nullptr;
  const int samples = static_cast<int>(std::min(1000.0, std::ceil(8 * reach / small)));
  for (int k = 1; k < samples; ++k) {
    if (after.gap > 0 && -contact_at(static_cast<double>(k) / samples).gap > 0.5 * small) return "pass through";
  }
  return -after.gap > small ? "pass through" : nullptr;
}

/// Displacement over the smallest radius below which no body can cross another.
constexpr double slow_way = 0.1;

/// Angle of a part in a step beyond which its contacts would begin and end unseen, and one that resolves them, rad.
constexpr double quarter_turn = 0.5 * std::numbers::pi, small_turn = 0.1;

std::string name_of_other(const GrainSystem& system, const Partners& of) {
  if (of.j >= 0) return fmt::format("grain {}", system.bodies.grain_of[of.j]);
  const Wall& wall = system.scene.walls[~of.j];
  return wall.name.empty() ? fmt::format("wall {}", system.walls.wall_of[~of.j])
                           : fmt::format("wall \"{}\"", wall.name);
}

/// \param way of points of the two against each other, m
[[noreturn]] void refuse(const GrainSystem& system, const Partners& of, double way, double room,
                         const char* happening) {
  const auto i = static_cast<std::size_t>(of.i);
  computation_failed(
      fmt::format("step {}: grain {} would {} {}", system.step, system.bodies.grain_of[i], happening,
                  name_of_other(system, of)),
      fmt::format("they move {:.4g} m against each other in a step of {:.4g} s, {:.4g} times the radius of the grain",
                  way, system.dt(), way / system.bodies.constants[i].radius),
      way > room ? fmt::format("Use a step below {:.3g} s, or stiffer contacts if they are pressed through",
                               room / way * system.dt())
                 : "Use stiffer contacts, or press less: a shorter step would not hold them");
}

/// Refuses turns in which a part that is near another one, or a wall, would touch and leave it unseen.
/// \param apart distance of the centres of the bodies, or of the centre and the wall, at either end of the step, m
void check_turns(const GrainSystem& system, const Partners& of, double apart) {
  const double of_i = turn_of(system, of.i, of.part_i), of_j = of.j < 0 ? 0 : turn_of(system, of.j, of.part_j);
  const double turn = std::max(of_i, of_j);
  if (!(turn > quarter_turn)) return;
  const auto extent = [&](std::int32_t body, std::int32_t part_index) {
    const GrainPart part = system.part(body, part_index);
    return norm(part.offset) + part.a;
  };
  if (apart > extent(of.i, of.part_i) + (of.j < 0 ? 0 : extent(of.j, of.part_j))) return;
  Partners turning = of;
  if (of_j > of_i) std::swap(turning.i, turning.j);
  computation_failed(
      fmt::format("step {}: grain {} would turn past {}", system.step, system.bodies.grain_of[turning.i],
                  name_of_other(system, turning)),
      fmt::format("it turns by {:.4g} rad in a step of {:.4g} s: contacts begin and end within it", turn, system.dt()),
      fmt::format("Use a step below {:.3g} s", small_turn / turn * system.dt()));
}

void check_discs(const GrainSystem& system, const Partners& of, const PartWay& parts) {
  const auto [before, after, radius_i, radius_j] = parts;
  const Vec2 way = after - before;
  const double small = std::min(radius_i, radius_j);
  const double sum = radius_i + radius_j;
  const double length2 = dot(way, way);
  if (!(length2 > 0)) return;
  const double along = std::clamp(-dot(before, way) / length2, 0.0, 1.0);
  const double nearest = norm(before + along * way);
  // centres that come this near and change sides were pressed through each other
  if (nearest < 0.5 * sum && dot(before, after) < 0) {
    refuse(system, of, norm(way), 0.5 * small, "pass through");
  }
  // in short steps they would go round each other instead: no centre enters another body
  const double distance = norm(after);
  if (distance < sum - small && distance < norm(before)) {
    refuse(system, of, norm(way), 0.5 * small, "be pressed into");
  }
  const bool seen = norm(before) < sum || norm(after) < sum;
  if (!seen && nearest < sum - 0.5 * small) refuse(system, of, norm(way), 0.5 * small, "pass through");
}

void check_wall(const GrainSystem& system, const Partners& of) {
  const auto i = static_cast<std::size_t>(of.i);
  const auto w = static_cast<std::size_t>(~of.j);
  const WallPlace& place = system.walls.places[w];
  const auto [start, end, radius_i, radius_j] = way_of_parts(system, of);
  const Vec2 before = start - place.displacement;
  const Vec2 after = end - place.displacement - system.dt() * place.velocity;
  if (passes_through(system.scene.walls[w], before, after)) {
    refuse(system, of, norm(after - before), 0.5 * system.bodies.constants[i].radius, "pass through");
  }
  const auto distance = [&](const GrainMotion& motion, Vec2 moved) {
    return nearest(system.scene.walls[w], moved, motion.position).distance;
  };
  check_turns(system, of,
              std::min(distance(system.bodies.motions[i], place.displacement),
                       distance(system.bodies.next[i], place.displacement + system.dt() * place.velocity)));
}

void check_parts(const GrainSystem& system, const Partners& of) {
  if (!system.shapes.parts.empty()) {
    const Vec2 before = system.branch(of);
    const Vec2 after =
        system.bodies.next[of.j].position + system.cell.next.shift(of.image()) - system.bodies.next[of.i].position;
    check_turns(system, of, std::min(norm(before), norm(after)));
  }
  const PartWay way = way_of_parts(system, of);
  if (!has_ellipse(system, of)) {
    check_discs(system, of, way);
  } else if (const char* happening = crossing_of_ellipses(system, of)) {
    refuse(system, of, reach_of_parts(system, of), 0.5 * std::min(way.radius_i, way.radius_j), happening);
  }
}

}  // namespace

void refuse_runaway(const GrainSystem& system, double reach) {
  if (std::isfinite(reach)) return;
  computation_failed(fmt::format("step {}: a motion is not a number any more", system.step),
                     "forces or speeds have grown beyond all bounds", "Use a smaller step or softer contacts");
}

void refuse_long_ways_in_cell(const GrainSystem& system, double reach) {
  if (!system.cell.active || !(reach > system.smallest_radius)) return;
  computation_failed(
      fmt::format("step {}: bodies of the periodic cell would pass through one another", system.step),
      fmt::format("they may move {:.4g} m in a step of {:.4g} s, by themselves and with the cell, {:.4g} times the "
                  "smallest radius",
                  reach, system.dt(), reach / system.smallest_radius),
      fmt::format("Use a step below {:.3g} s, or deform the cell and move its bodies more slowly",
                  0.5 * system.dt() * system.smallest_radius / reach));
}

bool may_cross(const GrainSystem& system, double reach) {
  // two bodies come nearer by twice the reach at most
  return !(reach <= slow_way * system.smallest_radius && system.deepest + 2 * reach < system.smallest_radius);
}

void find_places_before(GrainSystem& system) {
  GrainBodies& bodies = system.bodies;
  bodies.motions.swap(bodies.next);
  bodies.moved = false;
  for (std::size_t i = 0; i < bodies.next.size(); ++i) {
    GrainMotion& before = bodies.motions[i] = bodies.next[i];
    before.position -= system.dt() * before.velocity;
    before.angle -= system.dt() * before.spin;
  }
}

void refuse_crossings(const GrainSystem& system) {
  const auto check = [&](const Partners& of) { of.j < 0 ? check_wall(system, of) : check_parts(system, of); };
  each_list(system.contacts, [&](const NearList& list) {
    for (std::size_t p = 0; p < list.count; ++p) check(partners_of(system, list, p));
  });
  for (const Candidate& candidate : system.contacts.candidates) check({candidate.i, candidate.j});
}

}  // namespace equidem
