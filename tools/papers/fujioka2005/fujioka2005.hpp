// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Fujioka & Ushijima (2005), "An evaluation method of normal contact force with energy conservation in distinct
/// element method", section 5, computed again, with exact_flow beside the paper's laws.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/progress.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/output/plots/plot.hpp"

namespace equidem::fujioka2005 {

// Section 5.1.
constexpr double restitution = 0.7;
constexpr double gravity = 9.8;   ///< m/s²
constexpr double diameter = 225;  ///< m
constexpr double drop = 0.01;     ///< of the diameter: height from which balls fall
constexpr double paper_step = 1e-3;
constexpr double fast_speed = 1e5;  ///< m/s, section 5.3

// The paper prints no stiffness; Table 2 gives it away (dimensionless, held while the step changes).
constexpr double of_springs = 0.10;
constexpr double of_hertz = 4.62;
// Which only exact_flow takes: w dt = 2 and 100.
constexpr double stiff_for_x = 4, very_stiff_for_x = 1e4;

/// A law with its stiffness.
struct Variant {
  NormalLaw law;
  double a = 0;       ///< dimensionless stiffness
  std::string label;  ///< "C", "T", "F", "P", "X", "X stiff"

  [[nodiscard]] bool of_paper() const { return law != NormalLaw::exact_flow; }
};

/// C, T, F, P, then X with the stiffness of C and X with another that only X can take.
std::vector<Variant> variants(double stiff);

/// How bodies meet: C and T while they overlap (the paper's), X while the force pushes.
PairProperties pair_of(const Variant& variant, double e = restitution);
/// Spheres in a vertical column over a floor at y = 0, the k-th lowest with k + 1 gaps below it. \param gap of the
/// diameter
GrainScene column(const Variant& variant, int balls, double gap, double e = restitution);
/// The three spheres of Fig. 9: A, B on the floor, C upon them.
GrainScene stacked(const Variant& variant);
GrainSimulation start(const GrainScene& scene, const Variant& variant, double step, bool refuse_crossing = true);

// Exact values of section 5.6, r0 = 2 cm; T0 without the singular sum (31).
constexpr double stacked_radius = 0.02;             ///< m
constexpr double exact_speed = 0.271462651012440;   ///< d', eq. (28)
constexpr double exact_parting = 0.10673687246956;  ///< T0, s, eq. (30)
constexpr double printed_parting_error = 9.504e-5;  ///< relative, of the sum (31), which leaves out a singular end

struct Table1Row {
  Variant variant;
  double step = 0;  ///< s
  std::int64_t evaluations = 0;
  std::int64_t gravity_first = 0;     ///< evaluations where gravity is added before the contact force; 0: not tried
  double run_seconds = 0;             ///< of the whole run
  double evaluation_nanoseconds = 0;  ///< the law alone, from given depth and closing speed
};
struct Table1 {
  double step = 0;       ///< s
  double duration = 5;   ///< s
  double rest_time = 0;  ///< s, from which on a rigid ball lies still
  std::vector<Table1Row> rows;
};

struct Table2Row {
  Variant variant;
  std::array<std::int64_t, 3> steps{};
};
constexpr std::array table2_steps{1e-3, 1e-4, 1e-5};

/// Impacts on the floor.
struct Impacts {
  Variant variant;
  std::vector<double> ratio;  ///< of the energies in flight after and before the N-th
  double deepest = 0;         ///< overlap at the start of a step, diameters
  bool ran_away = false;      ///< faster than half a diameter in a step: beyond the paper's limit
  std::vector<std::vector<std::pair<double, double>>> paths;  ///< of each impact: depth and closing, both in diameters
};

/// Depth or parting time of the stacked spheres against the step.
struct StackedPoint {
  double step = 0;
  double speed_error = 0, parting_error = 0;  ///< relative, of d' and T0
  double seconds = 0;                         ///< of computing
  double sweeps = 0;                          ///< of X over all contacts, in a step
};
struct Stacked {
  Variant variant;
  std::string label;
  std::vector<StackedPoint> points;
  double speed_order = 0, parting_order = 0;  ///< slope over steps of 1e-4 s and less
};

/// A ball falls and rebounds for 3 s: rms of the height's error against the rigid ball, over the drop.
struct BallPoint {
  double step = 0, a = 0, error = 0, seconds = 0;
};
struct BallCost {
  Variant variant;
  std::string label;
  std::vector<BallPoint> points;
};

/// What is left of the motion when all should be still.
struct Rest {
  Variant variant;
  int balls = 0;
  std::vector<double> times,
      energies;        ///< s; kinetic, elastic and potential less those at rest, over the weight times the diameter
  double speed = 0;    ///< rms over the last tenth of the time, of g dt
  double overlap = 0;  ///< of the floor contact, mean over the same, of the static one
  double contact = 0;  ///< share of the same steps that have a contact with the floor
};

struct Reproduction {
  bool quick = false;
  Table1 table1;
  std::vector<Table2Row> table2;
  std::vector<Impacts> slow, fast;
  std::vector<Stacked> stacked;
  std::vector<BallCost> ball;
  std::vector<Rest> rest, column, lossless;
  StageTimes times;
};

Table1 measure_table1(bool quick, Progress& progress);
std::vector<Table2Row> count_table2();
std::vector<Impacts> slow_impacts();
std::vector<Impacts> fast_impacts();
std::vector<Stacked> slide_stacked(bool quick, Progress& progress);
std::vector<BallCost> cost_of_ball(bool quick, Progress& progress);
/// A column falls; with e = 1 it goes on for ever.
std::vector<Rest> come_to_rest(int balls, double duration, double e = restitution);

std::string report(const Reproduction& result);
std::vector<std::pair<std::string, Plot>> plots(const Reproduction& result);

}  // namespace equidem::fujioka2005
