// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Scene of colliding bodies: bodies, walls, bonds, contact properties and options.
///
/// Checks of scenes with ellipses or clumps.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <ranges>
#include <span>
#include <string>
#include <vector>

#include "equidem/breakage/strengths.hpp"
#include "equidem/contact/laws/normal_law.hpp"
#include "equidem/contact/restitution.hpp"
#include "equidem/core/names.hpp"
#include "equidem/geometry/shapes.hpp"
#include "equidem/grains/cell/periodic_cell.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/motion/any_simulation.hpp"
#include "equidem/motion/wall.hpp"

namespace equidem {

enum class GrainShape { disc, ellipse, clump };

/// A body. Units are those of its mass: kg and N for spheres, kg and N per metre of depth for discs, ellipses and
/// clumps.
struct Grain {
  Vec2 position;  ///< centre of mass, m
  /// Radius of the circle round the centre of mass that contains the body, m: of a disc its radius, of an ellipse the
  /// long half-axis.
  double radius = 0;
  Inertia inertia;
  Vec2 velocity = {};
  double spin = 0;   ///< rad/s
  double angle = 0;  ///< rad
  int kind = 0;      ///< row of the table of pairs
  /// Ellipse: the short half-axis, m; at angle 0 the long half-axis lies along x. 0: not an ellipse.
  double short_half_axis = 0;
  int clump = -1;       ///< index in GrainScene::clumps; -1: not a clump
  bool present = true;  ///< false: a body of the run that has gone or comes later, of which nothing else is read

  [[nodiscard]] GrainShape shape() const {
    if (clump >= 0) return GrainShape::clump;
    return short_half_axis > 0 ? GrainShape::ellipse : GrainShape::disc;
  }
};

/// Two discs of a bond as they were without stretch.
struct BondRest {
  Vec2 branch;                      ///< from the centre of i to that of j, m
  double angle_i = 0, angle_j = 0;  ///< of the discs, rad
};

/// Two discs bonded by dashpots along and across the line of their centres (Sukegawa 2010, (5.1)-(5.19)), optionally
/// with springs. They do not collide with each other.
struct GrainBond {
  std::size_t i = 0, j = 0;
  double normal_dashpot = 0, tangential_dashpot = 0;  ///< C_n, C_s; N s/m, discs: per metre of depth
  double rolling_dashpot = 0;                         ///< against the relative spin, N m s
  /// Springs, unstretched at rest, N/m. 0 in the thesis: a bond under tension then creeps.
  double normal_spring = 0, tangential_spring = 0;
  double bending_spring = 0;          ///< kM, against the relative rotation, unstretched at rest, N m/rad
  std::optional<BondRest> rest = {};  ///< none: as the discs are at the start

  [[nodiscard]] bool has_springs() const { return normal_spring > 0 || tangential_spring > 0 || bending_spring > 0; }
};

/// Contact properties of two kinds of bodies.
struct PairProperties {
  /// Stiffness k of a force k overlap^p, N/m^p; used if > 0, else `dimensionless`.
  double stiffness = 0;
  /// a = k dt²/m, constant for all steps and masses (as in the paper); where p is not 1, k d_c^(p-1) dt²/m.
  double dimensionless = 0;
  double restitution = 1;                      ///< of central impacts; eccentric ones of shapes: part_loop.cpp
  ContactEnd end = ContactEnd::at_zero_force;  ///< read by laws that give a force, and exact_flow
  double friction = 0;                         ///< mu
  /// kT/kN >= 0; where p is not 1, kT/(k d_c^(p-1)). Laws that give a force need more than 0 with friction; with 0
  /// other laws have contacts that always slide.
  double tangential_ratio = 0;
  double tangential_damping = 0;  ///< zeta_T: dashpot 2 zeta_T sqrt(m kT), m the effective tangential mass
  // rolling and cohesion of laws that give a force: contacts/contact_effects.hpp
  double rolling_friction = 0;  ///< mu_r
  double rolling_ratio = 0;     ///< k_r/(kN R²), > 0 with rolling friction; kN as in tangential_ratio
  double rolling_damping = 0;   ///< zeta_r: dashpot 2 zeta_r sqrt(I k_r), 1/I = 1/I_i + 1/I_j
  double cohesion = 0;          ///< F_c, N
  double cohesion_range = 0;    ///< largest gap at which it acts, m
  bool operator==(const PairProperties&) const = default;
};

/// Bodies, bonds and the properties of contacts, besides walls and gravity. In a run whose stages change them, bodies
/// and bonds keep their numbers: a bond counts where both of its bodies are present.
struct GrainScene : AnyScene {
  std::vector<Grain> grains;
  std::vector<Clump> clumps;  ///< shapes, each used by any number of grains
  std::vector<GrainBond> bonds;
  std::optional<PeriodicCell> cell;           ///< none: nothing repeats
  std::optional<ContactStrengths> strengths;  ///< of the bonds, in their order; none: they never break
  int kinds = 1;
  std::vector<PairProperties> pairs;  ///< kinds x kinds, symmetric, row by row

