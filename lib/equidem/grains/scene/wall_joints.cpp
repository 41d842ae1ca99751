// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/wall_joints.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/contact_geometry.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem {
namespace {

Vec2 end_of(const Wall& wall, int end) {
  return end == 1 ? wall.point : wall.end;
}

double length_of(const Wall& wall) {
  if (wall.shape == Wall::Shape::line) return std::numeric_limits<double>::infinity();
  return norm(wall.end - wall.point);
}

bool has_ends(const Wall& wall) {
  return wall.shape == Wall::Shape::segment;
}

/// Largest gap at which two walls join.
double gap_between(const Wall& a, const Wall& b, double tolerance) {
  return std::min(tolerance, joint_gap * std::min(length_of(a), length_of(b)));
}

/// The wall that covers a contact of grain i with an end of wall w; -1: none.
std::int32_t cover_of(const GrainSystem& system, std::int32_t i, std::int32_t part, std::int32_t w) {
  const WallJoints& joints = system.walls.joints[w];
  if (joints[0].empty() && joints[1].empty()) return -1;
  // The contacts of an ellipse with two walls are seen from two points.
  const bool round = system.shapes.parts.empty() || system.shapes.parts[part].is_round();
  struct Met {
    WallContact contact;
    Vec2 point;  // without displacement
  };
  const auto meet = [&](std::int32_t wall) {
    const auto k = static_cast<std::size_t>(wall);
    const Vec2 from = viewpoint_on(system, i, part, wall), displacement = system.walls.places[k].displacement;
    const WallContact contact = nearest(system.scene.walls[k], displacement, from);
    return Met{contact, from - displacement - contact.distance * contact.normal};
  };
  const auto is_at = [&](const Met& met, std::int32_t wall, int end, double reach) {
    if (met.contact.end == end) return true;
    return round && norm(met.point - end_of(system.scene.walls[wall], end)) <= reach;
  };
  const Met own = meet(w);
  for (const int end : {1, 2}) {
    for (const WallJoint& joint : joints[end - 1]) {
      const bool at_end = own.contact.end == end;
      if (joint.end == 0 && at_end) return joint.wall;
      if (joint.end == 0 || !is_at(own, w, end, joint.reach)) continue;
      const Met other = meet(joint.wall);
      const double nearer = round ? own.contact.distance - other.contact.distance : 0;
      // Where the other wall is not met in the same point it is met in a nearer one.
      const bool covers =
          is_at(other, joint.wall, joint.end, joint.reach) ? nearer > 0 || (nearer == 0 && joint.wall < w) : at_end;
      if (covers) return joint.wall;
    }
  }
  return -1;
}

bool move_alike(const Wall& a, const Wall& b) {
  return a.move_x == b.move_x && a.move_y == b.move_y && !a.servo && !b.servo;
}

void put_end(Wall& wall, int end, Vec2 point) {
  (end == 1 ? wall.point : wall.end) = point;
}

}  // namespace

std::optional<std::pair<std::size_t, std::size_t>> coinciding_walls(std::span<const Wall> walls, double tolerance) {
  using enum Wall::Shape;
  const auto is_on = [&](const Vec2& point, const Wall& wall) {
    return std::abs(nearest(wall, {}, point).distance) <= tolerance;
  };
  const auto lies_on = [&](const Wall& a, const Wall& b) {
    if (a.shape == line) return b.shape == line && is_on(a.point, b) && norm(a.normal - b.normal) <= 1e-9;
    const bool first = is_on(a.point, b), second = is_on(a.end, b);
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

std::vector<Wall> joined_walls(std::span<const Wall> given, double tolerance) {
  constexpr double rounding = 1e-4;  // of the tolerance
  std::vector<Wall> walls(given.begin(), given.end());
  struct End {
    std::size_t wall = 0;
    int number = 0;
    bool placed = false;
  };
  std::vector<End> ends;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    if (has_ends(walls[w])) ends.insert(ends.end(), {{w, 1}, {w, 2}});
  }
  for (std::size_t e = 0; e < ends.size(); ++e) {
    if (ends[e].placed) continue;
    const Wall& wall = given[ends[e].wall];
    const Vec2 point = end_of(wall, ends[e].number);
    std::vector<End*> meeting;
    Vec2 sum;
    double widest = 0;
    for (std::size_t f = e; f < ends.size(); ++f) {
      const Wall& other = given[ends[f].wall];
      const Vec2 at = end_of(other, ends[f].number);
      const double gap = norm(at - point);
      const bool meets = f == e || (gap <= tolerance && ends[f].wall != ends[e].wall && !ends[f].placed &&
                                    move_alike(wall, other) && gap <= gap_between(wall, other, tolerance));
      if (!meets) continue;
      meeting.push_back(&ends[f]);
      sum += at;
      widest = std::max(widest, gap);
    }
    if (meeting.size() == 1) continue;
    const Vec2 common = sum / static_cast<double>(meeting.size());
    for (End* end : meeting) {
      end->placed = true;
      if (widest > rounding * tolerance) put_end(walls[end->wall], end->number, common);
    }
  }
  for (const End& end : ends) {
    Wall& wall = walls[end.wall];
    for (std::size_t k = 0; k < walls.size() && !end.placed; ++k) {
      const Vec2 point = end_of(wall, end.number);
      const WallContact foot = nearest(walls[k], {}, point);
      const double gap = std::abs(foot.distance);
      if (k == end.wall || gap > tolerance || !move_alike(wall, walls[k])) continue;
      if (gap > gap_between(wall, walls[k], tolerance)) continue;
      if (gap > rounding * tolerance) put_end(wall, end.number, point - foot.distance * foot.normal);
      break;
    }
  }
  return walls;
}

std::vector<WallJoints> joints_of(std::span<const Wall> walls, double tolerance) {
  std::vector<WallJoints> all(walls.size());
  bool any = false;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    if (!has_ends(walls[w])) continue;
    for (const int end : {1, 2}) {
      const Vec2 point = end_of(walls[w], end);
      for (std::size_t k = 0; k < walls.size(); ++k) {
        const double gap = std::abs(nearest(walls[k], {}, point).distance);
        if (k == w || !(gap <= tolerance) || !move_alike(walls[k], walls[w])) continue;
        WallJoint joint{static_cast<std::int32_t>(k), 0, gap_between(walls[w], walls[k], tolerance)};
        if (gap > joint.reach) continue;
        if (has_ends(walls[k])) {
          for (const int other : {1, 2})
            if (norm(end_of(walls[k], other) - point) <= joint.reach) joint.end = other;
        }
        all[w][end - 1].push_back(joint);
        any = true;
      }
    }
  }
  if (!any) all.clear();
  return all;
}

