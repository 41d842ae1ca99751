// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/contacts/part_crossing.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/contact/shapes/ellipse_contact.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/scene/grain_parts.hpp"

namespace equidem {
namespace {

/// Within a step, `share` of it gone: ways and turns are uniform. \param body or an image
GrainMotion motion_at(const GrainSystem& system, std::int32_t body, double share) {
  const auto own = static_cast<std::size_t>(system.body_of(body));
  GrainMotion motion = system.bodies.motions[own];
  const Vec2 from = system.position_of(body);
  motion.position = from + share * (system.next_position_of(body) - from);
  motion.angle += share * (system.bodies.next[own].angle - motion.angle);
  return motion;
}

struct Pose {
  GrainPart part;
  Vec2 centre, axis;
  [[nodiscard]] Ellipse ellipse() const { return {part.a, part.b, axis}; }
};

Pose pose_at(const GrainSystem& system, std::int32_t body, std::int32_t part_index, double share) {
  const GrainMotion motion = motion_at(system, body, share);
  if (system.shapes.parts.empty()) {
    const double radius = system.bodies.constants[static_cast<std::size_t>(system.body_of(body))].radius;
    return {{{}, radius, radius, radius}, motion.position, {1, 0}};
  }
  const GrainPart& part = system.shapes.parts[static_cast<std::size_t>(part_index)];
  const Vec2 axis = axis_at(motion.angle);
  return {part, motion.position + offset_of(part, axis), axis};
}

}  // namespace

PartWay way_of_parts(const GrainSystem& system, const Candidate& candidate, const PartPair& parts) {
  const Pose start_i = pose_at(system, candidate.i, parts.i, 0), end_i = pose_at(system, candidate.i, parts.i, 1);
  if (candidate.j < 0) return {start_i.centre, end_i.centre, start_i.part.b, 0};
  const Pose start_j = pose_at(system, candidate.j, parts.j, 0), end_j = pose_at(system, candidate.j, parts.j, 1);
  return {start_j.centre - start_i.centre, end_j.centre - end_i.centre, start_i.part.b, start_j.part.b};
}

bool has_ellipse(const GrainSystem& system, const Candidate& candidate, const PartPair& parts) {
  if (system.shapes.parts.empty()) return false;
  if (!system.shapes.parts[static_cast<std::size_t>(parts.i)].is_round()) return true;
  return candidate.j >= 0 && !system.shapes.parts[static_cast<std::size_t>(parts.j)].is_round();
}

const char* crossing_of_ellipses(const GrainSystem& system, const Candidate& candidate, const PartPair& parts) {
  const auto contact_at = [&](double share) {
    const Pose i = pose_at(system, candidate.i, parts.i, share), j = pose_at(system, candidate.j, parts.j, share);
    return contact_of_ellipses(i.ellipse(), j.ellipse(), j.centre - i.centre);
  };
  const Pose i = pose_at(system, candidate.i, parts.i, 1), j = pose_at(system, candidate.j, parts.j, 1);
  const Vec2 branch = j.centre - i.centre;
  const PartWay way = way_of_parts(system, candidate, parts);
  const bool inside = holds(i.part, i.axis, branch) || holds(j.part, j.axis, branch);
  if (inside && norm(branch) < norm(way.before)) return "be pressed into";
  const EllipseContact before = contact_at(0), after = contact_at(1);
  if (before.gap < 0 && after.gap < 0 && dot(before.normal, after.normal) < 0) return "pass through";
  if (before.gap < 0) return nullptr;
  // how far a point of one goes against the other, at most
  const auto turn = [&](std::int32_t body, const GrainPart& part) {
    const auto b = static_cast<std::size_t>(system.body_of(body));
    return std::abs(system.bodies.next[b].angle - system.bodies.motions[b].angle) * part.a;
  };
  const double reach = norm(way.after - way.before) + turn(candidate.i, i.part) + turn(candidate.j, j.part);
  const double small = std::min(i.part.b, j.part.b);
  if (std::min(before.gap, after.gap) > reach) return nullptr;
  const int samples = static_cast<int>(std::min(1000.0, std::ceil(8 * reach / small)));
  for (int k = 1; k < samples; ++k) {
    if (after.gap > 0 && -contact_at(static_cast<double>(k) / samples).gap > 0.5 * small) return "pass through";
  }
  return -after.gap > small ? "pass through" : nullptr;
}

}  // namespace equidem
