// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies as the loops over near parts read them, and the contacts that these loops keep.
#include "equidem/grains/neighbours/near_parts.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "equidem/geometry/shape_contact.hpp"
#include "equidem/grains/contacts/contact_geometry.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem {

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

namespace {

using PartColumn = PartGroup::Column;

NewList<NearParts::List> new_list(const GrainSystem& system, NearParts::List& list, std::size_t b) {
  list.has_effects = system.has_effects();
  if (list.of_walls) return {list, NewList<NearParts::List>::nothing(), nullptr};
  return {list, system.bodies.blocks.end(b), &system.shapes.body_of_part};
}

/// Set the constants of a new contact, which is apart. \param apart a direction along which it is, or {}
void set_constants(const GrainSystem& system, NearParts::List& list, std::size_t p, Vec2 apart) {
  const Partners of = partners_of(system, list, p);
  const ContactConstants constants = constants_of(system, of.i, of.j);
  const auto set = [&](PartColumn column, double number) { list.number(p, column) = number; };
  for (PairLanes& column : list.group(p).numbers) column[p % lanes_of_pairs] = 0;
  const GrainBody& body_i = system.bodies.constants[of.i];
  set(PartGroup::inverse_mass, 1 / constants.reduced_mass);
  set(PartGroup::inverse_moment_i, body_i.inverse_moment);
  set(PartGroup::stiffness, constants.stiffness);
  set(PartGroup::dashpot, constants.dashpot());
  set(PartGroup::least, constants.least);
  set(PartGroup::friction, constants.sliding.coefficient);
  set(PartGroup::tangential_stiffness, constants.sliding.stiffness);
  set(PartGroup::tangential_damping, constants.tangential_damping);
  set(PartGroup::normal_x, apart.x);
  set(PartGroup::normal_y, apart.y);
  const auto radius_of = [&](std::int32_t body, std::int32_t part) {
    return system.shapes.parts.empty() ? system.bodies.constants[body].radius : system.shapes.parts[part].size;
  };
  if (list.has_effects)
    list.effects_of(p).set(
        p % lanes_of_pairs, effects_between(system, of.i, of.j, constants.stiffness),
        {radius_of(of.i, of.part_i),
         of.j < 0 ? std::numeric_limits<double>::infinity() : radius_of(system.body_of(of.j), of.part_j),
         body_i.inverse_moment, of.j < 0 ? 0 : system.bodies.constants[system.body_of(of.j)].inverse_moment},
        system.dt());
  if (list.of_walls) return;
  const GrainPart &part_i = system.shapes.parts[of.part_i], &part_j = system.shapes.parts[of.part_j];
  const GrainBody& body_j = system.bodies.constants[system.body_of(of.j)];
  set(PartGroup::inverse_mass, body_i.inverse_mass + body_j.inverse_mass);
  set(PartGroup::inverse_moment_j, body_j.inverse_moment);
  set(PartGroup::reach, part_i.a + part_j.a);
  set(PartGroup::a_i, part_i.a);
  set(PartGroup::b_i, part_i.b);
  set(PartGroup::a_j, part_j.a);
  set(PartGroup::b_j, part_j.b);
  set(PartGroup::share, part_i.size / (part_i.size + part_j.size));
  set(PartGroup::arrived, angle_of_arrival({part_i.a, part_i.b}, {part_j.a, part_j.b}));
  set(PartGroup::sharpest, part_i.b / part_i.a * part_i.b + part_j.b / part_j.a * part_j.b);
}

/// Set constants and state of a new contact.
void set_state(const GrainSystem& system, NearParts::List& list, std::size_t p, const ContactState& contact) {
  set_constants(system, list, p, contact.normal);
  list.since(p) = system.step + 1 - contact.steps;
  const auto set = [&](PartColumn column, double number) { list.number(p, column) = number; };
  set(PartGroup::impulse, contact.impulse);
  set(PartGroup::tangential_impulse, contact.tangential_impulse);
  set(PartGroup::stretch, contact.stretch);
  if (list.has_effects)
    list.effects_of(p).set_state(p % lanes_of_pairs, contact.rolling_stretch, contact.rolling_impulse);
  set(PartGroup::overlap, contact.overlap);
  set(PartGroup::closing, contact.closing);
  // of discs it is not saved
  const Vec2 arm_i =
      system.shapes.parts.empty() ? system.bodies.constants[contact.i].radius * contact.normal : contact.arm_i;
  set(PartGroup::arm_i_x, arm_i.x);
  set(PartGroup::arm_i_y, arm_i.y);
  set(PartGroup::arm_j_x, contact.arm_j.x);
  set(PartGroup::arm_j_y, contact.arm_j.y);
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
double gap_of(const GrainSystem& system, std::int32_t p, std::int32_t q, double enough, Vec2& apart) {
  const GrainPart &part_i = system.shapes.parts[p], &part_j = system.shapes.parts[q];
  const auto i = static_cast<std::size_t>(system.shapes.body_of_part[p]);
  const auto j = static_cast<std::size_t>(system.shapes.body_of_part[q]);
  const Vec2 branch = system.position_of(system.shapes.body_of_part[q]) - system.bodies.motions[i].position +
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
  NearParts& near = system.contacts.near_parts;
  std::fill(near.met.begin(), near.met.end(), char{0});
  each_list(system.contacts, [&](const NearParts::List& list) {
    for (std::size_t p = 0; p < list.count; ++p) {
      const Partners of = partners_of(system, list, p);
      near.met[of.part_i] = 1;
      if (list.of_walls) continue;
      near.met[of.part_j] = 1;
      near.met[system.own_part(of.part_j)] = 1;
    }
  });
}

std::size_t list_of(const GrainSystem& system, std::int32_t p, std::int32_t q) {
  const bool round = system.shapes.parts[p].is_round() && system.shapes.parts[q].is_round();
  return round ? 0 : 1;
}

/// All but pairs of whole discs.
void find_close_parts(const GrainSystem& system, std::size_t block, std::vector<NearParts::Close>& close) {
  const NeighbourList& neighbours = *system.contacts.near.outer;
  const double farthest = system.contacts.margin + system.range;
  close.clear();
  for (std::size_t i = system.bodies.blocks.begin(block); i < system.bodies.blocks.end(block); ++i) {
    const auto body = static_cast<std::int32_t>(i);
    const bool disc = are_discs(system, body, body);
    for (std::int32_t p = system.shapes.first_part[i]; p < system.shapes.first_part[i + 1]; ++p) {
      for (std::int64_t n = neighbours.begin[i]; n < neighbours.begin[i + 1]; ++n) {
        const std::int32_t partner = neighbours.partner[n];
        if (disc && are_discs(system, body, partner)) continue;
        const std::int32_t other = system.body_of(partner);
        if (other != partner && other <= body) continue;  // listed with the other one, or itself
        const auto j = static_cast<std::size_t>(partner);
        for (std::int32_t q = system.shapes.first_part[j]; q < system.shapes.first_part[j + 1]; ++q) {
          NearParts::Close pair{p, q, 0, {}};
          pair.clear = gap_of(system, p, q, farthest, pair.apart);
          if (pair.clear <= farthest) close.push_back(pair);
        }
      }
    }
  }
}

/// Those of the close parts of a block that are nearer than the margin.
void find_nearest_parts(const GrainSystem& system, std::size_t b, NearParts::Block& block) {
  const NearParts& near = system.contacts.near_parts;
  const double farthest = near.margin + system.range;
  std::array<NewList<NearParts::List>, 2> lists{new_list(system, block.lists[0], b),
                                                new_list(system, block.lists[1], b)};
  for (NearParts::Close& pair : block.close) {
    if (pair.clear - 2 * near.travelled > farthest) continue;
    const std::size_t l = list_of(system, pair.i, pair.j);
    NewList<NearParts::List>& list = lists[l];
    if (list.keep_contact(pair.i, pair.j)) continue;
    if (const std::size_t before = list.place_before(); before < list.old().count) {
      // where it was apart: a direction along which it was, or {}
      const Vec2 apart{list.old().number(before, PartGroup::normal_x), list.old().number(before, PartGroup::normal_y)};
      if (apart != Vec2{}) pair.apart = apart;
    }
    const double gap = gap_of(system, pair.i, pair.j, farthest, pair.apart);
    pair.clear = gap + 2 * near.travelled;
    const bool is_near = gap <= farthest;
    if (!list.leave(is_near) && is_near) set_constants(system, block.lists[l], list.add(pair.i, pair.j), pair.apart);
  }
  for (NewList<NearParts::List>& list : lists) list.keep_others();
}

void find_nearest_parts(GrainSystem& system, double reach) {
  NearParts& near = system.contacts.near_parts;
  near.margin = margin_of_near_pairs(system, near.size, reach);
  near.travelled += near.moved;
  near.moved = 0;
  system.bodies.blocks.each([&](std::size_t block) { find_nearest_parts(system, block, near.blocks[block]); });
  find_met_parts(system);
  connect_blocks(system);
}

}  // namespace

std::size_t NearParts::bytes() const {
  std::size_t sum = bodies.capacity() * sizeof(PartBody) + met.capacity();
  for (const Block& block : blocks) {
    sum += block.close.capacity() * sizeof(Close);
    for (const List& list : block.lists) sum += list.bytes();
  }
  return sum;
}

std::size_t NearWalls::bytes() const {
  std::size_t sum = 0;
  for (const NearParts::List& list : blocks) sum += list.bytes();
  return sum;
}

NearParts::List NearParts::List::emptied() {
  List before = std::move(*this);
  *this = {};
  of_walls = before.of_walls;
  make_room(before);
  return before;
}

void NearParts::List::add_group() {
  add_columns();
  std::fill_n(&groups.back().numbers[0][0], PartGroup::columns * lanes_of_pairs, 1.0);  // anything to divide by
}

void NearParts::List::copy(const List& other, std::size_t from, std::size_t to) {
  copy_lane(other.group(from), from % lanes_of_pairs, group(to), to % lanes_of_pairs,
            sizeof(ContactGroup) / sizeof(PairLanes) - 1);
  copy_effects(other, from, to);
}

void NearParts::List::end(std::size_t p) {
  since(p) = ContactGroup::apart;
  for (const auto column : {PartGroup::impulse, PartGroup::tangential_impulse, PartGroup::stretch})
    number(p, column) = 0;
  if (has_effects) effects_of(p).set_state(p % lanes_of_pairs, 0, 0);
}

void NearParts::List::move_state(std::size_t from, std::size_t to) {
  using enum PartGroup::Column;
  since(to) = since(from);
  for (const auto column :
       {impulse, tangential_impulse, stretch, normal_x, normal_y, overlap, closing, arm_i_x, arm_i_y})
    number(to, column) = number(from, column);
  if (has_effects) {
    const ContactEffects& state = effects_of(from);
    const std::size_t k = from % lanes_of_pairs;
    effects_of(to).set_state(to % lanes_of_pairs, state.stretch[k], state.impulse[k]);
  }
  end(from);
}

bool are_discs(const GrainSystem& system, std::int32_t i, std::int32_t j) {
  const auto is_disc = [&](std::int32_t body) {
    return system.grain(system.body_of(body)).shape() == GrainShape::disc;
  };
  return is_disc(i) && is_disc(j);
}

void prepare_near_parts(GrainSystem& system) {
  if (system.shapes.parts.empty() || !gives_force(system.options.law)) return;
  NearParts& near = system.contacts.near_parts;
  near.active = true;
  near.law = common_law(system);
  near.loops = {loop_of_round_parts(system), loop_of_ellipses(system)};
  near.blocks.resize(system.bodies.blocks.count());
  near.bodies.resize(system.shapes.parts.size());
  near.met.resize(system.shapes.parts.size());
  near.size = std::numeric_limits<double>::infinity();
  for (const GrainPart& part : system.shapes.parts) near.size = std::min(near.size, part.size);
}

void find_near_parts(GrainSystem& system, double reach) {
  NearParts& near = system.contacts.near_parts;
  near.travelled = near.moved = 0;
  system.bodies.blocks.each([&](std::size_t b) { find_close_parts(system, b, near.blocks[b].close); });
  find_nearest_parts(system, reach);
}

void refresh_near_parts(GrainSystem& system, double reach) {
  NearParts& near = system.contacts.near_parts;
  if (2 * (near.moved + reach) > near.margin) find_nearest_parts(system, reach);
  near.moved += reach;
}

void take_near_parts(GrainSystem& system, std::vector<ContactState> contacts) {
  std::ranges::sort(contacts, {},
                    [](const ContactState& contact) { return std::pair(contact.part_i, contact.part_j); });
  auto next = contacts.begin();
  for (std::size_t b = 0; b < system.bodies.blocks.count(); ++b) {
    auto& lists = system.contacts.near_parts.blocks[b].lists;
    lists[0].count = lists[1].count = 0;
    std::array<NewList<NearParts::List>, 2> taken{new_list(system, lists[0], b), new_list(system, lists[1], b)};
    for (; next != contacts.end() && system.bodies.blocks.of(static_cast<std::size_t>(next->i)) == b; ++next) {
      const ContactState& contact = *next;
      const std::size_t l = list_of(system, contact.part_i, contact.part_j);
      set_state(system, lists[l], taken[l].add(contact.part_i, contact.part_j), contact);
    }
  }
}

void prepare_near_walls(GrainSystem& system) {
  NearWalls& near = system.contacts.near_walls;
  if (system.scene.walls.empty() || !gives_force(system.options.law)) return;
  near.active = true;
  near.loop = loop_of_walls(system);
  near.blocks.resize(system.bodies.blocks.count());
  for (NearParts::List& list : near.blocks) list.of_walls = true;
}

namespace {

/// Whether a part comes nearer to a wall than the margin; ellipses at a segment by their bounding circle.
bool is_near_wall(const GrainSystem& system, std::size_t body, const GrainPart& part, std::size_t w) {
  const Vec2 axis = system.shapes.axes[body];
  const Wall& wall = system.scene.walls[w];
  const WallContact contact =
      nearest(wall, system.walls.places[w].displacement, system.bodies.motions[body].position + offset_of(part, axis));
  const double reach = wall.shape == Wall::Shape::line ? support({part.a, part.b, axis}, contact.normal).reach : part.a;
  return contact.distance <= reach + system.contacts.margin + system.range;
}

void find_walls_of_block(const GrainSystem& system, NearParts::List& list, std::size_t block) {
  NewList<NearParts::List> walls = new_list(system, list, block);
  const auto see = [&](std::int32_t i, std::size_t w) {
    const auto j = static_cast<std::int32_t>(w);
    if (!walls.keep_contact(i, j) && !walls.leave(true)) set_constants(system, list, walls.add(i, j), {});
  };
  const std::size_t count = system.scene.walls.size();
  const double farthest = system.contacts.margin + system.range;
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

void find_near_walls(GrainSystem& system) {
  NearWalls& near = system.contacts.near_walls;
  if (!near.active) return;
  system.bodies.blocks.each([&](std::size_t block) { find_walls_of_block(system, near.blocks[block], block); });
}

void take_near_walls(GrainSystem& system, const std::vector<ContactState>& contacts) {
  std::vector<ContactState> walls;
  std::ranges::copy_if(contacts, std::back_inserter(walls), [](const ContactState& contact) { return contact.j < 0; });
  if (!system.contacts.near_walls.active) return;
  const bool shapes = !system.shapes.parts.empty();
  const auto number_of = [&](const ContactState& contact) { return shapes ? contact.part_i : contact.i; };
  std::ranges::sort(walls, {}, [&](const ContactState& contact) { return std::pair(number_of(contact), ~contact.j); });
  auto next = walls.begin();
  for (std::size_t b = 0; b < system.bodies.blocks.count(); ++b) {
    NearParts::List& list = system.contacts.near_walls.blocks[b];
    list.count = 0;
    NewList<NearParts::List> taken = new_list(system, list, b);
    for (; next != walls.end() && system.bodies.blocks.of(static_cast<std::size_t>(next->i)) == b; ++next)
      set_state(system, list, taken.add(number_of(*next), ~next->j), *next);
  }
}

void load_part_bodies(GrainSystem& system) {
  NearParts& near = system.contacts.near_parts;
  if (!near.active) return;
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

Partners partners_of(const GrainSystem& system, const NearParts::List& list, std::size_t p) {
  const std::int32_t i = list.first(p), j = list.second(p);
  if (system.shapes.parts.empty()) return {i, ~j};
  const std::vector<std::int32_t>& bodies = system.shapes.body_of_part;
  return list.of_walls ? Partners{bodies[i], ~j, i} : Partners{bodies[i], bodies[j], i, j};
}

namespace {

/// At the present positions.
PartGeometry geometry_of(const GrainSystem& system, const NearParts::List& list, std::size_t p) {
  const Vec2 normal{list.number(p, PartGroup::normal_x), list.number(p, PartGroup::normal_y)};
  const bool touching = list.touching(p);
  if (!list.of_walls) return geometry_of_parts(system, partners_of(system, list, p), touching, normal);
  if (list.number(p, PartGroup::covered) != 0) return {.overlap = -std::numeric_limits<double>::max()};
  return geometry_with_wall(system, list.first(p), list.wall(p), touching ? normal : Vec2{});
}

}  // namespace

void touch_near_parts(GrainSystem& system) {
  each_list(system.contacts, [&](NearParts::List& list) {
    for (std::size_t p = 0; p < list.count; ++p) {
      const double range = list.has_effects ? list.effects_of(p).range[p % lanes_of_pairs] : 0;
      if (!(geometry_of(system, list, p).overlap > -range)) continue;
      list.since(p) = system.step + (system.options.verlet() ? 0 : 1);
      list.number(p, PartGroup::normal_x) = list.number(p, PartGroup::normal_y) = 0;
      ++system.counters.contacts;
    }
  });
}

std::pair<double, double> elastic_of(const GrainSystem& system, const NearParts::List& list, std::size_t p) {
  const auto number = [&](PartColumn column) { return list.number(p, column); };
  const double overlap = geometry_of(system, list, p).overlap, stretch = number(PartGroup::stretch);
  return {overlap > 0 ? system.law().energy(number(PartGroup::stiffness), overlap) : 0,
          0.5 * number(PartGroup::tangential_stiffness) * stretch * stretch};
}

std::pair<double, double> effects_of(const GrainSystem& system, const NearParts::List& list, std::size_t p) {
  if (!list.has_effects || !list.touching(p)) return {};
  const std::size_t k = p % lanes_of_pairs;
  const ContactEffects& effects = list.effects_of(p);
  const PartGeometry found = geometry_of(system, list, p);
  const Partners of = partners_of(system, list, p);
  const GrainMotion& i = system.bodies.motions[of.i];
  GrainMotion j;
  if (of.j < 0) {
    j.velocity = system.walls.places[~of.j].passed_velocity;
  } else {
    j = system.bodies.motions[system.body_of(of.j)];
  }
  const Vec2 n = found.normal;
  const double opening = dot(j.velocity - i.velocity, n) + j.spin * cross(found.arm_j, n) -
                         i.spin * (of.j < 0 ? found.across_i : cross(found.arm_i, n));
  const double depth = found.overlap + system.lag() * opening + effects.range[k];
  return {effects.elastic(k), -effects.attraction[k] / system.dt() * depth};
}

void resolve_image(const GrainSystem& system, ContactState& state) {
  if (!system.is_image(state.j)) return;
  const PeriodicImage& image = system.image(state.j);
  if (!system.shapes.parts.empty()) state.part_j = system.own_part(state.part_j);
  state.j = image.body;
  state.a = image.a;
  state.b = image.b;
}

ContactState state_of(const GrainSystem& system, const NearParts::List& list, std::size_t p) {
  const auto number = [&](PartColumn column) { return list.number(p, column); };
  const auto vector = [&](PartColumn x, PartColumn y) { return Vec2{number(x), number(y)}; };
  const Partners of = partners_of(system, list, p);
  ContactState state{.i = of.i,
                     .j = of.j,
                     .part_i = of.part_i,
                     .part_j = of.part_j,
                     .steps = system.step + 1 - list.since(p),
                     .overlap = number(PartGroup::overlap),
                     .closing = number(PartGroup::closing),
                     .normal = vector(PartGroup::normal_x, PartGroup::normal_y),
                     .impulse = number(PartGroup::impulse),
                     .tangential_impulse = number(PartGroup::tangential_impulse),
                     .stretch = number(PartGroup::stretch),
                     .arm_i = vector(PartGroup::arm_i_x, PartGroup::arm_i_y),
                     .arm_j = vector(PartGroup::arm_j_x, PartGroup::arm_j_y)};
  if (list.has_effects) state.set_effects(list.effects_of(p), p % lanes_of_pairs);
  resolve_image(system, state);
  return state;
}

}  // namespace equidem
