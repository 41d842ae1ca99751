// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [collisions], [grains], [bonds], [cell] with their completion, and the file of colliding bodies that binds all
/// tables.
#include "equidem/casefile/grains/grain_tables.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/contact_tables.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/contact/laws/normal_law.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/grains/scene/grain_file.hpp"

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

/// The keys of a contact, with the defaults of [collisions].
std::vector<Key<PairOptions>> contact_keys() {
  using P = PairOptions;
  return {
      rebound_key<Restitution>(
          "restitution", from(0, 1), not_beside({"damping"}, "each says how strong the dashpot is"),
          "speed after over speed before, of two bodies that collide head-on without gravity; give it or damping"),
      rebound_key<DashpotDamping>("damping", range({.low = 0, .high = 10, .low_open = true}),
                                  "h of the dashpots 2 h sqrt(m k), along and across, m the mass of a disc; of "
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
                                    "not exceeded by two bodies that collide at closing_speed"),
      key("closing_speed", &P::closing_speed, optional, unit("m/s"), positive,
          "speed of the fastest impact expected; for largest_overlap, and for an automatic step with springs that are "
          "not linear"),
      key("friction", &P::friction, not_negative, "Coulomb's mu"),
      key("tangential_ratio", &P::tangential_ratio, from(0, 1e6),
          not_beside({"shear_wave_speed"}, "each says how stiff the tangential spring is"),
          "kT/kN of the tangential spring, with friction; left out: 2/7, with wave speeds theirs, and for the maps, "
          "which act in one or two steps, 0: no spring, contacts slide"),
      key("tangential_damping", &P::tangential_damping, not_negative,
          "zeta of the tangential dashpot; left out: 0, with damping that of its dashpot"),
      key("rolling_friction", &P::rolling_friction, not_negative,
          "mu_r: a contact resists the relative rotation of its bodies with a moment of at most mu_r R times the "
          "repulsion, R = R_i R_j/(R_i + R_j), at a wall the radius; laws that give a force"),
      key("rolling_ratio", &P::rolling_ratio, range({.low = 0, .high = 1e6, .low_open = true}),
          "k_r/(kN R²) of the rolling spring, with rolling_friction; left out: tangential_ratio, without friction 2/7"),
      key("rolling_damping", &P::rolling_damping, not_negative,
          "zeta of the rolling dashpot, with rolling_friction; left out: as tangential_damping"),
      key("cohesion", &P::cohesion, unit("N (discs: per m of depth)"), not_negative,
          "constant attraction of bodies closer than cohesion_range, overlapping ones too; friction then holds up to "
          "mu "
          "times the sum of the normal force and it; laws that give a force"),
      key("cohesion_range", &P::cohesion_range, unit("m"), not_negative,
          "largest gap at which cohesion acts; with cohesion")};
}

}  // namespace

std::vector<Key<PairOptions>> changed_contact_keys() {
  std::vector<Key<PairOptions>> keys = contact_keys();
  for (Key<PairOptions>& key : keys) key.spec.fallback = KeySpec::none;
  return keys;
}

std::vector<Key<PairOptions>> pair_keys() {
  const std::string two = "two groups of grains, or a group and the name of a [[wall]]";
  std::vector<Key<PairOptions>> pair{unbound_key<PairOptions>("group", KeyType::text, required, two),
                                     unbound_key<PairOptions>("with", KeyType::text, required, two)};
  for (Key<PairOptions>& key : changed_contact_keys()) pair.push_back(std::move(key));
  return pair;
}

void bind_collisions(File<GrainTables>& file) {
  using T = GrainTables;
  using C = CollisionTable;
  const std::string both = "both make the stiffness of a contact";
  const auto nonlinear = laws_with([](const LawDescription& law) { return !is_linear(law); });
  file.table("collisions", required, "how bodies collide, rebound and separate")
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
  file.table("collisions", &T::collisions, &C::contact).keys(contact_keys());
  file.table("collisions.walls", like("collisions"), "contacts of a grain with a wall, where they differ from that")
      .described(changed_contact_keys());
  file.table("collisions.pair", repeated_table, like("collisions"),
             "contacts of two groups, or of a group and a wall, where they differ from that")
      .described(pair_keys());
  bind_springs(file, &T::springs);
}

