// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/motion_description.hpp"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cmath>

#include "equidem/assembly/touching.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

std::string describe_motion(const Assembly& assembly, std::span<const DiscMotion> motions) {
  assert(motions.size() == assembly.size());
  const auto turn_of = [&](std::size_t d) { return std::abs(assembly.radii[d] * motions[d].theta); };
  const auto size_of = [&](std::size_t d) {
    return std::max({std::abs(motions[d].u.x), std::abs(motions[d].u.y), turn_of(d)});
  };
  std::size_t first = 0, moving = 0;
  for (std::size_t d = 1; d < motions.size(); ++d)
    if (size_of(d) > size_of(first)) first = d;
  if (motions.empty() || !(size_of(first) > 0)) return "no motion";
  constexpr double at_rest = 1e-3;  // of the largest motion
  for (std::size_t d = 0; d < motions.size(); ++d)
    if (size_of(d) > at_rest * size_of(first)) ++moving;
  const bool turns = turn_of(first) == size_of(first);
  return fmt::format("a motion of {} of {}, most of all of {}, which {}", moving, counted(assembly.size(), "disc"),
                     describe_disc(assembly, first),
                     turns ? "turns" : "moves along " + describe_direction(motions[first].u));
}

std::string describe_direction(Vec2 direction) {
  constexpr double aligned = 1e-6;
  Vec2 n = direction / norm(direction);
  if (std::abs(n.y) < aligned) return "x";
  if (std::abs(n.x) < aligned) return "y";
  if (n.x < 0) n = -n;
  return fmt::format("({:.4g}, {:.4g})", n.x, n.y);
}

std::string describe_disc(const Assembly& assembly, std::size_t disc) {
  return fmt::format("disc {} at ({:.6g}, {:.6g})", disc, assembly.centres[disc].x, assembly.centres[disc].y);
}

std::string remedy_of_mechanisms(const Assembly& assembly, const ContactSprings& springs, bool rotation,
                                 std::vector<std::string> before) {
  std::vector<std::string> ways = std::move(before);
  ways.push_back("add contacts" + by_larger_tolerance(assembly));
  bool slides = false;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) slides |= springs[c].kT == 0;
  if (slides) ways.emplace_back("give the contacts tangential springs (kT > 0)");
  if (rotation && !springs.bends()) ways.emplace_back("give the contacts bending springs (kM > 0)");
  if (rotation) ways.emplace_back("restrain rotation");
  std::string text = ways.front();
  for (std::size_t k = 1; k < ways.size(); ++k) text += (k + 1 < ways.size() ? ", " : ", or ") + ways[k];
  text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  return text;
}

double elastic_energy(const Assembly& assembly, const ContactSprings& springs, std::span<const DiscMotion> motions) {
  double energy = 0;
  for (std::size_t k = 0; k < assembly.contacts.size(); ++k) {
    const Contact& c = assembly.contacts[k];
    const ContactDeformation d = deformation(frame_of(assembly, k), motions[c.i], motions[c.j]);
    energy += linear_spring_energy(springs[k], d);
    if (springs.bends()) energy += bending_energy(springs.bending(k), motions[c.i].theta, motions[c.j].theta);
    if (const ContactPrestress* const prestress = springs.prestress(k)) {
      const double theta_i = motions[c.i].theta, theta_j = motions[c.j].theta;
      energy += 0.5 * prestress_form(*prestress, d, theta_i, theta_j, d, theta_i, theta_j);
    }
  }
  return energy;
}

double reference_energy(const Assembly& assembly, const ContactSprings& springs, std::span<const DiscMotion> motions) {
  double energy = 0;
  for (std::size_t k = 0; k < assembly.contacts.size(); ++k) {
    const Contact& c = assembly.contacts[k];
    const DiscMotion& i = motions[c.i];
    const DiscMotion& j = motions[c.j];
    const ContactFrame frame = frame_of(assembly, k);
    energy +=
        0.5 * springs[k].kN *
            (dot(i.u, i.u) + dot(j.u, j.u) + squared(frame.offset_i * i.theta) + squared(frame.offset_j * j.theta)) +
        0.5 * std::abs(springs[k].kT) * (squared(frame.lever_i * i.theta) + squared(frame.lever_j * j.theta)) +
        0.5 * springs.bending(k) * (squared(i.theta) + squared(j.theta));
  }
  return energy;
}

double softness(const Assembly& assembly, const ContactSprings& springs, std::span<const DiscMotion> motions) {
  const double reference = reference_energy(assembly, springs, motions);
  return reference > 0 ? elastic_energy(assembly, springs, motions) / reference : 0;
}

}  // namespace equidem
