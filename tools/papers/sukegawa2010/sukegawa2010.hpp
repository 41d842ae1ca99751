// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sukegawa (2010), chapter 8, computed again: a box filled with discs, ellipses and pairs of discs, at rest and
/// shaken; and two questions that section 9.2 leaves open, which shaking compacts best and whether the box resonates.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "equidem/core/statistics.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/packing/packing_shape.hpp"

#include "papers.hpp"
#include "sukegawa2010/packings.hpp"
#include "sukegawa2010/printed_discs.hpp"

namespace equidem::sukegawa2010 {

using Shape = PackingShape::Kind;
using EllipseLaw = GrainOptions::EllipseLaw;

// The tables of sections 8.2 to 8.4.
constexpr double poisson_ratio = 0.25, shear_speed = 150, density = 2480;  ///< -, m/s, kg/m³
constexpr double friction = 0.17, wall_friction = 0.25, gravity = 9.8;     ///< -, -, m/s²
constexpr double smallest_radius = 0.005, largest_radius = 0.01;           ///< m, uniform
constexpr double printed_step = 1e-6;                                      ///< s
constexpr double printed_box_height = 2.25;                                ///< m, section 8.9.3
constexpr double printed_period = 1.85;                                    ///< s, section 8.9.3
constexpr double bulk_void_ratio = 0.213;                                  ///< e of (2.25) in the variants that use it

/// Before and after 400 gal, 10 Hz (Figs. 8.2 to 8.24); 0: not in the thesis.
struct Printed {
  Shape shape;
  double before, after;  ///< void ratio
};
inline constexpr std::array printed_void_ratios{
    Printed{Shape::disc, 0.213, 0.198}, Printed{Shape::ellipse, 0.160, 0.139},
    Printed{Shape::bonded_pair, 0.220, 0.205}, Printed{Shape::rigid_pair, 0, 0}};

/// The start: rows of places at the distance `cell`, every other row shifted by half of it, in a box of their width. 40
/// columns, 75 rows and 3 cm give the thesis's box: width 40.5 x 3 cm = 1.215 m, height 75 x 3 cm = 2.25 m, 3000
/// bodies; its numbers 485, 500, 515 and so on lie at the left, middle and right of rows 13, 38 and 63.
struct StartGrid {
  std::int64_t columns = 40, rows = 75;

  [[nodiscard]] std::int64_t places() const { return columns * rows; }
  [[nodiscard]] double width() const { return cell * (static_cast<double>(columns) + 0.5); }
  static constexpr double cell = 0.03;       ///< m
  static constexpr double pair_row = 0.041;  ///< m, rows of pairs: each takes two places of a row
};

/// a cos(2 pi f t), along x.
struct Shaking {
  double gal = 0, frequency = 0;  ///< 0.01 m/s², Hz
  std::int64_t cycles = 0;
};

/// A filling of the box.
struct Fill {
  Shape shape = Shape::disc;
  StartGrid grid = {};
  std::uint64_t seed = 1;
  double softness = 1;                       ///< springs of (2.26) over those used
  double damping = 1;                        ///< h of (2.27)
  double friction = sukegawa2010::friction;  ///< between grains
  double step_share = 0.5;                   ///< of the limit of the two lightest bodies
  std::optional<double> step = {};           ///< s, in place of step_share
  double bond_step = printed_step;           ///< s: dashpots of bonds C_n = m_r/bond_step, C_s = C_n/3
  FrictionCap cap = FrictionCap::whole_force;
  EllipseLaw ellipse_law = EllipseLaw::exact;
  double row_share = 1;  ///< height of the rows at the start over that of the thesis
  /// rho = (1 + e) gamma (2.25) with gamma = `density`: in the springs, and in the masses too.
  enum class BulkDensity { unused, of_springs, of_springs_and_masses } bulk_density = BulkDensity::unused;
  std::optional<PrintedOptions> printed = {};  ///< discs moved by PrintedDiscs; its damping and step are those above
  std::string variant = {};                    ///< part of names; empty: as in the thesis, except for the step

  [[nodiscard]] std::string name() const;  ///< "discs_1"
};

/// Cycles of 5 s and 20 s at 10 Hz: the thesis does not state the duration of the shaking.
inline constexpr std::array<std::int64_t, 2> long_shakings{50, 200};

/// A box filled, and shaken where `shaking` is given.
struct Run {
  Fill fill;
  std::optional<Shaking> shaking = {};
  bool shown = false;     ///< pictures, and paths of nine grains
  bool animated = false;  ///< an animation of the shaking
  bool mapped = false;    ///< part of the table over amplitudes and frequencies (sections 8.6 to 9.2)