namespace {

/// `options` with those that a table gives instead.
PairOptions with(PairOptions options, const TomlValue& table) {
  static const auto keys = changed_contact_keys();
  read_table(keys, table, options);
  return options;
}

void check_one_density(const TomlValue& table, const GrainTables& tables) {
  const auto [least, most] = std::ranges::minmax(tables.densities);
  if (least < most && tables.body == Body::disc)
    fail_at(*table.find("shear_wave_speed"), fmt::format("the grains have densities from {} to {} kg/m³", least, most),
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
      fail_at(*given, fmt::format("[springs] and {} are both given", key), "each says how stiff a contact is",
              "Remove one of them");
  if (tables.body == Body::sphere)
    fail_at(table, "the grains are spheres", "kN and kT are springs of discs per metre of depth",
            "Give stiffness in [collisions] instead, or set grains.body = \"disc\"");
  if (!is_linear(describe(tables.options.law)))
    fail_at(table, fmt::format("{} has no linear spring", to_string(tables.options.law)),
            "kN and kT are linear springs",
            fmt::format("Set collisions.law to one of {}, or give stiffness there", joined(laws_with(is_linear))));
  if (weighting != SpringWeighting::uniform)
    fail_at(*table.find("weighting"),
            fmt::format("the springs differ from contact to contact: weighting = \"{}\"", to_string(weighting)),
            "contacts of bodies that collide come and go, and all have the same springs",
            "Calibrate with weighting = \"uniform\"");
  check_stable_in_motion(root, constants);
  const auto has_it = [&](double given) { return std::abs(given - *density) <= 1e-6 * *density; };
  if (density && std::ranges::none_of(tables.densities, has_it))
    fail_at(
        *table.find("density"),
        fmt::format("the springs are for discs of {:.9g} kg/m³, and no grain has that density: the first has {:.9g}",
                    *density, tables.densities.front()),
        "both are the density of the discs themselves", "Remove one of them");
  bodies.stiffness = SpringStiffness{constants.kN};
  if (!is_map(tables.options.law)) bodies.tangential_ratio = constants.ratio();
}

/// The error of set_kinds with the line and the key of its option: "walls.stiffness", "pairs.2.with".
[[noreturn]] void fail_at_option(const Error& error, const TomlValue& collisions) {
  if (error.where() == "group")
    bad_input_at(collisions.where() + ": grain.group", error.problem(), error.why(), error.remedy());
  std::vector<std::string_view> words = parts_of(error.where(), '.');
  std::vector<const TomlValue*> tables;  // the first that has the key is at fault, else the first
  const TomlValue* walls = collisions.find("walls");
  if (words.front() == "pairs") tables.push_back(&repeated(collisions, "pair")[*number_from<std::size_t>(words[1])]);
  if (walls != nullptr && (words.front() == "pairs" || words.front() == "walls")) tables.push_back(walls);
  tables.push_back(&collisions);
  words.erase(words.begin(), words.begin() + (words.front() == "pairs" ? 2 : words.front() == "walls" ? 1 : 0));
  const std::string option(words.empty() ? "" : words.front());
  for (const TomlValue* table : tables)
    if (const TomlValue* given = table->find(option)) fail_at(*given, error.problem(), error.why(), error.remedy());
  if (option.empty()) fail_at(*tables.front(), error.problem(), error.why(), error.remedy());
  fail_at(*tables.front(), option, error.problem(), error.why(), error.remedy());
}

}  // namespace

void complete_collisions(const TomlValue& root, const std::vector<std::string>& groups, GrainTables& tables) {
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
    fail_at_option(error, table);
  }
}

