// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A sample made ready for homogenization: what carries no load left out, what moves freely held, the rest factorized.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/matrix.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/statics/linear_system.hpp"
#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/statics/stiffness_solver.hpp"

namespace equidem {

class SampleSolver {
 public:
  /// \param held discs that the boundary holds or loads: never left out; empty: none
  /// \param hold_translations whether the translations of these discs are prescribed
  /// \param result receives the findings about the network, and the times of stages
  /// \throws Error as effective_stiffness
  SampleSolver(const Assembly& assembly, const ContactSprings& springs, const HomogenizeOptions& options,
               const std::vector<std::uint8_t>& held, bool hold_translations, EffectiveStiffness& result);

  /// The part that carries load.
  [[nodiscard]] const Assembly& assembly() const { return network_.part ? network_.part->assembly : whole_; }
  [[nodiscard]] const ContactSprings& springs() const {
    return network_.part ? network_.part->springs : whole_springs_;
  }
  [[nodiscard]] const StiffnessSolver& solver() const { return *solver_; }
  [[nodiscard]] const DegreesOfFreedom& unknowns() const { return solver_->unknowns(); }
  /// Index in assembly() of a disc of the whole; -1 where it is left out.
  [[nodiscard]] std::vector<std::int32_t> indices() const;
  /// Motions of assembly() as motions of the whole, 0 where left out.
  [[nodiscard]] std::vector<DiscMotion> motions_of_whole(const PreciseMotion& motion) const;

  /// Solve, check that balanced loads leave no reaction where free motions are held, and report residual and condition.
  std::vector<Solution> solve(std::span<const RightHandSide> cases, EffectiveStiffness& result);
  /// Bound on the error of an energy of two cases, r K^-1 r, with the residuals of the last solve, N.
  [[nodiscard]] double energy_error() const { return energy_error_; }

 private:
  void prune(const std::vector<std::uint8_t>& held, EffectiveStiffness& result);
  void factorize(const std::vector<std::uint8_t>& held, bool hold_translations, EffectiveStiffness& result);
  [[noreturn]] void report_unbalanced_disc(std::size_t disc) const;
  void check_reactions(const RightHandSide& given, const Solution& solution) const;

  const Assembly& whole_;
  const ContactSprings& whole_springs_;
  HomogenizeOptions options_;
  LoadBearingNetwork network_;
  HeldMotions held_motions_;
  std::optional<StiffnessSolver> solver_;
  double energy_error_ = 0;
};

/// Twice the energies of pairs of three load cases in normal and in tangential springs, sum kN dn_a dn_b and sum kT
/// ds_a ds_b, N.
struct PairEnergies {
  Matrix3 normal{}, tangential{};
};

/// Entries of both matrices, which are symmetric.
inline constexpr std::size_t pair_sums = 12;
/// Adds the terms of one contact.
/// \param deformations by three load cases, m
void add_pair_energies(const SpringConstants& k, const ContactDeformation* deformations, double* sums);
PairEnergies pair_energies(const double* sums);
/// Adds twice the energies of pairs of three load cases in the prestress of a contact, N, to the entries of a triangle.
/// \param motions of the contact by three load cases
void add_prestress_energies(const ContactPrestress& prestress, const ContactMotion* motions, double* sums);
/// Twice the energies of pairs of the first three load cases in bending springs, sum kM (theta_j - theta_i)_a (theta_j
/// - theta_i)_b, N.
Matrix3 bending_energies(const SampleSolver& solver, const std::vector<RightHandSide>& cases,
                         const std::vector<Solution>& solutions);

/// Displacement gradients of unit strains xx, yy, xy (engineering) and of the unit rotation.
inline constexpr std::size_t strain_cases = 4;
inline constexpr Tensor2 unit_gradients[strain_cases] = {{1, 0, 0, 0}, {0, 0, 0, 1}, {0, 0.5, 0.5, 0}, {0, -1, 1, 0}};

/// Hill & Mandel: mean stress times mean strain is the mean of the powers. The largest difference, relative.
double power_difference(const std::vector<Tensor2>& stresses, const Matrix3& stiffness);

/// Sets the stresses of unit displacement gradients xx, yy, xy, yx, and their asymmetry, from the stresses of unit
/// strains and, where there is a fourth one, of the unit rotation.
void keep_gradient_stiffness(const std::vector<Tensor2>& stresses, EffectiveStiffness& result);

/// \throws Error (bad_input) where the boundary does not suit the assembly, it has no contacts, or levers do not add up
///         to their branch where they matter
void check_sample(const Assembly& assembly, const ContactSprings& springs, const HomogenizeOptions& options);

/// The sample of a periodic cell, or of one whose boundary is displaced.
/// \throws Error as SampleSolver
SampleSolver strain_sample(const Assembly& assembly, const ContactSprings& springs, const HomogenizeOptions& options,
                           EffectiveStiffness& result);

/// Unit mean strains, and the unit mean rotation where discs cannot turn. Fills the stiffness, its parts, the
/// unsymmetric tensor, the fluctuations and the error bound (without rounding) of `result`.
/// \throws Error as effective_stiffness
void solve_strains(const Assembly& assembly, const ContactSprings& springs, const HomogenizeOptions& options,
                   EffectiveStiffness& result);

/// The compliance of a sample whose boundary carries the tractions of unit stresses, inverted: see TractionSample.
/// Fills the stiffness, its parts and the error bound (without rounding) of `result`.
/// \throws Error as effective_stiffness
void solve_tractions(const Assembly& assembly, const ContactSprings& springs, const HomogenizeOptions& options,
                     EffectiveStiffness& result);

/// The equations of the motions beside the unit mean strains xx, yy and xy (engineering), which effective_stiffness
/// solves for Boundary::periodic; where rotation is restrained also those beside the unit mean rotation. Discs that
/// carry no load are left out, and one component is held for each rigid motion and each group of gears. Mechanisms of a
/// few discs are not looked for: they leave K singular.
/// \throws Error (bad_input) where the assembly is not periodic, has no contacts, or nothing of it carries load
LinearSystem strain_system(const Assembly& assembly, const ContactSprings& springs,
                           Rotation rotation = Rotation::from_scene);

/// Pa, of the forces that contacts carry at rest.
Tensor2 mean_stress_at_rest(const Assembly& assembly);
/// From the stiffness of the nominal stress to that of the Cauchy stress. A rotation h of the whole changes the nominal
/// stress by h sigma_0, which is known without a solution where discs turn along.
void add_stress_at_rest(const Tensor2& at_rest, EffectiveStiffness& result);

/// From the change of the nominal stress P = J sigma F^-T by unit strains to that of the Cauchy stress: at the strain h
/// d sigma = dP + sigma_0 h^T - tr(h) sigma_0.
Matrix3 change_to_cauchy(const Tensor2& at_rest);

}  // namespace equidem
