// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Time step of colliding bodies from the duration of contacts and the stability limit.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include "equidem/grains/scene/pair_options.hpp"

namespace equidem {

/// Longest lever of a normal force about the centre of mass of a body, m: a - b for an ellipse, 0 for a disc.
double longest_lever(const Grain& grain, std::span<const Clump> clumps);

struct GrainStepOptions {
  std::optional<double> time_step = {};                      ///< s; none: by steps_per_contact
  std::optional<double> steps_per_contact = {};              ///< none: LawDescription::steps_per_contact
  double longest = std::numeric_limits<double>::infinity();  ///< largest step to choose, s: the duration of the run
};

/// The step of a run and its shortest contact.
struct GrainTimeStep {
  double step = 0;      ///< s
  double contact = 0;   ///< duration of the shortest contact, s; 0: not known (no closing_speed, or no two bodies)
  std::string between;  ///< kinds of that contact, "grains and walls"
  /// omega dt of that contact, omega = sqrt(k/m), i.e. sqrt(a); nonlinear springs: with the tangent stiffness at the
  /// largest overlap; 0: not known.
  double omega_step = 0;
  double limit = 0;       ///< LawDescription::stable_step, the largest omega dt; 0: none
  double bond_limit = 0;  ///< step limit of bonds, s; 0: none
  /// Limit of explicit dashpots, s, where bonds are exact and the step is more than a tenth of it, else 0. Each bond is
  /// exact with the others as they are; those that share discs lose too little energy, in proportion to the step: in
  /// bending 7 % at this limit.
  double chain_limit = 0;
  bool automatic = false;

  [[nodiscard]] double steps_in_contact() const { return contact / step; }
};

/// The given step, or a fraction of the shortest contact and at most half the limit of bonds (at which the dashpots of
/// a pair bring it to rest in one step).
/// \param scene with kinds set; pairs are not read
/// \param options time_step is not read
/// \throws Error (bad_input), its place the name of the option ("time_step", "law", "bonds"): a step that cannot be
///         chosen (DimensionlessStiffness, a nonlinear spring without closing_speed, no two bodies that can meet), a
///         step at which a force law is unstable even for one contact, bonds that check_bonds refuses
GrainTimeStep choose_time_step(const GrainScene& scene, const ContactTable& contacts, const GrainOptions& options,
                               const GrainStepOptions& wanted = {});

}  // namespace equidem
