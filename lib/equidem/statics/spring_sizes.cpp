// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/spring_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

template <typename Change>
ContactSprings changed(const Assembly& assembly, const ContactSprings& springs, const Change& change) {
  if (springs.uniform()) return ContactSprings(change(springs[0]));
  std::vector<SpringConstants> each(assembly.contacts.size());
  for (std::size_t c = 0; c < each.size(); ++c) each[c] = change(springs[c]);
  return ContactSprings(std::move(each));
}

}  // namespace

ContactSprings equal_springs(const Assembly& assembly, const ContactSprings& springs) {
  return changed(assembly, springs, [](SpringConstants k) {
    return SpringConstants{k.kN != 0 ? 1.0 : 0.0, k.kT != 0 ? 1.0 : 0.0};
  });
}

ContactSprings scaled_springs(const Assembly& assembly, const ContactSprings& springs, double factor) {
  return changed(assembly, springs, [factor](SpringConstants k) {
    return SpringConstants{factor * k.kN, factor * k.kT};
  });
}

double spring_unit(const ContactSprings& springs) {
  const double largest = springs.largest();
  constexpr int least = -1000;  // its inverse does not overflow
  return largest > 0 ? std::ldexp(1.0, std::max(least, std::ilogb(largest))) : 1.0;
}

double spring_spread(const Assembly& assembly, const ContactSprings& springs) {
  double smallest = springs.largest();
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const SpringConstants k = springs[c];
    smallest = std::min(smallest, k.kN);
    if (k.kT != 0) smallest = std::min(smallest, std::abs(k.kT));
  }
  return springs.largest() / smallest;
}

void refuse_spread(double spread) {
  bad_input(fmt::format("the springs differ by a factor of {:.1e}", spread),
            "the softest of them is lost in the round-off of the stiffest",
            "Choose springs within a factor of 1e10 of each other");
}

}  // namespace equidem
