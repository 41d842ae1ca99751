// SPDX-License-Identifier: GPL-3.0-or-later

#include "equidem/grains/scene/pair_options.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "equidem/contact/restitution.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

namespace {

SpringConstants springs_of(const WaveSpeedStiffness& given) {
  if (!(given.poisson_ratio < 0.5))
    bad_input_at("poisson_ratio", fmt::format("poisson_ratio = {} with wave speeds", given.poisson_ratio),
                 "a body that keeps its volume has an infinite speed of pressure waves", "Give less than 0.5");
  return springs_of_wave_speeds(given.density, wave_speeds_from_shear(given.shear_wave_speed, given.poisson_ratio));
}

/// "exact_flow or linear_dashpot": laws with linear spring and dashpot.
std::string linear_laws_with_dashpot() {
  std::vector<std::string> names;
  for (const LawDescription& law : normal_laws())
    if (law.has_dashpot && law.spring_power == 1) names.emplace_back(law.name);
  return listed(std::move(names), " or ");
}

/// Requirements of each way to give the stiffness of a contact.
class StiffnessCheck {
 public:
  StiffnessCheck(const PairOptions& options, const LawDescription& law, Body body)
      : options_(options), law_(law), body_(body), linear_(law.spring_power == 1) {}

  void operator()(std::monostate) const {
    bad_input_at("stiffness", "stiffness is missing", "no default says how stiff contacts are",
                 linear_ ? "Add contact_duration = ... in s, or stiffness, or largest_overlap with closing_speed, "
                           "or shear_wave_speed with poisson_ratio"
                 : law_.hertz_spring
                     ? "Add stiffness, or young_modulus with poisson_ratio, or largest_overlap with closing_speed"
                     : "Add stiffness, or largest_overlap with closing_speed");
  }
  void operator()(SpringStiffness) const {}
  void operator()(DimensionlessStiffness) const {}
  void operator()(ContactDuration) const {
    if (!linear_)
      bad_input_at(
          "contact_duration", fmt::format("contact_duration with {}", law_.name),
          "its contacts last the shorter the faster they are, so that a duration does not give their stiffness",
          fmt::format("Give stiffness, {}or largest_overlap with closing_speed",
                      law_.hertz_spring ? "young_modulus, " : ""));
  }
  void operator()(LargestOverlap) const {
    if (options_.closing_speed == 0)
      bad_input_at("largest_overlap", "largest_overlap is given without closing_speed",
                   "the overlap depends on the speed", "Add closing_speed = ... in m/s");
  }
  void operator()(const HertzModuli&) const {
    if (!law_.hertz_spring)
      bad_input_at("young_modulus", fmt::format("young_modulus with {}", law_.name), "its spring is not that of Hertz",
                   "Give stiffness, or the law hertz_dashpot");
    if (body_ == Body::disc)
      bad_input_at("young_modulus", "the bodies are discs", "the stiffness by Hertz is that of spheres",
                   "Write body = \"sphere\" in [grains], or give stiffness");
  }
  void operator()(const WaveSpeedStiffness&) const {
    if (!linear_)
      bad_input_at("shear_wave_speed", fmt::format("shear_wave_speed with {}", law_.name),
                   "the springs of wave speeds are linear", "Give stiffness, or a law with linear springs");
    if (body_ == Body::sphere)
      bad_input_at("shear_wave_speed", "the bodies are spheres",
                   "springs of wave speeds are those of cylinders, per metre of depth",
                   "Write body = \"disc\" in [grains], or give stiffness");
  }

