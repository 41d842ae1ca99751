// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs between walls in motion that is loaded slowly, and the same discs for statics.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "equidem/breakage/strengths.hpp"
#include "equidem/breakage/unbonded/unbonded_run.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/size_distribution.hpp"

#include "breakage/scenes.hpp"

namespace equidem::test {

inline constexpr SpringConstants frictional_springs{1e8, 5e7};
inline constexpr double sliding_friction = 0.3, frictional_density = 2500;

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
    options.springs = frictional_springs;
    options.damping = 0.5;
    options.friction = options.wall_friction = sliding_friction;
    scene_ = scene_of_box(box.x, options);
    scene_.walls = walls_of({box, PackingBox::Sides::walls});
    scene_.grains = std::move(grains);
    scene_.bonds = std::move(bonds);
    options_ = {.law = NormalLaw::linear_dashpot, .integrator = GrainOptions::Integrator::velocity_verlet};
    options_.time_step = 0.2 * contact_step_limit(scene_, options);
    parts_ = std::llround(steps / steps_a_part);
    push_to({});
  }

  /// Goes there along a smooth way, and stays until nothing moves any more.
  void push_to(const Push& to) {
    const double begin = at_.lid == Vec2{} && to.lid == Vec2{} ? 0 : time_;
    const double whole = static_cast<double>(parts_ * steps_a_part) * options_.time_step;
    const auto way = [&](double a, double b) {
      Schedule schedule{.kind = Schedule::Kind::table};
      constexpr int pieces = 1000;
      for (int k = 0; k <= pieces; ++k) {
        const double share = static_cast<double>(k) / pieces;
        schedule.times.push_back(begin + share * whole);
        schedule.values.push_back(a + share * share * (3 - 2 * share) * (b - a));
      }
      return schedule;
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
      for (const BodyContact& c : run.body_contacts()) forces_[{c.i, c.j}] = {c.normal_force, c.tangential_force};
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
  [[nodiscard]] const std::vector<Grain>& grains() const { return grains_; }
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

/// The discs as an assembly for statics: those behind the lid are the group "lid", behind other walls "walls".
struct HeldDiscs {
  Assembly assembly;
  ContactStrengths strengths;
  UnbondedOptions options{sliding_friction, {}};
  std::vector<std::pair<std::int32_t, std::int32_t>> bodies;  // of contacts
  std::vector<double> masses;                                 // of the discs that are no walls
};

/// \param gaps tolerance of contacts that are open, of the sum of the radii
/// \param bonds contacts of other discs have none
inline HeldDiscs held_discs(const GrainPacking& packing, double gaps, std::span<const GrainBond> bonds) {
  HeldDiscs held;
  const HeldNetwork network = held_network_of(packing, {.springs = frictional_springs, .gap_tolerance = gaps});
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
      force.normal = frictional_springs.kN * std::max(0.0, body[j] < 0 ? gap / 2 : gap);
    }
    held.options.rest.push_back(force);
  }
  return held;
}

/// Discs that jammed in a box of walls, without those that nothing touches.
inline std::vector<Grain> jammed_discs(std::int64_t discs, double overlap, Vec2& box) {
  PackingOptions options;
  Random random(11);
  options.radii = draw_radii({.smallest = 0.005, .largest = 0.01}, discs, random);
  const double side = std::sqrt(area_of(PackingShape{}, options.radii) / 0.5);
  options.box = {box = {side, side}, PackingBox::Sides::walls};
  options.as_dense_as_possible = true;
  options.overlap = overlap;
  options.settling.density = frictional_density;
  const GrainPacking packing = pack(options);
  std::vector<Grain> grains;
  for (const std::int32_t body : held_network_of(packing, {}).bodies)
    grains.push_back(packing.grains[static_cast<std::size_t>(body)]);
  return grains;
}

}  // namespace equidem::test
