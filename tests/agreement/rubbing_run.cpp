// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts that open, close and slip along a path carry the forces of damped motion that is loaded slowly.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/lattices/hexagonal.hpp"
#include "equidem/breakage/notch.hpp"
#include "equidem/breakage/unbonded/unbonded_run.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/network.hpp"
#include "equidem/packing/size_distribution.hpp"

#include "breakage/unbonded_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr SpringConstants rubbing_springs{1e8, 5e7};
constexpr double rubbing_friction = 0.3, rubbing_density = 2500;

/// Displacement of the lid, m, and gravity, m/s².
struct Push {
  Vec2 lid, gravity;

  friend Push operator+(const Push& a, const Push& b) { return {a.lid + b.lid, a.gravity + b.gravity}; }
  friend Push operator*(double by, const Push& p) { return {by * p.lid, by * p.gravity}; }
};

/// Discs between walls in time, pushed so slowly that inertia and dashpots hardly count.
class SlowGrains {
 public:
  /// \param steps from one push to the next
  SlowGrains(std::vector<Grain> grains, Vec2 box, std::vector<GrainBond> bonds, double steps) : box_(box) {
    SettlingOptions options;
    options.springs = rubbing_springs;
    options.damping = 0.5;
    options.friction = options.wall_friction = rubbing_friction;
    scene_ = scene_of_box(box.x, options);
    scene_.walls = walls_of({box, PackingBox::Sides::walls});
    scene_.grains = std::move(grains);
    scene_.bonds = std::move(bonds);
    options_ = {.law = NormalLaw::linear_dashpot, .integrator = GrainOptions::Integrator::corrected_verlet};
    options_.time_step = 0.2 * contact_step_limit(scene_, options);
    parts_ = std::llround(steps / steps_a_part);
    push_to({});
  }

  /// Goes there along a smooth way, and stays until nothing moves any more.
  void push_to(const Push& to) {
    const double begin = at_.lid == Vec2{} && to.lid == Vec2{} ? 0 : time_;
    const double whole = static_cast<double>(parts_ * steps_a_part) * options_.time_step;
    const auto way = [&](double a, double b) {
      return Schedule{
          .kind = Schedule::Kind::smooth_table, .times = {begin, begin + whole}, .values = {a, b}, .rates = {0, 0}};
    };
    scene_.walls[3].move_x = way(at_.lid.x, to.lid.x);
    scene_.walls[3].move_y = way(at_.lid.y, to.lid.y);
    const auto advance = [&](std::int64_t steps) {
      GrainSimulation run(scene_, options_);
      if (time_ > 0) run.restore(state_);
      run.advance(steps);
      state_ = run.save();
      time_ = run.time();
      grains_ = run.grains();
      contacts_ = run.contacts();
      forces_.clear();
      for (const BodyContact& c : run.body_contacts()) forces_[{c.i, c.j}] = {-c.normal_force, -c.tangential_force};
    };
    for (std::int64_t part = 1; part <= parts_; ++part) {
      const double share = static_cast<double>(part) / static_cast<double>(parts_);
      scene_.gravity = at_.gravity + share * (to.gravity - at_.gravity);
      advance(steps_a_part);
    }
    advance(parts_ * steps_a_part);
    at_ = to;
  }

  [[nodiscard]] const Push& at() const { return at_; }
  using Forces = std::map<std::pair<std::int32_t, std::int32_t>, ContactForce>;
  [[nodiscard]] const Forces& forces() const { return forces_; }
  /// The discs as they lie, with the forces of their contacts.
  [[nodiscard]] GrainPacking packing() const {
    GrainPacking packing;
    packing.box = {box_ + Vec2{0, at_.lid.y}, PackingBox::Sides::walls};
    packing.grains = grains_;
    packing.contacts = contacts_;
    for (const Grain& grain : grains_) packing.radii.push_back(grain.radius);
    return packing;
  }

 private:
  static constexpr std::int64_t steps_a_part = 20;
  Vec2 box_;
  GrainScene scene_;
  GrainOptions options_;
  std::int64_t parts_ = 0;
  Push at_;
  double time_ = 0;
  SavedState state_;
  std::vector<Grain> grains_;
  std::vector<GrainContact> contacts_;
  Forces forces_;
};

