// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [collisions]: which kinds of bodies there are, and how two of them meet.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "equidem/casefile/grain_case.hpp"
#include "equidem/casefile/toml.hpp"

namespace equidem {

/// Give grains and walls their kinds, and every two kinds what the case says of them.
/// \param root seen by check_and_complete
/// \param groups of each grain
/// \param result with bodies, walls and law; kinds and pairs are set
/// \throws Error (bad_input) with line and key: several stiffnesses or none, a key that the law has no use for, a
///         restitution that no
///         dashpot gives, a pair of unknown groups
void read_collisions(const TomlValue& root, const std::vector<std::string>& groups, GrainCase& result);

/// The masses of the grains of a kind.
struct KindMasses {
  std::size_t grains = 0;                                                     ///< 0: walls
  double smallest = 0, second_smallest = 0, second_largest = 0, largest = 0;  ///< kg
};
std::vector<KindMasses> masses_of_kinds(const GrainCase& resolved);

struct ReducedMasses {
  double smallest = 0, largest = 0;  ///< kg
};
/// Of all pairs of two kinds; none where no two such bodies are there.
std::optional<ReducedMasses> reduced_masses(const std::vector<KindMasses>& kinds, int a, int b);

/// LawDescription::damping_ratio of a pair; 0 where the law has no dashpot.
double damping_ratio(NormalLaw law, const PairProperties& pair);

}  // namespace equidem
