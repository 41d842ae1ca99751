// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/internal_force.hpp"

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr std::size_t grain = 1 << 13;

}  // namespace

void PreciseMotion::add(std::span<const double> correction) {
  for (std::size_t k = 0; k < high.size(); ++k) {
    const double add = low[k] + correction[k];
    const double sum = high[k] + add;
    const double rounded = sum - high[k];  // two-sum (Knuth): exact remainder of high + add
    low[k] = (high[k] - (sum - rounded)) + (add - rounded);
    high[k] = sum;
  }
}

void contact_forces_of(const Assembly& assembly, const ContactSprings& springs,
                       const DegreesOfFreedom& unknowns, const PreciseMotion& motion,
                       std::span<ContactForce> forces) {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  parallel_ranges(assembly.contacts.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const Contact& contact = assembly.contacts[c];
      const ContactFrame frame = frame_of(assembly, contact);
      const std::size_t i = contact.i * b, j = contact.j * b;
      const auto difference = [&](std::size_t k) {
        return (motion.high[j + k] - motion.high[i + k]) + (motion.low[j + k] - motion.low[i + k]);
      };
      const Vec2 du{difference(0), difference(1)};
      ContactDeformation d{dot(du, frame.normal), dot(du, frame.tangent())};
      if (b == 3) {
        const double turn_i = motion.high[i + 2] + motion.low[i + 2],
                     turn_j = motion.high[j + 2] + motion.low[j + 2];
        d.tangential -= (frame.lever_i * turn_i + frame.lever_j * turn_j) / unknowns.rotation_scale;
      }
      forces[c] = linear_spring_force(springs[c], d);
    }
  });
}

void internal_force(const Assembly& assembly, const ContactGraph& graph, const DegreesOfFreedom& unknowns,
                    std::span<const ContactForce> forces, std::span<double> result) {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  parallel_ranges(assembly.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t d = begin; d < end; ++d) {
      Vec2 force;
      double moment = 0;
      for (const auto& edge : graph.of(d)) {
        const Contact& contact = assembly.contacts[edge.contact];
        const ContactForce& f = forces[edge.contact];
        const ContactFrame frame = frame_of(assembly, contact);
        if (static_cast<std::size_t>(contact.i) == d) {
          force += force_on_i(frame, f);
          moment += frame.lever_i * f.tangential;
        }
        if (static_cast<std::size_t>(contact.j) == d) {
          force -= force_on_i(frame, f);
          moment += frame.lever_j * f.tangential;
        }
      }
      result[d * b] = -force.x;
      result[d * b + 1] = -force.y;
      if (b == 3) result[d * b + 2] = -moment / unknowns.rotation_scale;
    }
  });
}

std::vector<double> contact_moments(const Assembly& assembly, std::span<const ContactForce> forces) {
  std::vector<double> moments(assembly.size(), 0.0);
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    moments[contact.i] += contact.lever_i * forces[c].tangential;
    moments[contact.j] += contact.lever_j * forces[c].tangential;
  }
  return moments;
}

}  // namespace equidem