  [[nodiscard]] const PairProperties& between(int a, int b) const { return pairs[a * kinds + b]; }
  [[nodiscard]] auto present() const { return grains | std::views::filter(&Grain::present); }
  [[nodiscard]] bool ties(const GrainBond& bond) const { return grains[bond.i].present && grains[bond.j].present; }
};

struct GrainOptions {
  NormalLaw law = NormalLaw::linear_dashpot;
  /// Integrator of the force laws; exact_flow and the maps have their own step.
  enum class Integrator {
    semi_implicit_euler,  ///< v' = v + a(x, v) dt, x' = x + v' dt; gravity is added after the contact force (the
                          ///< paper's runs)
    velocity_verlet,      ///< half kick, drift, force with the velocities of the half step, half kick (LAMMPS)
  } integrator = Integrator::semi_implicit_euler;
  [[nodiscard]] bool verlet() const { return integrator != Integrator::semi_implicit_euler; }
  double time_step = 0;         ///< s, > 0
  double reference_length = 0;  ///< d_c, m; 0: twice the largest radius (ellipses: long half-axis)
  double margin = 0;            ///< margin of the neighbour lists, m; 0: chosen from speeds and density
  /// Contact detection of two ellipses, or of an ellipse and a disc.
  enum class EllipseLaw {
    exact,     ///< closest points and common normal (geometry/shape_contact.hpp)
    enlarged,  ///< Sukegawa's test (4.1)-(4.49), same file: misses shallow contacts
  } ellipse_law = EllipseLaw::exact;
  /// How dashpots of bonds act over a step.
  enum class BondStep {
    exact,           ///< each bond decays exactly, bonds that share discs one after the other
    explicit_euler,  ///< velocities at the start of the step (Sukegawa 2010, (5.2), (5.8)): step limit (bond_step.hpp)
  } bond_step = BondStep::exact;
  /// Bodies of a block, the work that a thread does at a time (body_blocks.hpp); 0: chosen from the number of bodies,
  /// one block of few. The order of sums, and so the last bits, depend on it.
  std::size_t bodies_per_block = 0;
  bool refuse_crossing = true;  ///< false: bodies may pass through one another (for studies of laws that allow it)
};

template <>
struct EnumNames<GrainOptions::BondStep> {
  using enum GrainOptions::BondStep;
  static constexpr const char* what = "step of bonds";
  static constexpr NamedValue<GrainOptions::BondStep> list[] = {{exact, "exact"}, {explicit_euler, "explicit"}};
};

template <>
struct EnumNames<GrainOptions::Integrator> {
  using enum GrainOptions::Integrator;
  static constexpr const char* what = "integrator";
  static constexpr NamedValue<GrainOptions::Integrator> list[] = {{semi_implicit_euler, "semi_implicit_euler"},
                                                                  {velocity_verlet, "velocity_verlet"}};
};

template <>
struct EnumNames<GrainOptions::EllipseLaw> {
  using enum GrainOptions::EllipseLaw;
  static constexpr const char* what = "contact of ellipses";
  static constexpr NamedValue<GrainOptions::EllipseLaw> list[] = {{exact, "exact"}, {enlarged, "enlarged"}};
};

/// d_c, m: options.reference_length, or twice the largest radius if that is 0.
double reference_length(const GrainScene& scene, const GrainOptions& options);

/// Place of a grain or of a bond in the user's input, by its number.
using PlaceOfGrain = std::function<std::string(std::size_t grain)>;
using PlaceOfBond = std::function<std::string(std::size_t bond)>;

/// \throws Error (bad_input), its place the name of the property: friction, rolling resistance or cohesion that miss a
///         number that they need, or that the law does not carry
void check_resistance(const PairProperties& pair, NormalLaw law);

/// \throws Error (bad_input): no grains, radius or mass not positive, numbers not finite or beyond 1e150, kinds and
///         pairs that do not match, a table that is not symmetric, neither or both of stiffness and dimensionless,
///         restitution out of range for the law, friction negative, rolling or cohesion incomplete or with a law that
///         gives no force, velocity_verlet with a map, shapes as in
///         grain_scene.hpp, the time step not positive, grains that start inside one another (centre within the other)
///         or with the centre behind a line
/// \param where place of a grain in the user's input, for error messages; may be empty
void check(const GrainScene& scene, const GrainOptions& options, const PlaceOfGrain& where = {});
/// The same, but for the places of the bodies and for bonds.
void check_properties(const GrainScene& scene, const GrainOptions& options, const PlaceOfGrain& where = {});
/// The places alone. \param begun not negative: the body is there already. Two that a run has brought into one another,
/// as bonds without springs do, stay so; empty: all are new
void check_places(const GrainScene& scene, const PlaceOfGrain& where, std::span<const std::int32_t> begun);

/// \throws Error (bad_input): bonds of bodies that do not exist or are not discs, of a body with itself, or of the same
///         two a second time; centres that coincide; dashpots and springs that are negative, not finite or all 0
/// \param where for error messages; may be empty
void check_bonds(const GrainScene& scene, const PlaceOfBond& where = {});

/// Check the servos of all walls against each other.
/// \throws Error (bad_input): a law without forces, a name of no wall, a wall that is moved by two servos, by its
///         mirror and itself, or by a schedule along the same direction, a stress whose length is not known
void check_servos(const GrainScene& scene, NormalLaw law);

/// \throws Error (bad_input): short half-axis not in (0, radius], a body that is both ellipse and clump, a clump that
///         does not exist, has no discs, has discs outside the radius or its centre of mass not at the origin
void check_shape(const GrainScene& scene, std::size_t grain);

/// \throws Error (bad_input): laws that do not support ellipses and clumps; spheres in the scene
void check_laws_of_shapes(const GrainScene& scene, const GrainOptions& options);

/// Whether the centre of a part is behind a wall or on it.
bool is_behind(const GrainScene& scene, const Grain& grain, const Wall& wall);

}  // namespace equidem
