// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/grain_pairs.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>

#include "equidem/casefile/read_value.hpp"
#include "equidem/contact/collision_stiffness.hpp"
#include "equidem/core/nearest.hpp"
#include "equidem/material/wave_speed_springs.hpp"

namespace equidem {
namespace {

/// With so many radii a table of all pairs of them is no longer small.
constexpr std::size_t most_kinds = 256;

/// What a table says that later ones may say otherwise; values that are not given are nullptr.
struct Terms {
  std::string key;  ///< of the table, for errors
  const TomlValue* restitution = nullptr;
  const TomlValue* damping = nullptr;  ///< instead of it
  const TomlValue* end = nullptr;
  const TomlValue* stiffness = nullptr;  ///< by the key `by`
  const char* by = "";
  const TomlValue* closing_speed = nullptr;
  const TomlValue* friction = nullptr;
  const TomlValue* tangential_ratio = nullptr;
  const TomlValue* tangential_damping = nullptr;
  const TomlValue* cap = nullptr;
};

constexpr std::array ways_to_stiffness = {"stiffness",       "dimensionless_stiffness", "contact_duration",
                                          "largest_overlap", "young_modulus",           "shear_wave_speed"};

/// Two kinds, as far as their contact depends on it.
struct Meeting {
  std::optional<ReducedMasses> masses;
  bool on_wall = false;
  std::function<double()> stiffness_by_hertz;
  SpringConstants by_wave_speeds;  ///< Pa; where they are given
};

bool is_linear(NormalLaw law) {
  return describe(law).spring_power == 1;
}

/// "Give restitution, or the law exact_flow or linear_dashpot"
std::string linear_laws_with_dashpot() {
  std::string names;
  for (const LawDescription& law : normal_laws()) {
    if (law.has_dashpot && law.spring_power == 1) names += (names.empty() ? "" : " or ") + std::string(law.name);
  }
  return names;
}

void check_damping(const TomlValue& table, const std::string& key, NormalLaw law) {
  const TomlValue& damping = *table.find("damping");
  if (table.find("restitution") != nullptr)
    fail_at(damping, key + ".damping", "restitution and damping are both given", "each says how strong the dashpot is",
            "Remove one of them");
  if (!describe(law).has_dashpot || !is_linear(law))
    fail_at(damping, key + ".damping", fmt::format("{} has no use for damping", to_string(law)),
            "it is h of the dashpots 2 h sqrt(m k) of linear springs",
            "Give restitution, or the law " + linear_laws_with_dashpot());
}

/// `terms` with what a table says instead.
Terms with(Terms terms, const TomlValue& table, const std::string& key, NormalLaw law) {
  terms.key = key;
  const auto take = [&](const TomlValue*& value, const char* name) {
    if (const TomlValue* found = table.find(name)) value = found;
  };
  take(terms.restitution, "restitution");
  if (table.find("restitution") != nullptr) terms.damping = nullptr;
  take(terms.damping, "damping");
  take(terms.end, "contact_end");
  take(terms.closing_speed, "closing_speed");
  take(terms.friction, "friction");
  take(terms.tangential_ratio, "tangential_ratio");
  take(terms.tangential_damping, "tangential_damping");
  take(terms.cap, "friction_cap");
  const TomlValue* earlier = nullptr;
  for (const char* way : ways_to_stiffness) {
    const TomlValue* found = table.find(way);
    if (found == nullptr) continue;
    if (earlier != nullptr)
      fail_at(*found, fmt::format("{}.{}", key, way), fmt::format("{} and {} are both given", terms.by, way),
              "each says how stiff a contact is", "Remove one of them");
    earlier = terms.stiffness = found;
    terms.by = way;
  }
  if (const TomlValue* end = table.find("contact_end"); end != nullptr && !describe(law).has_dashpot)
    fail_at(*end, key + ".contact_end", fmt::format("{} has no use for contact_end", to_string(law)),
            "it has no dashpot", "Remove it");
  if (table.find("damping") != nullptr) check_damping(table, key, law);
  if (const TomlValue* duration = table.find("contact_duration"); duration != nullptr && !is_linear(law))
    fail_at(*duration, key + ".contact_duration",
            fmt::format("a contact of {} lasts the shorter the faster it is", to_string(law)),
            "a duration says nothing of its stiffness",
            fmt::format("Give stiffness, {}or largest_overlap with closing_speed",
                        describe(law).hertz_spring ? "young_modulus, " : ""));
  return terms;
}

void check_springs_of_moduli(const TomlValue& table, const GrainCase& result) {
  const TomlValue* young = table.find("young_modulus");
  const TomlValue* shear = table.find("shear_wave_speed");
  const TomlValue* poisson = table.find("poisson_ratio");
  if (young == nullptr && shear == nullptr) {
    if (poisson == nullptr) return;
    const bool hertz = describe(result.law).hertz_spring;
    fail_at(*poisson, "collisions.poisson_ratio",
            fmt::format("poisson_ratio is given without {}", hertz ? "young_modulus" : "shear_wave_speed"),
            "both make the stiffness of a contact",
            hertz ? "Add young_modulus = ... in Pa" : "Add shear_wave_speed = ... in m/s");
  }
  const TomlValue& given = young != nullptr ? *young : *shear;
  const char* name = young != nullptr ? "young_modulus" : "shear_wave_speed";
  const std::string key = fmt::format("collisions.{}", name);
  if (poisson == nullptr)
    fail_at(given, key, fmt::format("{} is given without poisson_ratio", name), "both make the stiffness of a contact",
            "Add poisson_ratio = ...");
  if (young != nullptr) {
    if (result.body == Body::disc)
      fail_at(given, key, "the bodies are discs", "the stiffness by Hertz is that of spheres",
              "Write body = \"sphere\" in [grains], or give stiffness");
    return;
  }
  if (result.body == Body::sphere)
    fail_at(given, key, "the bodies are spheres", "springs of wave speeds are those of cylinders, per metre of depth",
            "Write body = \"disc\" in [grains], or give stiffness");
  if (!(poisson->real < 0.5))
    fail_at(*poisson, "collisions.poisson_ratio", "poisson_ratio = 0.5 with wave speeds",
            "what keeps its volume has an infinite speed of pressure waves", "Give less than 0.5");
  if (const TomlValue* ratio = table.find("tangential_ratio"))
    fail_at(*ratio, "collisions.tangential_ratio", "tangential_ratio and shear_wave_speed are both given",
            "each says how stiff the tangential spring is", "Remove one of them");
  const auto [least, most] = std::ranges::minmax(result.densities);
  if (least < most)
    fail_at(given, key, fmt::format("the grains have densities from {} to {} kg/m³", least, most),
            "springs of wave speeds belong to one density",
            "Give one density, or stiffness and tangential_ratio for each pair");
}

void check_base(const TomlValue& table, const Terms& base, const GrainCase& result) {
  if (base.restitution == nullptr && base.damping == nullptr)
    fail_at(table, "collisions.restitution", "it is not said how contacts rebound", "there is no default for it",
            "Add restitution = ... from 0 to 1, or damping = ... of the dashpots");
  check_springs_of_moduli(table, result);
  if (base.stiffness != nullptr) return;
  const LawDescription& law = describe(result.law);
  fail_at(
      table, "collisions.stiffness", "it is not said how stiff contacts are", "there is no default for it",
      law.spring_power == 1 ? "Add contact_duration = ... in s, or stiffness, or largest_overlap with closing_speed, "
                              "or shear_wave_speed with poisson_ratio"
      : law.hertz_spring ? "Add stiffness, or young_modulus with poisson_ratio, or largest_overlap with closing_speed"
                         : "Add stiffness, or largest_overlap with closing_speed");
}

/// The restitution, and zeta of the tangential dashpot where nothing else is said of it.
double read_dashpots(const Terms& terms, const GrainCase& result, bool on_wall, PairProperties& properties) {
  if (terms.damping == nullptr) {
    properties.restitution = terms.restitution->real;
    return 0;
  }
  if (properties.end == ContactEnd::at_zero_overlap)
    fail_at(*terms.end, terms.key + ".contact_end", "contact_end = \"zero_overlap\" with damping",
            "a strong dashpot never lets the overlap come back to zero", "Remove it, or give restitution");
  const ContactDamping zeta = contact_damping_of(terms.damping->real, on_wall, inertia_factor(result.body));
  properties.restitution = restitution_of(zeta.normal, properties.end);
  return zeta.tangential;
}

/// The dashpot that gives the restitution exists, and numbers resolve what it does.
void check_restitution(const Terms& terms, NormalLaw law, const PairProperties& pair) {
  constexpr double least = 1e-12;  // a dashpot a million times the critical one
  if (!describe(law).has_dashpot || pair.end == ContactEnd::at_zero_overlap || pair.restitution >= least) return;
  assert(terms.damping == nullptr);
  fail_at(*terms.restitution, terms.key + ".restitution",
          fmt::format("restitution = {} of contacts that end at zero force", terms.restitution->shown()),
          "it would need an infinite dashpot, or one too strong for numbers to resolve",
          fmt::format("Give {} or more, or contact_end = \"zero_overlap\", or the law energy_map", least));
}

void set_stiffness(const Terms& terms, const GrainCase& result, const Meeting& meeting, PairCase& pair) {
  PairProperties& properties = pair.properties;
  const std::string by = terms.by;
  const double value = terms.stiffness->real;
  if (by == "stiffness") {
    properties.stiffness = value;
  } else if (by == "dimensionless_stiffness") {
    properties.dimensionless = value;
  } else if (by == "contact_duration") {
    pair.duration = value;
    const double zeta = damping_ratio(result.law, properties);
    if (zeta >= 1)
      fail_at(*terms.stiffness, terms.key + ".contact_duration",
              fmt::format("with restitution {} the contact never comes back to zero overlap", properties.restitution),
              fmt::format("its damping ratio is {:.4g}, 1 or more", zeta), "Give stiffness instead");
  } else if (by == "largest_overlap") {
    if (terms.closing_speed == nullptr)
      fail_at(*terms.stiffness, terms.key + ".largest_overlap", "largest_overlap is given without closing_speed",
              "the overlap depends on the speed", "Add closing_speed = ... in m/s");
    const double speed = terms.closing_speed->real;
    const double mass = meeting.masses ? meeting.masses->largest : 1;
    properties.stiffness =
        describe(result.law).stiffness_from_overlap(value, speed, mass, damping_ratio(result.law, properties));
  } else if (by == "young_modulus") {
    properties.stiffness = meeting.stiffness_by_hertz();
  } else {
    properties.stiffness = meeting.by_wave_speeds.kN;
  }
}

PairCase pair_of(const Terms& terms, const GrainCase& result, const Meeting& meeting) {
  PairCase pair;
  PairProperties& properties = pair.properties;
  properties.end = describe(result.law).usual_end;
  if (terms.end != nullptr) properties.end = enum_from<ContactEnd>(terms.end->text);
  const double tangential_zeta = read_dashpots(terms, result, meeting.on_wall, properties);
  properties.friction = terms.friction->real;
  if (properties.friction > 0) {
    // A map gives all of its impulse in one or two steps, in which a spring cannot be stretched to the force of
    // friction.
    const bool by_wave_speeds = std::string_view(terms.by) == "shear_wave_speed";
    const double usual = is_map(result.law) ? 0 : by_wave_speeds ? meeting.by_wave_speeds.ratio() : 2.0 / 7;
    properties.tangential_ratio = terms.tangential_ratio != nullptr ? terms.tangential_ratio->real : usual;
    if (terms.tangential_damping != nullptr) {
      properties.tangential_damping = terms.tangential_damping->real;
    } else if (properties.tangential_ratio > 0) {
      properties.tangential_damping = tangential_zeta;
    }
    if (properties.tangential_damping > 0 && properties.tangential_ratio == 0)
      fail_at(*terms.tangential_damping, terms.key + ".tangential_damping",
              "tangential damping is given without a tangential spring", "it is measured by that spring",
              "Give tangential_ratio > 0");
  }
  properties.cap = terms.cap->text == "whole_force" ? FrictionCap::whole_force : FrictionCap::spring_alone;
  if (terms.closing_speed != nullptr) pair.closing_speed = terms.closing_speed->real;
  check_restitution(terms, result.law, properties);
  set_stiffness(terms, result, meeting, pair);
  return pair;
}

struct Override {
  std::string first, second;
  const TomlValue* table;
};

/// The overrides of [[collisions.pair]]; `walls` collects the walls that have some.
std::vector<Override> read_overrides(const TomlValue& collisions, const std::vector<std::string>& groups,
                                     const GrainCase& result, std::vector<std::string>& walls) {
  std::vector<Override> overrides;
  std::vector<std::string> names = groups, wall_names;
  for (const GrainWall& wall : result.walls) wall_names.push_back(wall.name);
  const auto is_in = [](const std::vector<std::string>& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  for (const TomlValue& table : repeated(collisions, "pair")) {
    const auto known = [&](const char* key, bool walls_too) {
      const TomlValue& value = *table.find(key);
      std::vector<std::string> choices = groups;
      if (walls_too) choices.insert(choices.end(), wall_names.begin(), wall_names.end());
      if (is_in(choices, value.text)) return value.text;
      const auto meant = nearest(value.text, choices);
      std::string list;
      for (const std::string& choice : choices) list += fmt::format("{}'{}'", list.empty() ? "" : ", ", choice);
      fail_at(value, fmt::format("collisions.pair.{}", key),
              fmt::format("{} is no group of grains{}", value.shown(), walls_too ? " and no wall" : ""),
              fmt::format("there are {}", list),
              meant ? fmt::format("Did you mean \"{}\"?", *meant) : "Name one of them");
    };
    const std::string first = known("group", false), second = known("with", true);
    if (is_in(wall_names, second) && !is_in(walls, second)) walls.push_back(second);
    for (const Override& earlier : overrides) {
      if (std::minmax(earlier.first, earlier.second) != std::minmax(first, second)) continue;
      fail_at(table, "collisions.pair", fmt::format("'{}' and '{}' are a pair twice", first, second),
              fmt::format("the other is at {}", earlier.table->where()), "Keep one of them");
    }
    overrides.push_back({first, second, &table});
  }
  return overrides;
}

}  // namespace

void read_collisions(const TomlValue& root, const std::vector<std::string>& groups, GrainCase& result) {
  const TomlValue& table = *root.find("collisions");
  const bool by_radius = table.find("young_modulus") != nullptr;
  std::map<std::pair<std::string, double>, int> kind_of;
  std::vector<std::string> group_names;
  std::vector<double> radii;  // of the kinds of grains, where contacts depend on it
  for (std::size_t g = 0; g < result.grains.size(); ++g) {
    const double radius = by_radius ? result.grains[g].radius : 0;
    const auto [at, is_new] = kind_of.try_emplace({groups[g], radius}, static_cast<int>(result.kinds.size()));
    if (is_new) {
      if (std::find(group_names.begin(), group_names.end(), groups[g]) == group_names.end())
        group_names.push_back(groups[g]);
      result.kinds.push_back(groups[g]);
      radii.push_back(radius);
      if (result.kinds.size() > most_kinds) {
        fail_at(table, by_radius ? "collisions.young_modulus" : "grain.group",
                fmt::format("there are more than {} {}", most_kinds, by_radius ? "different radii" : "groups"),
                "a table of all pairs of them would grow large",
                by_radius ? "Give stiffness instead, or fewer radii" : "Put grains that meet alike into one group");
      }
    }
    result.grains[g].kind = at->second;
  }
  const std::size_t grain_kinds = result.kinds.size();

  std::vector<std::string> walls_apart;
  const auto overrides = read_overrides(table, group_names, result, walls_apart);
  if (walls_apart.size() < result.walls.size()) result.kinds.emplace_back("walls");
  result.kinds.insert(result.kinds.end(), walls_apart.begin(), walls_apart.end());
  for (GrainWall& wall : result.walls) {
    const auto at =
        std::find(result.kinds.begin() + static_cast<std::ptrdiff_t>(grain_kinds), result.kinds.end(), wall.name);
    wall.kind = static_cast<int>(
        (at != result.kinds.end() ? at - result.kinds.begin() : static_cast<std::ptrdiff_t>(grain_kinds)));
  }

  const Terms base = with({}, table, "collisions", result.law);
  check_base(table, base, result);
  Terms walls = base;
  if (const TomlValue* differs = table.find("walls")) walls = with(base, *differs, "collisions.walls", result.law);
  SpringConstants by_wave_speeds;
  if (const TomlValue* shear = table.find("shear_wave_speed"))
    by_wave_speeds = springs_of_wave_speeds(result.densities.front(),
                                            wave_speeds_from_shear(shear->real, number(table, "poisson_ratio")));
  const auto masses = masses_of_kinds(result);
  const int count = result.kind_count();
  result.pairs.resize(static_cast<std::size_t>(count) * static_cast<std::size_t>(count));
  for (int a = 0; a < count; ++a) {
    for (int b = a; b < count; ++b) {
      const auto first = static_cast<std::size_t>(a), second = static_cast<std::size_t>(b);
      const bool on_wall = second >= grain_kinds;
      Terms terms = on_wall ? walls : base;
      for (const Override& differs : overrides) {
        if (std::minmax(differs.first, differs.second) == std::minmax(result.kinds[first], result.kinds[second]))
          terms = with(terms, *differs.table, "collisions.pair", result.law);
      }
      const auto by_hertz = [&] {
        if (first >= grain_kinds) return 1.0;  // two walls never meet
        const double young = number(table, "young_modulus"), poisson = number(table, "poisson_ratio");
        return on_wall ? hertz_stiffness_on_rigid_wall(young, poisson, radii[first])
                       : hertz_stiffness(young, poisson, radii[first], young, poisson, radii[second]);
      };
      const PairCase pair = pair_of(terms, result, {reduced_masses(masses, a, b), on_wall, by_hertz, by_wave_speeds});
      result.pairs[static_cast<std::size_t>(a * count + b)] = pair;
      result.pairs[static_cast<std::size_t>(b * count + a)] = pair;
    }
  }
}

std::vector<KindMasses> masses_of_kinds(const GrainCase& resolved) {
  std::vector<KindMasses> kinds(resolved.kinds.size());
  for (const Grain& grain : resolved.grains) {
    KindMasses& kind = kinds[static_cast<std::size_t>(grain.kind)];
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
  const KindMasses& first = kinds[static_cast<std::size_t>(a)];
  const KindMasses& second = kinds[static_cast<std::size_t>(b)];
  const auto reduced = [](double m, double n) { return m * n / (m + n); };
  if (first.grains == 0 && second.grains == 0) return {};
  if (first.grains == 0) return ReducedMasses{second.smallest, second.largest};
  if (second.grains == 0) return ReducedMasses{first.smallest, first.largest};
  if (a != b) return ReducedMasses{reduced(first.smallest, second.smallest), reduced(first.largest, second.largest)};
  if (first.grains < 2) return {};
  return ReducedMasses{reduced(first.smallest, first.second_smallest), reduced(first.largest, first.second_largest)};
}

double damping_ratio(NormalLaw law, const PairProperties& pair) {
  return describe(law).damping_ratio(pair.restitution, pair.end);
}

}  // namespace equidem
