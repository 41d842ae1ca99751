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
  /// have what is given for these first, else what all contacts of the pair have. Only pairs that occur are joined.
  /// \param pairs as of the constructor
  template <typename Property, typename Join>
  std::vector<Property> of_contacts(const Property& elsewhere, const std::vector<OfPair<Property>>& pairs,
                                    const Join& join) const {
    const std::size_t count = names_.size() + 1;
    std::vector<std::optional<Property>> known(2 * count * count);
    std::vector<Property> result;
    result.reserve(contacts_.size());
    for (const Place& place : contacts_) {
      auto& property = known[(place.across * count + place.i) * count + place.j];
      if (!property) property = property_at(place, elsewhere, pairs, join);
      result.push_back(*property);
    }
    return result;
  }

  /// The pair that gives a contact its property; none where no pair does, or two are joined.
  [[nodiscard]] std::optional<std::size_t> pair_of(std::size_t contact) const { return pair_at(contacts_[contact]); }

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
  /// Whether contacts between cells of the two groups have the properties of those inside either, joined.
  [[nodiscard]] bool joined_across(const Place& place) const;
  [[nodiscard]] std::optional<std::size_t> pair_at(const Place& place) const;

  template <typename Property, typename Join>
  Property property_at(const Place& place, const Property& elsewhere, const std::vector<OfPair<Property>>& pairs,
                       const Join& join) const {
    if (const auto pair = pair_at(place)) return pairs[*pair].property;
    if (place.i == place.j) return elsewhere;
    const bool across = joined_across(place);
    const auto inside = [&](std::size_t group) {
      const auto pair = named(group, group, across);
      return pair ? pairs[*pair].property : elsewhere;
    };
    return join(inside(place.i), inside(place.j));
  }

  std::vector<std::string> names_;
  std::vector<std::array<std::size_t, 2>> pairs_;  ///< as Place, the smaller number first
  std::vector<bool> across_;                       ///< by pair
  std::vector<Place> contacts_;
};

/// Springs of half a contact of each material in series: 2 a b/(a + b), 0 where one is 0.
/// \throws Error (bad_input) where a tangential spring is negative
SpringConstants in_series(const SpringConstants& a, const SpringConstants& b);

}  // namespace equidem