std::vector<std::string> gaps_of_walls(std::span<const Wall> given, double smallest_radius) {
  constexpr double widest = 0.2;
  const std::vector<Wall> walls = joined_walls(given, joint_gap * smallest_radius);
  const std::vector<WallJoints> joints = joints_of(walls, joint_gap * smallest_radius);
  const auto is_free = [&](std::size_t w, int end) {
    return has_ends(walls[w]) && (joints.empty() || joints[w][end - 1].empty());
  };
  std::vector<std::string> sentences;
  const auto compare = [&](std::size_t w, int end, std::size_t k, int other) {
    if (!is_free(w, end) || !is_free(k, other)) return;
    const double gap = norm(end_of(walls[w], end) - end_of(walls[k], other));
    if (gap > widest * smallest_radius || !move_alike(walls[w], walls[k])) return;
    sentences.push_back(fmt::format(
        "walls \"{}\" and \"{}\" end {:.3g} m apart, {:.2g} of the smallest radius: a body over this gap is pushed by "
        "both; let them end in one point, or farther apart",
        walls[w].name, walls[k].name, gap, gap / smallest_radius));
  };
  for (std::size_t w = 0; w < walls.size(); ++w)
    for (std::size_t k = w + 1; k < walls.size(); ++k)
      for (const int end : {1, 2})
        for (const int other : {1, 2}) compare(w, end, k, other);
  return sentences;
}

namespace {

/// Those of a map or a simultaneous law: contacts with walls stand behind the pairs of a body.
void cover_single_contacts(GrainSystem& system) {
  std::vector<Candidate>& candidates = system.contacts.candidates;
  for (Candidate& candidate : candidates) {
    if (candidate.j >= 0) continue;
    const std::int32_t cover = cover_of(system, candidate.i, 0, ~candidate.j);
    candidate.covered = cover >= 0;
    if (!candidate.covered || !candidate.touching) continue;
    const Candidate left = candidate;
    candidate.stretch = 0;  // not lost
    forget_contact(candidate, system.lost);
    const auto is_cover = [&](const Candidate& other) { return other.i == left.i && other.j == ~cover; };
    const auto other = std::ranges::find_if(candidates, is_cover);
    if (other == candidates.end() || other->touching) continue;
    const Candidate place = *other;
    *other = left;
    static_cast<ContactConstants&>(*other) = place;
    other->j = place.j;
    other->covered = place.covered;
  }
}

/// The contact of the part of another one with a wall; list.count: there is none.
std::size_t place_of_wall(const NearList& list, std::size_t p, std::int32_t wall) {
  const std::int32_t own = list.first(p);
  while (p > 0 && list.first(p - 1) == own) --p;
  while (p < list.count && list.first(p) == own && list.second(p) != wall) ++p;
  return p < list.count && list.first(p) == own ? p : list.count;
}

}  // namespace

void cover_joints(GrainSystem& system) {
  if (system.walls.joints.empty()) return;
  cover_single_contacts(system);
  for (NearList& list : system.contacts.of(Between::walls).blocks) {
    for (std::size_t p = 0; p < list.count; ++p) {
      const Partners of = partners_of(system, list, p);
      const std::int32_t cover = cover_of(system, of.i, of.part_i, ~of.j);
      list.shapes[p / lanes_of_pairs].covered[p % lanes_of_pairs] = cover >= 0 ? 1 : 0;
      if (cover < 0 || !list.touching(p)) continue;
      const std::size_t other = place_of_wall(list, p, cover);
      if (other < list.count && !list.touching(other)) set_state(system, list, other, state_of(system, list, p));
      list.end(p);
    }
  }
}

}  // namespace equidem
