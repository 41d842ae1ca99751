// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [collisions], [collisions.walls] and [[collisions.pair]].
#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/contact/laws/normal_law.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace casefile {
namespace {

/// The names of the laws that have a property.
template <class Property>
std::vector<std::string> laws_with(const Property& property) {
  std::vector<std::string> names;
  for (const LawDescription& law : normal_laws())
    if (property(law)) names.emplace_back(law.name);
  return names;
}

bool is_linear(const LawDescription& law) {
  return law.spring_power == 1;
}

/// "N/m (hertz_dashpot N/m^1.5; discs: per m of depth)"
std::string unit_of_stiffness() {
  std::string others;
  for (const LawDescription& law : normal_laws())
    if (!is_linear(law)) others += fmt::format("{} {}; ", law.name, law.stiffness_unit);
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

/// A key that sets one of the alternatives of PairOptions.
template <class Option, class... Attributes>
Key<PairOptions> rebound_key(const char* name, const Attributes&... attributes) {
  return key_with<PairOptions, double>(
      name, [](PairOptions& pair, const double& value) { pair.rebound = Option{value}; }, attributes...);
}
template <class Option, class... Attributes>
Key<PairOptions> stiffness_key(const char* name, const Attributes&... attributes) {
  return key_with<PairOptions, double>(
      name, [](PairOptions& pair, const double& value) { pair.stiffness = Option{value}; }, positive, attributes...);
}

/// The laws whose contacts may pull by default.
std::string laws_that_pull() {
  std::vector<std::string> names;
  for (const LawDescription& law : normal_laws())
    if (law.usual_end == ContactEnd::at_zero_overlap) names.emplace_back(law.name);
  return joined(names, ", ");
}

}  // namespace

std::vector<Key<PairOptions>> contact_keys(bool base) {
  using P = PairOptions;
  std::vector<Key<P>> keys{
      rebound_key<Restitution>(
          "restitution", from(0, 1),
          "speed after over speed before, of two bodies that meet head-on without gravity; give it or damping"),
      rebound_key<DashpotDamping>(
          "damping", range({.low = 0, .high = 10, .low_open = true}),
          "h of the dashpots 2 h sqrt(m k), along and across, m the mass of a disc, as in [settling] of a packing; of "
          "laws with linear springs and dashpots"),
      key("contact_end", &P::contact_end,
          "of laws with a dashpot; zero_force: contacts never pull (default, except for " + laws_that_pull() +
              "); zero_overlap: they may pull while the bodies part"),
      stiffness_key<SpringStiffness>("stiffness", unit(unit_of_stiffness()), "k; give it or one of the next keys"),
      stiffness_key<DimensionlessStiffness>(
          "dimensionless_stiffness",
          "a = k dt²/m, m the reduced mass: held whatever the step and the masses; a force k u^p: k d^(p - 1) dt²/m"),
      stiffness_key<ContactDuration>("contact_duration", unit("s"),
                                     "until the overlap is zero again, the same for all masses; of linear springs"),
      stiffness_key<LargestOverlap>("largest_overlap", unit("m"),
                                    "not exceeded by two bodies that meet at closing_speed"),
      key("closing_speed", &P::closing_speed, optional, unit("m/s"), positive,
          "speed of the fastest impact expected; for largest_overlap, and for an automatic step with springs that are "
          "not linear"),
      key("friction", &P::friction, not_negative, "Coulomb's mu"),
      key("tangential_ratio", &P::tangential_ratio, from(0, 1e6),
          "kT/kN of the tangential spring, with friction; left out: 2/7, with wave speeds theirs, and for the maps, "
          "which act in one or two steps, 0: no spring, contacts slide"),
      key("tangential_damping", &P::tangential_damping, not_negative,
          "zeta of the tangential dashpot; left out: 0, with damping that of its dashpot"),
      key("friction_cap", &P::friction_cap,
          "force that mu times the normal force limits: of spring and dashpot together, or of the spring alone")};
  for (Key<P>& key : keys) {
    if (base) break;
    key.spec.fallback = KeySpec::none;
    key.spec.help = "as in [collisions]";
  }
  return keys;
}

void bind_collisions(File<GrainTables>& file) {
  using T = GrainTables;
  const auto nonlinear = laws_with([](const LawDescription& law) { return !is_linear(law); });
  file.table("collisions", required, "how bodies meet, rebound and part")
      .keys({key_in<T>("law", &GrainCase::options, &GrainOptions::law, help_of_laws()),
             key("young_modulus", &T::young_modulus, unit("Pa"), positive,
                 when("law", laws_with([](const LawDescription& law) { return law.hertz_spring; })),
                 "modulus of all spheres, walls being rigid: k by Hertz; with poisson_ratio, instead of stiffness"),
             key("poisson_ratio", &T::poisson_ratio, range({.low = -1, .high = 0.5, .low_open = true}),
                 "of all bodies; with young_modulus or shear_wave_speed (there below 0.5, plane strain)"),
             key("shear_wave_speed", &T::shear_wave_speed, unit("m/s"), positive, when("law", laws_with(is_linear)),
                 "Vs of all discs: kT = pi/4 rho Vs², kN = pi/4 rho Vp²; with poisson_ratio, instead of stiffness"),
             key_in<T>("ellipse_contact", &GrainCase::options, &GrainOptions::ellipse_law, optional,
                       "exact (default): closest points and common normal; enlarged: the test of Sukegawa (2010), "
                       "which takes the offset of an ellipse for an ellipse and so misses shallow contacts, with its "
                       "quadrants mended; enlarged_as_printed: with its errors, for comparison"),
             key_in<T>("reference_length", &GrainCase::options, &GrainOptions::reference_length, optional, unit("m"),
                       positive, when("law", nonlinear),
                       "d of dimensionless_stiffness; left out: twice the largest radius")});
  file.table("collisions", &T::collisions).keys(contact_keys(true));
  file.table("collisions.walls", "contacts of a grain with a wall, where they differ from that")
      .described(contact_keys(false));
  std::vector<Key<PairOptions>> pair{
      unbound_key<PairOptions>("group", KeyType::text, required, "group of grains"),
      unbound_key<PairOptions>("with", KeyType::text, required, "a group of grains, or the name of a [[wall]]")};
  for (Key<PairOptions>& key : contact_keys(false)) pair.push_back(std::move(key));
  file.table("collisions.pair", repeated_table,
             "contacts of two groups, or of a group and a wall, where they differ from that")
      .described(std::move(pair));
}

}  // namespace casefile

