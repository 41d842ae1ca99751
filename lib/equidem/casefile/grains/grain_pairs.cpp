// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [collisions], [collisions.walls] and [[collisions.pair]].
#include <algorithm>
#include <cmath>

#include "equidem/casefile/engine/value.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/contact/laws/normal_law.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {
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
  const auto help = [](const LawDescription& law) {
    return fmt::format("{} ({}{}{}): {}", law.name, law.letter, *law.source ? ", " : "", law.source, law.summary);
  };
  return joined(normal_laws(), help, "; ");
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

/// The letters of the paper are known, and no names.
std::vector<RefusedWord> letters_of_laws() {
  std::vector<RefusedWord> letters;
  for (const LawDescription& law : normal_laws())
    letters.push_back({law.letter,
                       fmt::format("that is the letter of {} in the paper, and laws go by their names", law.name),
                       fmt::format("Write law = \"{}\"", law.name)});
  return letters;
}

/// The keys of a contact. In [collisions] they have defaults and help; elsewhere they override those.
std::vector<Key<PairOptions>> contact_keys(bool base) {
  using P = PairOptions;
  std::vector<Key<P>> keys{
      rebound_key<Restitution>(
          "restitution", from(0, 1), not_beside({"damping"}, "each says how strong the dashpot is"),
          "speed after over speed before, of two bodies that meet head-on without gravity; give it or damping"),
      rebound_key<DashpotDamping>(
          "damping", range({.low = 0, .high = 10, .low_open = true}),
          "h of the dashpots 2 h sqrt(m k), along and across, m the mass of a disc, as in [settling] of a packing; of "
          "laws with linear springs and dashpots"),
      stiffness_key<SpringStiffness>("stiffness", unit(unit_of_stiffness()),
                                     not_beside({"dimensionless_stiffness", "contact_duration", "largest_overlap",
                                                 "young_modulus", "shear_wave_speed"},
                                                "each says how stiff a contact is"),
                                     "k; give it or one of the next keys"),
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
          not_beside({"shear_wave_speed"}, "each says how stiff the tangential spring is"),
          "kT/kN of the tangential spring, with friction; left out: 2/7, with wave speeds theirs, and for the maps, "
          "which act in one or two steps, 0: no spring, contacts slide"),
      key("tangential_damping", &P::tangential_damping, not_negative,
          "zeta of the tangential dashpot; left out: 0, with damping that of its dashpot")};
  for (Key<P>& key : keys) {
    if (base) break;
    key.spec.fallback = KeySpec::none;
    key.spec.help = "as in [collisions]";
  }
  return keys;
}

}  // namespace

std::vector<Key<PairOptions>> changed_contact_keys() {
  return contact_keys(false);
}

std::vector<Key<PairOptions>> pair_keys() {
  std::vector<Key<PairOptions>> pair{
      unbound_key<PairOptions>("group", KeyType::text, required, "group of grains"),
      unbound_key<PairOptions>("with", KeyType::text, required, "a group of grains, or the name of a [[wall]]")};
  for (Key<PairOptions>& key : contact_keys(false)) pair.push_back(std::move(key));
  return pair;
}