namespace {

/// Disc, ellipse or clump.
void read_shape(const TomlValue& table, const GrainTable& read, double density, GrainShapes& shapes, Grain& grain) {
  const char* key = read.radius ? "radius" : read.half_axes ? "half_axes" : "discs";
  with_key(table, key, [&] {
    if (read.radius) return shapes.make_disc(grain, *read.radius, density);
    if (read.half_axes) return shapes.make_ellipse(grain, read.half_axes->x, read.half_axes->y, density);
    shapes.make_clump(grain, read.discs, density);
  });
}

void add_grain(const TomlValue& table, const GrainTable& read, std::optional<double> common_density,
               GrainShapes& shapes, GrainRows& bodies) {
  if (!read.density && !common_density) {
    fail_at(table, "density", "the density is missing", "motion needs the mass of the grains",
            fmt::format("Add density = ... in kg/m³ to [grains], or to each [[{}]]", table.path));
  }
  check_group_name(*table.find("group"));
  Grain grain = read.grain;
  bodies.densities.push_back(read.density ? *read.density : *common_density);
  read_shape(table, read, bodies.densities.back(), shapes, grain);
  bodies.grains.push_back(grain);
  bodies.groups.push_back(read.group);
}

/// Springs that were made for discs of one density belong to those discs.
void check_density_of_springs(const TomlValue& root, const GrainTables& tables, const std::filesystem::path& path,
                              const GrainRows& file) {
  constexpr double tolerance = 1e-6;
  const std::optional<double> stated = tables.springs ? tables.springs->density : std::nullopt;
  if (!stated) return;
  for (std::size_t k = 0; k < file.densities.size(); ++k) {
    const double own = file.densities[k];
    if (std::abs(own - *stated) <= tolerance * *stated) continue;
    fail_at(
        *root.find("springs")->find("density"),
        fmt::format("it is {:.9g} kg/m³ here and {:.9g} kg/m³ at {}:{}", *stated, own, path.string(), file.lines[k]),
        "both are the density of the discs themselves",
        "Pack with these springs, which carry it, or take the column of densities out of the file of grains");
  }
}

}  // namespace

void check_group_name(const TomlValue& group) {
  if (group.text.empty()) fail_at(group, "the name is empty", "a group is known by its name", "Name it");
  check_plain_name(group, "a group", "it stands in tables");
  if (group.text == name_of_all_walls)
    fail_at(group, "a group of grains is called 'walls'", "the name stands for all of them", "Name it otherwise");
}

void check_names_of_walls(const TomlValue& holder, const std::vector<std::string>& groups) {
  const auto check = [&](const TomlValue& name) {
    if (name.text == name_of_all_walls)
      fail_at(name, "a wall is called 'walls'", "the name stands for all of them", "Name it otherwise");
    if (std::find(groups.begin(), groups.end(), name.text) != groups.end())
      fail_at(name, fmt::format("a wall and a group of grains are both called '{}'", name.text),
              "[[collisions.pair]] chooses them by name", "Rename one of them");
  };
  for (const TomlValue& wall : repeated(holder, "wall")) check(*wall.find("name"));
  for (const TomlValue& renaming : repeated(holder, "rename"))
    if (renaming.find("wall") != nullptr) check(*renaming.find("to"));
}

GrainRows bodies_of(const TomlValue& root, const TomlValue& holder, const CommonBodyTable& common,
                    const std::vector<GrainTable>& read, GrainShapes& shapes, const GrainTables& tables) {
  GrainRows bodies;
  if (common.path) {
    std::optional<Vec2> cell;
    if (tables.cell_table && tables.cell_table->along == PeriodicCell::Along::xy)
      cell = Vec2{tables.cell_table->width, tables.cell_table->height};
    bodies = with_key(*holder.find("grains"), "path",
                      [&] { return read_grains(*common.path, common.density, shapes, cell); });
    check_density_of_springs(root, tables, *common.path, bodies);
  }
  for (std::size_t k = 0; k < read.size(); ++k)
    add_grain(repeated(holder, "grain")[k], read[k], common.density, shapes, bodies);
  return bodies;
}

std::vector<std::string> complete_bodies(const TomlValue& root, GrainShapes& shapes, GrainTables& tables) {
  GrainRows bodies = bodies_of(root, root, tables.common, tables.grain_tables, shapes, tables);
  if (tables.common.path) tables.grain_file = tables.common.path->string();
  if (bodies.grains.empty()) {
    fail_at(root, "grain", "there are no grains", "something has to move",
            "Add [[grain]] with position and radius, or [grains] with path");
  }
  tables.scene.grains = std::move(bodies.grains);
  tables.scene.clumps = shapes.clumps();
  tables.densities = std::move(bodies.densities);
  tables.grain_lines = std::move(bodies.lines);
  return std::move(bodies.groups);
}