/// The same discs for statics: those behind the lid are the group "lid", behind other walls "walls".
struct HeldDiscs {
  Assembly assembly;
  ContactStrengths strengths;
  UnbondedOptions options{rubbing_friction, {}};
  std::vector<std::pair<std::int32_t, std::int32_t>> bodies;  // of contacts
  std::vector<double> masses;                                 // of the discs that are no walls
};

/// \param gaps tolerance of contacts that are open, of the sum of the radii
/// \param bonds contacts of other discs have none
HeldDiscs held_discs(const GrainPacking& packing, double gaps, std::span<const GrainBond> bonds) {
  HeldDiscs held;
  const HeldNetwork network = held_network_of(packing, {.springs = rubbing_springs, .gap_tolerance = gaps});
  Assembly& assembly = held.assembly = network.assembly;
  std::vector<std::int32_t> body(network.bodies);
  for (const std::int32_t k : network.bodies) {
    const auto grain = static_cast<std::size_t>(k);
    held.masses.push_back(packing.grains[grain].inertia.mass);
    assembly.groups[fmt::format("disc {}", held.masses.size() - 1)] = {
        {static_cast<std::int32_t>(held.masses.size() - 1)}, {}};
  }
  DiscGroup lid, walls;
  for (std::size_t k = body.size(); k < assembly.size(); ++k) {
    const Vec2 x = assembly.centres[k];
    body.push_back(x.y < 0 ? -1 : x.x < 0 ? -2 : x.x > packing.box.size.x ? -3 : -4);
    (body.back() == -4 ? lid : walls).discs.push_back(static_cast<std::int32_t>(k));
  }
  assembly.groups["lid"] = lid;
  assembly.groups["walls"] = walls;
  held.strengths = equal_strengths(assembly, 0, 0);
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const auto i = static_cast<std::size_t>(assembly.contacts[c].i),
               j = static_cast<std::size_t>(assembly.contacts[c].j);
    held.bodies.emplace_back(body[i], body[j]);
    const auto ties = [&](const GrainBond& bond) {
      return std::pair(bond.i, bond.j) ==
             std::pair(static_cast<std::size_t>(body[i]), static_cast<std::size_t>(body[j]));
    };
    ContactForce force = force_at_rest(assembly, c);
    if (std::ranges::any_of(bonds, ties)) {
      held.strengths.tension[c] = held.strengths.shear[c] = 1e9;
    } else if (force.normal == 0) {
      const double gap = norm(assembly.branch(assembly.contacts[c])) - assembly.radii[i] - assembly.radii[j];
      force.normal = rubbing_springs.kN * std::max(0.0, body[j] < 0 ? gap / 2 : gap);
    }
    held.options.rest.push_back(force);
  }
  return held;
}

/// Statics beside motion at one level.
struct RubbingLevel {
  double force = 0;  // the largest difference of a force over the largest force
  std::int64_t open = 0;
  std::vector<std::string> other_contacts;  // open in one and closed in the other
  std::map<std::string, int> events;
  UnbondedCounters counters;
  PathEnd ended = PathEnd::none;
  std::string why;
};

RubbingLevel level_of(const HeldDiscs& held, const Push& load, const std::vector<double>& legs,
                      const SlowGrains::Forces& moved) {
  LoadPathOptions path;
  path.supports = {{"walls", 0, 0, 0}, {"lid", load.lid.x, load.lid.y, 0}};
  path.control = load.lid == Vec2{} ? LoadControl::load : LoadControl::motion;
  path.legs = legs;
  for (std::size_t k = 0; load.gravity != Vec2{} && k < held.masses.size(); ++k)
    path.loads.push_back({fmt::format("disc {}", k), LoadKind::per_disc, held.masses[k] * load.gravity, 0});
  Unbonded scene(held.assembly, ContactSprings(rubbing_springs), held.strengths, path, held.options);
  scene.all();
  RubbingLevel level;
  level.ended = scene.run().end();
  level.why = scene.run().why();
  level.counters = scene.run().counters();
  for (const BreakEvent& event : scene.events()) ++level.events[to_string(event.mode)];
  const UnbondedState& state = scene.run().state();
  double largest = 0;
  for (const ContactForce& f : state.forces())
    largest = std::max({largest, std::abs(f.normal), std::abs(f.tangential)});
  for (std::size_t c = 0; c < held.bodies.size(); ++c) {
    const auto found = moved.find(held.bodies[c]);
    const ContactForce f = state.forces()[c], g = found == moved.end() ? ContactForce{} : found->second;
    level.force = std::max(
        {level.force, std::abs(f.normal - g.normal) / largest, std::abs(f.tangential - g.tangential) / largest});
    const bool open = state.status()[c] == ContactStatus::open;
    level.open += open ? 1 : 0;
    // A contact that just touches carries no force that tells whether it is open.
    const bool touches = std::abs(state.normal_coordinate(c)) < 1e-4 * largest;
    if (open != (found == moved.end()) && !touches && state.status()[c] != ContactStatus::bonded)
      level.other_contacts.push_back(
          fmt::format("{} {}: {} beside {}", held.bodies[c].first, held.bodies[c].second, f.normal, g.normal));
  }
  return level;
}