  [[nodiscard]] std::string name() const;  ///< "discs_1_400gal_10Hz"
};

/// Results of a run. Lengths in m. NaN: not measured.
struct Outcome {
  double void_ratio_before = 0, void_ratio = 0;  ///< away from walls and surface
  double whole_before = 0, whole = 0;            ///< void ratio between the walls below the mean surface
  double height_before = 0, height = 0;          ///< mean height of the surface
  double roughness_before = 0, roughness = 0;    ///< standard deviation of the surface about a straight line
  double centre_before = 0, centre = 0;          ///< height of the centre of mass
  double slope = 0;                              ///< largest slope of the surface during the shaking
  double swing = 0;         ///< amplitude of the centre of mass along x in the box at the frequency of shaking
  double thrown = 0;        ///< bodies that at any moment were a mean diameter away from the heap
  double coordination = 0;  ///< contacts per body
  // motion of the grains in the box, means over all of them (GrainMovement)
  double path = 0, path_x = 0;  ///< length of the path, and of its part along x
  double first_path = 0;        ///< of the path, in the first 0.1 s
  double turn = 0;              ///< sum of the rotations one way and the other, rad
  double displaced_x = 0;       ///< root mean square of the displacement along x
  double inward = 0;            ///< displacement towards the middle, of the outer thirds of the width
  double sunk = 0;              ///< displacement downwards
  double layered = 0;           ///< share of the squares of displacements along x that ten layers have in common
  double creep = 0;             ///< bonds: mean drift of the distance over the sum of radii
  double roll = 0;              ///< bonds: mean relative rotation, rad
  double overlap = 0;           ///< the largest, over the smallest radius
  double time_step = 0, steps = 0, time = 0;  ///< s, -, s of motion
  double energy_error = 0;                    ///< of the energy balance, over the potential energy lost
  double seconds = 0;                         ///< of computing

  [[nodiscard]] double change() const { return void_ratio - void_ratio_before; }
  [[nodiscard]] double whole_change() const { return whole - whole_before; }
};

/// A number of an outcome and its name in files.
struct OutcomeKey {
  const char* name;
  double Outcome::*value;
};
inline constexpr std::array outcome_keys{OutcomeKey{"void_ratio_before", &Outcome::void_ratio_before},
                                         OutcomeKey{"void_ratio", &Outcome::void_ratio},
                                         OutcomeKey{"whole_void_ratio_before", &Outcome::whole_before},
                                         OutcomeKey{"whole_void_ratio", &Outcome::whole},
                                         OutcomeKey{"surface_height_before_m", &Outcome::height_before},
                                         OutcomeKey{"surface_height_m", &Outcome::height},
                                         OutcomeKey{"roughness_before_m", &Outcome::roughness_before},
                                         OutcomeKey{"roughness_m", &Outcome::roughness},
                                         OutcomeKey{"centre_height_before_m", &Outcome::centre_before},
                                         OutcomeKey{"centre_height_m", &Outcome::centre},
                                         OutcomeKey{"largest_slope", &Outcome::slope},
                                         OutcomeKey{"swing_m", &Outcome::swing},
                                         OutcomeKey{"thrown", &Outcome::thrown},
                                         OutcomeKey{"coordination", &Outcome::coordination},
                                         OutcomeKey{"path_m", &Outcome::path},
                                         OutcomeKey{"path_along_x_m", &Outcome::path_x},
                                         OutcomeKey{"first_path_m", &Outcome::first_path},
                                         OutcomeKey{"turned_rad", &Outcome::turn},
                                         OutcomeKey{"displaced_x_m", &Outcome::displaced_x},
                                         OutcomeKey{"inward_m", &Outcome::inward},
                                         OutcomeKey{"sunk_m", &Outcome::sunk},
                                         OutcomeKey{"layered", &Outcome::layered},
                                         OutcomeKey{"bond_creep", &Outcome::creep},
                                         OutcomeKey{"bond_roll_rad", &Outcome::roll},
                                         OutcomeKey{"largest_overlap", &Outcome::overlap},
                                         OutcomeKey{"time_step_s", &Outcome::time_step},
                                         OutcomeKey{"steps", &Outcome::steps},
                                         OutcomeKey{"time_s", &Outcome::time},
                                         OutcomeKey{"energy_error", &Outcome::energy_error},
                                         OutcomeKey{"seconds", &Outcome::seconds}};

/// A run with its results.
struct Done {
  Run run;
  Outcome outcome;
};

struct Reproduction {
  bool quick = false;
  std::size_t planned = 0;
  std::vector<Done> runs;   ///< those done, in the order of the plan
  std::vector<Done> fills;  ///< the fillings of those, each once
  std::vector<PackedDiscs> packings;
  std::vector<FallenEllipses> fallen_ellipses;
  StageTimes times;