namespace {

/// The dashpots and springs of a bond.
std::vector<Key<GrainBond>> keys_of_bonds() {
  std::vector<Key<GrainBond>> keys;
  for (const BondProperty& property : bond_properties())
    keys.push_back(key(property.name, property.value, optional, unit(property.unit), not_negative, property.help));
  return keys;
}

void bind_bonds(File<GrainTables>& file) {
  file.table("bonds", &GrainTables::bonds, "properties of all bonds")
      .keys({key("path", &BondsTable::path,
                 "a CSV file whose first two columns i, j number the grains that are tied; columns named like the keys "
                 "below say how, instead of these; bonds.csv of run and pack can be read back")});
  file.table("bonds").keys({key_in<GrainTables>(
      "step", &GrainCase::options, &GrainOptions::bond_step, optional,
      "exact (default): each bond decays as it should in whatever step, bonds that share discs in short steps alone, "
      "where they decay one after the other, by the places of the discs: a mirror image differs by the square of the "
      "step; explicit: dashpots by the velocities at the start of the step, as in Sukegawa (2010), with the limit "
      "dt < 2 m/C_n, 2 m/(3 C_s) of equal discs: right for chains of discs with strong dashpots")});
  file.table("bonds", &GrainTables::bonds, &BondsTable::common).keys(keys_of_bonds());
  std::vector<Key<GrainBond>> keys{
      unbound_key<GrainBond>("grains", KeyType::discs, required,
                             "[i, j]: two discs, counted from 0, those of the file first; they do not collide")};
  for (Key<GrainBond>& key : keys_of_bonds()) keys.push_back(std::move(key));
  file.table("bond", repeated_table, like("bonds"), "two bonded discs, and what of [bonds] differs for them")
      .described(std::move(keys));
  bind_strength(file, &GrainTables::strength);
}

}  // namespace

std::vector<Key<StageBonds>> stage_bond_keys() {
  std::vector<Key<StageBonds>> keys{key("gap_tolerance", &StageBonds::gap_tolerance, from(0, 1),
                                        "discs are bonded where the gap between them is at most this share of the sum "
                                        "of their radii; 0: where they touch. Discs that press each other keep their "
                                        "force; those that have or had a bond get no other")};
  for (Key<StageBonds>& key : keys_of_member(&StageBonds::like, keys_of_bonds())) keys.push_back(std::move(key));
  return keys;
}

StageBonds read_stage_bonds(const TomlValue& table, const GrainTables& tables, std::size_t stage) {
  StageBonds bonds{.like = tables.bonds.common, .strengths = tables.strength};
  read_table(stage_bond_keys(), table, bonds);
  const GrainBond& like = bonds.like;
  if (!like.has_springs() && like.normal_dashpot == 0 && like.tangential_dashpot == 0 && like.rolling_dashpot == 0)
    fail_at(table, "the bonds have neither dashpots nor springs", "they would tie nothing",
            "Give normal_spring or normal_dashpot here or in [bonds]");
  if (bonds.strengths) bonds.strengths->seed += stage + 1;  // the bonds of the start take the seed itself
  return bonds;
}

