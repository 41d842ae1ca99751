// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Table 2, Figs. 4 to 7: one ball on a floor.
#include <cmath>

#include "fujioka2005/fujioka2005.hpp"

namespace equidem::fujioka2005 {
namespace {

constexpr double radius = 0.5 * diameter;
constexpr std::size_t impacts_shown = 20;

double gap(const Grain& ball) {
  return ball.position.y - radius;
}

/// Energy per mass above that of the ball on the floor. In semi-implicit Euler the velocity is half a step behind the
/// position; its flights conserve v²/2 + g (gap - v dt/2).
double energy(const Variant& variant, const Grain& ball, double dt) {
  const double lag = variant.of_paper() ? 0.5 * dt * ball.velocity.y : 0;
  return 0.5 * ball.velocity.y * ball.velocity.y + gravity * (gap(ball) - lag);
}

/// Energy per mass of position and velocity of the same step.
double energy_of_step(const Grain& ball) {
  return 0.5 * ball.velocity.y * ball.velocity.y + gravity * gap(ball);
}

/// The flight up and down again to some steps above the floor in one move, by the closed form of its steps.
void leap(const Variant& variant, Grain& ball, double dt) {
  const double n = std::floor(2 * ball.velocity.y / (gravity * dt)) - 3;
  if (n < 100) return;
  const double lag = variant.of_paper() ? 1 : 0;
  ball.position.y += n * dt * (ball.velocity.y - 0.5 * gravity * dt * (n + lag));
  ball.velocity.y -= n * gravity * dt;
}

/// Impacts until there are enough of them or `most_steps` are made.
Impacts watch_impacts(const Variant& variant, GrainScene scene, double dt, bool leaps, std::int64_t most_steps) {
  Impacts seen{.variant = variant, .ratio = {}, .flight_ratio = {}, .paths = {}};
  Grain ball = scene.grains[0];
  double before = energy(variant, ball, dt), at_contact = 0;
  std::optional<GrainSimulation> run = start(scene, variant.law, dt, false);
  bool met = false;  // contact with the floor since the last flight
  for (std::int64_t step = 0; step < most_steps && seen.ratio.size() < impacts_shown; ++step) {
    const std::int64_t contacts = run->counters().contacts;
    run->advance(1);
    if (!met && run->counters().contacts > contacts) {
      met = true;
      at_contact = energy_of_step(ball);
    }
    const double depth = -gap(ball) / diameter;
    if (depth > 0) {
      if (seen.paths.size() == seen.ratio.size()) seen.paths.emplace_back();
      seen.paths.back().emplace_back(depth, -ball.velocity.y * dt / diameter);
      seen.deepest = std::max(seen.deepest, depth);
    }
    ball = run->grains()[0];
    if (!met || gap(ball) <= 0) continue;
    const double after = energy(variant, ball, dt);
    seen.ratio.push_back(energy_of_step(ball) / at_contact);
    seen.flight_ratio.push_back(after / before);
    seen.paths.resize(seen.ratio.size());
    before = after;
    met = false;
    seen.ran_away = ball.velocity.y * dt > radius;
    if (seen.ran_away) break;
    if (leaps) {
      leap(variant, ball, dt);
      scene.grains[0] = ball;
      run = start(scene, variant.law, dt, false);
    }
  }
  return seen;
}

}  // namespace

std::vector<Table2Row> count_table2() {
  std::vector<Table2Row> rows;
  for (const Variant& variant : variants(very_stiff)) {
    Table2Row row{.variant = variant};
    for (std::size_t k = 0; k < table2_steps.size(); ++k) {
      GrainSimulation run = start(column(variant.pair(), 1), variant.law, table2_steps[k]);
      for (bool parted = false; !parted;) {
        const std::int64_t evaluations = run.counters().evaluations;
        run.advance(1);
        const bool acted = run.counters().evaluations > evaluations;
        if (acted) ++row.steps[k];
        parted = row.steps[k] > 0 && gap(run.grains()[0]) > 0;
      }
    }
    rows.push_back(row);
  }
  return rows;
}

std::vector<Impacts> impacts(bool fast) {
  std::vector<Impacts> all;
  std::vector<Variant> laws = variants(very_stiff);
  if (fast) laws.insert(laws.begin() + 2, {NormalLaw::hertz_dashpot, soft_hertz, "T soft"});
  for (const Variant& variant : laws) {
    GrainScene scene = column(variant.pair(), 1);
    if (fast) scene.grains[0].velocity.y = -fast_speed;
    all.push_back(watch_impacts(variant, scene, paper_step, fast, fast ? 100000 : 8000));
  }
  return all;
}

}  // namespace equidem::fujioka2005
