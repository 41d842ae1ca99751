// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/neighbours/contact_list.hpp"

#include <cmath>
#include <utility>

#include "equidem/geometry/shape_contact.hpp"
#include "equidem/grains/contacts/contact_geometry.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem {
namespace {

PairLaw law_of(const ContactConstants& constants) {
  return {constants.stiffness, constants.least, constants.sliding.coefficient, constants.sliding.stiffness};
}

/// All kinds except those of walls only.
std::vector<const PairProperties*> pairs_of_grains(const GrainScene& scene) {
  std::vector<bool> of_walls(static_cast<std::size_t>(scene.kinds)), met(of_walls);
  for (const Wall& wall : scene.walls) of_walls[wall.kind] = true;
  for (const Grain& grain : scene.present()) met[grain.kind] = true;
  for (std::size_t k = 0; k < met.size(); ++k) met[k] = met[k] || !of_walls[k];
  std::vector<const PairProperties*> pairs;
  for (int a = 0; a < scene.kinds; ++a) {
    for (int b = 0; b < scene.kinds; ++b) {
      if (met[a] && met[b]) pairs.push_back(&scene.between(a, b));
    }
  }
  return pairs;
}

/// Set the constants of a new contact.
void set_constants(const GrainSystem& system, NearList& list, std::size_t p) {
  static constexpr GrainBody wall{};
  static constexpr GrainPart no_part{{}, 0, 0, std::numeric_limits<double>::infinity()};
  const std::size_t g = p / lanes_of_pairs, k = p % lanes_of_pairs;
  const double dt = system.dt();
  const Partners of = partners_of(system, list, p);
  const bool at_wall = of.j < 0;
  const ContactConstants constants = constants_of(system, of.i, of.j);
  const GrainBody& bi = system.bodies.constants[of.i];
  const GrainBody& bj = at_wall ? wall : system.bodies.constants[of.j];
  const GrainPart i = system.part(of.i, of.part_i), j = at_wall ? no_part : system.part(of.j, of.part_j);
  ContactGroup& group = list.groups[g];
  group.reach[k] = i.a + j.a;
  group.dashpot[k] = constants.dashpot() * dt;
  group.half_mobility[k] = 0.5 * (at_wall ? 1 / constants.reduced_mass : bi.inverse_mass + bj.inverse_mass);
  const bool discs = list.between == Between::discs;
  if (list.slips.used) {
    const double share_i = bi.radius / (bi.radius + bj.radius), share_j = bj.radius / (bi.radius + bj.radius);
    PairSlips& slips = list.slips[g];
    slips.half_turning[k] = 0.5 * (share_i * share_i * bi.inverse_moment + share_j * share_j * bj.inverse_moment);
    slips.dashpot[k] = discs ? constants.sliding.dashpot * dt : constants.tangential_damping;
  }
  if (list.laws.used) {
    const PairLaw law = law_of(constants);
    PairLaws& laws = list.laws[g];
    laws.stiffness[k] = law.stiffness;
    laws.least[k] = law.least;
    laws.friction[k] = law.friction;
    laws.tangential_stiffness[k] = law.tangential_stiffness;
  }
  if (list.effects.used)
    list.effects[g].set(k, effects_between(system, of.i, of.j, constants.stiffness),
                        {i.size, j.size, bi.inverse_moment, bj.inverse_moment}, dt);
  if (discs) return;
  PartShapes& shapes = list.shapes[g];
  shapes.inverse_moment_i[k] = bi.inverse_moment;
  shapes.inverse_moment_j[k] = bj.inverse_moment;
  if (at_wall) return;
  shapes.share[k] = i.size / (i.size + j.size);
  shapes.a_i[k] = i.a;
  shapes.a_j[k] = j.a;
  shapes.b_i[k] = i.b;
  shapes.b_j[k] = j.b;
  shapes.arrived[k] = angle_of_arrival({i.a, i.b}, {j.a, j.b});
  shapes.sharpest[k] = i.b / i.a * i.b + j.b / j.a * j.b;
}

void set_normal(PairRecords& records, std::size_t k, Vec2 normal) {
  records.normal_x[k] = normal.x;
  records.normal_y[k] = normal.y;
}

/// Call visit(number of the state, number of the list) for all that a contact carries from step to step.
template <class List, class State, class Visit>
void each_number(List& list, std::size_t p, State& state, const Visit& visit) {
  const std::size_t g = p / lanes_of_pairs, k = p % lanes_of_pairs;
  visit(state.impulse, list.groups[g].impulse[k]);
  if (list.slips.used) {
    visit(state.stretch, list.slips[g].stretch[k]);
    visit(state.tangential_impulse, list.slips[g].impulse[k]);
  }
  if (list.records.used) {
    auto& records = list.records[g];
    visit(state.overlap, records.overlap[k]), visit(state.closing, records.closing[k]);
    visit(state.normal.x, records.normal_x[k]), visit(state.normal.y, records.normal_y[k]);
  }
  if (list.shapes.used) {
    auto& shapes = list.shapes[g];
    visit(state.arm_i.x, shapes.arm_i_x[k]), visit(state.arm_i.y, shapes.arm_i_y[k]);
    visit(state.arm_j.x, shapes.arm_j_x[k]), visit(state.arm_j.y, shapes.arm_j_y[k]);
  }
  if (!list.effects.used) return;
  visit(state.rolling_stretch, list.effects[g].stretch[k]);
  visit(state.rolling_impulse, list.effects[g].impulse[k]);
}

/// At the present positions.
PartGeometry geometry_of(const GrainSystem& system, const NearList& list, std::size_t p) {
  const Partners of = partners_of(system, list, p);
  if (list.between == Between::discs)
    return {.overlap = list.groups[p / lanes_of_pairs].reach[p % lanes_of_pairs] - norm(system.branch(of))};
  const Vec2 normal = list.normal(p);
  const bool touching = list.touching(p);
  if (of.j >= 0) return geometry_of_parts(system, of, touching, normal);
  if (list.shapes[p / lanes_of_pairs].covered[p % lanes_of_pairs] != 0)
    return {.overlap = -std::numeric_limits<double>::max()};
  return geometry_with_wall(system, list.first(p), static_cast<std::size_t>(~of.j), touching ? normal : Vec2{});
}

StoredEnergy stored_energy(const GrainSystem& system, const NearList& list, std::size_t p) {
  const std::size_t g = p / lanes_of_pairs, k = p % lanes_of_pairs;
  const PairLaw law = law_of(system, list, p);
  const PartGeometry found = geometry_of(system, list, p);
  StoredEnergy stored;
  if (found.overlap > 0) stored.normal = system.law().energy(law.stiffness, found.overlap);
  if (list.slips.used)
    stored.tangential = 0.5 * law.tangential_stiffness * list.slips[g].stretch[k] * list.slips[g].stretch[k];
  if (!list.effects.used || !list.touching(p)) return stored;
  const ContactEffects& effects = list.effects[g];
  const Partners of = partners_of(system, list, p);
  const GrainMotion& i = system.bodies.motions[of.i];
  GrainMotion j;
  if (of.j < 0) {
    j.velocity = system.walls.places[~of.j].passed_velocity;
  } else {
    j = system.bodies.motions[of.j];
  }
  double depth = found.overlap;
  if (list.between == Between::discs) {
    const Vec2 branch = j.position - system.lag() * j.velocity - (i.position - system.lag() * i.velocity);
    depth = list.groups[g].reach[k] - norm(branch + system.cell.now.shift(of.image()));
  } else {
    const Vec2 n = found.normal;
    depth += system.lag() * (dot(j.velocity - i.velocity, n) + j.spin * cross(found.arm_j, n) -
                             i.spin * (of.j < 0 ? found.across_i : cross(found.arm_i, n)));
  }
  stored.rolling = effects.elastic(k);
  stored.cohesion = -effects.attraction[k] / system.dt() * (depth + effects.range[k]);
  return stored;
}

}  // namespace

