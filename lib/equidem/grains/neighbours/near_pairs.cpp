// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/neighbours/near_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/geometry/shape_contact.hpp"
#include "equidem/grains/contacts/block_step.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem {
namespace {

/// Margin of the pairs: of the smallest body; and a multiple of the mean of that and the way in a step, where pairs too
/// many cost as much as lists found anew.
constexpr double least_margin = 0.02, margin_of_mean = 2.5;

/// The margin for bodies of a size (discs: the radius) that move by about `reach` in a step.
double margin_of(const GrainSystem& system, double size, double reach) {
  const double wanted = std::max({least_margin * size, margin_of_mean * std::sqrt(reach * size), 4 * reach});
  return std::min(wanted, system.contacts.skin.margin);
}

/// Whether a body of a periodic cell is bonded to that image of another one.
bool is_bonded_image(const GrainSystem& system, std::int32_t i, const PeriodicImage& j) {
  const auto bond = place_of_bond(system.bonds.tied, i, j.body);
  if (bond == system.bonds.tied.end() || bond->i != i || bond->j != j.body || bond->broken) return false;
  return bond->image.a == j.a && bond->image.b == j.b;
}

/// The neighbours of a body that are nearer than the margin of the pairs; without a branch for each, since which ones
/// are cannot be predicted.
/// \param[out] near their places in the list of neighbours; at least as long as that of the body
/// \return their number
std::size_t find_near_of(const GrainSystem& system, std::size_t i, std::vector<std::int64_t>& near) {
  const NeighbourList& list = *system.contacts.neighbours;
  const GrainBody* constants = system.bodies.constants.data();
  const GrainMotion* motions = system.bodies.motions.data();
  const std::int32_t* partner = list.partner.data();
  const PeriodicImage* images = system.cell.active ? system.contacts.images.data() : nullptr;
  const Vec2 centre = motions[i].position;
  const double own = constants[i].radius + system.contacts.pairs.skin.margin + system.range;
  const std::int64_t end = list.begin[i + 1];
  std::size_t count = 0;
  for (std::int64_t p = list.begin[i]; p < end; ++p) {
    const std::int32_t j = images == nullptr ? partner[p] : images[p].body;
    Vec2 branch = motions[j].position - centre;
    if (images != nullptr) branch += system.cell.now.shift(images[p]);
    const double far = own + constants[j].radius;
    near[count] = p;
    count += dot(branch, branch) <= far * far ? 1 : 0;
  }
  return count;
}

void find_pairs_of_block(GrainSystem& system, std::size_t b) {
  const NeighbourList& list = *system.contacts.neighbours;
  const std::size_t begin = system.bodies.blocks.begin(b), end = system.bodies.blocks.end(b);
  NewList pairs(system, system.contacts.of(Between::discs).blocks[b], b);
  const bool shapes = !system.shapes.parts.empty(), cell = system.cell.active;
  const bool touch = system.bonds.beside_contact;
  std::size_t next_bond = first_bond_from(system.bonds.tied, static_cast<std::int32_t>(begin));
  std::vector<std::int64_t> near;
  for (std::size_t i = begin; i < end; ++i) {
    const auto listed = static_cast<std::size_t>(list.begin[i + 1] - list.begin[i]);
    if (near.size() < listed) near.resize(2 * listed);
    const std::size_t count = find_near_of(system, i, near);
    const auto first = static_cast<std::int32_t>(i);
    for (std::size_t k = 0; k < count; ++k) {
      const PeriodicImage j = system.contacts.neighbour(near[k]);
      const bool bonded =
          !touch && (cell ? is_bonded_image(system, first, j) : are_tied(system.bonds.tied, next_bond, first, j.body));
      if (bonded) continue;
      if (!shapes || are_discs(system, first, j.body)) pairs.take({first, j});
    }
  }
  pairs.keep_others();
}

void find_near_pairs(GrainSystem& system, double reach) {
  system.contacts.pairs.skin = {margin_of(system, system.smallest_radius, reach), 0};
  system.bodies.blocks.each([&](std::size_t block) { find_pairs_of_block(system, block); });
  connect_blocks(system);
}

/// A direction along which ellipses are apart by some distance, m.
struct Apart {
  double gap = -std::numeric_limits<double>::infinity();
  Vec2 normal = {};
};

/// The axis of either part, towards j, with the largest gap of their bounding boxes.
Apart apart_along_axes(const Ellipse& i, const Ellipse& j, Vec2 branch) {
  Apart best;
  const double c = dot(i.axis, j.axis), s = cross(i.axis, j.axis);
  const double cc = c * c, ss = s * s;
  const auto look = [&](double way, Vec2 axis, double own, double a, double b, double along, double across) {
    const double gap = std::abs(way) - own - std::sqrt(a * a * along + b * b * across);
    if (gap > best.gap) best = {gap, way < 0 ? -axis : axis};
  };
  look(cross(i.axis, branch), perpendicular(i.axis), i.b, j.a, j.b, ss, cc);
  look(cross(j.axis, branch), perpendicular(j.axis), j.b, i.a, i.b, ss, cc);
  look(dot(i.axis, branch), i.axis, i.a, j.a, j.b, cc, ss);
  look(dot(j.axis, branch), j.axis, j.a, i.a, i.b, cc, ss);
  return best;
}

/// Gap of two parts, or a sufficient lower bound of it; negative: overlap.
/// \param[in,out] apart a direction along which they were apart, or {}
double gap_of(const GrainSystem& system, const PairKey& pair, double enough, Vec2& apart) {
  const GrainPart &part_i = system.shapes.parts[pair.i], &part_j = system.shapes.parts[pair.j.body];
  const auto i = static_cast<std::size_t>(system.shapes.body_of_part[pair.i]);
  const auto j = static_cast<std::size_t>(system.shapes.body_of_part[pair.j.body]);
  const Vec2 branch = system.bodies.motions[j].position - system.bodies.motions[i].position +
                      system.cell.now.shift(pair.j) +
                      (offset_of(part_j, system.shapes.axes[j]) - offset_of(part_i, system.shapes.axes[i]));
  if (part_i.is_round() && part_j.is_round()) return norm(branch) - (part_i.a + part_j.a);
  const Ellipse of_i{part_i.a, part_i.b, system.shapes.axes[i]}, of_j{part_j.a, part_j.b, system.shapes.axes[j]};
  if (apart != Vec2{}) {
    const double along = separation_along(of_i, of_j, branch, apart);
    if (along > enough) return along;
  }
  const Apart boxes = apart_along_axes(of_i, of_j, branch);
  if (boxes.gap > enough) {
    apart = boxes.normal;
    return boxes.gap;
  }
  const EllipseContact contact = contact_of_ellipses(of_i, of_j, branch, apart != Vec2{} ? apart : boxes.normal);
  apart = contact.normal;
  return contact.gap;
}

void find_met_parts(GrainSystem& system) {
  std::vector<char>& met = system.contacts.parts.met;
  std::ranges::fill(met, char{0});
  each_list(system.contacts, [&](const NearList& list) {
    for (std::size_t p = 0; p < list.count && list.between != Between::discs; ++p) {
      const Partners of = partners_of(system, list, p);
      met[of.part_i] = 1;
      if (of.j >= 0) met[of.part_j] = 1;
    }
  });
}

/// All but pairs of whole discs.
void find_close_parts(const GrainSystem& system, std::size_t block, std::vector<NearParts::Close>& close) {
  const NeighbourList& neighbours = *system.contacts.neighbours;
  const double farthest = system.contacts.skin.margin + system.range;
  close.clear();
  for (std::size_t i = system.bodies.blocks.begin(block); i < system.bodies.blocks.end(block); ++i) {
    const auto body = static_cast<std::int32_t>(i);
    const bool disc = are_discs(system, body, body);
    for (std::int32_t p = system.shapes.first_part[i]; p < system.shapes.first_part[i + 1]; ++p) {
      for (std::int64_t n = neighbours.begin[i]; n < neighbours.begin[i + 1]; ++n) {
        const PeriodicImage j = system.contacts.neighbour(n);
        if (disc && are_discs(system, body, j.body)) continue;
        for (std::int32_t q = system.shapes.first_part[j.body]; q < system.shapes.first_part[j.body + 1]; ++q) {
          NearParts::Close pair{{p, {q, j.b, j.a}}, 0, {}};
          pair.clear = gap_of(system, pair.pair, farthest, pair.apart);
          if (pair.clear <= farthest) close.push_back(pair);
        }
      }
    }
  }
  if (system.cell.active) std::ranges::sort(close, {}, &NearParts::Close::pair);
}

/// Those of the close parts of a block that are nearer than the margin.
void find_nearest_parts(GrainSystem& system, std::size_t b) {
  NearParts& near = system.contacts.parts;
  const double farthest = near.skin.margin + system.range;
  NewList round(system, system.contacts.of(Between::round_parts).blocks[b], b);
  NewList ellipses(system, system.contacts.of(Between::ellipses).blocks[b], b);
  for (NearParts::Close& pair : near.close[b]) {
    if (pair.clear - 2 * near.travelled > farthest) continue;
    NewList& list = between_parts(system, pair.pair.i, pair.pair.j.body) == Between::ellipses ? ellipses : round;
    if (list.keep_contact(pair.pair)) continue;
    if (const Vec2 apart = list.normal_before(); apart != Vec2{}) pair.apart = apart;
    const double gap = gap_of(system, pair.pair, farthest, pair.apart);
    pair.clear = gap + 2 * near.travelled;
    list.leave(pair.pair, gap <= farthest, pair.apart);
  }
  round.keep_others();
  ellipses.keep_others();
}

void find_nearest_parts(GrainSystem& system, double reach) {
  NearParts& near = system.contacts.parts;
  near.travelled += near.skin.moved;
  near.skin = {margin_of(system, near.size, reach), 0};
  system.bodies.blocks.each([&](std::size_t block) { find_nearest_parts(system, block); });
  find_met_parts(system);
  connect_blocks(system);
}

/// Whether a part comes nearer to a wall than the margin; ellipses at a segment by their bounding circle.
bool is_near_wall(const GrainSystem& system, std::size_t body, const GrainPart& part, std::size_t w) {
  const Vec2 axis = system.shapes.axes[body];
  const Wall& wall = system.scene.walls[w];
  const WallContact contact =
      nearest(wall, system.walls.places[w].displacement, system.bodies.motions[body].position + offset_of(part, axis));
  const double reach = wall.shape == Wall::Shape::line ? support({part.a, part.b, axis}, contact.normal).reach : part.a;
  return contact.distance <= reach + system.contacts.skin.margin + system.range;
}

void find_walls_of_block(GrainSystem& system, std::size_t block) {
  NewList walls(system, system.contacts.of(Between::walls).blocks[block], block);
  const auto see = [&](std::int32_t i, std::size_t w) { walls.take({i, {static_cast<std::int32_t>(w)}}); };
  const std::size_t count = system.scene.walls.size();
  const double farthest = system.contacts.skin.margin + system.range;
  std::vector<char> near(count);
  for (std::size_t i = system.bodies.blocks.begin(block); i < system.bodies.blocks.end(block); ++i) {
    for (std::size_t w = 0; w < count; ++w) {
      const WallContact contact =
          nearest(system.scene.walls[w], system.walls.places[w].displacement, system.bodies.motions[i].position);
      near[w] = contact.distance <= system.bodies.constants[i].radius + farthest ? 1 : 0;
      if (near[w] != 0 && system.shapes.parts.empty()) see(static_cast<std::int32_t>(i), w);
    }
    for (std::int32_t p = system.shapes.parts.empty() ? 0 : system.shapes.first_part[i];
         !system.shapes.parts.empty() && p < system.shapes.first_part[i + 1]; ++p) {
      for (std::size_t w = 0; w < count; ++w)
        if (near[w] != 0 && is_near_wall(system, i, system.shapes.parts[p], w)) see(p, w);
    }
  }
  walls.keep_others();
}

}  // namespace