void bind_collisions(File<GrainTables>& file) {
  using T = GrainTables;
  using C = CollisionTable;
  const std::string both = "both make the stiffness of a contact";
  const auto nonlinear = laws_with([](const LawDescription& law) { return !is_linear(law); });
  file.table("collisions", required, "how bodies meet, rebound and part")
      .keys({key_in<T>("law", &GrainCase::options, &GrainOptions::law, refused(letters_of_laws()), help_of_laws())});
  file.table("collisions", &T::collisions)
      .keys({key("young_modulus", &C::young_modulus, unit("Pa"), positive, only_with({"poisson_ratio"}, both),
                 when("law", laws_with([](const LawDescription& law) { return law.hertz_spring; })),
                 "modulus of all spheres, walls being rigid: k by Hertz; with poisson_ratio, instead of stiffness"),
             key("poisson_ratio", &C::poisson_ratio, range({.low = -1, .high = 0.5, .low_open = true}),
                 only_with({"young_modulus", "shear_wave_speed"}, both),
                 "of all bodies; with young_modulus or shear_wave_speed (there below 0.5, plane strain)"),
             key("shear_wave_speed", &C::shear_wave_speed, unit("m/s"), positive, only_with({"poisson_ratio"}, both),
                 when("law", laws_with(is_linear)),
                 "Vs of all discs: kT = pi/4 rho Vs², kN = pi/4 rho Vp²; with poisson_ratio, instead of stiffness")});
  file.table("collisions")
      .keys({key_in<T>("ellipse_contact", &GrainCase::options, &GrainOptions::ellipse_law, optional,
                       "exact (default): closest points and common normal; enlarged: the test of Sukegawa (2010), "
                       "which takes the offset of an ellipse for an ellipse and so misses shallow contacts, with its "
                       "quadrants mended"),
             key_in<T>("reference_length", &GrainCase::options, &GrainOptions::reference_length, optional, unit("m"),
                       positive, when("law", nonlinear),
                       "d of dimensionless_stiffness; left out: twice the largest radius")});
  file.table("collisions", &T::collisions, &C::contact).keys(contact_keys(true));
  file.table("collisions.walls", "contacts of a grain with a wall, where they differ from that")
      .described(contact_keys(false));
  file.table("collisions.pair", repeated_table,
             "contacts of two groups, or of a group and a wall, where they differ from that")
      .described(pair_keys());
  bind_springs_file(file);
  file.table("springs", &T::springs,
             "kN, kT of all contacts, those with walls too, instead of stiffness and tangential_ratio")
      .keys(springs_keys());
}