std::size_t NearList::bytes() const {
  std::size_t sum = groups.capacity() * sizeof(ContactGroup) + outward.bytes();
  each_column([&](const auto& column) { sum += column.capacity() * sizeof(column[0]); }, *this);
  return sum;
}

NearList NearList::emptied() {
  NearList before = std::exchange(*this, {});
  between = before.between;
  const std::size_t room = before.groups.size() + before.groups.size() / 16 + 8;
  groups.reserve(room);
  const auto make_room = [&](auto& column, const auto& other) {
    column.used = other.used;
    if (column.used) column.reserve(room);
  };
  each_column(make_room, *this, before);
  first_outward = std::numeric_limits<std::size_t>::max();
  return before;
}

void NearList::add_group() {
  std::ranges::fill(groups.emplace_back().reach, -1.0);
  const auto add = [](auto& column) {
    if (column.used) column.emplace_back();
  };
  each_column(add, *this);
}

void NearList::copy(const NearList& other, std::size_t from, std::size_t to) {
  constexpr std::size_t partners = offsetof(ContactGroup, since) / sizeof(PairLanes);
  const std::size_t g = from / lanes_of_pairs, k = from % lanes_of_pairs, lane = to % lanes_of_pairs;
  copy_lane(other.groups[g], k, groups[to / lanes_of_pairs], lane, partners);
  const auto copy_row = [&](const auto& source, auto& target) {
    if (target.used) copy_lane(source[g], k, target[to / lanes_of_pairs], lane);
  };
  each_column(copy_row, other, *this);
}