void place_parts(GrainSystem& system) {
  if (!has_shapes(system.scene)) return;
  for (const std::size_t number : system.bodies.grain_of) {
    const Grain& grain = system.scene.grains[number];
    system.shapes.first_part.push_back(static_cast<std::int32_t>(system.shapes.parts.size()));
    const std::vector<GrainPart> parts = parts_of(grain, system.scene.clumps);
    const auto body = static_cast<std::int32_t>(system.shapes.first_part.size() - 1);
    system.shapes.parts.insert(system.shapes.parts.end(), parts.begin(), parts.end());
    system.shapes.body_of_part.insert(system.shapes.body_of_part.end(), parts.size(), body);
    if (grain.shape() != GrainShape::disc) system.shapes.shaped.push_back(body);
  }
  system.shapes.first_part.push_back(static_cast<std::int32_t>(system.shapes.parts.size()));
  system.shapes.axes.resize(system.bodies.motions.size(), {1, 0});
  turn_axes(system);
}

double longest_turn(const GrainSystem& system) {
  const std::vector<std::int32_t>& shaped = system.shapes.shaped;
  std::vector<double> ways(system.bodies.blocks.count());
  system.bodies.blocks.each_piece(shaped.size(), [&](std::size_t begin, std::size_t end) {
    double longest = 0;
    for (std::size_t k = begin; k < end && longest == longest; ++k) {
      const auto i = static_cast<std::size_t>(shaped[k]);
      const double way =
          std::abs(system.bodies.next[i].angle - system.bodies.motions[i].angle) * system.bodies.constants[i].radius;
      if (way > longest || way != way) longest = way;
    }
    ways[system.bodies.blocks.of(begin)] = longest;
  });
  double longest = 0;
  for (const double way : ways) {
    if (way > longest || way != way) longest = way;
    if (way != way) break;
  }
  return longest;
}