/// Discs that jammed in a box of walls, without those that nothing touches.
std::vector<Grain> jammed_discs(std::int64_t discs, double overlap, Vec2& box) {
  PackingOptions options;
  Random random(11);
  options.radii = draw_radii({.smallest = 0.005, .largest = 0.01}, discs, random);
  const double side = std::sqrt(area_of(PackingShape{}, options.radii) / 0.5);
  options.box = {box = {side, side}, PackingBox::Sides::walls};
  options.as_dense_as_possible = true;
  options.overlap = overlap;
  options.settling.density = rubbing_density;
  const GrainPacking packing = pack(options);
  std::vector<Grain> grains;
  for (const std::int32_t body : held_network_of(packing, {}).bodies)
    grains.push_back(packing.grains[static_cast<std::size_t>(body)]);
  return grains;
}

/// A block of bonded discs between floor and lid with a crack across it, whose faces lie `gap` apart.
struct CrackedBlock {
  std::vector<Grain> discs;
  std::vector<GrainBond> bonds;
  Vec2 box;

  explicit CrackedBlock(double gap) {
    constexpr double r = 0.01;
    const Assembly lattice = hexagonal_lattice({.columns = 7, .rows = 8, .radius = r});
    const Vec2 low = *std::ranges::min_element(lattice.centres, {}, &Vec2::y);
    const std::vector<Notch> crack{{{3.1 * r, 4.2 * r}, {11.2 * r, 9.3 * r}}};
    const std::vector<std::size_t> cut = contacts_across(lattice, crack);
    std::vector<double> radii = lattice.radii;
    for (std::size_t c = 0; c < lattice.contacts.size(); ++c) {
      const auto i = static_cast<std::size_t>(lattice.contacts[c].i),
                 j = static_cast<std::size_t>(lattice.contacts[c].j);
      if (std::ranges::binary_search(cut, c)) {
        radii[lattice.centres[i].y > lattice.centres[j].y ? i : j] = r - gap;
        continue;
      }
      const double mass = inertia_of(r, rubbing_density, Body::disc).mass,
                   dashpot = 0.1 * std::sqrt(mass * rubbing_springs.kN);
      bonds.push_back({.i = std::min(i, j),
                       .j = std::max(i, j),
                       .normal_dashpot = dashpot,
                       .tangential_dashpot = dashpot,
                       .normal_spring = rubbing_springs.kN,
                       .tangential_spring = rubbing_springs.kT});
    }
    for (std::size_t k = 0; k < radii.size(); ++k) {
      discs.push_back({.position = lattice.centres[k] + Vec2{2 * r, r - low.y},
                       .radius = radii[k],
                       .inertia = inertia_of(radii[k], rubbing_density, Body::disc)});
      box = {std::max(box.x, discs.back().position.x + 3 * r), std::max(box.y, discs.back().position.y + r)};
    }
  }
};

/// Both go to the levels one after another, from where the motion is.
std::vector<RubbingLevel> follow(SlowGrains& slow, const HeldDiscs& held, const Push& load,
                                 std::span<const double> to) {
  const Push from = slow.at();
  std::vector<double> legs;
  std::vector<RubbingLevel> levels;
  for (const double lambda : to) {
    slow.push_to(from + lambda * load);
    legs.push_back(lambda);
    levels.push_back(level_of(held, load, legs, slow.forces()));
  }
  return levels;
}

const std::vector<double> loaded_and_unloaded{0.25, 0.5, 0.75, 1, 0.5, 0};

