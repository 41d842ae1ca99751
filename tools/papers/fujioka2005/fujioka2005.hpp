// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Fujioka & Ushijima (2005), section 5, computed again, with exact_flow beside the paper's laws.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/progress.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/study/fujioka2005_scenes.hpp"

#include "papers.hpp"

namespace equidem::fujioka2005 {

constexpr double theory = restitution * restitution;  ///< energy after over before an impact
constexpr double paper_step = 1e-3;                   ///< s, section 5.1
constexpr double fast_speed = 1e5;                    ///< m/s, section 5.3
/// Stiffnesses that only exact_flow permits: w dt = 2 and 100.
constexpr double stiff = 4, very_stiff = 1e4;
/// Stiffness with which T survives the fast impacts, in place of that of Table 2.
constexpr double soft_hertz = 1.5;
constexpr double printed_parting_error = 9.504e-5;  ///< relative, of the sum (31), which omits a singular end

/// A law with its dimensionless stiffness.
struct Variant {
  NormalLaw law;
  double a;
  std::string label;  ///< "C", "T", "F", "P", "X", "X stiff", "T soft"

  [[nodiscard]] bool of_paper() const { return law != NormalLaw::exact_flow; }
  [[nodiscard]] PairProperties pair(double e = restitution) const { return pair_of(law, e, a); }
};

/// C, T, F, P, then X with the stiffness of C and X with `stiffness`.
std::vector<Variant> variants(double stiffness);

struct Table1Row {
  Variant variant;
  double step = 0;  ///< s
  std::int64_t evaluations = 0;
  std::int64_t gravity_first = 0;     ///< evaluations where gravity is added before the contact force; 0: not computed
  double run_seconds = 0;             ///< of the processor, for the whole run
  double evaluation_nanoseconds = 0;  ///< of the law alone, for given depth and closing speed
};
struct Table1 {
  double step = 0;       ///< s
  double duration = 5;   ///< s
  double rest_time = 0;  ///< s, when a rigid ball comes to rest
  std::vector<Table1Row> rows;
};

struct Table2Row {
  Variant variant;
  std::array<std::int64_t, 3> steps{};
};
constexpr std::array table2_steps{1e-3, 1e-4, 1e-5};  // s

/// Impacts on the floor.
struct Impacts {
  Variant variant;
  /// Energy after the N-th impact over that before it: v²/2 + g h of the first step apart over that of the step of
  /// contact, position and velocity of the same step.
  std::vector<double> ratio;
  std::vector<double>
      flight_ratio;       ///< energy that the flight after the N-th impact keeps over that of the flight before
  double deepest = 0;     ///< largest overlap at the start of a step, diameters
  bool ran_away = false;  ///< faster than half a diameter in a step: beyond the paper's limit
  /// Depth and change of depth in a step, diameters, during each impact.
  std::vector<std::vector<std::pair<double, double>>> paths;
};

/// Energy ratios of one impact by P over all phases of the contact step; theory: e².
struct PrintedRow {
  const char* name;  ///< equation as printed
  double a = 0;
  double mean = 0, least = 0, largest = 0;
};

/// Error against the time step, and time of computing.
struct CurvePoint {
  double step = 0, a = 0;                     ///< s, -
  double speed_error = 0, parting_error = 0;  ///< stacked spheres: relative errors of d' and T0
  double error = 0;                           ///< bouncing ball: rms error of the height over the drop, for 3 s
  double seconds = 0;                         ///< time of computing; 0: not measured
  double sweeps = 0;                          ///< of exact_flow over all contacts, per step
};
struct Curve {
  Variant variant;
  std::string label;
  std::vector<CurvePoint> points;
  double speed_order = 0, parting_order = 0;  ///< slope over steps of 1e-4 s and less
};

/// Motion left in a column that should be at rest.
struct Rest {
  Variant variant;
  int balls = 0;
  std::vector<double> times;     ///< s
  std::vector<double> energies;  ///< kinetic, elastic and potential less that at rest, over weight times diameter
  double speed = 0;              ///< rms over the last tenth of the time, over g dt
  double overlap = 0;            ///< of the floor contact, mean over the last tenth, over the static one
  double contact = 0;            ///< share of those steps with a contact at the floor

  /// Relative change of the energy since the start.
  [[nodiscard]] double change(std::size_t k) const { return energies[k] / energies.front() - 1; }
};

struct Reproduction {
  bool quick = false;
  Table1 table1;
  std::vector<Table2Row> table2;
  std::vector<Impacts> slow, fast;
  std::vector<PrintedRow> printed;
  std::vector<Curve> stacked, ball;
  std::vector<Rest> rest, column, lossless;
  StageTimes times;
};

Table1 measure_table1(bool quick, Progress& progress);
std::vector<Table2Row> count_table2();
std::vector<PrintedRow> compare_printed();
/// \param fast thrown at fast_speed in place of falling; T then with soft_hertz too
std::vector<Impacts> impacts(bool fast);
std::vector<Curve> slide_stacked(bool quick, Progress& progress);
std::vector<Curve> cost_of_ball(bool quick, Progress& progress);
/// A column falls; with e = 1 it bounces without end.
std::vector<Rest> come_to_rest(int balls, double duration, double e = restitution);

/// Each conclusion of the paper with what the numbers say.
std::string verdicts(const Reproduction& result);
std::string report(const Reproduction& result);
Named<Plot> plots(const Reproduction& result);

}  // namespace equidem::fujioka2005
