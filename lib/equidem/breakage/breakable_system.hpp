// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A network whose contacts break one after another, with the state of rest of every network for fixed right-hand
/// sides.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/breakage/break_search.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/statics/breaking/updated_network.hpp"
#include "equidem/statics/stiffness_solver.hpp"
#include "equidem/statics/supports.hpp"

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

struct BreakableCounters {
  std::int64_t factorizations = 0;  ///< of a whole matrix, the first included
  std::int64_t updates = 0;         ///< contacts taken out of a factor
  std::int64_t mended = 0;          ///< factorizations because round-off of updates had grown
  std::int64_t refinements = 0;     ///< of motions behind a factor that was updated
  double largest_residual = 0;      ///< relative, of all states so far
};

/// The network after some breaks. Discs that can carry no force (load_bearing.hpp) have left it: they are held at 0 and
/// their contacts carry nothing. Forces and motions are those of the network as it is.
class BreakableSystem {
 public:
  BreakableSystem() = default;
  virtual ~BreakableSystem() = default;
  BreakableSystem(const BreakableSystem&) = delete;
  BreakableSystem& operator=(const BreakableSystem&) = delete;

  /// Removes contacts, several where a computation is resumed, and solves anew.
  /// \return discs that leave the network with them, ascending
  /// \throws Error (computation_failed) where a motion resists no more than round-off, and is no mechanism
  virtual std::vector<std::int32_t> remove(std::span<const std::size_t> contacts) = 0;

  /// The contact that breaks next, with the first right-hand side times lambda beside the second one. Both must be
  /// carried.
  [[nodiscard]] virtual std::optional<NextBreak> next_break(const ContactStrengths& strengths,
                                                            const LoadFactorSearch& search) = 0;
  /// Works and sums of the network as it is, where the system has them; else null.
  [[nodiscard]] virtual const EquilibriumSums* sums() const { return nullptr; }

  /// Per contact, N/m; 0 of those that are removed or carry nothing.
  [[nodiscard]] virtual std::span<const ContactForce> forces(std::size_t of_case) const = 0;
  /// Per component, m; 0 of discs that left the network.
  [[nodiscard]] virtual std::span<const double> motion(std::size_t of_case) const = 0;
  /// Reactions K u - f of held components, N/m (moments over the mean radius); 0 of free ones.
  [[nodiscard]] virtual std::span<const double> reactions(std::size_t of_case) const = 0;
  /// Whether the network carries this right-hand side; false where its loads move a part that nothing holds, or drive a
  /// mechanism. Its forces are then 0.
  [[nodiscard]] virtual bool carries(std::size_t of_case) const = 0;
  /// A sentence on what moves, where some right-hand side is not carried.
  [[nodiscard]] virtual std::string why_not() const = 0;
  /// Discs that have left the network, the first included, per disc: 1.
  [[nodiscard]] virtual std::span<const std::uint8_t> left() const = 0;
  /// |f - f_int| over |f|, the largest of the right-hand sides, or an upper estimate of it.
  [[nodiscard]] virtual double relative_residual() const = 0;
  /// Negative eigenvalues of K beyond those that rotations bring by themselves where kT < 0; -1: not known.
  [[nodiscard]] virtual std::int64_t unstable_modes() const = 0;
  [[nodiscard]] virtual BreakableCounters counters() const = 0;
  [[nodiscard]] virtual std::string solver_name() const = 0;
};

/// With elimination where the method is left to the library: its factor can be updated and tells the stability of each
/// network.
inline SolverOptions factor_to_update(SolverOptions options) {
  if (options.method == SolverMethod::automatic) options.method = SolverMethod::multifrontal;
  return options;
}

/// Discs that never leave the network, per disc: those held, and those on which a force acts.
std::vector<std::uint8_t> held_or_loaded(const BreakableNetwork& network);

/// A factor that is updated where K is positive definite, every disc carries load at first, and no other method is
/// asked for; else as below. The assembly and the springs must outlive the system.
/// \throws Error as UpdatedNetwork and StiffnessSolver do
std::unique_ptr<BreakableSystem> make_breakable_system(BreakableNetwork network);

/// Factorizes every network anew. The assembly and the springs must outlive the system.
/// \throws Error as StiffnessSolver does
std::unique_ptr<BreakableSystem> make_refactorized_system(BreakableNetwork network);
/// Likewise, of the network without the contacts `broken`.
std::unique_ptr<BreakableSystem> make_refactorized_rest(BreakableNetwork network, std::span<const std::size_t> broken);

}  // namespace equidem