void complete_bonds(const TomlValue& root, GrainTables& tables) {
  static const auto keys = keys_of_bonds();
  const bool bonds_later = std::ranges::any_of(repeated(root, "stage"),
                                               [](const TomlValue& stage) { return stage.find("bonds") != nullptr; });
  BondRows read;
  if (const TomlValue* table = root.find("bonds")) {
    const auto& path = tables.bonds.path;
    if (path)
      read = with_key(*table, "path", [&] { return read_bonds(*path, tables.bonds.common); });
    else if (repeated(root, "bond").empty() && !bonds_later)
      fail_at(*table, "no grains are tied", "the table only says how",
              "Add [[bond]] with grains, a path, or [stage.bonds]");
  }
  for (const TomlValue& table : repeated(root, "bond")) {
    const TomlValue& two = *table.find("grains");
    if (two.items.size() != 2)
      fail_at(two, fmt::format("{} are {}", two.shown(), counted(static_cast<long long>(two.items.size()), "grain")),
              "a bond ties two", "Write it like grains = [0, 1]");
    GrainBond& bond = read.bonds.emplace_back(tables.bonds.common);
    read_table(keys, table, bond);
    bond.i = static_cast<std::size_t>(two.items[0].integer);
    bond.j = static_cast<std::size_t>(two.items[1].integer);
    read.places.push_back(fmt::format("{}: bond", table.where()));
  }
  tables.scene.bonds = std::move(read.bonds);
  const auto place = [&](std::size_t bond) { return read.places[bond]; };
  check_bonds(tables.scene, place);  // before their grains are looked up
  if (tables.strength) {
    const TomlValue& table = *root.find("strength");
    if (tables.scene.bonds.empty() && !bonds_later)
      fail_at(table, "no grains are tied", "there is nothing that could break", "Add [bonds], or [[bond]]");
    if (tables.body == Body::sphere)
      fail_at(table, "the grains are spheres", "strengths are those of discs, N per metre of depth",
              "Take the table out, or set grains.body = \"disc\"");
    tables.scene.strengths = at_key(table, [&] { return bond_strengths(tables.scene, *tables.strength); });
    for (std::size_t b = 0; b < read.strengths.size(); ++b) {
      if (const auto& own = read.strengths[b].tension) tables.scene.strengths->tension[b] = *own;
      if (const auto& own = read.strengths[b].shear) tables.scene.strengths->shear[b] = *own;
    }
  } else if (std::ranges::any_of(read.strengths, &BondRows::Strength::given)) {
    fail_at(*root.find("bonds"), "path", "the file gives strengths, and the case has no [strength]",
            "bonds without that table never break", "Add [strength], or take the columns tension and shear out");
  }
  check_bonds(tables.scene, place);
}

namespace {

/// [cell.motion].
struct CellMotionTable {
  std::optional<double> xx, yy, xy;  ///< 1/s
  std::optional<std::string> schedule;
};

std::vector<Key<CellMotionTable>> cell_motion_keys() {
  using M = CellMotionTable;
  const std::string longer =
      "rates: xx, yy of the logarithm of the width, of the height; xy of simple shear: the images above move along x "
      "at "
      "this rate times height";
  return {key("xx", &M::xx, unit("1/s"), longer), key("yy", &M::yy, unit("1/s"), longer),
          key("xy", &M::xy, unit("1/s"), longer),
          key("schedule", &M::schedule, "factor of these rates; without one they are constant")};
}

/// [cell.servo].
struct CellServoTable {
  CellServo servo;
  std::optional<double> stress_xx, stress_yy;  ///< Pa
  std::optional<std::string> schedule;
};

std::vector<Key<CellServoTable>> cell_servo_keys() {
  using S = CellServoTable;
  const std::string followed = "tension positive; the width follows that along x, the height that along y";
  return {key("stress_xx", &S::stress_xx, unit("Pa"), followed), key("stress_yy", &S::stress_yy, unit("Pa"), followed),
          key("schedule", &S::schedule, "factor of the stresses; without one they are constant"),
          key("max_rate", &S::servo, &CellServo::max_rate, required, unit("1/s"), positive,
              "width and height never change faster, and shrink by it while nothing touches and the wanted stress is a "
              "pressure"),
          key("relaxation", &S::servo, &CellServo::relaxation, range({.low = 0, .high = 1, .low_open = true}),
              "share of the difference that a step mends, by stiffness and dashpots of the contacts")};
}

/// \param holder table of the cell
void refuse_deformation_along_x(const TomlValue& holder, const PeriodicCell& cell) {
  if (cell.along == PeriodicCell::Along::xy) return;
  for (const char* name : {"motion", "servo"})
    if (const TomlValue* given = holder.find(name))
      fail_at(*given, "a cell that repeats along x alone deforms", "walls bound it along y",
              "Let periodic = \"xy\", or move the walls");
}

/// The rates that a table gives; a component with a rate keeps no stress.
void take_motion(const TomlValue& table, std::span<const NamedSchedule> schedules, PeriodicCell& cell) {
  CellMotionTable read;
  read_table(cell_motion_keys(), table, read);
  const auto take = [&](const std::optional<double>& value, Schedule& rate,
                        std::optional<Schedule> CellServo::*stress) {
    if (!value) return;
    rate = *value == 0 ? Schedule{} : scheduled(table, *value, schedules);
    if (stress != nullptr && cell.servo) ((*cell.servo).*stress).reset();
  };
  take(read.xx, cell.rate_xx, &CellServo::stress_xx);
  take(read.yy, cell.rate_yy, &CellServo::stress_yy);
  take(read.xy, cell.rate_xy, nullptr);
  if (cell.servo && !cell.servo->stress_xx && !cell.servo->stress_yy) cell.servo.reset();
}

/// The stresses that a table gives, beside those that the cell keeps.
void take_servo(const TomlValue& table, std::span<const NamedSchedule> schedules, PeriodicCell& cell) {
  CellServoTable read;
  read_table(cell_servo_keys(), table, read);
  if (cell.servo) {  // stresses that are not named stay as they were
    read.servo.stress_xx = cell.servo->stress_xx, read.servo.stress_yy = cell.servo->stress_yy;
    read.servo.goes_on_xx = !read.stress_xx, read.servo.goes_on_yy = !read.stress_yy;
  }
  if (read.stress_xx) read.servo.stress_xx = scheduled(table, *read.stress_xx, schedules);
  if (read.stress_yy) read.servo.stress_yy = scheduled(table, *read.stress_yy, schedules);
  cell.servo = read.servo;
}

void bind_cell(File<GrainTables>& file) {
  using C = PeriodicCell;
  file.table("cell", &GrainTables::cell_table,
             "a rectangular cell whose content repeats: bodies under laws that give a force")
      .keys({key("periodic", &C::along,
                 "xy: along x and y, without walls and gravity; x: along x, between walls that are lines along x"),
             key("corner", &C::corner, unit("m"), "lower left corner; bodies outside are taken as their images inside"),
             key("width", &C::width, required, unit("m"), positive,
                 "period along x; more than two of the largest diameters, as the height"),
             key("height", &C::height, optional, unit("m"), positive, "period along y"),
             key("shift", &C::shift, unit("m"),
                 "along x, of the images above against the cell: a cell that is sheared at the start")});
  file.table("cell.motion", "rates at which the cell and its bodies deform; with integrator = \"velocity_verlet\"")
      .described(cell_motion_keys());
  file.table("cell.servo", "the cell deforms so that its mean stress is the wanted one").described(cell_servo_keys());
}

}  // namespace

