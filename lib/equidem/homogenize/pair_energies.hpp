// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What load cases store together, and the mean stress of one.
#pragma once

#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/matrix.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// Twice the energies of pairs of three load cases in normal and in tangential springs, sum kN dn_a dn_b and sum kT
/// ds_a ds_b, N.
struct PairEnergies {
  Matrix3 normal{}, tangential{};
};

/// \param deformations per load case (the first three count), per contact, m
PairEnergies pair_energies(const ContactSprings& springs,
                           const std::vector<std::vector<ContactDeformation>>& deformations);

/// Love-Weber, (1/A) sum F_i l_j, Pa.
Tensor2 mean_stress(const Assembly& assembly, const ContactSprings& springs,
                    const std::vector<ContactDeformation>& deformations, double area);

}  // namespace equidem