/// Discs that jammed, pressed and sheared by their lid, which then moves back and further down by some times their
/// overlaps.
std::vector<RubbingLevel> under_a_lid(double overlap, double steps) {
  Vec2 box;
  const std::vector<Grain> discs = jammed_discs(60, overlap, box);
  SlowGrains slow(discs, box, {}, steps);
  const double way = 0.04 * overlap;
  slow.push_to({{way, -way}, {}});
  const HeldDiscs held = held_discs(slow.packing(), 20 * overlap, {});
  return follow(slow, held, {{-2 * way, -0.3 * way}, {}}, loaded_and_unloaded);
}

double largest_difference(const std::vector<RubbingLevel>& levels) {
  return std::ranges::max(levels, {}, &RubbingLevel::force).force;
}

/// \param most of the forces at each level
void check_levels(const std::vector<RubbingLevel>& levels, double most) {
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const RubbingLevel& level = levels[k];
    CAPTURE(k, level.why, level.open, level.counters.unchecked);
    CHECK(level.force < most);
    CHECK(level.other_contacts == std::vector<std::string>{});
    CHECK(level.ended == PathEnd::legs_done);
    CHECK(level.counters.not_unique == 0);
  }
}

}  // namespace

// The dashpots of moving contacts add to the force that friction allows: differences fall with the speed, from 5e-4
// here to 6e-5 at a tenth of it.
TEST_CASE("a_packing_whose_lid_moves_carries_the_forces_of_slow_motion") {
  const std::vector<RubbingLevel> levels = under_a_lid(1e-5, 8000);
  check_levels(levels, 1e-3);
  for (const char* mode : {"open", "close", "slip", "stick"}) {
    CAPTURE(mode);
    CHECK(levels.back().events.at(mode) > 2);
  }
  CHECK(levels.back().counters.unchecked == 0);
}

TEST_CASE("a_packing_with_forces_at_rest_carries_those_of_slow_motion_as_its_weight_grows") {
  constexpr double overlap = 1e-5;
  Vec2 box;
  const std::vector<Grain> discs = jammed_discs(100, overlap, box);
  SlowGrains slow(discs, box, {}, 8000);
  const double way = 0.004 * overlap;
  slow.push_to({{way, -way}, {}});
  const HeldDiscs held = held_discs(slow.packing(), 20 * overlap, {});
  const std::vector<RubbingLevel> levels =
      follow(slow, held, {{}, {2.5, -0.75}}, std::vector{0.25, 0.5, 0.75, 1.0, 0.5});
  check_levels(levels, 0.003);
  CHECK(levels.back().events.at("slip") > 50);
  CHECK(levels.back().events.at("stick") > 30);
}

TEST_CASE("a_crack_in_a_block_closes_slips_and_opens_as_in_slow_motion") {
  const CrackedBlock block(1e-7);
  SlowGrains slow(block.discs, block.box, block.bonds, 4000);
  const HeldDiscs held = held_discs(slow.packing(), 1e-3, block.bonds);
  CHECK(held.assembly.contacts.size() > block.bonds.size() + 10);
  const std::vector<double> to{0.25, 0.5, 1, 0.5, 0.25, 0.7};
  const std::vector<RubbingLevel> levels = follow(slow, held, {{5e-7, -1e-6}, {}}, to);
  check_levels(levels, 1e-3);
  for (const char* mode : {"open", "close", "slip", "stick"}) {
    CAPTURE(mode);
    CHECK(levels.back().events.at(mode) > 4);
  }
}

// Motions are small in statics; in the run contacts turn with the discs. What that changes does not depend on the
// speed: 8e-5, 8e-4 and 7e-3 of the largest force where discs overlap by 1e-4, 1e-3 and 1e-2 of their radius.
TEST_CASE("the_difference_to_slow_motion_falls_with_its_speed_and_with_the_overlaps") {
  const double fast = largest_difference(under_a_lid(1e-5, 2000)), slow = largest_difference(under_a_lid(1e-5, 8000));
  const double deep = largest_difference(under_a_lid(1e-2, 3000)),
               deep_slow = largest_difference(under_a_lid(1e-2, 6000));
  CAPTURE(fast, slow, deep, deep_slow);
  CHECK(slow < fast / 2);
  CHECK(deep_slow == Approx(deep).epsilon(0.1));
  CHECK(deep < 0.01);
  CHECK(deep_slow > 5 * slow);
}
