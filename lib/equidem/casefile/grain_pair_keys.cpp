// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/grain_pair_keys.hpp"

#include "equidem/contact/laws/normal_law.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
using namespace casefile;
namespace {

using enum KeyType;

constexpr const char* none = KeySpec::none;

/// The names of the laws that have a property.
template <class Property>
std::vector<std::string> laws_with(const Property& property) {
  std::vector<std::string> names;
  for (const LawDescription& law : normal_laws()) {
    if (property(law)) names.emplace_back(law.name);
  }
  return names;
}

bool is_linear(const LawDescription& law) {
  return law.spring_power == 1;
}

/// "N/m (hertz_dashpot N/m^1.5; discs: per m of depth)"
std::string unit_of_stiffness() {
  std::string others;
  for (const LawDescription& law : normal_laws()) {
    if (!is_linear(law)) others += fmt::format("{} {}; ", law.name, law.stiffness_unit);
  }
  return fmt::format("N/m ({}discs: per m of depth)", others);
}

/// Name, letter, reference and summary of every law.
std::string help_of_laws() {
  std::string help;
  for (const LawDescription& law : normal_laws()) {
    const std::string source = *law.source ? std::string(", ") + law.source : "";
    help += fmt::format("{}{} ({}{}): {}", help.empty() ? "" : "; ", law.name, law.letter, source, law.summary);
  }
  return help;
}

/// What may be said of the contacts of every pair of bodies.
/// \param base the table says it for all: then restitution is needed, friction has a default, and keys are explained
std::vector<KeySpec> keys_of_contacts(const char* table, bool base) {
  const auto fallback = [&](const char* value) { return base ? value : none; };
  static const std::string stiffness_unit = unit_of_stiffness();
  std::vector<KeySpec> keys{
      {.table = table,
       .name = "restitution",
       .type = number,
       .fallback = none,
       .range = Range::from(0, 1),
       .help = "speed after over speed before, of two bodies that meet head-on without gravity; give it or damping"},
      {.table = table,
       .name = "damping",
       .type = number,
       .fallback = none,
       .range = {.low = 0, .high = 10, .low_open = true},
       .help =
           "h of the dashpots 2 h sqrt(m k), along and across, m the mass of a disc, as in [settling] of a packing; of "
           "laws with linear springs and dashpots"},
      {.table = table,
       .name = "contact_end",
       .type = choice,
       .fallback = none,
       .choices = {"zero_force", "zero_overlap"},
       .help = "of laws with a dashpot; zero_force: contacts never pull (default, but of hertz_dashpot); zero_overlap: "
               "they may pull while the bodies part"},
      {.table = table,
       .name = "stiffness",
       .type = number,
       .unit = stiffness_unit.c_str(),
       .fallback = none,
       .range = Range::positive(),
       .help = "k; give it or one of the next keys"},
      {.table = table,
       .name = "dimensionless_stiffness",
       .type = number,
       .fallback = none,
       .range = Range::positive(),
       .help =
           "a = k dt²/m, m the reduced mass: held whatever the step and the masses; a force k u^p: k d^(p - 1) dt²/m"},
      {.table = table,
       .name = "contact_duration",
       .type = number,
       .unit = "s",
       .fallback = none,
       .range = Range::positive(),
       .help = "until the overlap is zero again, the same for all masses; of linear springs"},
      {.table = table,
       .name = "largest_overlap",
       .type = number,
       .unit = "m",
       .fallback = none,
       .range = Range::positive(),
       .help = "not exceeded by two bodies that meet at closing_speed"},
      {.table = table,
       .name = "closing_speed",
       .type = number,
       .unit = "m/s",
       .fallback = none,
       .range = Range::positive(),
       .help = "of the fastest impact expected; for largest_overlap, and for an automatic step with springs that are "
               "not linear"},
      {.table = table,
       .name = "friction",
       .type = number,
       .fallback = fallback("0.0"),
       .range = Range::not_negative(),
       .help = "Coulomb's mu"},
      {.table = table,
       .name = "tangential_ratio",
       .type = number,
       .fallback = none,
       .range = {.low = 0, .high = 1e6},
       .help =
           "kT/kN of the tangential spring, with friction; left out: 2/7, with wave speeds theirs, and for the maps, "
           "which act in one or two steps, 0: no spring, contacts slide"},
      {.table = table,
       .name = "tangential_damping",
       .type = number,
       .fallback = none,
       .range = Range::not_negative(),
       .help = "zeta of the tangential dashpot; left out: 0, with damping that of its dashpot"},
      {.table = table,
       .name = "friction_cap",
       .type = choice,
       .fallback = fallback("\"whole_force\""),
       .choices = {"whole_force", "spring_alone"},
       .help = "what mu times the normal force limits: spring and dashpot together, or the spring alone"},
  };
  if (!base)
    for (KeySpec& key : keys) key.help = "";  // as in the base
  return keys;
}

}  // namespace

std::vector<KeySpec> keys_of_collisions() {
  static const std::string help = help_of_laws();
  const auto nonlinear = laws_with([](const LawDescription& law) { return !is_linear(law); });
  std::vector<KeySpec> keys{
      {.table = "collisions",
       .name = "law",
       .type = choice,
       .fallback = "\"exact_flow\"",
       .choices = laws_with([](const LawDescription&) { return true; }),
       .help = help.c_str()},
      {.table = "collisions",
       .name = "young_modulus",
       .type = number,
       .unit = "Pa",
       .fallback = none,
       .range = Range::positive(),
       .when_key = "law",
       .when = laws_with([](const LawDescription& law) { return law.hertz_spring; }),
       .help = "of all spheres, walls being rigid: k by Hertz; with poisson_ratio, instead of stiffness"},
      {.table = "collisions",
       .name = "poisson_ratio",
       .type = number,
       .fallback = none,
       .range = {.low = -1, .high = 0.5, .low_open = true},
       .help = "of all bodies; with young_modulus or shear_wave_speed (there below 0.5, plane strain)"},
      {.table = "collisions",
       .name = "shear_wave_speed",
       .type = number,
       .unit = "m/s",
       .fallback = none,
       .range = Range::positive(),
       .when_key = "law",
       .when = laws_with(is_linear),
       .help = "Vs of all discs: kT = pi/4 rho Vs², kN = pi/4 rho Vp²; with poisson_ratio, instead of stiffness"},
      {.table = "collisions",
       .name = "ellipse_contact",
       .type = choice,
       .fallback = none,
       .choices = {"exact", "enlarged", "enlarged_as_printed"},
       .help =
           "exact (default): closest points and common normal; enlarged: the test of Sukegawa (2010), which takes the "
           "offset of an ellipse for an ellipse and so misses shallow contacts, with its quadrants mended; "
           "enlarged_as_printed: with its errors, for comparison"},
      {.table = "collisions",
       .name = "reference_length",
       .type = number,
       .unit = "m",
       .fallback = none,
       .range = Range::positive(),
       .when_key = "law",
       .when = nonlinear,
       .help = "d of dimensionless_stiffness; left out: twice the largest radius"},
  };
  const auto append = [&](std::vector<KeySpec> more) { keys.insert(keys.end(), more.begin(), more.end()); };
  append(keys_of_contacts("collisions", true));
  append(keys_of_contacts("collisions.walls", false));
  append({{.table = "collisions.pair", .name = "group", .type = text, .help = "of grains"},
          {.table = "collisions.pair",
           .name = "with",
           .type = text,
           .help = "a group of grains, or the name of a [[wall]]"}});
  append(keys_of_contacts("collisions.pair", false));
  return keys;
}

}  // namespace equidem