 private:
  const PairOptions& options_;
  const LawDescription& law_;
  Body body_;
  bool linear_;
};

/// The law and the body have what the options ask for.
void check_use(const PairOptions& options, const LawDescription& law, Body body) {
  if (std::holds_alternative<std::monostate>(options.rebound))
    bad_input_at("restitution", "restitution is missing", "no default says how contacts rebound",
                 "Add restitution = ... from 0 to 1, or damping = ... of the dashpots");
  std::visit(StiffnessCheck(options, law, body), options.stiffness);
  if (!std::holds_alternative<DashpotDamping>(options.rebound)) return;
  if (!law.has_dashpot || law.spring_power != 1)
    bad_input_at("damping", fmt::format("{} has no use for damping", law.name),
                 "it is h of the dashpots 2 h sqrt(m k) of linear springs",
                 "Give restitution, or the law " + linear_laws_with_dashpot());
}

/// The restitution, and zeta of the tangential dashpot where no other is given.
double set_rebound(const ReboundOptions& rebound, const MeetingBodies& bodies, PairProperties& properties) {
  if (const auto* given = std::get_if<Restitution>(&rebound)) {
    properties.restitution = given->value;
    return 0;
  }
  const ContactDamping zeta =
      contact_damping_of(std::get<DashpotDamping>(rebound).value, bodies.on_wall, inertia_factor(bodies.body));
  properties.restitution = restitution_of(zeta.normal, properties.end);
  return zeta.tangential;
}

/// The dashpot that gives the restitution is finite, and floating-point numbers resolve its work.
void check_restitution(NormalLaw law, const PairProperties& pair) {
  constexpr double least = 1e-12;  // a dashpot a million times the critical one
  if (!describe(law).has_dashpot || pair.end == ContactEnd::at_zero_overlap || pair.restitution >= least) return;
  bad_input_at("restitution", fmt::format("restitution = {} for contacts that end at zero force", pair.restitution),
               "it would need an infinite dashpot, or one too strong for numbers to resolve",
               fmt::format("Give {} or more, or the law energy_map", least));
}

void set_friction(const PairOptions& options, NormalLaw law, double tangential_zeta, PairProperties& properties) {
  properties.friction = options.friction;
  if (!(options.friction > 0)) return;
  const auto* waves = std::get_if<WaveSpeedStiffness>(&options.stiffness);
  const double usual = is_map(law) ? 0 : waves != nullptr ? springs_of(*waves).ratio() : 2.0 / 7;
  properties.tangential_ratio = options.tangential_ratio.value_or(usual);
  if (options.tangential_damping) {
    properties.tangential_damping = *options.tangential_damping;
  } else if (properties.tangential_ratio > 0) {
    properties.tangential_damping = tangential_zeta;
  }
}

/// Rolling resistance, and cohesion. \param tangential_zeta as in set_friction
void set_effects(const PairOptions& options, double tangential_zeta, PairProperties& properties) {
  if (options.cohesion > 0) properties.cohesion = options.cohesion, properties.cohesion_range = options.cohesion_range;
  if (!(options.rolling_friction > 0)) return;
  const double usual = properties.tangential_ratio > 0 ? properties.tangential_ratio : 2.0 / 7;
  properties.rolling_friction = options.rolling_friction;
  properties.rolling_ratio = options.rolling_ratio.value_or(usual);
  properties.rolling_damping = options.rolling_damping.value_or(options.tangential_damping.value_or(tangential_zeta));
}

/// Sets stiffness, dimensionless or duration of a contact whose other properties are known.
class StiffnessOf {
 public:
  StiffnessOf(NormalLaw law, const MeetingBodies& bodies, PairContact& contact)
      : law_(law), bodies_(bodies), contact_(contact), k_(contact.properties.stiffness) {}

  void operator()(std::monostate) const {}
  void operator()(SpringStiffness given) const { k_ = given.value; }
  void operator()(DimensionlessStiffness given) const { contact_.properties.dimensionless = given.value; }
  void operator()(ContactDuration given) const {
    contact_.duration = given.value;
    const double zeta = damping_ratio(law_, contact_.properties);
    if (zeta >= 1)
      bad_input_at("contact_duration",
                   fmt::format("with restitution {} the contact never comes back to zero overlap",
                               contact_.properties.restitution),
                   fmt::format("its damping ratio is {:.4g}, 1 or more", zeta), "Give stiffness instead");
  }
  void operator()(LargestOverlap given) const {
    k_ = describe(law_).stiffness_from_overlap(given.value, contact_.closing_speed, bodies_.largest_reduced_mass,
                                               damping_ratio(law_, contact_.properties));
  }
  void operator()(const HertzModuli& given) const {
    const double young = given.young_modulus, poisson = given.poisson_ratio;
    k_ = bodies_.on_wall ? hertz_stiffness_on_rigid_wall(young, poisson, bodies_.radius_i)
                         : hertz_stiffness(young, poisson, bodies_.radius_i, young, poisson, bodies_.radius_j);
  }
  void operator()(const WaveSpeedStiffness& given) const { k_ = springs_of(given).kN; }