void NearList::end(std::size_t p) {
  const std::size_t g = p / lanes_of_pairs, k = p % lanes_of_pairs;
  since(p) = ContactGroup::apart;
  groups[g].impulse[k] = 0;
  if (slips.used) slips[g].stretch[k] = slips[g].impulse[k] = 0;
  if (effects.used) effects[g].set_state(k, 0, 0);
}

NewList::NewList(const GrainSystem& system, NearList& list, std::size_t block)
    : system_(system),
      list_(list),
      old_(list.emptied()),
      end_(static_cast<std::int32_t>(system.bodies.blocks.end(block))),
      next_(old_.count > 0 ? old_.pair(0) : PairKey::last()) {}

std::size_t NewList::add(const PairKey& pair) {
  const std::size_t p = list_.count++, k = p % lanes_of_pairs;
  if (k == 0) {
    list_.add_group();
    // unused lanes have bodies of this block, to which they give nothing
    std::ranges::fill(list_.groups.back().i, pair.i);
    std::ranges::fill(list_.groups.back().j, pair.i);
    std::ranges::fill(list_.groups.back().since, ContactGroup::unused);
  }
  ContactGroup& group = list_.groups.back();
  const std::int32_t j = pair.j.body;
  group.i[k] = pair.i;
  group.j[k] = j;
  group.since[k] = ContactGroup::apart;
  if (list_.images.used) list_.images.back().a[k] = pair.j.a, list_.images.back().b[k] = pair.j.b;
  if (list_.between == Between::walls) return p;
  const std::int32_t receiver = list_.between == Between::discs ? j : system_.shapes.body_of_part[j];
  if (receiver >= end_) {
    list_.first_outward = std::min(list_.first_outward, list_.groups.size() - 1);
    list_.outward.add(receiver);
  }
  return p;
}

std::size_t NewList::add(const PairKey& pair, Vec2 apart) {
  const std::size_t p = add(pair);
  set_constants(system_, list_, p);
  if (list_.shapes.used) set_normal(list_.records.back(), p % lanes_of_pairs, apart);
  return p;
}

Partners partners_of(const GrainSystem& system, const NearList& list, std::size_t p) {
  const auto [i, image] = list.pair(p);
  const auto [j, b, a] = image;
  const Shapes& shapes = system.shapes;
  if (list.between == Between::walls)
    return shapes.parts.empty() ? Partners{i, ~j} : Partners{shapes.body_of_part[i], ~j, i};
  if (list.between != Between::discs) return {shapes.body_of_part[i], shapes.body_of_part[j], i, j, a, b};
  return shapes.parts.empty() ? Partners{i, j, 0, 0, a, b}
                              : Partners{i, j, shapes.first_part[i], shapes.first_part[j], a, b};
}

std::optional<PairLaw> common_law(const GrainSystem& system) {
  const std::vector<const PairProperties*> pairs = pairs_of_grains(system.scene);
  const bool equal = std::all_of(pairs.begin(), pairs.end(), [&](const PairProperties* pair) {
    const bool plain = pair->stiffness > 0 && (!system.friction || pair->friction > 0);
    return plain && *pair == *pairs[0];
  });
  if (!equal || system.has_effects() || system.bodies.constants.size() < 2) return {};
  return law_of(constants_of(system, 0, 1));
}

PairLaw law_of(const GrainSystem& system, const NearList& list, std::size_t p) {
  if (!list.laws.used) return *system.contacts.law;
  const PairLaws& laws = list.laws[p / lanes_of_pairs];
  const std::size_t k = p % lanes_of_pairs;
  return {laws.stiffness[k], laws.least[k], laws.friction[k], laws.tangential_stiffness[k]};
}

void prepare_lists(GrainSystem& system) {
  if (!gives_force(system.options.law)) return;
  ContactList& contacts = system.contacts;
  contacts.law = common_law(system);
  const auto prepare = [&](Between between, NearLists::Loop loop) {
    NearLists& lists = contacts.of(between);
    lists.loop = loop;
    lists.blocks.resize(system.bodies.blocks.count());
    const bool discs = between == Between::discs;
    for (NearList& list : lists.blocks) {
      list.between = between;
      list.slips.used = !discs || system.friction;
      list.laws.used = !discs || !contacts.law;
      list.records.used = list.shapes.used = !discs;
      list.effects.used = system.has_effects();
      list.images.used = system.cell.active && between != Between::walls;
    }
  };
  const auto is_disc = [](const Grain& grain) { return grain.shape() == GrainShape::disc; };
  if (std::ranges::any_of(system.scene.present(), is_disc)) prepare(Between::discs, loop_of_discs(system));
  std::vector<Between> others;
  if (!system.shapes.parts.empty()) others = {Between::round_parts, Between::ellipses};
  if (!system.scene.walls.empty()) others.push_back(Between::walls);
  for (const Between between : others) prepare(between, loop_of_parts(system, between));
}

