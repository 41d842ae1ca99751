// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/kinds.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
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
      table.pairs[static_cast<std::size_t>(a * count + b)] = found;
      table.pairs[static_cast<std::size_t>(b * count + a)] = found;
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

}  // namespace equidem