 private:
  NormalLaw law_;
  const MeetingBodies& bodies_;
  PairContact& contact_;
  double& k_;
};

}  // namespace

PairContact contact_of(const PairOptions& options, NormalLaw law, const MeetingBodies& bodies) {
  check_use(options, describe(law), bodies.body);
  PairContact contact{.properties = {}, .closing_speed = options.closing_speed};
  contact.properties.end = describe(law).usual_end;
  const double tangential_zeta = set_rebound(options.rebound, bodies, contact.properties);
  set_friction(options, law, tangential_zeta, contact.properties);
  set_effects(options, tangential_zeta, contact.properties);
  check_resistance(contact.properties, law);
  check_restitution(law, contact.properties);
  std::visit(StiffnessOf(law, bodies, contact), options.stiffness);
  return contact;
}

PairProperties properties_at(const PairContact& contact, NormalLaw law, double step) {
  PairProperties properties = contact.properties;
  if (contact.duration > 0) {  // the half period of the damped oscillator
    const double zeta = damping_ratio(law, properties);
    const double turn = std::numbers::pi * step / contact.duration;
    properties.dimensionless = turn * turn / (1 - zeta * zeta);
  }
  return properties;
}

double damping_ratio(NormalLaw law, const PairProperties& pair) {
  return describe(law).damping_ratio(pair.restitution, pair.end);
}

namespace {

/// With more kinds the table of all pairs is no longer small.
constexpr std::size_t most_kinds = 256;

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// \throws Error where `name` is none of `groups` and, with `walls_too`, none of the walls
void check_name(const std::string& name, const std::string& option, std::vector<std::string> groups,
                const std::vector<Wall>& walls, bool walls_too) {
  if (walls_too)
    for (const Wall& wall : walls) groups.push_back(wall.name);
  if (contains(groups, name)) return;
  const auto meant = nearest(name, groups);
  for (std::string& choice : groups) choice = "'" + choice + "'";
  const std::string names = first_words(std::move(groups));
  bad_input_at(option, fmt::format("\"{}\" is no group of grains{}", name, walls_too ? " and no wall" : ""),
               "there are " + names, meant ? fmt::format("Did you mean \"{}\"?", *meant) : "Name one of them");
}

bool is_pair(const CollisionOptions::Pair& pair, const std::string& first, const std::string& second) {
  return std::minmax(pair.group, pair.with) == std::minmax(first, second);
}

/// \return the walls that have a pair of their own
std::vector<std::string> check_pairs(const CollisionOptions& options, const std::vector<std::string>& groups,
                                     const std::vector<Wall>& walls) {
  std::vector<std::string> apart;
  for (std::size_t k = 0; k < options.pairs.size(); ++k) {
    const CollisionOptions::Pair& pair = options.pairs[k];
    if (!contains(groups, pair.group) && contains(names_of(walls), pair.group))
      bad_input_at(fmt::format("pairs.{}.group", k), fmt::format("'{}' is no group of grains but a wall", pair.group),
                   contains(groups, pair.with) ? "group names grains, and with names grains or a wall"
                                               : "walls do not meet one another",
                   contains(groups, pair.with) ? "Exchange group and with" : "Name a group of grains");
    check_name(pair.group, fmt::format("pairs.{}.group", k), groups, walls, false);
    check_name(pair.with, fmt::format("pairs.{}.with", k), groups, walls, true);
    if (!contains(groups, pair.with) && !contains(apart, pair.with)) apart.push_back(pair.with);
    for (std::size_t earlier = 0; earlier < k; ++earlier)
      if (is_pair(options.pairs[earlier], pair.group, pair.with))
        bad_input_at(fmt::format("pairs.{}", k), fmt::format("'{}' and '{}' are a pair twice", pair.group, pair.with),
                     "two bodies meet in one way", "Keep one of them");
  }
  return apart;
}

/// contact_of with errors that name the table of the option.
PairContact contact_in(const std::string& table, const PairOptions& options, NormalLaw law,
                       const MeetingBodies& bodies) {
  try {
    return contact_of(options, law, bodies);
  } catch (const Error& error) {
    bad_input_at(error.where().empty() ? table
                 : table.empty()       ? error.where()
                                       : table + "." + error.where(),
                 error.problem(), error.why(), error.remedy());
  }
}

}  // namespace

