// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/prestress/forces_at_rest.hpp"

#include <algorithm>
#include <cmath>

namespace equidem {
namespace {

constexpr double largest_round_off = 1e-12;  // of the largest force: such as solve leaves where a contact carries none

bool is_loaded(const ContactForce& force) {
  return force.normal != 0 || force.tangential != 0;
}

}  // namespace

bool carries_forces(const Assembly& assembly) {
  for (std::size_t c = 0; c < assembly.contact_normal_force.size(); ++c)
    if (is_loaded(force_at_rest(assembly, c))) return true;
  return false;
}

RestSums sums_at_rest(const Assembly& assembly) {
  RestSums sums{std::vector<Vec2>(assembly.size()), std::vector<double>(assembly.size())};
  std::vector<double> magnitudes;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const ContactForce force = force_at_rest(assembly, c);
    if (!is_loaded(force)) continue;
    const Contact& contact = assembly.contacts[c];
    const auto i = static_cast<std::size_t>(contact.i), j = static_cast<std::size_t>(contact.j);
    const ContactFrame frame = frame_of(assembly, c);
    const Vec2 on_i = force_on_i(frame, force);
    sums.forces[i] += on_i;
    sums.forces[j] -= on_i;
    sums.moments[i] += moment_on_i(frame, force);
    sums.moments[j] += moment_on_j(frame, force);
    magnitudes.push_back(norm(on_i));
  }
  if (magnitudes.empty()) return sums;
  const double largest = *std::ranges::max_element(magnitudes);
  for (const double force : magnitudes) {
    if (force <= largest_round_off * largest) continue;
    sums.mean_force += force;
    ++sums.loaded;
  }
  if (sums.loaded > 0) sums.mean_force /= static_cast<double>(sums.loaded);
  return sums;
}

RestBalance balance_at_rest(const Assembly& assembly, const std::vector<std::int32_t>& held) {
  const RestSums sums = sums_at_rest(assembly);
  RestBalance balance;
  balance.loaded = sums.loaded;
  balance.mean_force = sums.mean_force;
  if (balance.loaded == 0) return balance;
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    const auto disc = static_cast<std::int32_t>(d);
    if (std::ranges::binary_search(held, disc)) continue;
    if (norm(sums.forces[d]) > balance.largest_force) {
      balance.largest_force = norm(sums.forces[d]);
      balance.disc_of_force = disc;
    }
    if (std::abs(sums.moments[d]) > balance.largest_moment) {
      balance.largest_moment = std::abs(sums.moments[d]);
      balance.disc_of_moment = disc;
    }
  }
  balance.relative =
      std::max(balance.largest_force, balance.largest_moment / assembly.mean_radius()) / balance.mean_force;
  return balance;
}

}  // namespace equidem
