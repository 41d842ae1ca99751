// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/stages/unbalance.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "equidem/grains/cell/periodic_cell.hpp"
#include "equidem/grains/cell/periodic_images.hpp"

namespace equidem {
namespace {

/// Grains that are one body.
struct RestingBody {
  std::vector<std::size_t> grains;
  std::vector<Vec2> places;  ///< of the grains, beside one another where they are in a periodic cell, m
  Vec2 centre{};             ///< of mass, m
  double radius = 0;         ///< of the circle about the centre that holds all grains, m
};

/// The bodies of a scene, and of each grain the number of its body.
class RestingBodies {
 public:
  RestingBodies(const std::vector<Grain>& grains, std::span<const GrainBond> bonds,
                const std::optional<PeriodicCell>& cell)
      : of_(grains.size(), none), tied_(grains.size()) {
    for (const GrainBond& bond : bonds) {
      if (bond.has_springs()) continue;
      tied_[bond.i].push_back(bond.j);
      tied_[bond.j].push_back(bond.i);
    }
    for (std::size_t grain = 0; grain < grains.size(); ++grain)
      if (of_[grain] == none) add_body(grain, grains, cell);
  }

  [[nodiscard]] std::size_t of(std::size_t grain) const { return of_[grain]; }
  [[nodiscard]] const std::vector<RestingBody>& all() const { return bodies_; }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  void add_body(std::size_t first, const std::vector<Grain>& grains, const std::optional<PeriodicCell>& cell) {
    RestingBody body{.grains = {first}, .places = {grains[first].position}};
    of_[first] = bodies_.size();
    for (std::size_t k = 0; k < body.grains.size(); ++k) {
      for (const std::size_t other : tied_[body.grains[k]]) {
        if (of_[other] != none) continue;
        of_[other] = bodies_.size();
        Vec2 branch = grains[other].position - grains[body.grains[k]].position;
        if (cell) {
          const Periods periods = periods_of(*cell);
          branch += periods.shift(image_inside(periods, {}, branch));
        }
        body.grains.push_back(other);
        body.places.push_back(body.places[k] + branch);
      }
    }
    double mass = 0;
    for (std::size_t k = 0; k < body.grains.size(); ++k) {
      const double own = grains[body.grains[k]].inertia.mass;
      mass += own;
      body.centre += own / mass * (body.places[k] - body.centre);
    }
    for (std::size_t k = 0; k < body.grains.size(); ++k)
      body.radius = std::max(body.radius, norm(body.places[k] - body.centre) + grains[body.grains[k]].radius);
    bodies_.push_back(std::move(body));
  }

  std::vector<std::size_t> of_;
  std::vector<std::vector<std::size_t>> tied_;
  std::vector<RestingBody> bodies_;
};

struct Load {
  Vec2 force;
  double moment = 0;  ///< about the centre of the grain
};

}  // namespace

Unbalance unbalance_of(const GrainSimulation& simulation, std::span<const GrainBond> bonds, Vec2 gravity) {
  const std::vector<Grain> grains = simulation.grains();
  const RestingBodies bodies(grains, bonds, simulation.placed_cell());
  std::vector<Load> loads(grains.size());
  for (std::size_t k = 0; k < grains.size(); ++k) loads[k].force = grains[k].inertia.mass * gravity;
  // of body_contacts() those of contacts() come first, with an arm to each body as the step has taken it
  const std::vector<GrainContact> contacts = simulation.contacts();
  double carried = 0, carriers = 0;
  std::size_t number = 0;
  for (const BodyContact& contact : simulation.body_contacts()) {
    const std::size_t c = number++;
    const auto i = static_cast<std::size_t>(contact.i), j = static_cast<std::size_t>(contact.j);
    if (contact.j >= 0 && bodies.of(i) == bodies.of(j)) continue;
    loads[i].force += contact.force;
    loads[i].moment += cross(contact.arm, contact.force) + contact.bending_moment;
    if (contact.j >= 0) {
      const Vec2 arm = c < contacts.size() ? contacts[c].arm_j
                                           : contact.arm - (grains[j].position + contact.shift - grains[i].position);
      loads[j].force -= contact.force;
      loads[j].moment -= cross(arm, contact.force) + contact.bending_moment;
    }
    carried += norm(contact.force);
    carriers += 1;
  }
  double sum = 0, largest = 0;
  for (const RestingBody& body : bodies.all()) {
    Load all;
    for (std::size_t k = 0; k < body.grains.size(); ++k) {
      const Load& load = loads[body.grains[k]];
      all.force += load.force;
      all.moment += load.moment + cross(body.places[k] - body.centre, load.force);
    }
    const double unbalanced = std::hypot(norm(all.force), all.moment / body.radius);
    sum += unbalanced;
    largest = std::max(largest, unbalanced);
  }
  const double mean = carriers > 0 ? carried / carriers : 0;
  if (!(mean > 0)) return {INFINITY, INFINITY};
  return {sum / static_cast<double>(bodies.all().size()) / mean, largest / mean};
}

}  // namespace equidem
