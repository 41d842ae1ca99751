// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/wall_joints.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "equidem/grains/contacts/part_geometry.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem {
namespace {

Vec2 end_of(const Wall& wall, int end) {
  if (wall.shape == Wall::Shape::segment) return end == 1 ? wall.point : wall.end;
  const double angle = end == 1 ? wall.from : wall.to;
  return wall.point + wall.radius * Vec2{std::cos(angle), std::sin(angle)};
}

/// The wall that covers a contact of grain i with an end of wall w; -1: none.
std::int32_t cover_of(const GrainSystem& system, std::int32_t i, std::int32_t part, std::int32_t w) {
  const WallJoints& joints = system.walls.joints[static_cast<std::size_t>(w)];
  if (joints[0].empty() && joints[1].empty()) return -1;
  const auto nearest_to = [&](std::int32_t wall) {
    const auto k = static_cast<std::size_t>(wall);
    return nearest(system.scene.walls[k], system.walls.places[k].displacement, viewpoint_on(system, i, part, wall));
  };
  const int end = nearest_to(w).end;
  if (end == 0) return -1;
  for (const WallJoint& joint : joints[static_cast<std::size_t>(end - 1)]) {
    // Where the other wall is not met in the same point it is met in a nearer one.
    if (joint.end == 0 || nearest_to(joint.wall).end != joint.end || joint.wall < w) return joint.wall;
  }
  return -1;
}

bool move_alike(const Wall& a, const Wall& b) {
  return a.move_x == b.move_x && a.move_y == b.move_y;
}

/// Transfer of the state of a contact to another one at the same point.
void go_on(const Candidate& left, Candidate& contact) {
  contact.touching = true;
  contact.parted = left.parted;
  contact.mode = left.mode;
  contact.steps = left.steps;
  contact.overlap = left.overlap;
  contact.closing = left.closing;
  contact.normal = left.normal;
  contact.impulse = left.impulse;
  contact.moment = left.moment;
  contact.tangential_impulse = left.tangential_impulse;
  contact.stretch = left.stretch;
}

}  // namespace

std::optional<std::pair<std::size_t, std::size_t>> coinciding_walls(std::span<const Wall> walls, double tolerance) {
  using enum Wall::Shape;
  const auto is_on = [&](const Vec2& point, const Wall& wall) {
    return std::abs(nearest(wall, {}, point).distance) <= tolerance;
  };
  const auto lies_on = [&](const Wall& a, const Wall& b) {
    if (a.shape == line) return b.shape == line && is_on(a.point, b) && norm(a.normal - b.normal) <= 1e-9;
    if (a.shape == arc)
      return b.shape == arc && a.point == b.point && a.radius == b.radius && a.from == b.from && a.to == b.to;
    const bool first = is_on(a.point, b), second = is_on(a.end, b);
    if (b.shape == arc) return false;  // a chord
    if (first && second) return true;
    if (b.shape == line || first == second) return false;
    // one end of a is on b: check whether they continue in the same direction
    const Vec2& common = first ? a.point : a.end;
    const Vec2 way = (first ? a.end : a.point) - common;
    const double apart = tolerance * (norm(way) + norm(b.end - b.point));
    const auto goes_back = [&](const Vec2& end) {
      const Vec2 rest = end - common;
      return norm(rest) > tolerance && std::abs(cross(way, rest)) <= apart && dot(way, rest) > 0;
    };
    return goes_back(b.point) || goes_back(b.end);
  };
  for (std::size_t k = 0; k < walls.size(); ++k) {
    for (std::size_t w = k + 1; w < walls.size(); ++w) {
      if (!move_alike(walls[k], walls[w])) continue;
      if (lies_on(walls[k], walls[w]) || lies_on(walls[w], walls[k])) return std::pair(k, w);
    }
  }
  return {};
}

std::vector<WallJoints> joints_of(std::span<const Wall> walls, double tolerance) {
  std::vector<WallJoints> all(walls.size());
  bool any = false;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    if (walls[w].shape == Wall::Shape::line) continue;
    for (const int end : {1, 2}) {
      const Vec2 point = end_of(walls[w], end);
      for (std::size_t k = 0; k < walls.size(); ++k) {
        if (k == w || !move_alike(walls[k], walls[w])) continue;
        if (!(std::abs(nearest(walls[k], {}, point).distance) <= tolerance)) continue;
        WallJoint joint{static_cast<std::int32_t>(k), 0};
        if (walls[k].shape != Wall::Shape::line) {
          for (const int other : {1, 2})
            if (norm(end_of(walls[k], other) - point) <= tolerance) joint.end = other;
        }
        all[w][static_cast<std::size_t>(end - 1)].push_back(joint);
        any = true;
      }
    }
  }
  if (!any) all.clear();
  return all;
}

void cover_joints(GrainSystem& system) {
  if (system.walls.joints.empty()) return;
  for (auto candidate = system.contacts.candidates.begin(); candidate != system.contacts.candidates.end();
       ++candidate) {
    if (candidate->j >= 0) continue;
    const auto part_of = [&](const Candidate& other) {
      if (system.contacts.part_pairs.empty()) return 0;
      return system.contacts.part_pairs[static_cast<std::size_t>(&other - system.contacts.candidates.data())].i;
    };
    const std::int32_t cover = cover_of(system, candidate->i, part_of(*candidate), ~candidate->j);
    candidate->covered = cover >= 0;
    if (!candidate->covered || !candidate->touching) continue;
    const Candidate left = *candidate;
    candidate->stretch = 0;  // not lost
    forget_contact(*candidate, system.lost);
    const auto same_body = [&](const Candidate& other) { return other.i == candidate->i; };
    auto other = candidate;  // candidates of a body stand together
    while (other != system.contacts.candidates.begin() && same_body(*std::prev(other))) --other;
    const auto is_cover = [&] { return other->j == ~cover && part_of(*other) == part_of(*candidate); };
    while (other != system.contacts.candidates.end() && same_body(*other) && !is_cover()) ++other;
    if (other == system.contacts.candidates.end() || !same_body(*other) || other->touching) continue;
    go_on(left, *other);
  }
}

}  // namespace equidem