bool are_discs(const GrainSystem& system, std::int32_t i, std::int32_t j) {
  return system.grain(i).shape() == GrainShape::disc && system.grain(j).shape() == GrainShape::disc;
}

Between between_parts(const GrainSystem& system, std::int32_t p, std::int32_t q) {
  const bool round = system.shapes.parts[p].is_round() && system.shapes.parts[q].is_round();
  return round ? Between::round_parts : Between::ellipses;
}

std::size_t NearParts::bytes() const {
  std::size_t sum = bodies.capacity() * sizeof(PartBody) + met.capacity();
  for (const std::vector<Close>& pairs : close) sum += pairs.capacity() * sizeof(Close);
  return sum;
}

void prepare_bodies(GrainSystem& system) {
  ContactList& contacts = system.contacts;
  if (contacts.has(Between::discs)) {
    contacts.pairs.bodies.resize(system.bodies.constants.size());
    load_pair_bodies(system);
  }
  if (!contacts.has(Between::ellipses)) return;
  contacts.parts.close.resize(system.bodies.blocks.count());
  contacts.parts.bodies.resize(system.shapes.parts.size());
  contacts.parts.met.resize(system.shapes.parts.size());
  contacts.parts.size = std::ranges::min(system.shapes.parts, {}, &GrainPart::size).size;
}