void touch_contacts(GrainSystem& system) {
  each_list(system.contacts, [&](NearList& list) {
    for (std::size_t p = 0; p < list.count; ++p) {
      const std::size_t g = p / lanes_of_pairs, k = p % lanes_of_pairs;
      const double range = list.effects.used ? list.effects[g].range[k] : 0;
      if (!(geometry_of(system, list, p).overlap > -range)) continue;
      list.since(p) = system.step + (system.options.verlet() ? 0 : 1);
      if (list.shapes.used) set_normal(list.records[g], k, {});
      ++system.counters.contacts;
    }
  });
}

void take_contacts(GrainSystem& system, std::vector<ContactState> contacts) {
  const bool shapes = !system.shapes.parts.empty();
  const auto list_of = [&](const ContactState& contact) {
    if (contact.j < 0) return Between::walls;
    if (are_discs(system, contact.i, contact.j)) return Between::discs;
    return between_parts(system, contact.part_i, contact.part_j);
  };
  const auto place_of = [&](const ContactState& contact) {
    const bool parts = shapes && list_of(contact) != Between::discs;
    const std::int32_t j = contact.j < 0 ? ~contact.j : parts ? contact.part_j : contact.j;
    return std::pair(list_of(contact), PairKey{parts ? contact.part_i : contact.i, {j, contact.b, contact.a}});
  };
  std::ranges::sort(contacts, {}, place_of);
  auto next = contacts.begin();
  each_list(system.contacts, [&](NearList& list) {
    list.count = 0;
    list.records.used = true;
    const auto block = static_cast<std::size_t>(&list - system.contacts.of(list.between).blocks.data());
    NewList taken(system, list, block);
    const auto is_here = [&] {
      return next != contacts.end() && list_of(*next) == list.between &&
             system.bodies.blocks.of(static_cast<std::size_t>(next->i)) == block;
    };
    for (; is_here(); ++next) set_state(system, list, taken.add(place_of(*next).second, {}), *next);
  });
}

ContactState state_of(const GrainSystem& system, const NearList& list, std::size_t p) {
  ContactState state;
  static_cast<Partners&>(state) = partners_of(system, list, p);
  const std::size_t g = p / lanes_of_pairs, k = p % lanes_of_pairs;
  state.steps = system.step + 1 - list.groups[g].since[k];
  each_number(list, p, state, [](double& of_state, double listed) { of_state = listed; });
  if (list.effects.used) state.lever = list.effects[g].lever[k];
  if (list.between != Between::discs) return state;
  const double sum = list.groups[g].reach[k], distance = sum - state.overlap;
  const double lever = system.bodies.constants[state.i].radius / sum * distance;
  state.arm_i = lever * state.normal;
  state.arm_j = (lever - distance) * state.normal;
  return state;
}

void set_state(const GrainSystem& system, NearList& list, std::size_t p, ContactState contact) {
  // of discs it is not saved
  if (system.shapes.parts.empty()) contact.arm_i = system.bodies.constants[contact.i].radius * contact.normal;
  list.since(p) = system.step + 1 - contact.steps;
  each_number(list, p, contact, [](double of_state, double& listed) { listed = of_state; });
}

StoredEnergy stored_energy(const GrainSystem& system) {
  StoredEnergy all;
  const std::vector<NearList>& discs = system.contacts.of(Between::discs).blocks;
  std::vector<StoredEnergy> of_discs(discs.size());
  const auto add = [&](const NearList& list, StoredEnergy& sum) {
    for (std::size_t p = 0; p < list.count; ++p) sum += stored_energy(system, list, p);
  };
  if (!discs.empty()) system.bodies.blocks.each([&](std::size_t b) { add(discs[b], of_discs[b]); });
  for (const StoredEnergy& part : of_discs) all += part;
  each_list(system.contacts, [&](const NearList& list) {
    if (list.between != Between::discs) add(list, all);
  });
  // these laws count the spring from the first step of the contact on
  for (const Candidate& candidate : system.contacts.candidates) {
    all.tangential += 0.5 * candidate.sliding.stiffness * candidate.stretch * candidate.stretch;
    if (!candidate.touching || candidate.parted) continue;
    const double overlap = geometry_of(system, candidate).overlap;
    if (overlap > 0) all.normal += system.law().energy(candidate.stiffness, overlap);
  }
  return all;
}

}  // namespace equidem