ContactTable set_kinds(GrainScene& scene, std::span<const std::string> groups, const CollisionOptions& options,
                       NormalLaw law) {
  const bool by_radius = std::holds_alternative<HertzModuli>(options.bodies.stiffness);
  ContactTable table;
  std::map<std::pair<std::string, double>, int> kind_of;
  std::vector<std::string> group_names;
  std::vector<double> radii;  // of the kinds of grains, where contacts depend on it
  for (std::size_t g = 0; g < scene.grains.size(); ++g) {
    const std::string group = groups.empty() ? "grains" : groups[g];
    const double radius = by_radius ? scene.grains[g].radius : 0;
    const auto [at, is_new] = kind_of.try_emplace({group, radius}, table.kind_count());
    if (is_new) {
      if (!contains(group_names, group)) group_names.push_back(group);
      table.kinds.push_back(group);
      radii.push_back(radius);
      if (table.kinds.size() > most_kinds)
        bad_input_at(
            by_radius ? "young_modulus" : "group",
            fmt::format("there are more than {} {}", most_kinds, by_radius ? "different radii" : "groups"),
            "a table of all pairs of them would grow large",
            by_radius ? "Give stiffness instead, or fewer radii" : "Put grains that meet alike into one group");
    }
    scene.grains[g].kind = at->second;
  }
  const std::size_t grain_kinds = table.kinds.size();

  const std::vector<std::string> walls_apart = check_pairs(options, group_names, scene.walls);
  if (walls_apart.size() < scene.walls.size()) table.kinds.emplace_back("walls");
  table.kinds.insert(table.kinds.end(), walls_apart.begin(), walls_apart.end());
  const auto first_wall = table.kinds.begin() + static_cast<std::ptrdiff_t>(grain_kinds);
  for (Wall& wall : scene.walls) {
    const auto at = std::find(first_wall, table.kinds.end(), wall.name);
    wall.kind = static_cast<int>((at != table.kinds.end() ? at : first_wall) - table.kinds.begin());
  }
  scene.kinds = table.kind_count();

  contact_in("", options.bodies, law, {.body = options.body, .radius_i = 1, .radius_j = 1});  // also where none meet
  const auto masses = masses_of_kinds(scene.grains, scene.kinds);
  const int count = scene.kinds;
  table.pairs.resize(static_cast<std::size_t>(count) * static_cast<std::size_t>(count));
  for (int a = 0; a < count; ++a) {
    for (int b = a; b < count; ++b) {
      const auto first = static_cast<std::size_t>(a), second = static_cast<std::size_t>(b);
      const auto reduced = reduced_masses(masses, a, b);
      MeetingBodies bodies{.body = options.body,
                           .on_wall = second >= grain_kinds,
                           .largest_reduced_mass = reduced ? reduced->largest : 1,
                           .radius_i = first < grain_kinds ? radii[first] : 1,  // two walls never meet
                           .radius_j = second < grain_kinds ? radii[second] : 0};
      const bool differs = bodies.on_wall && options.walls;
      const PairOptions* contact = differs ? &*options.walls : &options.bodies;
      std::string name = differs ? "walls" : "";
      for (std::size_t k = 0; k < options.pairs.size(); ++k) {
        if (!is_pair(options.pairs[k], table.kinds[first], table.kinds[second])) continue;
        contact = &options.pairs[k].contact;
        name = fmt::format("pairs.{}", k);
      }
      const PairContact found = contact_in(name, *contact, law, bodies);
      table.pairs[a * count + b] = found;
      table.pairs[b * count + a] = found;
    }
  }
  return table;
}

std::vector<PairProperties> pairs_at(const ContactTable& contacts, NormalLaw law, double step) {
  std::vector<PairProperties> pairs;
  for (const PairContact& contact : contacts.pairs) pairs.push_back(properties_at(contact, law, step));
  return pairs;
}

