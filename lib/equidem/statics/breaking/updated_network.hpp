// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The states of rest of a network whose contacts are taken out one after another, from a factor that is updated.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/large_buffer.hpp"
#include "equidem/linear/multifrontal/updated_cholesky.hpp"
#include "equidem/statics/stiffness_solver.hpp"

namespace equidem {

struct UpdatedNetworkOptions {
  double claimed_residual = 1e-12;  ///< relative: motions are refined where that of a state is above it
  double memory_limit = 0;          ///< bytes; 0: what the machine has
  bool force_moments = false;       ///< EquilibriumSums::moment is computed
};

/// Works and sums over all contacts of the states of rest, N. Energies are works halved (Clapeyron).
struct EquilibriumSums {
  std::array<std::array<double, 2>, 2> load_work{};  ///< of the loads of one right-hand side on the motions of another
  /// Under each right-hand side, of what the prescribed motions and the mean strain of the first one need, on these.
  std::array<double, 2> imposed{};
  std::array<Tensor2, 2> moment{};  ///< sum F_i l_j, per right-hand side; 0 where it is not computed
};

struct UpdateCounters {
  std::int64_t updates = 0;         ///< contacts taken out of the factor
  std::int64_t factorizations = 0;  ///< of the whole matrix, the first included
  std::int64_t mended = 0;          ///< of these, because round-off of updates had grown
  std::int64_t refinements = 0;     ///< times that the motions were refined
};

/// A mechanism that a removal left. A component is held instead.
struct HeldMechanism {
  std::int64_t component = -1;  ///< disc * per_disc + k
  /// Whether the support of the component takes a force beyond round-off: a load works on the mechanism, and the
  /// network does not carry it.
  bool driven = false;
};

/// At most two right-hand sides, the first in proportion to lambda, the second, where there is one, dead. A removal
/// updates the factor along one path of the elimination tree, solves for the motions that the force of the contact
/// held back, and evaluates the forces of all contacts and what they leave of the loads. Positive definite networks
/// only.
class UpdatedNetwork {
 public:
  /// The assembly must outlive the object. \param unknowns holds what supports and free rigid motions need.
  /// \throws Error (bad_input) where a spring is negative, or there are no or more than two right-hand sides;
  ///         (computation_failed) where K is not positive definite: the network has mechanisms; or where the memory
  ///         does not suffice
  UpdatedNetwork(const Assembly& assembly, const ContactSprings& springs, DegreesOfFreedom unknowns,
                 std::vector<RightHandSide> cases, const UpdatedNetworkOptions& options = {});
  UpdatedNetwork(const UpdatedNetwork&) = delete;
  UpdatedNetwork& operator=(const UpdatedNetwork&) = delete;

  /// Takes a contact out. \return mechanisms that this leaves
  std::vector<HeldMechanism> remove(std::size_t contact);
  /// Forces of these contacts are 0 from here on, as of those whose discs have left the network.
  void spare(std::span<const std::size_t> contacts);

  /// Per contact, N/m.
  [[nodiscard]] std::span<const ContactForce> forces(std::size_t of_case) const { return forces_[of_case]; }
  /// Per component.
  [[nodiscard]] PreciseMotion motion(std::size_t of_case) const;
  [[nodiscard]] EquilibriumSums sums() const;
  /// Relative, measured, the largest of all right-hand sides, with the round-off of the measurement. Where a load
  /// drives a mechanism there is no state to claim anything of.
  [[nodiscard]] double residual() const;
  /// A motion that deforms no contact, to round-off, and on which the loads of every right-hand side do work: the
  /// network carries none of them.
  /// \param component held in place of a mechanism; -1: the softest motion that the loads find
  /// \return per disc; empty where there is no such motion
  [[nodiscard]] std::vector<DiscMotion> driven_mechanism(std::int64_t component);

  [[nodiscard]] const ContactSprings& springs() const { return springs_; }
  [[nodiscard]] const UpdateCounters& counters() const { return counters_; }

 private:
  /// A contact as its forces are evaluated; discs are named by their position in the order of elimination, and arms are
  /// 0 where rotations are no unknowns.
  struct Link {
    std::int32_t i = 0, j = 0;
    ContactFrame frame;
    SpringConstants springs;
  };
  struct Held {
    std::int64_t component;
    double stiffness;  // Pa
  };

  [[nodiscard]] std::size_t components() const { return unknowns_.held.size(); }
  [[nodiscard]] std::span<double> column(LargeVector<double>& of, std::size_t of_case) const {
    return std::span(of).subspan(of_case * components(), components());
  }
  [[nodiscard]] std::span<const double> column(const LargeVector<double>& of, std::size_t of_case) const {
    return std::span(of).subspan(of_case * components(), components());
  }
  [[nodiscard]] UpdatedCholesky::Columns change() { return {change_.data(), components(), cases_.size()}; }
  [[nodiscard]] std::size_t place_of(std::int64_t component) const;
  [[nodiscard]] PreciseMotion driving_motion(std::size_t of_case) const;
  template <typename Number>
  [[nodiscard]] PullOf<Number> pull_on(std::size_t disc, std::size_t of_case) const;
  [[nodiscard]] HeldMechanism mechanism_at(std::int64_t component);
  /// Refines the motions, and factorizes anew where that does not serve.
  /// \return mechanisms that a new factorization came across
  std::vector<HeldMechanism> refine(int least_steps);
  bool improve(int least_steps);
  bool factorize();
  void hold(std::int64_t component);
  void add_change();
  void evaluate();
  void evaluate_forces(std::size_t of_case);
  /// \return twice the energy of the contacts of the range, N
  template <typename Number>
  double evaluate_forces(std::size_t of_case, std::size_t begin, std::size_t end);
  double balance(std::size_t of_case);

  const Assembly& assembly_;
  ContactGraph graph_;
  ContactSprings springs_;
  DegreesOfFreedom unknowns_;
  std::vector<RightHandSide> cases_;
  UpdatedNetworkOptions options_;
  std::shared_ptr<const SymbolicFactor> symbolic_;
  UpdatedCholesky factor_;
  UpdateCounters counters_;
  std::vector<Held> holds_;
  std::vector<Link> links_;                              // per contact
  std::vector<std::uint8_t> spared_;                     // per contact, 1
  std::vector<std::vector<ContactDeformation>> affine_;  // per right-hand side and contact, by its mean strain, m
  // Per right-hand side:
  std::vector<std::vector<ForceOf<DoubleDouble>>> exact_;  // forces of contacts, N/m
  std::vector<std::vector<ContactForce>> forces_;          // the same, as reported
  std::vector<PreciseMotion> motions_;                     // in the order of elimination
  std::vector<double> scales_;                             // N/m: reference of relative residuals
  std::vector<double> twice_energy_;                       // N
  LargeVector<double> unbalanced_;                         // N/m, loads that forces leave, in the order of elimination
  LargeVector<double> change_;                             // right-hand sides and solutions
  double residual_ = 0;
  bool carried_ = true;         // no load drives a mechanism
  int altered_ = 0;             // contacts since the factor was made
  double softness_ = 0;         // error in energy over the residual, as it was measured last
  double measured_energy_ = 0;  // N, twice that under the first right-hand side, then
  int unmeasured_ = 0;          // removals since then
};

}  // namespace equidem