  [[nodiscard]] bool complete() const { return runs.size() == planned; }
};

/// All runs, the most important first.
std::vector<Run> plan(bool quick);
/// Estimate of the time of computing, in arbitrary units.
double cost_of(const Run& run);

std::string plural_of(Shape shape);
/// The text with spaces in place of '_'.
std::string words(std::string name);
/// The grains of the thesis's numbers 485, 500, ..., 2515, or those in the same places of another grid.
std::array<std::size_t, 9> followed(const StartGrid& grid, Shape shape);
std::string label_of_followed(const StartGrid& grid, std::size_t k);

/// Bodies in the places of the start, in a box.
GrainScene start_of(const Fill& fill);
/// Step of the loop, s: the one given, else step_share of the limit of a contact of the two lightest bodies.
double step_of(const GrainScene& scene, const Fill& fill);
GrainOptions options_of(const GrainScene& scene, const Fill& fill);

/// Motion of grains in the box between samples.
class GrainMovement {
 public:
  /// \param left side of the box, m \param time s since the first sample
  void add(const std::vector<Grain>& grains, double left, double time);
  /// Set the members of an outcome that tell of it. \param width of the box, m
  void tell(Outcome& outcome, double width) const;

 private:
  struct Way {
    double all = 0, along_x = 0, first = 0, turned = 0;
  };
  std::vector<Grain> start_, last_;  ///< positions in the box
  std::vector<Way> ways_;
};

using Folder = std::optional<std::filesystem::path>;  ///< for the files of runs; empty: no files

/// A box at rest.
struct FilledBox {
  SavedState state;
  Outcome outcome;
};
/// Let the bodies fall and come to rest.
/// \param tick called with the share done, several times in a run
FilledBox fill_box(const Fill& fill, bool shown, const Folder& folder, const std::function<void(double)>& tick);
/// Shake a box at rest and let it come to rest again.
Outcome shake_box(const Run& run, const FilledBox& filled, const Folder& folder,
                  const std::function<void(double)>& tick);

/// \throws Error (bad_input) where the folder holds runs of other settings, or altered ones
void check_kept(const CommonOptions& options, bool quick);

/// Compute all runs that are not yet in the folder, on all threads.
/// \throws Error (bad_input) where the folder holds runs of other settings; (interrupted): the runs done are in the
///         result
void compute(const CommonOptions& options, Reproduction& result);

/// Runs that differ only in the seed.
struct Kind {
  Shape shape = Shape::disc;
  double gal = 400, frequency = 10;
  std::string variant = {};
  std::int64_t cycles = 10;
};
/// Finite values over the runs of a kind, and their mean and scatter.
std::vector<double> values_of(const Reproduction& result, const Kind& kind,
                              const std::function<double(const Outcome&)>& value);
MeanEstimate sample_of(const Reproduction& result, const Kind& kind,
                       const std::function<double(const Outcome&)>& value);

/// The mapped runs of a shape, in the order of the plan.
std::vector<Done> mapped(const Reproduction& result, Shape shape);
/// The mapped runs of discs shaken by 400 gal, by ascending period.
std::vector<Done> resonance_runs(const Reproduction& result);

/// First period of sloshing, s, by linear theory, for the width of the box and the depth of the heap.
double first_period(const Done& done);
/// First period by (7.2) as printed, s: omega² = (pi g/l) tanh(2 pi h/l).
double printed_formula_period(double width, double depth);
/// Swing of the centre of mass along x over that of a liquid whose surface tilts by a/g at once, l² a/(12 h g).
double amplification_of(const Done& done);
/// Amplification of a liquid without viscosity that is shaken at that period.
double liquid_amplification(double period, double width, double depth);

/// The conclusions of sections 8.5, 8.9 and 9.2 and whether they hold.
std::string verdicts(const Reproduction& result);
std::string report(const Reproduction& result);
Named<Plot> plots(const Reproduction& result, const Folder& folder);

}  // namespace equidem::sukegawa2010
