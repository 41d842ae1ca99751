// SPDX-License-Identifier: GPL-3.0-or-later
#include "sukegawa2010/printed_discs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem::sukegawa2010 {
namespace {

constexpr double margin_share = 0.2;  // margin of the list of near pairs, of the smallest radius
constexpr std::size_t columns_of_contact = 5;
constexpr double clearly_apart = 1 + 1e-9;  // distance over reach that needs no root

double dashpot(double damping, double mass, double stiffness) {
  return 2 * damping * std::sqrt(mass * stiffness);
}

}  // namespace

PrintedDiscs::PrintedDiscs(const GrainScene& scene, const PrintedOptions& options)
    : AnySimulation(BodyFamily::colliding, options.time_step), scene_(scene), options_(options) {
  double smallest = INFINITY;
  for (const Grain& grain : scene_.grains) {
    bodies_.push_back({.radius = grain.radius,
                       .inverse_mass = 1 / grain.inertia.mass,
                       .inverse_moment = 1 / grain.inertia.moment,
                       .place = {grain.position, grain.angle},
                       .velocity = {grain.velocity, grain.spin}});
    smallest = std::min(smallest, grain.radius);
  }
  margin_ = margin_share * smallest;
  for (const Wall& wall : scene_.walls) wall_places_.push_back(wall.displacement(0));
  wall_increments_.resize(wall_places_.size());
  find_near();
  potential_at_start_ = 0;
  potential_at_start_ = energy().potential;
}

const PairProperties& PrintedDiscs::properties(const Near& near) const {
  const int i = scene_.grains[static_cast<std::size_t>(near.i)].kind;
  return scene_.between(i, near.j >= 0 ? scene_.grains[static_cast<std::size_t>(near.j)].kind
                                       : scene_.walls[static_cast<std::size_t>(~near.j)].kind);
}

void PrintedDiscs::find_near() {
  std::vector<Circle> circles;
  for (const Body& body : bodies_) circles.push_back({body.place.u, options_.beta * body.radius});
  const NeighbourList& list = finder_.within(circles, margin_);
  const std::vector<Near> before = std::exchange(near_, {});
  std::size_t old = 0;
  const auto add = [&](std::int32_t i, std::int32_t j) {
    Near near{.i = i, .j = j};
    const PairProperties& pair = properties(near);
    near.pair = &pair;
    const double inverse = bodies_[static_cast<std::size_t>(i)].inverse_mass;
    const double mass = j >= 0 ? 2 / (inverse + bodies_[static_cast<std::size_t>(j)].inverse_mass) : 1 / inverse;
    near.normal_dashpot = dashpot(options_.damping, mass, pair.stiffness);
    near.tangential_dashpot = dashpot(options_.damping, mass, pair.tangential_ratio * pair.stiffness);
    while (old < before.size() && std::pair(before[old].i, before[old].j) < std::pair(i, j)) ++old;
    if (old < before.size() && before[old].i == i && before[old].j == j)
      near.normal = before[old].normal, near.tangential = before[old].tangential, near.overlap = before[old].overlap;
    near_.push_back(near);
  };
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const auto body = static_cast<std::int32_t>(i);
    for (std::size_t w = scene_.walls.size(); w-- > 0;) {
      const Wall& wall = scene_.walls[w];
      const double distance = dot(wall.normal, circles[i].centre - wall.point - wall_places_[w]);
      if (distance < circles[i].radius + margin_) add(body, ~static_cast<std::int32_t>(w));
    }
    for (auto k = list.begin[i]; k < list.begin[i + 1]; ++k) add(body, list.partner[static_cast<std::size_t>(k)]);
  }
  moved_ = 0;
}