std::vector<KindMasses> masses_of_kinds(std::span<const Grain> grains, int kind_count) {
  std::vector<KindMasses> kinds(static_cast<std::size_t>(kind_count));
  for (const Grain& grain : grains) {
    if (!grain.present) continue;
    KindMasses& kind = kinds[grain.kind];
    const double mass = grain.inertia.mass;
    if (kind.grains++ == 0) {
      kind.smallest = kind.largest = mass;
    } else if (kind.grains == 2) {
      kind.second_smallest = kind.largest = std::max(kind.smallest, mass);
      kind.second_largest = kind.smallest = std::min(kind.smallest, mass);
    } else {
      kind.second_smallest = std::min(kind.second_smallest, std::max(kind.smallest, mass));
      kind.smallest = std::min(kind.smallest, mass);
      kind.second_largest = std::max(kind.second_largest, std::min(kind.largest, mass));
      kind.largest = std::max(kind.largest, mass);
    }
  }
  return kinds;
}

std::optional<ReducedMasses> reduced_masses(const std::vector<KindMasses>& kinds, int a, int b) {
  const KindMasses& first = kinds[a];
  const KindMasses& second = kinds[b];
  const auto reduced = [](double m, double n) { return m * n / (m + n); };
  if (first.grains == 0 && second.grains == 0) return {};
  if (first.grains == 0) return ReducedMasses{second.smallest, second.largest};
  if (second.grains == 0) return ReducedMasses{first.smallest, first.largest};
  if (a != b) return ReducedMasses{reduced(first.smallest, second.smallest), reduced(first.largest, second.largest)};
  if (first.grains < 2) return {};
  return ReducedMasses{reduced(first.smallest, first.second_smallest), reduced(first.largest, first.second_largest)};
}

