// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A network whose contacts break one after another, with the state of rest of every network for fixed right-hand
/// sides: by a factor that is updated where that serves, else by one that is made anew.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/statics/breaking/updated_network.hpp"
#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/loads.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/statics/stiffness_solver.hpp"

namespace equidem {

/// The network before the first break, and what acts on it.
struct BreakableNetwork {
  const Assembly& assembly;
  const ContactSprings& springs;
  Effects effects;
  /// Which components are held; their values are not used, RightHandSide::prescribed gives them.
  std::vector<Support> supports;
  /// Solved for in every network: per component of all discs, effects.unknowns_per_disc() components a disc. Moments
  /// are divided by the mean radius of `assembly`.
  std::vector<RightHandSide> cases;
  SolverOptions solver;
};

/// How the states of a network were solved for.
struct SolverReport {
  std::string name;
  std::int64_t factorizations = 0;  ///< of a whole matrix, the first included
  std::int64_t updates = 0;         ///< of a factor, by one contact
  std::int64_t mended = 0;          ///< factorizations because round-off of updates had grown
  std::int64_t refinements = 0;     ///< of motions behind a factor that was updated
  double largest_residual = 0;      ///< relative, of all states so far
};

/// With elimination where the method is left to the library: its factor can be updated, and its pivots give the
/// stability of each network.
inline SolverOptions factor_to_update(SolverOptions options) {
  if (options.method == SolverMethod::automatic) options.method = SolverMethod::multifrontal;
  return options;
}

/// Discs that can carry no force (load_bearing.hpp) without the contacts `broken` (per contact, 1), per disc: 1. Those
/// held, and those on which a force acts, are none.
std::vector<std::uint8_t> idle_discs(const BreakableNetwork& network, const std::vector<std::uint8_t>& broken);
/// Discs that are not 0, ascending; of those that were 0 before where that is given.
std::vector<std::int32_t> discs_set(const std::vector<std::uint8_t>& now, const std::vector<std::uint8_t>& before = {});

/// The network after some breaks. Discs that can carry no force have left it: they are held at 0 and their contacts
/// carry nothing. Forces and motions are those of the network as it is.
class BreakableSystem {
 public:
  enum class Factor {
    updated,  ///< where K is positive definite, every disc carries load at first, and no other method is asked for
    anew,     ///< made for every network
  };

  /// The assembly and the springs must outlive the system.
  /// \param broken per contact, 1: it is not there from the start; empty: all are
  /// \throws Error as UpdatedNetwork and StiffnessSolver do
  explicit BreakableSystem(BreakableNetwork network, Factor factor = Factor::updated,
                           std::vector<std::uint8_t> broken = {});
  ~BreakableSystem();
  BreakableSystem(const BreakableSystem&) = delete;
  BreakableSystem& operator=(const BreakableSystem&) = delete;

  /// Removes contacts, several where a computation is resumed, and solves anew.
  /// \return discs that leave the network with them, ascending
  /// \throws Error (computation_failed) where a motion resists no more than round-off, and is no mechanism
  std::vector<std::int32_t> remove(std::span<const std::size_t> contacts);

  /// Works and sums of the network as it is, where its factor is updated; none: they follow from the springs.
  [[nodiscard]] std::optional<EquilibriumSums> sums() const;
  /// Per contact, N/m; 0 of those that are removed or carry nothing.
  [[nodiscard]] std::span<const ContactForce> forces(std::size_t of_case) const;
  /// Per component, m; 0 of discs that left the network.
  [[nodiscard]] std::span<const double> motion(std::size_t of_case) const { return state(of_case).motion; }
  /// Reactions K u - f of held components, N/m (moments over the mean radius); 0 of free ones.
  [[nodiscard]] std::span<const double> reactions(std::size_t of_case) const { return state(of_case).reactions; }
  /// Whether the network carries its right-hand sides: all, or one. False where loads move a part that nothing holds,
  /// or drive a mechanism; forces of that right-hand side are then 0.
  [[nodiscard]] bool carries() const;
  [[nodiscard]] bool carries(std::size_t of_case) const { return states_[of_case].carried; }
  /// A sentence on what moves, where some right-hand side is not carried.
  [[nodiscard]] const std::string& why_not() const { return why_not_; }
  /// Discs that have left the network, the first included, per disc: 1.
  [[nodiscard]] const std::vector<std::uint8_t>& left() const { return left_; }
  /// |f - f_int| over |f|, the largest of the right-hand sides.
  [[nodiscard]] double relative_residual() const { return residual_; }
  /// Negative eigenvalues of K beyond those that rotations bring by themselves where kT < 0; none: not known.
  [[nodiscard]] std::optional<std::int64_t> unstable_modes() const { return unstable_modes_; }
  [[nodiscard]] SolverReport report() const;
  [[nodiscard]] const BreakableNetwork& network() const { return network_; }
  /// Per contact, 1.
  [[nodiscard]] const std::vector<std::uint8_t>& broken() const { return broken_; }

 private:
  struct Updated;
  struct State {
    std::vector<ContactForce> forces;
    std::vector<double> motion, reactions;
    bool carried = true;
  };

  [[nodiscard]] bool can_be_updated() const;
  void update_from_here();
  void stop_updating();
  void take_out(std::size_t contact);
  void leave();
  [[nodiscard]] const State& state(std::size_t of_case) const;
  void read_state(State& state, std::size_t of_case) const;
  void solve_anew();
  void solve_cases(StiffnessSolver& solver, const HeldMotions& held, const LoadBearingNetwork::Part& rest,
                   StageTimes& times);
  [[nodiscard]] std::string describe_driven(const std::vector<DiscMotion>& motions) const;
  void measured(double residual);

  BreakableNetwork network_;
  std::size_t per_disc_;
  std::vector<std::uint8_t> broken_, left_;
  std::unique_ptr<Updated> updated_;   // none: every network is factorized anew
  bool was_updated_ = false;           // before that
  mutable std::vector<State> states_;  // those of an updated factor are filled when they are asked for
  mutable bool read_ = false;          // whether they are
  std::string why_not_;
  double residual_ = 0;
  std::optional<std::int64_t> unstable_modes_ = 0;
  SolverReport report_;  // without what the updated factor has counted
};

}  // namespace equidem
