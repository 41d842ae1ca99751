// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contact options of two bodies, and the constants derived from them.
///
/// Kinds of bodies and walls, and the contact properties of every two kinds.
///
/// Time step of colliding bodies from the duration of contacts and the stability limit.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

/// Stiffness k of a force k overlap^p, N/m^p, per metre of depth for discs.
struct SpringStiffness {
  double value = 0;
};
/// Dimensionless stiffness a = k dt²/m, constant for every step and every reduced mass m; where p is not 1,
/// k d_c^(p-1) dt²/m.
struct DimensionlessStiffness {
  double value = 0;
};
/// Duration of a contact until the overlap is zero again, s, equal for all masses. For linear laws: contacts of
/// others are shorter at higher speed.
struct ContactDuration {
  double value = 0;
};
/// Largest overlap of any two bodies that meet at PairOptions::closing_speed, m.
struct LargestOverlap {
  double value = 0;
};
/// Elastic spheres, rigid walls: k by Hertz, for each pair of radii. For laws of p = 3/2.
struct HertzModuli {
  double young_modulus = 0;  ///< Pa
  double poisson_ratio = 0;  ///< in (-1, 0.5]
};
/// Discs as squares of a continuum in plane strain: kN = pi/4 rho Vp², kT = pi/4 rho Vs² (Sukegawa 2010, (2.26)). For
/// linear laws.
struct WaveSpeedStiffness {
  double density = 0;           ///< rho, kg/m³
  double shear_wave_speed = 0;  ///< Vs, m/s
  double poisson_ratio = 0;     ///< in (-1, 0.5)
};
/// One of these must be given.
using StiffnessOptions = std::variant<std::monostate, SpringStiffness, DimensionlessStiffness, ContactDuration,
                                      LargestOverlap, HertzModuli, WaveSpeedStiffness>;

/// Ratio of the speeds after and before a central impact without gravity, 0 to 1.
struct Restitution {
  double value = 1;
};
/// h of the dashpots 2 h sqrt(m k) along and across, m the mass of a disc (Sukegawa 2010, (2.27)). exact_flow and
/// linear_dashpot only.
struct DashpotDamping {
  double value = 0;
};
/// One of these must be given.
using ReboundOptions = std::variant<std::monostate, Restitution, DashpotDamping>;

/// Contact options of two bodies.
struct PairOptions {
  StiffnessOptions stiffness = {};
  ReboundOptions rebound = {};
  double closing_speed = 0;  ///< closing speed of the fastest impact expected, m/s; 0: not known
  double friction = 0;       ///< mu
  /// kT/kN with friction; none: 2/7; with WaveSpeedStiffness the ratio of the wave speeds; 0 for the maps, which apply
  /// an impulse in one or two steps, in which no spring stretches to the friction force.
  std::optional<double> tangential_ratio = {};
  /// zeta of the tangential dashpot, with a tangential spring; none: 0, or with DashpotDamping its damping ratio.
  std::optional<double> tangential_damping = {};
  double rolling_friction = 0;  ///< mu_r (contacts/contact_effects.hpp)
  /// k_r/(kN R²) with rolling friction; none: as tangential_ratio, and 2/7 without friction.
  std::optional<double> rolling_ratio = {};
  /// zeta of the rolling dashpot, with rolling friction; none: as tangential_damping.
  std::optional<double> rolling_damping = {};
  double cohesion = 0;        ///< N, for discs per metre of depth
  double cohesion_range = 0;  ///< m
};

/// Data of the two kinds of bodies in contact.
struct MeetingBodies {
  Body body = Body::disc;
  bool on_wall = false;
  double largest_reduced_mass = 1;  ///< largest over all pairs of the two kinds, kg; for LargestOverlap
  double radius_i = 0;              ///< m; for HertzModuli
  double radius_j = 0;              ///< m; not used on a wall
};

/// Contact constants of two kinds of bodies.
struct PairContact {
  /// stiffness and dimensionless are not set if they follow from `duration`.
  PairProperties properties;
  double duration = 0;       ///< s; 0: not given
  double closing_speed = 0;  ///< m/s; 0: not known
};

/// \throws Error (bad_input), its place the name of the option: no stiffness or rebound, options that the law or the
///         body does not have, numbers out of range, a restitution that no dashpot gives
PairContact contact_of(const PairOptions& options, NormalLaw law, const MeetingBodies& bodies);

/// The constants for a time step: ContactDuration keeps omega = sqrt(k/m) for all masses, a = (omega dt)².
/// \param step s
PairProperties properties_at(const PairContact& contact, NormalLaw law, double step);

/// LawDescription::damping_ratio of a pair; 0 for laws without a dashpot.
double damping_ratio(NormalLaw law, const PairProperties& pair);

/// Contact options of the bodies of a scene.
struct CollisionOptions {
  Body body = Body::disc;
  PairOptions bodies = {};                ///< contacts of two bodies
  std::optional<PairOptions> walls = {};  ///< contacts of a body and a wall; none: as for two bodies
  /// Contacts of two groups of bodies, or of a group and the wall of that name.
  struct Pair {
    std::string group, with;
    PairOptions contact;
  };
  std::vector<Pair> pairs = {};  ///< each pair of names at most once
};

/// Contact properties of every two kinds.
struct ContactTable {
  /// Groups of bodies, then "walls", then walls with a pair of their own; with HertzModuli a group counts once for each
  /// radius.
  std::vector<std::string> kinds;
  std::vector<PairContact> pairs;  ///< row by row, symmetric

  [[nodiscard]] int kind_count() const { return static_cast<int>(kinds.size()); }
  [[nodiscard]] const PairContact& between(int a, int b) const { return pairs[a * kind_count() + b]; }
  [[nodiscard]] const std::string& kind(int a) const { return kinds[a]; }
};

/// Sets the kinds of bodies and walls of a scene, and the contact properties of every two kinds.
/// \param scene with all bodies and walls; Grain::kind, Wall::kind and GrainScene::kinds are set
/// \param groups one name for each body; empty: all are "grains"
/// \throws Error (bad_input) as contact_of, its place the name of the option, such as "restitution", "walls.stiffness",
///         "pairs.0.with"; also: more than 256 kinds, a pair of unknown names, a pair given twice
ContactTable set_kinds(GrainScene& scene, std::span<const std::string> groups, const CollisionOptions& options,
                       NormalLaw law);

/// Value of GrainScene::pairs for a time step.
/// \param step s
std::vector<PairProperties> pairs_at(const ContactTable& contacts, NormalLaw law, double step);

/// Extreme masses of the bodies of a kind.
struct KindMasses {
  std::size_t grains = 0;                                                     ///< 0: walls
  double smallest = 0, second_smallest = 0, second_largest = 0, largest = 0;  ///< kg
};
std::vector<KindMasses> masses_of_kinds(std::span<const Grain> grains, int kinds);

struct ReducedMasses {
  double smallest = 0, largest = 0;  ///< kg
};
/// Extremes over all pairs of two kinds; none if the scene has no two such bodies.
std::optional<ReducedMasses> reduced_masses(const std::vector<KindMasses>& kinds, int a, int b);

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