void find_near_lists(GrainSystem& system) {
  const BodyBlocks& blocks = system.bodies.blocks;
  NearParts& parts = system.contacts.parts;
  if (system.contacts.has(Between::walls)) blocks.each([&](std::size_t block) { find_walls_of_block(system, block); });
  if (system.contacts.has(Between::discs)) find_near_pairs(system, std::sqrt(system.longest_way));
  if (!system.contacts.has(Between::ellipses)) return;
  parts.travelled = parts.skin.moved = 0;
  blocks.each([&](std::size_t block) { find_close_parts(system, block, parts.close[block]); });
  find_nearest_parts(system, reach_of(system));
}

void refresh_near_lists(GrainSystem& system, double reach) {
  const auto refresh = [&](Between between, Skin& skin, const auto& find) {
    if (!system.contacts.has(between)) return;
    if (!skin.holds(reach)) find(system, reach);
    skin.moved += reach;
  };
  refresh(Between::discs, system.contacts.pairs.skin, find_near_pairs);
  refresh(Between::ellipses, system.contacts.parts.skin,
          [](GrainSystem& of, double way) { find_nearest_parts(of, way); });
}

void find_near_pairs_of(GrainSystem& system, std::vector<std::size_t> blocks) {
  std::ranges::sort(blocks);
  const auto twice = std::ranges::unique(blocks);
  blocks.erase(twice.begin(), twice.end());
  for (const std::size_t block : blocks) find_pairs_of_block(system, block);
  connect_blocks(system);
}

void load_pair_bodies(GrainSystem& system) {
  for (std::size_t i = 0; i < system.bodies.constants.size(); ++i) {
    const GrainBody& body = system.bodies.constants[i];
    const GrainMotion& motion = system.bodies.motions[i];
    const BodyImpulse& push = system.bodies.impulses[i];
    system.contacts.pairs.bodies[i] =
        pair_body(body, motion, body.inverse_mass * push.impulse, body.inverse_moment * push.torque);
  }
}

void load_part_bodies(GrainSystem& system) {
  NearParts& near = system.contacts.parts;
  system.bodies.blocks.each_piece(system.bodies.motions.size(), [&](std::size_t begin, std::size_t end_body) {
    for (std::size_t b = begin; b < end_body; ++b) {
      const GrainMotion& motion = system.bodies.motions[b];
      const GrainBody& body = system.bodies.constants[b];
      const BodyImpulse& push = system.bodies.impulses[b];
      const auto end_part = static_cast<std::size_t>(system.shapes.first_part[b + 1]);
      for (auto k = static_cast<std::size_t>(system.shapes.first_part[b]); k < end_part; ++k) {
        if (near.met[k] == 0) continue;
        const GrainPart& part = system.shapes.parts[k];
        PartBody& seen = near.bodies[k];
        seen.turned = part.is_round() ? offset_of(part, system.shapes.axes[b]) : system.shapes.axes[b];
        seen.centre = part.is_round() ? motion.position + seen.turned : motion.position;
        seen.velocity = motion.velocity;
        if (system.cell.deforms)  // as in the drift before
          seen.velocity += system.cell.gradient * (system.bodies.next[b].position - system.cell.centre);
        seen.middle_velocity = seen.velocity + (0.5 * body.inverse_mass) * push.impulse;
        seen.spin = motion.spin;
        seen.middle_spin = motion.spin + 0.5 * body.inverse_moment * push.torque;
      }
    }
  });
}

}  // namespace equidem
