// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Kinds of bodies and walls, and the contact properties of every two kinds.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/grains/scene/pair_options.hpp"

namespace equidem {

/// Contact options of the bodies of a scene.
struct CollisionOptions {
  Body body = Body::disc;
  PairOptions bodies = {};                ///< contacts of two bodies
  std::optional<PairOptions> walls = {};  ///< contacts of a body and a wall; none: as for two bodies
  /// Contacts of two groups of bodies, or of a group and the wall of that name.
  struct Pair {
    std::string group, with;
    PairOptions contact;
  };
  std::vector<Pair> pairs = {};  ///< each pair of names at most once
};

/// Contact properties of every two kinds.
struct ContactTable {
  /// Groups of bodies, then "walls", then walls with a pair of their own; with HertzModuli a group counts once for each
  /// radius.
  std::vector<std::string> kinds;
  std::vector<PairContact> pairs;  ///< row by row, symmetric

  [[nodiscard]] int kind_count() const { return static_cast<int>(kinds.size()); }
  [[nodiscard]] const PairContact& between(int a, int b) const {
    return pairs[static_cast<std::size_t>(a * kind_count() + b)];
  }
  [[nodiscard]] const std::string& kind(int a) const { return kinds[static_cast<std::size_t>(a)]; }
};

/// Sets the kinds of bodies and walls of a scene, and the contact properties of every two kinds.
/// \param scene with all bodies and walls; Grain::kind, Wall::kind and GrainScene::kinds are set
/// \param groups one name for each body; empty: all are "grains"
/// \throws Error (bad_input) as contact_of, its place the name of the option, such as "restitution", "walls.stiffness",
///         "pairs.0.with"; also: more than 256 kinds, a pair of unknown names, a pair given twice
ContactTable set_kinds(GrainScene& scene, std::span<const std::string> groups, const CollisionOptions& options,
                       NormalLaw law);

/// Value of GrainScene::pairs for a time step.
/// \param step s
std::vector<PairProperties> pairs_at(const ContactTable& contacts, NormalLaw law, double step);

/// Extreme masses of the bodies of a kind.
struct KindMasses {
  std::size_t grains = 0;                                                     ///< 0: walls
  double smallest = 0, second_smallest = 0, second_largest = 0, largest = 0;  ///< kg
};
std::vector<KindMasses> masses_of_kinds(std::span<const Grain> grains, int kinds);

struct ReducedMasses {
  double smallest = 0, largest = 0;  ///< kg
};
/// Extremes over all pairs of two kinds; none if the scene has no two such bodies.
std::optional<ReducedMasses> reduced_masses(const std::vector<KindMasses>& kinds, int a, int b);

}  // namespace equidem
