// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The factor of the forces at rest at which an assembly loses its stability.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/statics/loads.hpp"

namespace equidem {

struct CriticalLoadOptions {
  Rotation rotation = Rotation::from_scene;
  double largest = 1e3;     ///< where the search ends: |N0|/(kN l) of the most loaded contact (largest_prestress)
  double memory_limit = 0;  ///< bytes; 0: what the machine has free
};

/// Result of the search.
struct CriticalLoad {
  bool sought = true;
  double factor = 0;    ///< infinity: none up to `searched`
  double searched = 0;  ///< the largest factor that was tried
  double width = 0;     ///< relative, of the interval that factorizations at its ends prove to hold it
  std::string why;      ///< why it was not sought, or not found; empty: it was
  std::int64_t factorizations = 0;
  std::vector<DiscMotion> motion;  ///< that is lost, per disc, largest translation 1 m; empty where there is none
};

/// The least lambda > 0 at which K + lambda K_g is singular: K the stiffness of the springs alone, K_g that of the
/// forces at rest. To first order, as Euler's load: the state before buckling is the one given, at forces that grow in
/// proportion. The number of negative eigenvalues brackets lambda (bisection); inverse iteration from the stable end
/// then finds the eigenvalue next to it, and factorizations beside the value prove it: as close to it as round-off lets
/// signs of pivots tell, which is far for slender assemblies, while the value itself is a quotient of energies. Not
/// sought where springs alone leave a mechanism or are unstable: K then loses or gains stability at lambda = 0.
/// \param springs with prestress
/// \throws Error (bad_input) on options out of range, as number_unknowns does; (computation_failed) where K cannot be
///         factorized
CriticalLoad find_critical_load(const Assembly& assembly, const ContactSprings& springs,
                                std::span<const Support> supports, const CriticalLoadOptions& options = {});

}  // namespace equidem
