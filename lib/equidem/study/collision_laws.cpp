// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Fujioka & Ushijima (2005), section 5: laws of collision that stand for rigid bodies, their dimensionless stiffness
/// held while the step changes; Figs. 10 and 11 with the time of computing as the axis.
#include <cmath>
#include <numbers>

#include "equidem/core/text.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/study/built_in.hpp"

namespace equidem {
namespace {

constexpr double restitution = 0.7, gravity = 9.8, unknown = std::numeric_limits<double>::quiet_NaN();

struct Law {
  NormalLaw law;
  double a;  ///< dimensionless stiffness of section 5.1, as Table 2 gives it away
  const char* name;
};
constexpr Law compared[] = {
    {NormalLaw::linear_dashpot, 0.10, "C linear_dashpot"},  {NormalLaw::hertz_dashpot, 4.62, "T hertz_dashpot"},
    {NormalLaw::five_case_map, 0.10, "F five_case_map"},    {NormalLaw::energy_map, 0.10, "P energy_map"},
    {NormalLaw::exact_flow, 0.10, "X exact_flow, a = 0.1"}, {NormalLaw::exact_flow, 4, "X exact_flow, a = 4"}};

GrainScene on_floor(const Law& law) {
  const bool flow = law.law == NormalLaw::exact_flow;
  GrainScene scene;
  scene.walls.emplace_back();
  scene.gravity = {0, -gravity};
  scene.pairs = {{.dimensionless = law.a,
                  .restitution = restitution,
                  .end = flow ? ContactEnd::at_zero_force : ContactEnd::at_zero_overlap}};
  return scene;
}

Grain ball_at(Vec2 position, double radius) {
  return {.position = position, .radius = radius, .inertia = inertia_of(radius, 1, Body::sphere)};
}

GrainSimulation start(const GrainScene& scene, const Law& law, double step) {
  return {scene, GrainOptions{.law = law.law, .time_step = step, .refuse_crossing = false}};
}

// One impact: balls of 1 m side by side fall from heights about 0.1 m, each meeting the floor at another instant of its
// step.
constexpr int balls = 32;
constexpr double height = 0.1, watched = 0.25;  // m, s: near the top of the rebound of most

double height_of(int ball) {
  return height * (1 + 0.2 * ball / balls);
}

/// Height of a rigid ball above the floor, m, at a time after its first impact.
double rigid_height(double from, double time) {
  const double fall = std::sqrt(2 * from / gravity), speed = restitution * gravity * fall, t = time - fall;
  return t * (speed - 0.5 * gravity * t);
}

StudyTask one_impact(const Law& law, double step) {
  const auto steps = std::llround(watched / step);
  const auto begin = [=] {
    GrainScene scene = on_floor(law);
    for (int k = 0; k < balls; ++k) scene.grains.push_back(ball_at({3.0 * k, 1 + height_of(k)}, 1));
    return start(scene, law, step);
  };
  const auto values = [=](const GrainSimulation& run) {
    const std::vector<Grain> grains = run.grains();
    double sum = 0;
    for (int k = 0; k < balls; ++k) {
      const double truth = rigid_height(height_of(k), static_cast<double>(steps) * step);
      const double off = grains[static_cast<std::size_t>(k)].position.y - 1 - truth;
      sum += off * off;
    }
    return std::vector{std::sqrt(sum / balls) / height, unknown, unknown};
  };
  return task_on(
      {.problem = "one impact", .method = law.name, .values = {{"time_step", step}}, .resolution = step}, begin,
      [=](GrainSimulation& run) { run.advance(steps); }, values);
}

// Three stacked spheres (Fig. 9), section 5.6.
constexpr double stacked_radius = 0.02;             // m
constexpr double exact_speed = 0.271462651012440;   // d', eq. (28)
constexpr double exact_parting = 0.10673687246956;  // s, T0, eq. (30) with the singular end of its integral

GrainScene stacked(const Law& law) {
  constexpr double r = stacked_radius;
  GrainScene scene = on_floor(law);
  scene.grains = {ball_at({-r, r}, r), ball_at({r, r}, r), ball_at({0, (1 + std::numbers::sqrt3) * r}, r)};
  return scene;
}

StudyTask stacked_spheres(const Law& law, double step) {
  const auto last = static_cast<std::int64_t>(std::ceil(1.3 * exact_parting / step));
  const auto values = [=](const GrainSimulation& run) {
    // an Euler step lists what touched at its start, exact_flow what touches at its end
    const std::int64_t late = law.law == NormalLaw::exact_flow ? 1 : 0;
    GrainSimulation watch = start(stacked(law), law, step);
    double parting = 0;
    while (watch.step() < last) {
      watch.advance(1);
      for (const GrainContact& contact : watch.contacts()) {
        if (contact.i == 1 && contact.j == 2) parting = static_cast<double>(watch.step() + late) * step;
      }
    }
    const double speed = run.grains()[1].velocity.x / std::sqrt(4 * gravity * stacked_radius);
    return std::vector{unknown, std::abs(speed / exact_speed - 1), std::abs(parting / exact_parting - 1)};
  };
  return task_on(
      {.problem = "stacked spheres", .method = law.name, .values = {{"time_step", step}}, .resolution = step},
      [=] { return start(stacked(law), law, step); }, [=](GrainSimulation& run) { run.advance(last); }, values);
}

}  // namespace

Study collision_laws_study(bool quick) {
  Study study{.name = "collision_laws",
              .title = "Laws of collision for rigid bodies",
              .quantities = {{.name = "rebound",
                              .label = "rms error of the height, of the drop",
                              .source = "closed form: a rigid ball falls, rebounds and rises"},
                             {.name = "final_speed",
                              .label = "relative error of the final speed d'",
                              .source = "closed form, Fujioka & Ushijima (2005), eq. (28)"},
                             {.name = "parting_time",
                              .label = "relative error of the parting time T0",
                              .source = "integral (30) of Fujioka & Ushijima (2005), its singular end included"}},
              .tasks = {}};
  for (const Law& law : compared) {
    for (int k = 8; k <= (quick ? 16 : 18); ++k) study.tasks.push_back(one_impact(law, watched / std::pow(2.0, k - 3)));
    for (int k = 12; k <= (quick ? 18 : 22); ++k)
      study.tasks.push_back(stacked_spheres(law, std::pow(10.0, -0.25 * k)));
  }
  const std::string held =
      "the stiffness is held with the step: a contact lasts a fixed number of steps, in which a force by Euler's "
      "steps misses the restitution by a fixed share";
  study.orders = {
      {.problem = "one impact", .method = "C linear_dashpot", .order = 0, .why = held},
      {.problem = "stacked spheres",
       .method = "C linear_dashpot",
       .quantity = "parting_time",
       .order = 0,
       .why = "its closing speed, that of the step before, lags behind the turning normal: an adhesion that no step "
              "removes"},
      // A time s before parting, Hertz's overlap is d ~ (s dt²)^(2/3) and its period dt d^(-1/4); contact is lost where
      // it is s.
      {.problem = "stacked spheres",
       .method = "T hertz_dashpot",
       .quantity = "parting_time",
       .order = 4.0 / 7,
       .why = "the contact softens as it opens: its period is dt d^(-1/4)"},
      {.problem = "stacked spheres",
       .method = "T hertz_dashpot",
       .quantity = "final_speed",
       .order = 8.0 / 7,
       .why = "the impulse lost with the last of the contact goes as the square of its time"}};
  for (const char* method : {"F five_case_map", "P energy_map", "X exact_flow, a = 0.1", "X exact_flow, a = 4"}) {
    study.orders.push_back({.problem = "one impact",
                            .method = method,
                            .order = 1,
                            .why = "a rigid ball would be on its way while an impact takes its steps"});
  }
  study.notes = {
      "Theory is silent on T at one impact, whose fixed share is small and met by fine steps only, on d' of C, which "
      "ends likewise, and on F, P and X at the stacked spheres: T0 is known to a step, so that errors scatter, and "
      "contacts that keep their "
      "energy chatter as they open."};
  return study;
}

}  // namespace equidem
