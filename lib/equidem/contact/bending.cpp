// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/bending.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

double smaller_radius(const Assembly& assembly, std::size_t contact) {
  const Contact& c = assembly.contacts[contact];
  return std::min(assembly.radii[c.i], assembly.radii[c.j]);
}

void check(const ContactSprings& springs, const BendingOptions& options) {
  if (options.kM && options.bond_width) {
    bad_input("kM and bond_width are both given", "each says how stiff contacts are in bending", "Remove one of them");
  }
  const double value = options.kM.value_or(options.bond_width.value_or(0));
  if (!(value >= 0) || !std::isfinite(value)) {
    bad_input(fmt::format("{} = {}", options.kM ? "kM" : "bond_width", value), "contacts cannot resist bending with it",
              "Give a number of 0 or more");
  }
  if (!springs.any_negative()) return;
  bad_input("some kT is negative, and contacts resist bending",
            "with kT < 0 statics eliminates rotations, which resist nothing else, before it asks for stability",
            "Take kT >= 0, or no bending springs");
}

}  // namespace

double bond_width(const Assembly& assembly, std::size_t contact, const BendingOptions& options) {
  return options.bond_width.value_or(0) * 2 * smaller_radius(assembly, contact);
}

ContactSprings bending_springs(const Assembly& assembly, const ContactSprings& springs, const BendingOptions& options) {
  if (!options.given()) return springs;
  check(springs, options);
  std::vector<double> bending(assembly.contacts.size());
  constexpr double most = 1e10;  // leaves six digits of the normal stiffness
  bool differ = false;
  for (std::size_t c = 0; c < bending.size(); ++c) {
    const double width = bond_width(assembly, c, options), radius = smaller_radius(assembly, c), kN = springs[c].kN;
    bending[c] = options.kM ? *options.kM : kN * width * width / 12;
    differ |= bending[c] != bending.front();
    if (bending[c] <= most * kN * radius * radius) continue;
    bad_input(fmt::format("contact {} has kM = {:.3g} N beside kN r² = {:.3g} N", c, bending[c], kN * radius * radius),
              fmt::format("springs so ill-scaled lose the normal stiffness in the round-off of bending, from about "
                          "{:.0e} on",
                          most),
              "Choose kM nearer to kN r², which a bond as wide as the disc has a third of");
  }
  if (std::all_of(bending.begin(), bending.end(), [](double kM) { return kM == 0; })) return springs;
  if (!differ) bending.resize(1);
  return springs.with_bending(std::move(bending));
}

}  // namespace equidem
