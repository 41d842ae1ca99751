// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/carried_forces.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

namespace equidem {
namespace {

/// Forces on i are the negatives of those on j; neither normal nor tangential force changes where i and j change
/// places.
ContactForce force_on_first(const GrainContact& contact) {
  return {-contact.normal_force, -contact.tangential_force};
}

/// The settled contact of the same bodies, of clumps the nearest; null where there is none.
class SettledContacts {
 public:
  explicit SettledContacts(const std::vector<GrainContact>& contacts) {
    for (const GrainContact& contact : contacts) {
      const bool swapped = contact.j >= 0 && contact.j < contact.i;
      by_bodies_[swapped ? std::pair(contact.j, contact.i) : std::pair(contact.i, contact.j)].push_back(
          {&contact, swapped ? contact.arm_j : contact.arm_i});
    }
  }

  [[nodiscard]] const GrainContact* find(const PackingContact& wanted) const {
    const auto found = by_bodies_.find({wanted.i, wanted.j});
    if (found == by_bodies_.end()) return nullptr;
    const auto distance = [&](const Placed& placed) { return norm(placed.arm - wanted.arm_i); };
    return std::ranges::min_element(found->second, {}, distance)->contact;
  }

 private:
  struct Placed {
    const GrainContact* contact;
    Vec2 arm;
  };
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<Placed>> by_bodies_;
};

}  // namespace

std::vector<ContactForce> carried_forces(const GrainPacking& packing, const std::vector<PackingContact>& contacts,
                                         const std::optional<SpringConstants>& springs) {
  std::vector<ContactForce> forces;
  if (!packing.contacts.empty()) {
    const SettledContacts settled(packing.contacts);
    for (const PackingContact& contact : contacts) {
      const GrainContact* const found = contact.overlap > 0 ? settled.find(contact) : nullptr;
      forces.push_back(found == nullptr ? ContactForce{} : force_on_first(*found));
    }
  } else if (packing.jammed && springs) {
    for (const PackingContact& contact : contacts) forces.push_back({-springs->kN * std::max(contact.overlap, 0.0), 0});
  }
  return forces;
}

}  // namespace equidem