void PrintedDiscs::add_forces(Near& near) {
  const PairProperties& pair = *near.pair;
  Body& a = bodies_[static_cast<std::size_t>(near.i)];
  Vec2 normal, slip = a.increment.u;
  double distance = 0, reach = a.radius, turn = a.radius * a.increment.theta;
  if (near.j >= 0) {
    const Body& b = bodies_[static_cast<std::size_t>(near.j)];
    const Vec2 to = b.place.u - a.place.u;
    reach += b.radius;
    if (squared(to) > squared(clearly_apart * options_.beta * reach)) {
      near.normal = near.tangential = 0;
      return;
    }
    distance = norm(to);
    normal = to / distance;
    slip -= b.increment.u;
    turn += b.radius * b.increment.theta;
  } else {
    const auto w = static_cast<std::size_t>(~near.j);
    const Wall& wall = scene_.walls[w];
    normal = -wall.normal;
    distance = dot(wall.normal, a.place.u - wall.point - wall_places_[w]);
    slip -= wall_increments_[w];
  }
  near.overlap = reach - distance;
  if (options_.beta * reach - distance <= 0) {  // (3.3)
    near.normal = near.tangential = 0;
    return;
  }
  const double du_n = dot(slip, normal), du_s = dot(slip, perpendicular(normal)) + turn;  // (3.11)
  near.normal += pair.stiffness * du_n;
  if (near.normal < 0) {  // (2.8), (2.15)
    near.normal = near.tangential = 0;
    return;
  }
  near.tangential += pair.tangential_ratio * pair.stiffness * du_s;
  const double limit = pair.friction * near.normal;
  double across = near.tangential_dashpot * du_s / options_.time_step;
  if (std::abs(near.tangential) > limit) near.tangential = std::copysign(limit, near.tangential);  // (2.16)
  if (pair.cap == FrictionCap::whole_force)
    across = std::clamp(near.tangential + across, -limit, limit) - near.tangential;
  const double along = near.normal + near.normal_dashpot * du_n / options_.time_step;
  across += near.tangential;
  const Vec2 force = along * normal + across * perpendicular(normal);  // (3.12)
  a.force.u -= force;
  a.force.theta -= a.radius * across;
  if (near.j >= 0) {
    Body& b = bodies_[static_cast<std::size_t>(near.j)];
    b.force.u += force;
    b.force.theta -= b.radius * across;
  }
}

void PrintedDiscs::move() {
  const double dt = options_.time_step;
  // c_i R²/I = 2 c_i/m
  const double damped = options_.mass_damping, damped_turn = 2 * options_.mass_damping;
  const double before = options_.integrator == PrintedOptions::Integrator::printed ? 0.5 * dt : 0, after = dt - before;
  double longest = 0;
  for (Body& body : bodies_) {
    const DiscMotion old = body.velocity;
    body.velocity.u += dt * (body.inverse_mass * body.force.u + scene_.gravity - damped * old.u);
    body.velocity.theta += dt * (body.inverse_moment * body.force.theta - damped_turn * old.theta);
    body.increment = {before * old.u + after * body.velocity.u, before * old.theta + after * body.velocity.theta};
    body.place.u += body.increment.u;
    body.place.theta += body.increment.theta;
    body.force = {};
    longest = std::max(longest, squared(body.increment.u));
  }
  if (!std::isfinite(longest)) {
    computation_failed(fmt::format("motions are not finite in step {}", step_), "the step is too long for the loop",
                       "Give a shorter one");
  }
  ++step_;
  double wall_motion = 0;
  for (std::size_t w = 0; w < wall_places_.size(); ++w) {
    const Vec2 place = scene_.walls[w].displacement(time());
    wall_increments_[w] = place - wall_places_[w];
    wall_places_[w] = place;
    wall_motion = std::max(wall_motion, norm(wall_increments_[w]));
  }
  moved_ += 2 * std::max(std::sqrt(longest), wall_motion);
}

void PrintedDiscs::make_step() {
  if (moved_ > margin_) find_near();
  for (Near& near : near_) add_forces(near);
  move();
}

void PrintedDiscs::advance(std::int64_t steps) {
  for (std::int64_t k = 0; k < steps; ++k) make_step();
}

std::vector<DiscMotion> PrintedDiscs::motions() const {
  std::vector<DiscMotion> all;
  for (const Body& body : bodies_) all.push_back(body.place);
  return all;
}