void bind_stage_cell(File<GrainTables>& file) {
  file.table("stage.cell", "how the periodic cell deforms from now on").holds_tables();
  file.table("stage.cell.motion", like("cell.motion"),
             "rates until the stage ends, 0 too; a component given here keeps no stress")
      .described(cell_motion_keys());
  file.table("stage.cell.servo", like("cell.servo"),
             "stresses from now on; a component that is not given keeps the stress that it has")
      .described(cell_servo_keys());
}

std::optional<PeriodicCell> cell_of_stage(const TomlValue& stage, std::span<const NamedSchedule> schedules,
                                          std::optional<PeriodicCell> cell) {
  if (cell) cell->rate_xx = cell->rate_yy = cell->rate_xy = {};
  if (cell && cell->servo) cell->servo->goes_on_xx = cell->servo->goes_on_yy = true;
  const TomlValue* given = stage.find("cell");
  if (given == nullptr) return cell;
  if (!cell) fail_at(*given, "the case has no [cell]", "there is nothing to deform", "Add [cell], or remove it");
  refuse_deformation_along_x(*given, *cell);
  cell->place = given->place();
  if (const TomlValue* motion = given->find("motion")) take_motion(*motion, schedules, *cell);
  if (const TomlValue* servo = given->find("servo")) take_servo(*servo, schedules, *cell);
  return cell;
}

