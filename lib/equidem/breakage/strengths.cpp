// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/strengths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// N/m, of strengths that are not 0: energies, which are squares over springs, then stay within a double.
constexpr double least_strength = 1e-100, largest_strength = 1e100;
constexpr double largest_friction = 1e6;

bool bearable(double strength) {
  return strength == 0 || (strength >= least_strength && strength <= largest_strength);
}

void check_strength(const char* name, double value) {
  if (bearable(value)) return;
  bad_input(fmt::format("the {} is {}", name, value),
            fmt::format("it must be 0, or lie between {:g} and {:g}", least_strength, largest_strength),
            "Correct it; a contact that never breaks has large strengths");
}

void check_friction(const char* name, double friction) {
  if (friction >= 0 && friction <= largest_friction) return;
  bad_input(fmt::format("the {} is {}", name, friction),
            fmt::format("it must be a number from 0 to {:g}", largest_friction), "Correct it");
}

/// \param why that of a strength which is out of range
void check_strengths(const ContactStrengths& strengths, const std::string& why, const std::string& what_to_do) {
  for (const auto* of_mode : {&strengths.tension, &strengths.shear}) {
    for (std::size_t c = 0; c < of_mode->size(); ++c) {
      if (bearable((*of_mode)[c])) continue;
      bad_input(fmt::format("contact {} has the strength {} N/m, which must be 0, or lie between {:g} and {:g}", c,
                            (*of_mode)[c], least_strength, largest_strength),
                why, what_to_do);
    }
  }
}

void check_options(const StrengthOptions& options) {
  if (options.tension) check_strength("strength in tension", *options.tension);
  if (options.shear) check_strength("strength in shear", *options.shear);
  check_friction("friction", options.friction);
  for (const auto& [groups, across, strengths] : options.between) {
    check_strength("strength in tension", strengths.tension);
    check_strength("strength in shear", strengths.shear);
  }
  if (options.residual_friction) check_friction("residual friction", *options.residual_friction);
  if (options.weibull_modulus) check_positive(*options.weibull_modulus, "Weibull modulus");
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

/// Whether the segments a + [0, 1] u and b + [0, 1] v meet; parallel ones do not.
bool segments_meet(Vec2 a, Vec2 u, Vec2 b, Vec2 v) {
  const double area = cross(u, v);
  if (area == 0) return false;
  const double s = cross(b - a, v) / area, t = cross(b - a, u) / area;
  return s >= 0 && s <= 1 && t >= 0 && t <= 1;
}

}  // namespace

ContactStrengths contact_strengths(const Assembly& assembly, const StrengthOptions& options) {
  check_options(options);
  ContactStrengths result;
  result.friction = options.friction;
  result.beside_contact = options.after_breaking == AfterBreaking::parallel;
  const bool own = !assembly.contact_tension.empty(), given = options.tension || options.shear;
  if (own && given) {
    bad_input("the case gives strengths, and so does the assembly", "one of the two would not count",
              "Remove tension and shear from [strength], or the strengths from the assembly");
  }
  if (own) {
    if (options.weibull_modulus || options.bond_length != BondLength::none || !options.between.empty()) {
      bad_input("the strengths are those of the assembly",
                "a Weibull modulus, a bond length and strengths of groups change given ones only",
                "Remove weibull_modulus, bond_length and [[strength.between]]");
    }
    result.tension = assembly.contact_tension;
    result.shear = assembly.contact_shear;
    check_strengths(result, "energies of breaks would leave the range of numbers", "Correct it in the assembly");
    return result;
  }
  if (!options.tension || !options.shear) {
    bad_input(given ? "one of two strengths is missing" : "the strengths are missing",
              "a contact breaks in tension and in shear",
              "Give tension and shear in [strength], both 0 where no contact is a bond");
  }
  if (options.bond_length == BondLength::facet && assembly.facet_lengths.size() != assembly.contacts.size()) {
    bad_input("the strengths are stresses on facets", "the facets of this assembly are not known",
              "Take bond_length = \"smaller_diameter\", or strengths in N/m");
  }
  const PairStrengths elsewhere{*options.tension, *options.shear};
  const auto weaker = [](const PairStrengths& a, const PairStrengths& b) -> PairStrengths {
    return {std::min(a.tension, b.tension), std::min(a.shear, b.shear)};
  };
  std::vector<PairStrengths> of_groups;
  if (!options.between.empty())
    of_groups = Materials(assembly, options.between).of_contacts(elsewhere, options.between, weaker);
  Random random(options.seed);
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const double share =
        options.weibull_modulus ? std::pow(-std::log1p(-random.uniform()), 1 / *options.weibull_modulus) : 1;
    const double size = share * length_of(assembly, c, options.bond_length);
    const PairStrengths of_contact = of_groups.empty() ? elsewhere : of_groups[c];
    result.tension.push_back(size * of_contact.tension);
    result.shear.push_back(size * of_contact.shear);
  }
  const double modulus = options.weibull_modulus.value_or(std::numeric_limits<double>::infinity());
  check_strengths(result,
                  std::isfinite(modulus)
                      ? fmt::format("a Weibull modulus of {:g} scatters them over that range", modulus)
                      : "energies of breaks would leave the range of numbers",
                  "Give a larger modulus, or strengths of a usual size");
  return result;
}

std::vector<std::size_t> contacts_across(const Assembly& assembly, std::span<const Notch> notches) {
  std::vector<std::size_t> crossed;
  std::vector<std::size_t> count(notches.size(), 0);
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const Vec2 branch = assembly.branch(contact);
    bool any = false;
    for (std::size_t k = 0; k < notches.size(); ++k) {
      const Vec2 along = notches[k].to - notches[k].from;
      if (!segments_meet(assembly.centres[contact.i], branch, notches[k].from, along) &&
          !segments_meet(assembly.centres[contact.j], -branch, notches[k].from, along)) {
        continue;
      }
      ++count[k];
      any = true;
    }
    if (any) crossed.push_back(c);
  }
  for (std::size_t k = 0; k < notches.size(); ++k) {
    if (count[k] > 0) continue;
    const auto& [from, to] = notches[k];
    bad_input(
        fmt::format("the notch from ({:g}, {:g}) to ({:g}, {:g}) m crosses no contact", from.x, from.y, to.x, to.y),
        "it would cut nothing", "Give its ends inside the assembly, more than a disc apart");
  }
  return crossed;
}

}  // namespace equidem