namespace {

using casefile::fail_at;
using casefile::repeated;

constexpr std::array ways_to_stiffness = {"stiffness",       "dimensionless_stiffness", "contact_duration",
                                          "largest_overlap", "young_modulus",           "shear_wave_speed"};

/// At most one way to the rebound and one to the stiffness of a contact.
void check_alternatives(const TomlValue& table, const std::string& name) {
  const TomlValue* damping = table.find("damping");
  if (damping != nullptr && table.find("restitution") != nullptr)
    fail_at(*damping, name + ".damping", "restitution and damping are both given",
            "each says how strong the dashpot is", "Remove one of them");
  const char* by = nullptr;
  for (const char* way : ways_to_stiffness) {
    const TomlValue* found = table.find(way);
    if (found == nullptr) continue;
    if (by != nullptr)
      fail_at(*found, fmt::format("{}.{}", name, way), fmt::format("{} and {} are both given", by, way),
              "each says how stiff a contact is", "Remove one of them");
    by = way;
  }
}

/// `options` with those that a table gives instead.
PairOptions with(PairOptions options, const TomlValue& table, const std::string& name) {
  static const auto keys = casefile::contact_keys(false);
  check_alternatives(table, name);
  TomlValue copy = table;
  casefile::read_table(keys, copy, {}, options);
  return options;
}

/// Keys of [collisions] that belong together are given together, and those that exclude one another are not.
void check_moduli(const TomlValue& table, const casefile::GrainTables& result) {
  const TomlValue* young = table.find("young_modulus");
  const TomlValue* shear = table.find("shear_wave_speed");
  const TomlValue* poisson = table.find("poisson_ratio");
  if (young == nullptr && shear == nullptr) {
    if (poisson == nullptr) return;
    const bool hertz = describe(result.options.law).hertz_spring;
    fail_at(*poisson, "collisions.poisson_ratio",
            fmt::format("poisson_ratio is given without {}", hertz ? "young_modulus" : "shear_wave_speed"),
            "both make the stiffness of a contact",
            hertz ? "Add young_modulus = ... in Pa" : "Add shear_wave_speed = ... in m/s");
  }
  const TomlValue& given = young != nullptr ? *young : *shear;
  const char* name = young != nullptr ? "young_modulus" : "shear_wave_speed";
  if (poisson == nullptr)
    fail_at(given, fmt::format("collisions.{}", name), fmt::format("{} is given without poisson_ratio", name),
            "both make the stiffness of a contact", "Add poisson_ratio = ...");
  if (shear == nullptr) return;
  if (const TomlValue* ratio = table.find("tangential_ratio"))
    fail_at(*ratio, "collisions.tangential_ratio", "tangential_ratio and shear_wave_speed are both given",
            "each says how stiff the tangential spring is", "Remove one of them");
  const auto [least, most] = std::ranges::minmax(result.densities);
  if (least < most && result.body == Body::disc)
    fail_at(given, "collisions.shear_wave_speed",
            fmt::format("the grains have densities from {} to {} kg/m³", least, most),
            "springs of wave speeds belong to one density",
            "Give one density, or stiffness and tangential_ratio for each pair");
}

/// The error of set_kinds with the line and the key of its option: "walls.stiffness", "pairs.2.with".
[[noreturn]] void fail_at_option(const Error& error, const TomlValue& collisions) {
  std::string_view option = error.where();
  std::string name = "collisions";
  std::vector<const TomlValue*> tables{&collisions};  // the first that has the key is at fault
  if (option.starts_with("pairs.")) {
    std::size_t k = 0;
    option.remove_prefix(6);
    const char* after = std::from_chars(option.data(), option.data() + option.size(), k).ptr;
    option.remove_prefix(static_cast<std::size_t>(after - option.data()));
    if (option.starts_with('.')) option.remove_prefix(1);
    tables.insert(tables.begin(), &repeated(collisions, "pair")[k]);
    if (const TomlValue* walls = collisions.find("walls")) tables.insert(tables.begin() + 1, walls);
    name += ".pair";
  } else if (option.starts_with("walls")) {
    option.remove_prefix(std::min<std::size_t>(6, option.size()));
    tables.insert(tables.begin(), collisions.find("walls"));
    name += ".walls";
  }
  if (option == "group" && tables.size() == 1) name = "grain";
  const TomlValue* at = tables.front();
  for (auto table = tables.rbegin(); table != tables.rend(); ++table)
    if (const TomlValue* value = (*table)->find(option)) at = value;
  if (!option.empty()) name += '.' + std::string(option);
  fail_at(*at, name, error.problem(), error.why(), error.remedy());
}

}  // namespace