namespace {

/// `options` with those that a table gives instead.
PairOptions with(PairOptions options, const TomlValue& table) {
  static const auto keys = contact_keys(false);
  read_table(keys, table, options);
  return options;
}

void check_one_density(const TomlValue& table, const GrainTables& tables) {
  const auto [least, most] = std::ranges::minmax(tables.densities);
  if (least < most && tables.body == Body::disc)
    fail_at(*table.find("shear_wave_speed"), "collisions.shear_wave_speed",
            fmt::format("the grains have densities from {} to {} kg/m³", least, most),
            "springs of wave speeds belong to one density",
            "Give one density, or stiffness and tangential_ratio for each pair");
}

/// kN and kT of [springs] as the stiffness and the tangential ratio of bodies and walls.
void take_springs(const TomlValue& root, const GrainTables& tables, PairOptions& bodies) {
  const TomlValue &collisions = *root.find("collisions"), &table = *root.find("springs");
  const SpringConstants& constants = tables.springs->constants;
  const SpringWeighting weighting = tables.springs->weighting;
  const std::optional<double> density = tables.springs->density;
  for (const char* key : {"stiffness", "dimensionless_stiffness", "contact_duration", "largest_overlap",
                          "young_modulus", "shear_wave_speed", "tangential_ratio"})
    if (const TomlValue* given = collisions.find(key))
      fail_at(*given, fmt::format("collisions.{}", key), fmt::format("[springs] and {} are both given", key),
              "each says how stiff a contact is", "Remove one of them");
  if (tables.body == Body::sphere)
    fail_at(table, "springs", "the grains are spheres", "kN and kT are springs of discs per metre of depth",
            "Give stiffness in [collisions] instead, or set grains.body = \"disc\"");
  if (!is_linear(describe(tables.options.law)))
    fail_at(table, "springs", fmt::format("{} has no linear spring", to_string(tables.options.law)),
            "kN and kT are linear springs",
            fmt::format("Set collisions.law to one of {}, or give stiffness there", joined(laws_with(is_linear))));
  if (weighting != SpringWeighting::uniform)
    fail_at(*table.find("weighting"), "springs.weighting",
            fmt::format("the springs differ from contact to contact: weighting = \"{}\"", to_string(weighting)),
            "contacts of bodies that collide come and go, and all have the same springs",
            "Calibrate with weighting = \"uniform\"");
  if (constants.kT < 0)
    fail_at(*table.find("kT"), "springs.kT", fmt::format("kT = {:.6g} Pa is negative", constants.kT),
            "no motion of the discs is stable with it", "Give springs with kT of 0 or more");
  const auto has_it = [&](double given) { return std::abs(given - *density) <= 1e-6 * *density; };
  if (density && std::ranges::none_of(tables.densities, has_it))
    fail_at(
        *table.find("density"), "springs.density",
        fmt::format("the springs are for discs of {:.9g} kg/m³, and no grain has that density: the first has {:.9g}",
                    *density, tables.densities.front()),
        "both are the density of the discs themselves", "Remove one of them");
  bodies.stiffness = SpringStiffness{constants.kN};
  if (!is_map(tables.options.law)) bodies.tangential_ratio = constants.ratio();
}

/// Whether a value stands in one of these tables, or is one of them.
bool stands_in(std::span<const TomlValue> tables, const TomlValue& value) {
  return std::ranges::any_of(tables, [&](const TomlValue& table) {
    return table.where() == value.where() || std::ranges::any_of(table.entries, [&](const TomlEntry& entry) {
             return entry.value.where() == value.where();
           });
  });
}

/// The error of set_kinds with the line and the key of its option: "walls.stiffness", "pairs.2.with".
/// \param stage that may have given it; null: none
[[noreturn]] void fail_at_option(const Error& error, const TomlValue& collisions, const TomlValue* stage) {
  std::string option = error.where(), name = "collisions";
  const auto next_segment = [&] {
    const std::size_t dot = std::min(option.find('.'), option.size());
    std::string segment = option.substr(0, dot);
    option.erase(0, dot + 1);
    return segment;
  };
  const TomlValue* walls = collisions.find("walls");
  std::vector<const TomlValue*> tables;  // the first that has the key is at fault, else the first
  if (option.starts_with("pairs.")) {
    next_segment();
    tables.push_back(&repeated(collisions, "pair")[*number_from<std::size_t>(next_segment())]);
    if (walls != nullptr) tables.push_back(walls);
    name += ".pair";
  } else if (option.starts_with("walls")) {
    next_segment();
    tables.push_back(walls);
    name += ".walls";
  } else if (option == "group") {
    name = "grain";
  }
  tables.push_back(&collisions);
  const auto found =
      std::ranges::find_if(tables, [&](const TomlValue* table) { return table->find(option) != nullptr; });
  const TomlValue& culprit = found == tables.end() ? *tables.front() : *(*found)->find(option);
  if (stage != nullptr && stands_in(repeated(*stage, "pair"), culprit)) name = "stage.pair";
  if (const TomlValue* changed = stage != nullptr ? stage->find("collisions") : nullptr)
    if (stands_in({changed, 1}, culprit)) name = "stage.collisions";
  if (!option.empty()) name += '.' + option;
  fail_at(culprit, name, error.problem(), error.why(), error.remedy());
}

}  // namespace

void complete_collisions(const TomlValue& root, const std::vector<std::string>& groups, GrainTables& tables,
                         const TomlValue* stage) {
  const TomlValue& table = *root.find("collisions");
  const auto& [contact, young_modulus, poisson_ratio, shear_wave_speed] = tables.collisions;
  CollisionOptions options{.body = tables.body, .bodies = contact};
  if (young_modulus) options.bodies.stiffness = HertzModuli{*young_modulus, *poisson_ratio};
  if (shear_wave_speed) {
    check_one_density(table, tables);
    options.bodies.stiffness = WaveSpeedStiffness{tables.densities.front(), *shear_wave_speed, *poisson_ratio};
  }
  if (tables.springs) take_springs(root, tables, options.bodies);
  if (const TomlValue* differs = table.find("walls")) options.walls = with(options.bodies, *differs);
  const PairOptions& walls = options.walls ? *options.walls : options.bodies;
  for (const TomlValue& pair : repeated(table, "pair")) {
    const std::string& group = pair.find("group")->text;
    const std::string& other = pair.find("with")->text;
    const bool on_wall = std::ranges::find(groups, other) == groups.end();
    options.pairs.push_back({group, other, with(on_wall ? walls : options.bodies, pair)});
  }
  try {
    tables.contacts = set_kinds(tables.scene, groups, options, tables.options.law);
  } catch (const Error& error) {
    fail_at_option(error, table, stage);
  }
}

}  // namespace equidem::casefile
