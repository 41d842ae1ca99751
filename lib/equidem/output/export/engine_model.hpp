// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A model as discrete-element codes take it: bodies, bonds or contact properties, walls, and what acts; the parts that
/// each code carries, as one table; the files that it runs.
///
/// Forces, masses and moments of inertia of discs are per metre of depth, those of spheres are whole.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/motion/schedule.hpp"
#include "equidem/motion/wall.hpp"

namespace equidem {

enum class Engine { lammps, yade };

template <>
struct EnumNames<Engine> {
  using enum Engine;
  static constexpr const char* what = "engine";
  static constexpr NamedValue<Engine> list[] = {{lammps, "LAMMPS"}, {yade, "YADE"}};
};

/// Parts of a model that some engine does not carry.
enum class EngineFeature {
  contact_points,
  contact_points_of_no_radii,
  shapes,
  bonds,
  strengths,
  other_strengths,
  cells,
  given_at_start,
  turning,
  schedules,
  mass_damping,
  bond_dashpots,
  some_walls,
  shaped_walls,
  other_laws,
  dashpots,
  friction_levers,
  rolling,
};

/// A row of the table.
struct EngineFeatureRow {
  EngineFeature value;
  const char* name;  ///< a plural noun
  bool lammps = false, yade = false;
  const char* why;     ///< of what is not carried
  const char* remedy;  ///< a sentence without its full stop
  /// The word of --accept that exports a model all the same, approximated as `why` says; null: nothing does.
  const char* accept = nullptr;

  [[nodiscard]] bool carried_by(Engine engine) const { return engine == Engine::lammps ? lammps : yade; }
};

template <>
struct EnumNames<EngineFeature> {
  using enum EngineFeature;
  static constexpr const char* what = "part of a model";
  static constexpr EngineFeatureRow list[] = {
      {contact_points, "contact points off the middle between two centres", false, true,
       "a bond of bpm/rotational acts half-way between the centres",
       "Export to yade, unequal discs with assembly.levers = \"middle\"; or set assembly.levers = \"halfway\""},
      {contact_points_of_no_radii, "contact points that no radii of round bodies place", false, false,
       "its contact points follow from one radius a body, on the line of centres",
       "Set assembly.levers = \"middle\", that is (d + r_i - r_j)/2, or \"halfway\", d/2, which LAMMPS needs"},
      {shapes, "bodies that are neither discs nor spheres", false, false,
       "their contacts and moments of inertia are others", "Take discs, or 'equidem run'"},
      {bonds, "bonds other than one spring kN >= 0 and one kT >= 0 between two bonded discs", false, false,
       "its bonds store energy, are one a pair, do not resist bending and are all there at the start",
       "Take out what is named here (negative kT, kM or bond_width, [[notch]], [[dead_load]], [bonds]), or use "
       "'equidem "
       "solve', 'quasistatic' or 'run'"},
      {strengths, "strengths of bonds", true, false, "a cohesive contact that broke goes on to push",
       "Export to lammps, or take out [strength]"},
      {other_strengths, "strengths whose friction is not shear/tension, or with friction after breaking", false, false,
       "its bonds are gone where N/tension + T/shear reaches 1, the tangential force T then being shear - friction N "
       "with "
       "friction = shear/tension",
       "Set strength.friction to shear/tension, or use 'equidem quasistatic'"},
      {cells, "periodic cells of bodies that collide, or shorter than twice the longest bond", false, false,
       "a bond joins the nearest images there, and the motion of the sides is not written",
       "Take a larger cell of bonded discs, or let walls bound the bodies"},
      {given_at_start, "prescribed displacements that a run begins with", true, false,
       "its tangential forces follow velocities, not positions", "Export to lammps, or run until_rest"},
      {turning, "moments as loads, and rotations that follow a schedule", false, true,
       "it has no command for the torque on single atoms", "Export to yade, or take them out"},
      {schedules, "schedules of more than 50 points, or in a run until rest", false, false,
       "a schedule is one formula of the time there, in a run of known duration",
       "Give a ramp, a sine or a shorter table, and run.duration in place of run.until_rest"},
      {mass_damping, "damping proportional to mass", false, false, "it has no such damping of rotations",
       "Take local damping"},
      {bond_dashpots, "dashpots in bonds (damping by stiffness or contact)", true, false,
       "it has none in the law of its bonds", "Export to lammps, or take local damping"},
      {some_walls, "walls that push bonded discs, or are not parallel to an axis", true, false,
       "its walls are parallel to one and touch free bodies", "Export to lammps, or hold discs by supports"},
      {shaped_walls, "walls that are segments, or follow a force or a stress", false, false,
       "its walls are planes of known motion", "Take lines without [wall.servo], or 'equidem run'"},
      {other_laws, "laws of contact other than one linear spring and dashpot", false, false, "it computes no others",
       "Take the law linear_dashpot with collisions.stiffness, and of what is named here none"},
      {dashpots, "restitution below 1 of unequal bodies or pairs, and dashpots that pull or act along the contact",
       true, false, "its dashpots follow from one number for each body, and end where they would pull",
       "Export to lammps, or set restitution = 1 and tangential_damping = 0"},
      {friction_levers, "friction of bodies that overlap", false, false,
       "its levers differ by parts of the overlap (LAMMPS: the radii, YADE: to the middle, walls otherwise; here: "
       "parts of the distance), and which contacts slide follows: overlaps of a settled box differ by 0.7 per cent "
       "(data/interop.md)",
       "Give --accept friction to export it with these levers, or set friction = 0", "friction"},
      {rolling, "rolling resistance", true, false, "its law of these contacts has no rolling moment",
       "Export to lammps, or set rolling_friction = 0"},
  };
};

/// The features of a model with an instance of each, such as "negative kT of contact 3".
using FoundFeatures = std::map<EngineFeature, std::string>;

/// \param accepted words of EngineFeatureRow::accept
/// \throws Error (bad_input) on a word that no feature has; on the first feature that the engine does not carry and
///         that is not accepted: name, instance, why, what to do
void require_carried(const FoundFeatures& found, Engine engine, const std::vector<std::string>& accepted);

/// The words of --accept, with the features that they are about.
std::vector<std::string> acceptable_features();

/// The table in Markdown: a row for each feature, a column for each engine, and the reason of its refusals.
std::string engine_features_table();

struct EngineBody {
  Vec2 position;      ///< m
  double radius = 0;  ///< m
  Inertia inertia;
  Vec2 velocity = {};   ///< m/s
  double spin = 0;      ///< rad/s
  int kind = 0;         ///< of a grain: row of the table of pairs
  DiscForce load = {};  ///< constant, without gravity
  /// Prescribed displacement in x, y (m) and rotation (rad) at the start; none: free.
  std::array<std::optional<double>, 3> held = {};
};

/// A bond of kN and kT, without force at the start.
struct EngineBond {
  std::int32_t i = 0, j = 0;
  double length = 0;  ///< distance of the centres, m
  SpringConstants springs;
  SpringConstants dashpots = {};  ///< N s/m per m; 0: none
  /// N/m: it is gone where N/tension + |T|/shear >= 1, N positive in tension; infinite: it does not break.
  double tension = std::numeric_limits<double>::infinity(), shear = std::numeric_limits<double>::infinity();
  std::int32_t shift_x = 0;  ///< periods from j to its image that i is bonded to
  std::int32_t shift_y = 0;
};

/// A prescribed displacement that changes with time, m or rad.
struct EngineMotion {
  std::size_t component = 0;  ///< 0: x, 1: y, 2: rotation
  Schedule displacement;
  std::vector<std::int32_t> bodies;
};

/// Loads on bodies times a factor that changes with time.
struct EngineLoad {
  Schedule factor;
  std::vector<std::pair<std::int32_t, DiscForce>> shares;
};

struct EngineModel {
  std::string title;
  Body body = Body::disc;
  bool bonded = false;
  bool to_rest = false;        ///< the run ends at rest, not after its duration
  double duration = 0;         ///< s
  double time_step = 0;        ///< s, stable
  double local_damping = 0;    ///< share of the resultant that acts against the velocity (Cundall)
  Vec2 gravity;                ///< m/s²
  std::optional<Vec2> period;  ///< m
  std::vector<EngineBody> bodies;
  std::vector<EngineBond> bonds;
  std::vector<EngineMotion> motions;
  std::vector<EngineLoad> timed_loads;
  /// Radii, m, that place the contact point of bodies at a distance d at (d + r_i - r_j)/2 from i, as the bonds have
  /// it; empty: there are none.
  std::vector<double> lever_radii;
  std::vector<Wall> walls;
  int kinds = 0;                      ///< of grains and walls
  std::vector<PairProperties> pairs;  ///< kinds x kinds, row by row
  bool graded_dashpots = false;       ///< dashpots of bodies of unequal masses, or along the contact
  FoundFeatures found;                ///< that some engine does not carry

