// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Assemblies of every kind and random fields on them.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/random.hpp"

#include "support/refusal.hpp"

namespace samples {

using namespace equidem;

struct Sample {
  std::string name;
  Assembly assembly;
};

/// Small assemblies of every kind, all with cells and with contacts whose levers add up to their branch.
inline std::vector<Sample> assemblies(bool periodic) {
  const LatticeOptions lattice{.columns = 8, .rows = 6, .radius = 0.005, .periodic = periodic};
  const auto random = [&](PointProcess points, double largest) {
    return delaunay_assembly({.discs = 150,
                              .points = points,
                              .disorder = 0.2,
                              .seed = 3,
                              .radii = {.smallest = 0.004, .largest = largest},
                              .aspect = 1.5,
                              .periodic = periodic});
  };
  return {{"hexagonal", hexagonal_lattice(lattice)},
          {"square", square_lattice(lattice)},
          {"perturbed hexagonal", random(PointProcess::perturbed_hexagonal, 0.004)},
          {"Poisson disc, radii 4 to 5 mm", random(PointProcess::poisson_disc, 0.005)}};
}

inline Tensor2 random_tensor(Random& random) {
  const auto draw = [&] { return random.uniform(-1, 1); };
  const double xx = draw(), xy = draw(), yx = draw(), yy = draw();
  return {xx, xy, yx, yy};
}

inline std::vector<ContactForce> random_forces(const Assembly& assembly, std::uint64_t seed) {
  Random random(seed);
  std::vector<ContactForce> forces(assembly.contacts.size());
  for (ContactForce& f : forces) {
    f.normal = random.uniform(-1, 1);
    f.tangential = random.uniform(-1, 1);
  }
  return forces;
}

/// The average of the stresses of the discs that are inside, weighted by their cells.
template <typename Inside>
Tensor2 average_stress(const Assembly& assembly, const std::vector<Tensor2>& stresses, const Inside& inside) {
  Tensor2 sum;
  double area = 0;
  for (std::size_t disc = 0; disc < stresses.size(); ++disc) {
    if (!inside(disc)) continue;
    sum += assembly.cell_areas[disc] * stresses[disc];
    area += assembly.cell_areas[disc];
  }
  return (1 / area) * sum;
}

/// Largest component by magnitude.
inline double largest(const Tensor2& t) {
  return std::max({std::abs(t.xx), std::abs(t.xy), std::abs(t.yx), std::abs(t.yy)});
}

inline double difference(const Tensor2& a, const Tensor2& b) {
  return largest(a + (-1.0) * b);
}

inline std::string shown(const Tensor2& t) {
  return "(" + std::to_string(t.xx) + ", " + std::to_string(t.xy) + "; " + std::to_string(t.yx) + ", " +
         std::to_string(t.yy) + ")";
}

/// The message of the Error that `call` throws; empty where it throws none.
template <typename Call>
std::string message_of(Call call) {
  return test::refusal_of([&] { call(); }).message;
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Force and moment (about its centre) that the contacts exert on every disc.
struct Resultant {
  Vec2 force;
  double moment = 0;
};

inline std::vector<Resultant> contact_resultants(const Assembly& assembly, const std::vector<ContactForce>& forces) {
  std::vector<Resultant> resultants(assembly.size());
  for (std::size_t c = 0; c < forces.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const ContactFrame frame = frame_of(assembly, c);
    const Vec2 on_i = force_on_i(frame, forces[c]);
    resultants[contact.i].force += on_i;
    resultants[contact.i].moment += cross(arm_of_i(frame), on_i);
    resultants[contact.j].force -= on_i;
    resultants[contact.j].moment += cross(-arm_to_j(frame), -on_i);
  }
  return resultants;
}

}  // namespace samples
