// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How a network answers lambda: load, motion, stress, elastic energy and work.
#pragma once

#include <array>

#include "equidem/breakage/breakable_system.hpp"
#include "equidem/breakage/load_path.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// Forces and motions are f0 + lambda f1 and u0 + lambda u1, so that load, motion and stress are linear in lambda and
/// energies quadratic. Arrays hold the coefficients of 1, lambda, lambda².
struct NetworkResponse {
  std::array<double, 2> load{};              ///< LoadPath, N/m or Pa
  std::array<double, 2> motion{};            ///< LoadPath, m or a strain
  std::array<Tensor2, 2> stress{};           ///< Pa, (1/A) sum F_i l_j over contacts; 0 where its area is not known
  std::array<double, 3> energy{};            ///< N, elastic
  std::array<double, 3> loads_by_motions{};  ///< N, sum f . u of all loads
  std::array<double, 2> power{};             ///< N, work of everything from outside over d(lambda)

  static double at(const std::array<double, 2>& c, double lambda) { return c[0] + lambda * c[1]; }
  static double at(const std::array<double, 3>& c, double lambda) { return c[0] + lambda * (c[1] + lambda * c[2]); }
  [[nodiscard]] Tensor2 stress_at(double lambda) const { return stress[0] + lambda * stress[1]; }
  [[nodiscard]] double energy_at(double lambda) const { return at(energy, lambda); }
  /// The energy that grows with lambda², N, as half of the work of the pattern (Clapeyron).
  [[nodiscard]] double pattern_energy_by_work() const { return 0.5 * power[1]; }
  /// Work of everything from outside while lambda goes from one value to another, N.
  [[nodiscard]] double work(double from, double to) const {
    return (to - from) * power[0] + 0.5 * (to * to - from * from) * power[1];
  }
};

/// m², of the assembly; 0: not known, and with it no stress.
double area_of_stress(const Assembly& assembly);

/// N/m, the largest component of any contact.
double largest_force(std::span<const ContactForce> forces);

/// \param area as area_of_stress
NetworkResponse response_of(const EquilibriumSums& sums, const LoadPath& path, double area);

/// \param system with the right-hand sides of the path, the pattern first
NetworkResponse response_of(const BreakableSystem& system, const Assembly& assembly, const ContactSprings& springs,
                            const LoadPath& path);

}  // namespace equidem
