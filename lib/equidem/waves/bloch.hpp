// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bloch waves of a periodic assembly: disc d moves as U_d exp(i q.x_d - i omega t), x_d its centre in whichever cell.
///
/// A contact of i and j with the branch vector l stores the energy of the contact law in the motions U_i and U_j exp(i
/// q.l), so that with the derivatives g of its stretch and h of its slip (linear_spring.hpp)
///
///   K_ij(q) += (kN g_i g_j^T + kT h_i h_j^T) exp(i q.l),   K_ji = K_ij^H,   K_ii, K_jj as at rest,
///
/// and K(q) U = omega² M U. On a lattice this is F9 of Suiker, Metrikine & de Borst (2001), IJSS 38:1563.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "equidem/material/inertia.hpp"
#include "equidem/waves/hermitian.hpp"
#include "equidem/waves/primitive_cell.hpp"

namespace equidem {

/// The unknowns of the waves of a cell: (u_x, u_y[, a theta]) of each disc, less those that no contact resists: discs
/// without contacts, rotations that no tangential spring turns.
class BlochWaves {
 public:
  /// \param inertia of every disc of the assembly that the cell was taken from
  /// \param rotation whether rotations are unknowns
  BlochWaves(PrimitiveCell cell, const std::vector<Inertia>& inertia, bool rotation);

  [[nodiscard]] const PrimitiveCell& cell() const { return cell_; }
  /// Number of branches.
  [[nodiscard]] std::size_t size() const { return components_.size(); }
  /// Mass of the cell over its area, kg/m² (per metre of depth).
  [[nodiscard]] double mass_per_area() const { return mass_ / cell_.area(); }

  /// K(q), Pa: Hermitian, rows (u_x, u_y[, a theta]) of disc after disc.
  [[nodiscard]] ComplexMatrix stiffness(Vec2 q) const;
  /// M^-1/2 K(q) M^-1/2, 1/s².
  [[nodiscard]] ComplexMatrix dynamic_matrix(Vec2 q) const;
  /// omega² of all branches, ascending, (rad/s)²; negative where a wave grows as exp(sqrt(-omega²) t).
  [[nodiscard]] std::vector<double> squared_frequencies(Vec2 q) const;

  /// Speeds of long waves along a direction, c² = d(omega²)/d(q²) at q = 0 in (m/s)²: exact second-order perturbation
  /// theory, in which discs of the cell and their rotations follow the wave.
  struct SoundSpeeds {
    double longitudinal_squared = 0;  ///< of the wave whose mean motion is most along q
    double transverse_squared = 0;    ///< of the one that is most across it
    std::vector<double> others;       ///< of motions without energy at q = 0 that are no translation (gears, ...)
  };
  [[nodiscard]] SoundSpeeds sound_speeds(Vec2 direction) const;

  /// Smallest omega² (by magnitude) at q = 0 of a wave with more than half of its kinetic energy in rotations, other
  /// than a zero-energy mode; none where rotations are no unknowns or all such waves have no energy. On lattices of
  /// one disc: hexagonal 12 kT/(beta m), square 8 kT/(beta m).
  [[nodiscard]] std::optional<double> squared_rotational_gap() const;

  /// The ratio r < 0 at which the wave loses its stiffness in statics where contacts have kT = r kN: K(q) with
  /// rotations eliminated is S_N + r S_T, both positive semidefinite, and r_c = -1/lambda, S_T v = lambda S_N v for the
  /// largest lambda.
  /// 0 where normal springs do not resist a motion that tangential ones do; negative infinity where tangential springs
  /// resist no motion. Motions that neither resists (translation at q = 0, gears) are left out. Of the springs kT only
  /// is read which are zero beside others that are not: those contacts have none for any r. Of contacts on the lines of
  /// centres only: elsewhere normal springs resist rotations too, and the stiffness is not linear in r.
  [[nodiscard]] double critical_ratio(Vec2 q) const;

  /// The largest limit of critical_ratio(q) as q -> 0, over all directions. The limit is another one along each of
  /// them, and none is what q = 0 has: there the mean strain is held, in a long wave it follows.
  [[nodiscard]] LongWaveLoss long_wave_loss() const;

 private:
  enum class Springs { given, normal, tangential };
  enum class Order { all, first, second };  // in q
  [[nodiscard]] ComplexMatrix assemble(Springs springs, Order order, Vec2 q) const;
  [[nodiscard]] StiffnessOrders orders(Springs springs) const;
  [[nodiscard]] std::vector<char> rotations() const;             // per row, 1: a rotation
  [[nodiscard]] double largest_second_order(double unit) const;  // of the dynamic matrix, q in 1/unit
  void scale_by_mass(ComplexMatrix& matrix) const;

  PrimitiveCell cell_;
  int per_disc_;
  bool any_tangential_;
  double mass_ = 0;                        // of the cell
  std::vector<std::int32_t> row_;          // of each component of each disc; -1: no unknown
  std::vector<std::int32_t> components_;   // of each row: disc * per_disc + k
  std::vector<double> inverse_root_mass_;  // per row, 1/sqrt(m), 1/sqrt(I/a²)
};

}  // namespace equidem