void casefile::read_collisions(const TomlValue& root, const std::vector<std::string>& groups, GrainTables& result) {
  const TomlValue& table = *root.find("collisions");
  check_alternatives(table, "collisions");
  check_moduli(table, result);
  CollisionOptions options{.body = result.body, .bodies = result.collisions};
  if (result.young_modulus) options.bodies.stiffness = HertzModuli{*result.young_modulus, *result.poisson_ratio};
  if (result.shear_wave_speed)
    options.bodies.stiffness =
        WaveSpeedStiffness{result.densities.front(), *result.shear_wave_speed, *result.poisson_ratio};
  PairOptions walls = options.bodies;
  if (const TomlValue* differs = table.find("walls")) options.walls = walls = with(walls, *differs, "collisions.walls");
  for (const TomlValue& pair : repeated(table, "pair")) {
    const std::string& group = pair.find("group")->text;
    const std::string& other = pair.find("with")->text;
    const bool on_wall = std::ranges::find(groups, other) == groups.end();
    options.pairs.push_back({group, other, with(on_wall ? walls : options.bodies, pair, "collisions.pair")});
  }
  try {
    result.contacts = set_kinds(result.scene, groups, options, result.options.law);
  } catch (const Error& error) {
    fail_at_option(error, table);
  }
}

}  // namespace equidem
