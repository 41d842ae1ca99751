// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Table 1, and the time of computing of a bouncing ball for an accuracy.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include "equidem/contact/laws/visit.hpp"

#include "fujioka2005/fujioka2005.hpp"

namespace equidem::fujioka2005 {
namespace {

constexpr int balls_of_table1 = 16;
constexpr double never = std::numeric_limits<double>::infinity();

struct Sample {
  double depth, closing;
};

/// What the law loses energy by: the restitution of maps, the dimensionless dashpot coefficient of forces.
template <class Law>
double dissipation_of(const Variant& variant) {
  const double dissipation = Law::dissipation(restitution, ContactEnd::at_zero_overlap);
  return Law::kind == LawKind::map ? dissipation : dissipation * std::sqrt(variant.a);
}

/// One step of the law, dimensionless.
template <class Law>
ContactStep step_of(const Variant& variant, double dissipation, const Sample& at) {
  if constexpr (Law::kind == LawKind::force) {
    return force_step<Law>(at.depth, at.closing, variant.a, dissipation, true);
  } else {
    return Law::step(at.depth, at.closing, variant.a, dissipation, at.closing >= at.depth);
  }
}

constexpr std::size_t sample_count = 4096;
constexpr double sample_closing = 1e-3;
double phase_of(std::size_t k) {
  return std::fmod(0.618033988749895 * (static_cast<double>(k) + 0.5), 1.0);
}

/// States during impacts that begin at all phases of a step.
template <class Law>
std::vector<Sample> samples_of(const Variant& variant) {
  std::vector<Sample> samples;
  const double dissipation = dissipation_of<Law>(variant);
  for (std::size_t impact = 0; samples.size() < sample_count; ++impact) {
    Sample at{std::max(1e-6, phase_of(impact)) * sample_closing, sample_closing};
    while (at.depth > 0) {
      samples.push_back(at);
      const ContactStep step = step_of<Law>(variant, dissipation, at);
      at.closing += step.change;
      at.depth += step.shift + at.closing;
    }
  }
  samples.resize(sample_count);
  return samples;
}

template <class Evaluate>
double nanoseconds(int repeats, Evaluate evaluate) {
  double sum = 0;
  Stopwatch watch;
  for (int r = 0; r < repeats; ++r) {
    for (std::size_t k = 0; k < sample_count; ++k) sum += evaluate(k);
  }
  const double seconds = watch.seconds();
  // the compiler must not remove the unused evaluations
  return std::isfinite(sum) ? seconds * 1e9 / (repeats * static_cast<double>(sample_count)) : never;
}

template <class Law>
double nanoseconds_of(const Variant& variant) {
  const std::vector<Sample> samples = samples_of<Law>(variant);
  const double dissipation = dissipation_of<Law>(variant);
  return nanoseconds(20, [&](std::size_t k) { return step_of<Law>(variant, dissipation, samples[k]).change; });
}

/// Unit mass and step; gravity as an outside acceleration of a thousandth of the closing speed.
double nanoseconds_of_exact(const Variant& variant) {
  const PairProperties properties = variant.pair();
  const ExactPair pair = exact_pair(1, variant.a, damping_ratio_of(restitution, properties.end), properties.end, 1);
  struct Start {
    Sample at;
    bool touching;
  };
  std::vector<Start> starts;
  constexpr double fall = 1e-3 * sample_closing;
  for (std::size_t impact = 0; starts.size() < sample_count; ++impact) {
    Start now{{-phase_of(impact) * sample_closing, sample_closing}, false};
    while (now.at.depth > 0 || now.at.closing > 0) {
      starts.push_back(now);
      const ExactStep step = exact_step(pair, now.at.depth, now.at.closing, now.touching, fall, 0);
      now.at.depth += now.at.closing - step.moment + 0.5 * fall;
      now.at.closing += fall - step.impulse;
      now.touching = step.touching_at_end;
      if (!now.touching) break;
    }
  }
  return nanoseconds(1, [&](std::size_t k) {
    return exact_step(pair, starts[k].at.depth, starts[k].at.closing, starts[k].touching, fall, 0).impulse;
  });
}

double evaluation_nanoseconds(const Variant& variant) {
  return visit_law(variant.law, [&]<class Law>(std::type_identity<Law>) {
    if constexpr (Law::kind == LawKind::simultaneous) {
      return nanoseconds_of_exact(variant);
    } else {
      return nanoseconds_of<Law>(variant);
    }
  });
}

/// Evaluations in the paper's run where gravity is added before the contact force.
template <class Law>
std::int64_t evaluations_with_gravity_first(const Variant& variant, double step, std::int64_t steps) {
  const double dissipation = dissipation_of<Law>(variant), fall = gravity * step * step / diameter;
  Sample at{-drop, 0};
  std::int64_t count = 0;
  for (std::int64_t n = 0; n < steps; ++n) {
    at.closing += fall;
    if (at.depth > 0) {
      ++count;
      const ContactStep change = step_of<Law>(variant, dissipation, at);
      at.closing += change.change;
      at.depth += change.shift;
    }
    at.depth += at.closing;
  }
  return balls_of_table1 * count;
}

std::int64_t gravity_first(const Variant& variant, double step, std::int64_t steps) {
  return visit_law(variant.law, [&]<class Law>(std::type_identity<Law>) -> std::int64_t {
    if constexpr (Law::kind == LawKind::simultaneous) {
      return 0;
    } else {
      return evaluations_with_gravity_first<Law>(variant, step, steps);
    }
  });
}

/// 16 balls side by side without contact.
GrainScene row_of_balls(const Variant& variant) {
  GrainScene scene = column(variant.pair(), 1);
  for (int k = 1; k < balls_of_table1; ++k) {
    scene.grains.push_back(scene.grains.front());
    scene.grains.back().position.x = 1.5 * diameter * k;
  }
  return scene;
}

constexpr double sampling = 0.1;  // s
constexpr int samples = 30;

CurvePoint follow_ball(Variant variant, double a, double step) {
  variant.a = a;
  const auto between = static_cast<std::int64_t>(std::llround(sampling / step));
  CurvePoint point{.step = step, .a = a};
  double squares = 0, least = never, all = 0;
  for (int round = 0; round < 3 || (all < 0.005 && round < 200); ++round) {
    squares = 0;
    GrainSimulation run = start(column(variant.pair(), 1), variant.law, step);
    Stopwatch watch;
    for (int k = 1; k <= samples; ++k) {
      run.advance(between);
      const double error =
          run.grains()[0].position.y - 0.5 * diameter - rigid_height(drop * diameter, restitution, k * sampling);
      squares += error * error;
    }
    least = std::min(least, watch.seconds());
    all += watch.seconds();
  }
  point.error = std::sqrt(squares / samples) / (drop * diameter);
  point.seconds = least;
  return point;
}

}  // namespace

Table1 measure_table1(bool quick, Progress& progress) {
  Table1 table{.step = quick ? 1e-5 : 1e-6, .rows = {}};
  table.rest_time = std::sqrt(2 * drop * diameter / gravity) * (1 + restitution) / (1 - restitution);
  constexpr int slices = 50;
  constexpr int copies = 3;
  std::vector<std::vector<GrainSimulation>> runs;
  for (const Variant& variant : variants(very_stiff)) {
    Table1Row row{.variant = variant, .step = variant.label == "X stiff" ? paper_step : table.step};
    row.evaluation_nanoseconds = never;
    row.gravity_first = gravity_first(variant, row.step, std::llround(table.duration / row.step));
    runs.emplace_back();
    for (int copy = 0; copy < copies; ++copy)
      runs.back().push_back(start(row_of_balls(variant), variant.law, row.step));
    table.rows.push_back(row);
  }
  // Time of the processor, by turns, of equal runs the least of each slice: other load of the machine has little
  // effect.
  for (int slice = 0; slice < slices; ++slice) {
    for (std::size_t k = 0; k < runs.size(); ++k) {
      Table1Row& row = table.rows[k];
      double least = never;
      for (GrainSimulation& run : runs[k]) {
        const std::clock_t before = std::clock();
        run.advance(std::llround(table.duration / row.step) / slices);
        least = std::min(least, static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC);
      }
      row.run_seconds += least;
      if (slice % 5 == 0) {
        row.evaluation_nanoseconds = std::min(row.evaluation_nanoseconds, evaluation_nanoseconds(row.variant));
      }
      stop_if_interrupted();
    }
    progress.update(0.5 + 0.5 * (slice + 1) / slices);
  }
  for (std::size_t k = 0; k < runs.size(); ++k) table.rows[k].evaluations = runs[k][0].counters().evaluations;
  return table;
}

std::vector<Curve> cost_of_ball(bool quick, Progress& progress) {
  std::vector<double> steps{1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4};
  if (!quick) steps.insert(steps.end(), {5e-5, 2e-5, 1e-5});
  std::vector<Curve> all;
  for (const Variant& variant : variants(0)) {
    const bool one_step = variant.a == 0;
    Curve cost{.variant = variant, .label = one_step ? "X, step 0.1 s" : variant.label, .points = {}};
    if (one_step) {
      for (double a = 1e4; a <= 1.1e12; a *= 10) cost.points.push_back(follow_ball(variant, a, sampling));
    } else {
      for (const double step : steps) cost.points.push_back(follow_ball(variant, variant.a, step));
    }
    all.push_back(std::move(cost));
    progress.update(0.03 * static_cast<double>(all.size()));
  }
  return all;
}

}  // namespace equidem::fujioka2005
