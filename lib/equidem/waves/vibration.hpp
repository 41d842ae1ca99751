// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The highest frequency of an assembly and the time steps that follow from it or replace it.
#pragma once

#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/statics/number_unknowns.hpp"
#include "equidem/waves/extreme_eigenvalues.hpp"

namespace equidem {

/// \throws Error (bad_input) where a mass, a moment or a kN/m is not within 1e-150 to 1e150: squares of frequencies and
///         speeds would leave the range of numbers; where |kT| exceeds 1e10 kN
void check_magnitudes(const Assembly& assembly, const ContactSprings& springs, const std::vector<Inertia>& inertia);

/// An end of the spectrum of M^-1 K, (rad/s)², over the components that are not held; in a periodic cell: of the
/// motions that repeat with it. \param inertia per disc
ExtremeEigenvalue extreme_squared_frequency(const Assembly& assembly, const ContactSprings& springs,
                                            const DegreesOfFreedom& unknowns, const std::vector<Inertia>& inertia,
                                            SpectrumEnd end, const LanczosOptions& options = {});

/// Upper bound of omega² for any supports: the largest eigenvalue of any contact taken alone with its share m/z,
/// I/z of the inertia of its discs (Fried 1972; O'Sullivan & Bray 2004). Stretch and slip of a contact do not couple,
/// so that
///
///   omega² <= max over contacts of kN (z_i/m_i + z_j/m_j) and kT (z_i/m_i + z_j/m_j + z_i r_i²/I_i + z_j r_j²/I_j),
///
/// z the number of contacts of a disc; off the lines of centres the larger eigenvalue of stretch and slip together,
/// which the rotations then couple; with a bending spring that of slip and relative rotation. Negative kT can only
/// lower omega² and counts as 0. \param rotation whether discs turn
double element_bound(const Assembly& assembly, const ContactSprings& springs, const std::vector<Inertia>& inertia,
                     bool rotation);

/// The rules of thumb of the field, s: no guarantee.
struct TimeStepRules {
  /// sqrt2 min sqrt(m/K_ii) over translations and rotations (YADE's estimate from the diagonal of K).
  double diagonal = 0;
  /// An eighth of the period of one disc on one normal spring, 2 pi min sqrt(m/kN) / 8 (Sukegawa 2010).
  double eighth_of_period = 0;
};
TimeStepRules time_step_rules(const Assembly& assembly, const ContactSprings& springs,
                              const std::vector<Inertia>& inertia, bool rotation);

}  // namespace equidem
