// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/strengths.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

void check_strength(const char* name, double value) {
  if (value >= 0 && std::isfinite(value)) return;
  bad_input(fmt::format("the {} is {}", name, value), "it must be finite and not negative",
            "Correct it; a contact that never breaks has large strengths");
}

void check_options(const StrengthOptions& options) {
  if (options.tension) check_strength("strength in tension", *options.tension);
  if (options.shear) check_strength("strength in shear", *options.shear);
  check_strength("friction", options.friction);
  if (options.residual_friction) check_strength("residual friction", *options.residual_friction);
  if (options.weibull_modulus) check_positive(*options.weibull_modulus, "the Weibull modulus");
}

double length_of(const Assembly& assembly, std::size_t contact, BondLength length) {
  const Contact& c = assembly.contacts[contact];
  switch (length) {
    case BondLength::none:
      return 1;
    case BondLength::facet:
      return assembly.facet_lengths[contact];
    case BondLength::smaller_diameter:
      return 2 * std::min(assembly.radii[c.i], assembly.radii[c.j]);
  }
  return 1;
}

}  // namespace

ContactStrengths contact_strengths(const Assembly& assembly, const StrengthOptions& options) {
  check_options(options);
  ContactStrengths result;
  result.friction = options.friction;
  const bool own = !assembly.contact_tension.empty(), given = options.tension || options.shear;
  if (own && given) {
    bad_input("the case gives strengths, and so does the assembly", "one of the two would not count",
              "Remove tension and shear from [strength], or the strengths from the assembly");
  }
  if (own) {
    if (options.weibull_modulus || options.bond_length != BondLength::none) {
      bad_input("the strengths are those of the assembly", "a Weibull modulus and a bond length change given ones only",
                "Remove weibull_modulus and bond_length");
    }
    result.tension = assembly.contact_tension;
    result.shear = assembly.contact_shear;
    return result;
  }
  if (!options.tension || !options.shear) {
    bad_input(given ? "one of two strengths is missing" : "the strengths are missing",
              "a contact breaks in tension and in shear", "Give tension and shear in [strength]");
  }
  if (options.bond_length == BondLength::facet && assembly.facet_lengths.size() != assembly.contacts.size()) {
    bad_input("the strengths are stresses on facets", "the facets of this assembly are not known",
              "Take bond_length = \"smaller_diameter\", or strengths in N/m");
  }
  Random random(options.seed);
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const double share =
        options.weibull_modulus ? std::pow(-std::log1p(-random.uniform()), 1 / *options.weibull_modulus) : 1;
    const double size = share * length_of(assembly, c, options.bond_length);
    result.tension.push_back(size * *options.tension);
    result.shear.push_back(size * *options.shear);
  }
  return result;
}

}  // namespace equidem
