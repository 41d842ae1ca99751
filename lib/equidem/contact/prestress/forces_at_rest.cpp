// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/prestress/forces_at_rest.hpp"

#include <algorithm>
#include <cmath>

namespace equidem {
namespace {

bool is_loaded(const ContactForce& force) {
  return force.normal != 0 || force.tangential != 0;
}

}  // namespace

bool carries_forces(const Assembly& assembly) {
  for (std::size_t c = 0; c < assembly.contact_normal_force.size(); ++c)
    if (is_loaded(force_at_rest(assembly, c))) return true;
  return false;
}

RestBalance balance_at_rest(const Assembly& assembly, const std::vector<std::int32_t>& held) {
  RestBalance balance;
  if (assembly.contact_normal_force.empty()) return balance;
  std::vector<Vec2> forces(assembly.size());
  std::vector<double> moments(assembly.size());
  double sum = 0;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const ContactForce force = force_at_rest(assembly, c);
    if (!is_loaded(force)) continue;
    const Contact& contact = assembly.contacts[c];
    const auto i = static_cast<std::size_t>(contact.i), j = static_cast<std::size_t>(contact.j);
    const ContactFrame frame = frame_of(assembly, c);
    const Vec2 on_i = force_on_i(frame, force);
    forces[i] += on_i;
    forces[j] -= on_i;
    moments[i] += moment_on_i(frame, force);
    moments[j] += moment_on_j(frame, force);
    sum += norm(on_i);
    ++balance.loaded;
  }
  if (balance.loaded == 0) return balance;
  balance.mean_force = sum / static_cast<double>(balance.loaded);
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    const auto disc = static_cast<std::int32_t>(d);
    if (std::ranges::binary_search(held, disc)) continue;
    if (norm(forces[d]) > balance.largest_force) {
      balance.largest_force = norm(forces[d]);
      balance.disc_of_force = disc;
    }
    if (std::abs(moments[d]) > balance.largest_moment) {
      balance.largest_moment = std::abs(moments[d]);
      balance.disc_of_moment = disc;
    }
  }
  balance.relative =
      std::max(balance.largest_force, balance.largest_moment / assembly.mean_radius()) / balance.mean_force;
  return balance;
}

}  // namespace equidem
