// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Mutual energies of load cases.
#pragma once

#include <vector>

#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/matrix.hpp"

namespace equidem {

/// Twice the energies of pairs of three load cases in normal and in tangential springs, sum kN dn_a dn_b and sum kT
/// ds_a ds_b, N.
struct PairEnergies {
  Matrix3 normal{}, tangential{};
};

/// \param deformations per load case (the first three count), per contact, m
PairEnergies pair_energies(const ContactSprings& springs,
                           const std::vector<std::vector<ContactDeformation>>& deformations);

}  // namespace equidem
