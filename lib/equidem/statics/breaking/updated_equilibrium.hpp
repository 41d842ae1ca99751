// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The states of rest of a network whose contacts break one after another, from a factor that is updated.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/breaking/least_load_factor.hpp"
#include "equidem/statics/stiffness_solver.hpp"

namespace equidem {

struct UpdatedEquilibriumOptions {
  double friction = 0;  ///< >= 0
  /// Bring only those parts of the network up to date in which a contact may be critical. The contact found is the
  /// same.
  bool skip = true;
  /// Relative residual that every state is to stay below: motions are refined where rounding since the last refinement
  /// may have left so much.
  double watched_residual = 1e-12;
  int most_changes_unwatched = 256;  ///< after which the residual is looked at in any case
  double memory_limit = 0;           ///< bytes; 0: what the machine has
  bool force_moments = false;        ///< follow the sums of OpenedContact::moment
};

/// Works and sums over all contacts of the states of rest, N. Energies are works halved (Clapeyron).
struct EquilibriumSums {
  std::array<std::array<double, 2>, 2> load_work{};  ///< of the loads of one right-hand side on the motions of another
  /// Under each right-hand side, of what the prescribed motions and the mean strain of the first one need, on these.
  std::array<double, 2> imposed{};
  std::array<Tensor2, 2> moment{};  ///< sum F_i l_j, per right-hand side; 0 where it is not followed
};

/// A contact that was removed, with the numbers from which work, energy and stress of the network behind the removal
/// follow (breakage/network_response.hpp, follow).
struct OpenedContact {
  std::array<ContactForce, 2> force{};          ///< per right-hand side, as it let go, N/m
  std::array<ContactDeformation, 2> opening{};  ///< of its ends without it, m
  std::array<Tensor2, 2> moment{};              ///< change of sum F_i l_j over all contacts, N
};

struct UpdateCounters {
  std::int64_t updates = 0;         ///< changes of a contact made in the factor
  std::int64_t factorizations = 0;  ///< of the whole matrix, the first included
  std::int64_t mended = 0;          ///< of these, because round-off of updates had grown
  std::int64_t refinements = 0;     ///< times that the residual was evaluated and the motion refined
  std::int64_t held = 0;            ///< components held because a removal left a mechanism
  std::int64_t fronts = 0;          ///< swept back through, by changes and searches
  std::int64_t all_fronts = 0;      ///< that there are, at every search
  double largest_residual = 0;      ///< relative, claimed of the states behind changes
  double most_over_claimed = 0;     ///< residual found when motions were refined, over that claimed before; the largest
};

/// A mechanism that a change left, and the component that is held instead.
struct HeldMechanism {
  std::int64_t component = -1;  ///< disc * per_disc + k
  double stiffness = 0;         ///< of its support, Pa
  /// Per right-hand side, N/m: force of the support. Not zero beyond round-off where the load works on the mechanism:
  /// the network does not carry it.
  std::vector<double> reaction;
  std::vector<std::uint8_t> driven;  ///< per right-hand side, 1: the reaction is more than round-off
};

/// The contact that breaks next.
struct CriticalContact : FirstToBreak {
  ProportionalForce force{};  ///< of the contact, N/m
  /// Found where motions had to be refined, and the factor made anew, before the contact could be told.
  std::vector<HeldMechanism> mechanisms{};
};

/// At most two right-hand sides, the first in proportion to lambda, the second, where there is one, dead. Every motion
/// follows from the one before by the forces that a removed contact set free: forward substitution along one path of
/// the elimination tree, back substitution where something moves enough to matter. Positive definite networks only.
class UpdatedEquilibrium {
 public:
  /// The assembly must outlive the object. \param unknowns holds what supports and free rigid motions need.
  /// \throws Error (bad_input) where a spring is negative, or there are no or more than two right-hand sides;
  ///         (computation_failed) where K is not positive definite: the network has mechanisms; or where the memory
  ///         does not suffice
  UpdatedEquilibrium(const Assembly& assembly, const ContactSprings& springs, DegreesOfFreedom unknowns,
                     std::vector<RightHandSide> cases, std::vector<ContactStrength> strengths,
                     const UpdatedEquilibriumOptions& options = {});
  ~UpdatedEquilibrium();
  UpdatedEquilibrium(const UpdatedEquilibrium&) = delete;
  UpdatedEquilibrium& operator=(const UpdatedEquilibrium&) = delete;

  /// Take a contact out: it carries nothing and never breaks again. \return mechanisms that this leaves
  std::vector<HeldMechanism> remove(std::size_t contact);
  /// Springs of a contact instead of those that it has; at most as stiff as at first. A contact that was removed comes
  /// back without its strength, and without force only where its ends are where they were at first.
  std::vector<HeldMechanism> change(std::size_t contact, SpringConstants springs);
  /// Contacts that were removed do not break. Where lambda goes back towards 0, in a time proportional to the contacts.
  [[nodiscard]] CriticalContact critical(const LoadFactorSearch& search = {});

  /// Per contact, by the bounds with which the last search, of that kind, left parts of the network as they were: no
  /// key (BreakingMoment) of it is less.
  [[nodiscard]] std::vector<double> least_keys(const LoadFactorSearch& search = {}) const;

  /// The contact that the last call of remove() took out, where the state has followed from that before it alone: null
  /// where motions were refined with it.
  [[nodiscard]] const OpenedContact* opened() const;
  /// Null but where motions were refined by the last call of remove() or refine(), nothing was changed since then, and
  /// loads drive no mechanism.
  [[nodiscard]] const EquilibriumSums* sums() const;
  /// Takes contacts out of all later searches, such as those of discs that have left the network.
  void spare(std::span<const std::size_t> contacts);

  /// Per contact, N/m.
  [[nodiscard]] std::vector<ContactForce> forces(std::size_t of_case);
  /// Per component.
  [[nodiscard]] PreciseMotion motion(std::size_t of_case);
  /// Evaluate the residuals of the contact law, refine the motions by one step at least, and factorize anew where that
  /// does not serve.
  /// \return the largest relative residual before
  double refine();
  /// A motion that deforms no contact, to round-off, and on which the loads of every right-hand side do work: the
  /// network carries none of them.
  /// \param component held in place of a mechanism that is to be told; -1: the softest motion that the loads find
  /// \return per disc; empty where there is no such motion
  [[nodiscard]] std::vector<DiscMotion> driven_mechanism(std::int64_t component) const;
  /// An upper estimate of the relative residual, the largest of all right-hand sides: measured when motions were last
  /// refined, and what rounding may have added since. Where a load drives a mechanism there is no state to claim
  /// anything of.
  [[nodiscard]] double estimated_residual() const;
  [[nodiscard]] const ContactSprings& springs() const;
  [[nodiscard]] const UpdateCounters& counters() const;
  [[nodiscard]] double factor_bytes() const;
  /// Bytes of everything that the object keeps, the factor included.
  [[nodiscard]] double bytes() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace equidem