namespace {

using std::numbers::pi;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The contact of the lightest bodies of two kinds.
struct Shortest {
  double duration = infinity;  ///< s
  double detail = infinity;    ///< s, to be resolved by steps: the duration, or the shorter time of a strong dashpot
  double omega = 0;            ///< 1/s; hertz_dashpot: at the largest overlap; 0: not known
  double zeta = 0;
  int a = 0, b = 0;
  bool any = false;  ///< two bodies can meet
};

/// Largest 1 + m l²/I of each kind: under a force with the lever l a body moves as if its mass were less by that
/// factor.
std::vector<double> agility_of_kinds(const GrainScene& scene) {
  std::vector<double> agility(static_cast<std::size_t>(scene.kinds), 1.0);
  for (const Grain& grain : scene.grains) {
    const double lever = longest_lever(outline_of(grain, scene.clumps));
    double& most = agility[grain.kind];
    most = std::max(most, 1 + grain.inertia.mass * lever * lever / grain.inertia.moment);
  }
  return agility;
}

/// \param step s, for a stiffness that is kept in steps; 0: not known
/// \throws Error where the contact of some pair has no known duration
Shortest shortest_contact(const GrainScene& scene, const ContactTable& contacts, const GrainOptions& options,
                          double step) {
  Shortest shortest;
  const LawDescription& law = describe(options.law);
  const auto masses = masses_of_kinds(scene.grains, scene.kinds);
  const auto agility = agility_of_kinds(scene);
  for (int a = 0; a < scene.kinds; ++a) {
    for (int b = a; b < scene.kinds; ++b) {
      const auto reduced = reduced_masses(masses, a, b);
      if (!reduced) continue;
      shortest.any = true;
      const PairContact& pair = contacts.between(a, b);
      const PairProperties& properties = pair.properties;
      if (properties.dimensionless > 0 && step == 0)
        bad_input_at("time_step", "time_step = \"auto\" with dimensionless_stiffness",
                     "the step is what makes the stiffness", "Give time_step = ... in s, or another stiffness");
      // Spring and dashpot of a contact are those of bodies that do not turn.
      const double faster = std::sqrt(std::max(agility[a], agility[b]));
      const double still = damping_ratio(options.law, properties), zeta = faster * still;
      double duration = 0, omega = 0;
      if (law.spring_power != 1) {
        if (pair.closing_speed == 0) {
          if (step > 0) return Shortest{.duration = 0, .any = true};
          bad_input_at("time_step", fmt::format("time_step = \"auto\" of {} without closing_speed", law.name),
                       "a contact of this law lasts the shorter the faster it is",
                       "Add closing_speed = ... in m/s to [collisions], or give time_step = ... in s");
        }
        const double k = properties.stiffness > 0
                             ? properties.stiffness
                             : properties.dimensionless * reduced->smallest /
                                   (step * step * law.length_factor(reference_length(scene, options)));
        const ElasticImpact impact = law.elastic_impact(k, reduced->smallest, pair.closing_speed);
        duration = impact.duration / faster;
        omega = faster * std::sqrt(law.spring_power * k * law.length_factor(impact.overlap) / reduced->smallest);
      } else {
        omega = faster * (pair.duration > 0          ? pi / (pair.duration * std::sqrt(1 - still * still))
                          : properties.stiffness > 0 ? std::sqrt(properties.stiffness / reduced->smallest)
                                                     : std::sqrt(properties.dimensionless) / step);
        duration = pi / (omega * (zeta < 1 ? std::sqrt(1 - zeta * zeta) : 1));
      }
      // simultaneous laws: omega dt = 1 by default, whatever the damping; else by the faster of the two rates of decay
      const double haste = zeta > 1 ? zeta + std::sqrt(zeta * zeta - 1) : 1;
      const double detail = law.kind == LawKind::simultaneous ? pi / omega : duration / haste;
      if (detail < shortest.detail)
        shortest = {.duration = duration, .detail = detail, .omega = omega, .zeta = zeta, .a = a, .b = b, .any = true};
    }
  }
  return shortest;
}

void limit_by_bonds(const GrainScene& scene, GrainOptions options, GrainTimeStep& result) {
  const double limit = bond_step_limit(scene, options.bond_step);
  if (std::isfinite(limit)) result.bond_limit = limit;
  if (result.automatic) result.step = std::min(result.step, 0.5 * limit);
  constexpr double one_percent = 0.1;  // of the limit of explicit dashpots
  const double explicit_limit = explicit_step_limit(scene);
  if (options.bond_step == GrainOptions::BondStep::exact && result.step > one_percent * explicit_limit)
    result.chain_limit = explicit_limit;
  options.time_step = result.step;
  try {
    check_bonds(scene, options);
  } catch (const Error& error) {
    throw error.at(is_simultaneous(options.law) ? "law" : result.step >= limit ? "time_step" : "bonds");
  }
}

}  // namespace

GrainTimeStep choose_time_step(const GrainScene& scene, const ContactTable& contacts, const GrainOptions& options,
                               const GrainStepOptions& wanted) {
  GrainTimeStep result{.step = wanted.time_step.value_or(0), .between = {}, .automatic = !wanted.time_step};
  const Shortest shortest = shortest_contact(scene, contacts, options, result.step);
  if (!shortest.any) {
    if (!result.automatic) return result;
    bad_input_at("time_step", "time_step = \"auto\" where no two bodies can meet", "there is one grain and no wall",
                 "Give time_step = ... in s, or add a [[wall]]");
  }
  if (result.automatic)
    result.step = std::min(shortest.detail / wanted.steps_per_contact.value_or(describe(options.law).steps_per_contact),
                           wanted.longest);
  if (!scene.bonds.empty()) limit_by_bonds(scene, options, result);
  result.contact = shortest.duration;
  result.between = fmt::format("{} and {}", contacts.kind(shortest.a), contacts.kind(shortest.b));
  result.omega_step = shortest.omega * result.step;
  result.limit = describe(options.law).stable_step(shortest.zeta);
  if (gives_force(options.law) && result.omega_step > result.limit)
    bad_input_at("time_step",
                 fmt::format("the step of {:.6g} s is {:.4g} times the limit of stability of a contact of {}",
                             result.step, result.omega_step / result.limit, result.between),
                 "contacts would gain energy without end",
                 fmt::format("Stay below {:.6g} s, or take softer contacts or the law exact_flow",
                             result.step * result.limit / result.omega_step));
  return result;
}

}  // namespace equidem
