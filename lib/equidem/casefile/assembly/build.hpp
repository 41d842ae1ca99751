// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Construction of the assembly, its springs, and the scene and options of a simulation from the case file.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/dynamics/simulation.hpp"

namespace equidem {

/// The assembly of a case, checked, with cells measured and the groups of [[group]] added.
/// \throws Error (bad_input), with the line of the case file: no such file, a group that names an absent disc, is empty
///         or has a name in use, a support or load on a group that does not exist
Assembly build_assembly(const Case& resolved);

/// disc_density and spring_relation of a case.
/// \throws Error (bad_input), with the line of the case file
std::optional<double> disc_density(const Case& resolved, const Assembly& assembly);
ChosenRelation spring_relation(const Case& resolved, const Assembly& assembly);

/// The springs of every contact and their source.
struct BuiltSprings {
  ContactSprings springs;
  std::optional<SpringConstants> constants;  ///< before weighting; none if the assembly file gives all springs
  std::string report;                        ///< report, one or two sentences
};

/// [material] is turned into springs by spring_relation.
/// \throws Error (bad_input), with the line of the case file: what the relation cannot represent, springs that
///         are missing or not positive
BuiltSprings build_springs(const Case& resolved, const Assembly& assembly);

/// Supports and loads that act from the start.
void add_constant_actions(Scene& scene, std::span<const Support> supports, const LoadCase& loads);

/// The scene: discs with their inertia, supports, loads, walls and velocities; the supports and loads of [test] act
/// from the start.
/// \param assembly, springs built from the case; they must outlive the scene
/// \throws Error (bad_input), with the line of the case file: no [run], no density, an assembly that is too small for
///         [test], a component of a disc that two supports prescribe differently, a disc with two velocities, walls
///         that the check of walls rejects
Scene build_scene(const Case& resolved, const Assembly& assembly, const ContactSprings& springs);

/// The probes of a run with the discs of their groups.
/// \param resolved with [run]
/// \throws Error (bad_input), with the line of the case file: a disc that is not there
std::vector<Probe> build_probes(const Case& resolved, const Assembly& assembly);

/// The settings of a run.
/// \param resolved with [run]
/// \param time_step s, > 0: that of [run], or that of its rule
SimulationOptions simulation_options(const Case& resolved, double time_step);

}  // namespace equidem