void complete_cell(const TomlValue& root, std::span<const NamedSchedule> schedules, GrainTables& tables) {
  const TomlValue* given = root.find("cell");
  if (given == nullptr) return;
  PeriodicCell cell = *tables.cell_table;
  if (cell.along == PeriodicCell::Along::xy && given->find("height") == nullptr)
    fail_at(*given, "height", "missing key", "a cell that repeats along xy has one", "Add height = ... to [cell]");
  if (const TomlValue* measures = root.find("measures"))
    fail_at(*measures, "a run in a periodic cell measures the bodies in a box",
            "a branch across a side of the cell would be taken for one through it",
            "Remove it: the histories have stress, void ratio and coordination number of the cell");
  if (tables.body == Body::sphere && cell.along == PeriodicCell::Along::xy)
    fail_at(*given, "a cell that repeats along xy holds spheres",
            "its stress is by area, and a plane of spheres has no thickness",
            "Let body = \"disc\", or periodic = \"x\"");
  refuse_deformation_along_x(*given, cell);
  cell.place = given->place();
  if (const TomlValue* motion = given->find("motion")) {
    take_motion(*motion, schedules, cell);
    if (!cell.has_rates())
      fail_at(*motion, "all rates are 0", "nothing would move", "Give xx, yy or xy, or remove the table");
  }
  if (const TomlValue* servo = given->find("servo")) take_servo(*servo, schedules, cell);
  tables.scene.cell = cell;
}

namespace {

void bind_bodies(File<GrainTables>& file) {
  file.table("grains", completed, "properties of all grains")
      .keys({key_in<GrainTables>("body", &GrainCase::body,
                                 "disc: a cylinder, kg and N per metre of depth; sphere: kg and N")});
  file.table("grains", &GrainTables::common).keys(common_body_keys());
  file.table("grain", &GrainTables::grain_tables, "one body").keys(grain_keys());
}

void bind_run(File<GrainTables>& file) {
  bind_motion(file, &GrainTables::run, &GrainCase::probes);
  bind_stages(file);
  using M = MeasureOptions;
  file.table("measures", &GrainCase::measures, "quantities measured on the bodies in a box")
      .keys({key("region", &M::region, unit("m"),
                 "[x_min, y_min, x_max, y_max] in which the void ratio is measured; it goes with the shaking box. Left "
                 "out: the box without two mean diameters at its walls and without three below the lowest place of the "
                 "surface, at each moment"),
             key("cell", &M::cell, unit("m"), positive,
                 "width of the cells of the fields of stress, velocity, solid fraction and coordination at the end, "
                 "some bodies wide; left out: no fields")});
}

}  // namespace

std::vector<Key<CommonBodyTable>> common_body_keys() {
  using C = CommonBodyTable;
  return {key("density", &C::density, unit("kg/m³"), positive, "density of every grain that has none of its own"),
          key("path", &C::path,
              "a CSV file of grains: the columns x, y, radius and, where wanted, short_half_axis (of an ellipse, "
              "radius being the long one), discs (of a clump: x y r; x y r), vx, vy, spin, angle, density, group; "
              "grains.csv of run and pack can be read back")};
}

std::vector<Key<GrainTable>> grain_keys() {
  using G = GrainTable;
  return {key("position", &G::grain, &Grain::position, required, unit("m"), "place of the mass centre"),
          key("radius", &G::radius, unit("m"), positive,
              or_instead({"half_axes", "discs"},
                         "a body has one shape: radius is for a disc, half_axes for an ellipse, discs for a clump"),
              "radius of a disc or sphere"),
          key("half_axes", &G::half_axes, unit("m"), positive,
              "[a, b] of an ellipse, the long one first: it lies along x at angle 0"),
          key("discs", &G::discs, optional, unit("m"),
              "discs of a clump, tied rigidly, in the frame of the body at angle 0; they may overlap, areas that "
              "two share count once; all are shifted so that their mass centre is the origin"),
          key("velocity", &G::grain, &Grain::velocity, unit("m/s")),
          key("spin", &G::grain, &Grain::spin, unit("rad/s"), "counter-clockwise"),
          key("angle", &G::grain, &Grain::angle, unit("rad")),
          key("density", &G::density, unit("kg/m³"), positive, "in place of that of [grains]"),
          key("group", &G::group, "for [[collisions.pair]] and [[probe]]")};
}

const File<GrainTables>& grain_file() {
  static const File<GrainTables> file = [] {
    File<GrainTables> made(case_schema, "case file of colliding bodies", CaseKind::colliding);
    made.ask(kinds_with);
    bind_bodies(made);
    bind_bonds(made);
    bind_cell(made);
    bind_collisions(made);
    bind_run(made);
    bind_output(made, &GrainCase::output);
    return made;
  }();
  return file;
}

}  // namespace equidem::casefile