  [[nodiscard]] const PairProperties& between(int a, int b) const {
    return pairs[static_cast<std::size_t>(a * kinds + b)];
  }
  [[nodiscard]] bool has_bodies(int kind) const {
    return std::ranges::find(bodies, kind, &EngineBody::kind) != bodies.end();
  }
};

/// Contact points that differ by less, of the length of the bond, count as the same: an engine then computes the model
/// to about that accuracy.
inline constexpr double lever_tolerance = 1e-6;

/// The model of bonded discs; title, to_rest, duration and time_step are not set.
EngineModel engine_model(const Scene& scene, const SimulationOptions& options, Body body);

/// The model of colliding bodies; title, duration and time_step are not set.
EngineModel engine_model(const GrainScene& scene, const GrainOptions& options, Body body);

/// Whether the masses of all bodies are equal to 1e-9.
bool equal_masses(const EngineModel& model);

/// A number in the shortest form that reads back to the same bits.
std::string exact(double value);

/// A schedule as a formula that LAMMPS and Python read, with abs, sin and cos.
/// \param time the name of the time in it, s
std::string formula_of(const Schedule& schedule, const std::string& time);

struct EngineFile {
  std::string name;
  std::string text;
};

/// Rows of a file that are written between two looks for a signal.
inline constexpr std::size_t rows_between_looks = 65536;

/// LAMMPS: in.equidem, assembly.data, and the loads where bodies have some. Bonds: BPM's bpm/rotational with a bond
/// type for each pair of kN and kT. Grains: gran/hooke/history, or, where dashpots or groups differ or bodies resist
/// rolling, the style granular (LAMMPS of 2023 or later).
/// \param model carried by LAMMPS (require_carried)
std::vector<EngineFile> lammps_files(const EngineModel& model);

/// YADE: run_equidem.py. Bonds: CohFrictMat with kn and ks of each, bodies of the radii that place the contact points.
/// Grains: FrictMat, Cundall and Strack's law; ViscElMat where bodies of one mass have dashpots.
/// \param model carried by YADE
std::vector<EngineFile> yade_files(const EngineModel& model);

/// README: model, units and depth, how to start.
EngineFile readme_of(const EngineModel& model, Engine engine);

/// The steps of a run: of its duration; to rest at most so many, after about fifty periods of the longest wave.
std::int64_t steps_of(const EngineModel& model);

/// N/m: the largest load, weight, or force of a bond that is stretched by a prescribed displacement; the measure of the
/// unbalanced force at rest.
double force_scale(const EngineModel& model);

}  // namespace equidem