std::vector<DiscMotion> PrintedDiscs::velocities() const {
  std::vector<DiscMotion> all;
  for (const Body& body : bodies_) all.push_back(body.velocity);
  return all;
}

EnergyLedger PrintedDiscs::energy() const {
  EnergyLedger ledger;
  for (const Body& body : bodies_) {
    ledger.kinetic +=
        0.5 * (squared(body.velocity.u) / body.inverse_mass + squared(body.velocity.theta) / body.inverse_moment);
    ledger.potential -= dot(scene_.gravity, body.place.u) / body.inverse_mass;
  }
  ledger.potential -= potential_at_start_;
  return ledger;
}

double PrintedDiscs::bytes_per_body() const {
  return sizeof(Body) + static_cast<double>(near_.capacity() * sizeof(Near)) / static_cast<double>(bodies_.size());
}

std::vector<Grain> PrintedDiscs::grains() const {
  std::vector<Grain> grains = scene_.grains;
  for (std::size_t g = 0; g < grains.size(); ++g) {
    grains[g].position = bodies_[g].place.u, grains[g].angle = bodies_[g].place.theta;
    grains[g].velocity = bodies_[g].velocity.u, grains[g].spin = bodies_[g].velocity.theta;
  }
  return grains;
}

std::vector<GrainContact> PrintedDiscs::contacts() const {
  std::vector<GrainContact> contacts;
  for (const Near& near : near_) {
    if (near.normal <= 0) continue;
    GrainContact contact;
    contact.i = near.i;
    contact.j = near.j;
    contact.overlap = near.overlap;
    contact.normal_force = near.normal;
    contact.tangential_force = near.tangential;
    contacts.push_back(contact);
  }
  return contacts;
}

SavedState PrintedDiscs::save() const {
  std::vector<DiscMotion> increments;
  for (const Body& body : bodies_) increments.push_back(body.increment);
  std::vector<double> contacts, walls;
  for (const Near& near : near_) {
    contacts.insert(contacts.end(), {static_cast<double>(near.i), static_cast<double>(near.j), near.normal,
                                     near.tangential, near.overlap});
  }
  for (std::size_t w = 0; w < wall_places_.size(); ++w) {
    walls.insert(walls.end(), {wall_places_[w].x, wall_places_[w].y, wall_increments_[w].x, wall_increments_[w].y});
  }
  return {.step = step_,
          .arrays = {{"motions", 3, numbers_of(motions())},
                     {"velocities", 3, numbers_of(velocities())},
                     {"increments", 3, numbers_of(increments)},
                     {"contacts", columns_of_contact, contacts},
                     {"walls", 4, walls}}};
}

void PrintedDiscs::restore(const SavedState& state) {
  const auto places = motions_of(state["motions"]), velocities = motions_of(state["velocities"]),
             increments = motions_of(state["increments"]);
  if (places.size() != bodies_.size()) {
    bad_input(fmt::format("the state has {} discs, the scene {}", places.size(), bodies_.size()),
              "they belong together", "Use the scene that the state was saved from");
  }
  for (std::size_t g = 0; g < bodies_.size(); ++g) {
    bodies_[g].place = places[g], bodies_[g].velocity = velocities[g], bodies_[g].increment = increments[g];
  }
  const std::vector<double>&rows = state["contacts"], &walls = state["walls"];
  near_.clear();
  for (std::size_t r = 0; r + columns_of_contact <= rows.size(); r += columns_of_contact) {
    near_.push_back({.i = static_cast<std::int32_t>(rows[r]),
                     .j = static_cast<std::int32_t>(rows[r + 1]),
                     .normal = rows[r + 2],
                     .tangential = rows[r + 3],
                     .overlap = rows[r + 4]});
  }
  for (std::size_t w = 0; w < wall_places_.size(); ++w) {
    wall_places_[w] = {walls[4 * w], walls[4 * w + 1]};
    wall_increments_[w] = {walls[4 * w + 2], walls[4 * w + 3]};
  }
  step_ = state.step;
  find_near();  // the list differs from that of an uninterrupted run, its contacts do not
}

}  // namespace equidem::sukegawa2010
