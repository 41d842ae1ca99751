// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Assemblies of several materials: groups that share out the discs at random, and properties of contacts by the groups
/// of their two discs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

/// A group that gets a share of the discs.
struct GroupShare {
  std::string name;
  double share = 0;  ///< in (0, 1], of all discs
};

/// How discs are shared out.
struct GroupDraw {
  /// Whole Voronoi cells of so many random points, as the grains of a rock; none: disc by disc.
  std::optional<std::int64_t> cells = {};
  std::uint64_t seed = 1;

  friend bool operator==(const GroupDraw&, const GroupDraw&) = default;
};

/// Adds a group for each share. No disc is in two of them; each has the number of discs nearest to its share, of whole
/// cells the nearest that they allow. The points of cells are uniform in the period, else in the rectangle around the
/// centres. Their discs are groups too, `cell_0`, `cell_1`, ...; cells without a disc are left out.
/// \throws Error (bad_input) where the shares exceed 1, a group gets no disc, or there are more cells than discs
void draw_groups(Assembly& assembly, std::span<const GroupShare> shares, const GroupDraw& draw);

/// Two groups, or twice the same one.
using GroupPair = std::array<std::string, 2>;

/// A property of the contacts of two groups.
template <typename Property>
struct OfPair {
  GroupPair groups;
  bool across = false;  ///< only of contacts between two cells of draw_groups
  Property property = {};
};

/// "quartz, mica across cells"
template <typename Property>
std::string name_of(const OfPair<Property>& pair) {
  return pair.groups[0] + ", " + pair.groups[1] + (pair.across ? " across cells" : "");
}

/// The groups whose contacts have properties of their own, and the contacts of each pair.
class Materials {
 public:
  struct Pair {
    GroupPair groups;
    bool across = false;
  };

  template <typename Property>
  Materials(const Assembly& assembly, const std::vector<OfPair<Property>>& pairs)
      : Materials(assembly, pairs_of(pairs)) {}
  /// \throws Error (bad_input) where a group does not exist, a disc is in two of the groups, or `across` is asked for
  ///         without cells
  Materials(const Assembly& assembly, const std::vector<Pair>& pairs);

  /// The property of each contact: as given for its pair; of a pair that is not named `join` of those inside either
  /// group, and inside a group that is not named, or of discs without a group, `elsewhere`. Contacts between two cells
  /// have what is given for these first, else what all contacts of the pair have.
  /// \param properties of the pairs, in their order
  template <typename Property, typename Join>
  std::vector<Property> of_contacts(const Property& elsewhere, const std::vector<Property>& properties,
                                    const Join& join) const {
    const std::size_t count = names_.size() + 1;
    std::vector<Property> table;
    for (const bool across : {false, true}) {
      for (std::size_t a = 0; a < count; ++a)
        for (std::size_t b = 0; b < count; ++b) table.push_back(lookup(a, b, across, elsewhere, properties, join));
    }
    std::vector<Property> result;
    result.reserve(contacts_.size());
    for (const Place& place : contacts_) result.push_back(table[(place.across * count + place.i) * count + place.j]);
    return result;
  }

  /// The pair whose property a contact has; none where its pair is not named.
  [[nodiscard]] std::optional<std::size_t> pair_of(std::size_t contact) const {
    const Place& place = contacts_[contact];
    const auto pair = place.across ? named(place.i, place.j, true) : std::nullopt;
    return pair ? pair : named(place.i, place.j, false);
  }

 private:
  /// Groups of the two discs: 0 none, else 1 + the number of the name.
  struct Place {
    std::size_t i, j;
    bool across;
  };

  template <typename Property>
  static std::vector<Pair> pairs_of(const std::vector<OfPair<Property>>& pairs) {
    std::vector<Pair> result;
    for (const auto& [groups, across, property] : pairs) result.push_back({groups, across});
    return result;
  }

  [[nodiscard]] std::optional<std::size_t> named(std::size_t a, std::size_t b, bool across) const;

  template <typename Property, typename Join>
  Property lookup(std::size_t a, std::size_t b, bool across, const Property& elsewhere,
                  const std::vector<Property>& properties, const Join& join) const {
    if (const auto pair = named(a, b, across)) return properties[*pair];
    if (across) {
      const auto in_a = named(a, a, true), in_b = named(b, b, true);
      if (in_a && in_b) return join(properties[*in_a], properties[*in_b]);
      return lookup(a, b, false, elsewhere, properties, join);
    }
    if (a == b) return elsewhere;
    return join(lookup(a, a, false, elsewhere, properties, join), lookup(b, b, false, elsewhere, properties, join));
  }

  std::vector<std::string> names_;
  std::vector<std::array<std::size_t, 2>> pairs_;  ///< as Place, the smaller number first
  std::vector<bool> across_;                       ///< by pair
  std::vector<Place> contacts_;
};

/// Materials::of_contacts of properties with their pairs; empty where there is no pair.
template <typename Property, typename Join>
std::vector<Property> values_of(const Assembly& assembly, const Property& elsewhere,
                                const std::vector<OfPair<Property>>& pairs, const Join& join) {
  if (pairs.empty()) return {};
  std::vector<Property> properties;
  for (const OfPair<Property>& pair : pairs) properties.push_back(pair.property);
  return Materials(assembly, pairs).of_contacts(elsewhere, properties, join);
}

/// Springs of half a contact of each material in series: 2 a b/(a + b), 0 where one is 0.
/// \throws Error (bad_input) where a tangential spring is negative
SpringConstants in_series(const SpringConstants& a, const SpringConstants& b);

}  // namespace equidem
