// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/chosen_springs.hpp"

#include <cstddef>
#include <utility>

namespace equidem {

ContactSprings chosen_springs(const ContactSprings& springs, const std::vector<std::int32_t>& contacts) {
  ContactSprings result = springs.with_prestress({});
  std::vector<double> bending = springs.bending_springs();
  if (bending.size() > 1) {
    bending.clear();
    for (const std::int32_t c : contacts) bending.push_back(springs.bending(static_cast<std::size_t>(c)));
  }
  if (!springs.uniform() && !contacts.empty()) {
    std::vector<SpringConstants> each;
    each.reserve(contacts.size());
    for (const std::int32_t c : contacts) each.push_back(springs[static_cast<std::size_t>(c)]);
    result = ContactSprings(std::move(each));
  }
  if (!contacts.empty()) result = result.with_bending(std::move(bending));
  if (!springs.prestressed()) return result;
  std::vector<ContactPrestress> prestress;
  prestress.reserve(contacts.size());
  for (const std::int32_t c : contacts) prestress.push_back(*springs.prestress(static_cast<std::size_t>(c)));
  return result.with_prestress(std::move(prestress));
}

}  // namespace equidem
