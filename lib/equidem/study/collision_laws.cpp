// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Fujioka & Ushijima (2005), section 5: laws of collision that stand for rigid bodies, their dimensionless stiffness
/// held while the step changes; Figs. 10 and 11 with the time of computing as the axis.
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "equidem/core/text.hpp"
#include "equidem/study/built_in.hpp"
#include "equidem/study/fujioka2005_scenes.hpp"

namespace equidem {
namespace fujioka2005 {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

struct Law {
  NormalLaw law;
  double a;  ///< dimensionless stiffness
  const char* name;
};
constexpr Law compared[] = {{NormalLaw::linear_dashpot, stiffness_of(NormalLaw::linear_dashpot), "C linear_dashpot"},
                            {NormalLaw::hertz_dashpot, stiffness_of(NormalLaw::hertz_dashpot), "T hertz_dashpot"},
                            {NormalLaw::five_case_map, stiffness_of(NormalLaw::five_case_map), "F five_case_map"},
                            {NormalLaw::energy_map, stiffness_of(NormalLaw::energy_map), "P energy_map"},
                            {NormalLaw::exact_flow, 0.10, "X exact_flow, a = 0.1"},
                            {NormalLaw::exact_flow, 4, "X exact_flow, a = 4"}};

// One impact: balls of 1 m side by side fall from heights about 0.1 m, each meeting the floor at another instant of its
// step.
constexpr int released_balls = 32;
constexpr double release_height = 0.1, watched = 0.25;  // m, s: near the top of the rebound of most

double height_of(int ball) {
  return release_height * (1 + 0.2 * ball / released_balls);
}

/// \param a dimensionless stiffness
/// \param varied name and value of what is refined
StudyTask one_impact(const Law& law, double a, double step, const std::pair<std::string, double>& varied,
                     double resolution) {
  const auto steps = std::llround(watched / step);
  const auto begin = [=] {
    const PairProperties pair = pair_of(law.law, restitution, a);
    GrainScene scene = column(pair, 1, 0.5 * height_of(0), 2);
    for (int k = 1; k < released_balls; ++k) {
      scene.grains.push_back(column(pair, 1, 0.5 * height_of(k), 2).grains[0]);
      scene.grains.back().position.x = 3.0 * k;
    }
    return start(scene, law.law, step, false);
  };
  const auto values = [=](const GrainSimulation& run) {
    const std::vector<Grain> grains = run.grains();
    double sum = 0;
    for (int k = 0; k < released_balls; ++k) {
      const double truth = rigid_height(height_of(k), restitution, static_cast<double>(steps) * step);
      const double off = grains[static_cast<std::size_t>(k)].position.y - 1 - truth;
      sum += off * off;
    }
    return std::vector{std::sqrt(sum / released_balls) / release_height, unknown, unknown};
  };
  return task_on(
      {.problem = "one impact", .method = law.name, .values = {varied}, .resolution = resolution}, begin,
      [=](GrainSimulation& run) { run.advance(steps); }, values);
}

StudyTask one_impact_resolved(const Law& law, double step) {
  return one_impact(law, law.a, step, {"time_step", step}, step);
}

constexpr Law long_steps{NormalLaw::exact_flow, 0, "X exact_flow, step 0.0625 s"};  // a is varied

/// Four steps in all: a contact lasts pi/sqrt(a) of a step.
StudyTask one_impact_in_long_steps(double a) {
  const double step = watched / 4;
  return one_impact(long_steps, a, step, {"a", a}, std::numbers::pi * step / std::sqrt(a));
}

// Three stacked spheres (Fig. 9), section 5.6.
StudyTask stacked_spheres(const Law& law, double step) {
  const auto last = static_cast<std::int64_t>(std::ceil(1.3 * exact_parting / step));
  const auto values = [=](const GrainSimulation& run) {
    // An Euler step lists the contacts at its start, exact_flow those at its end.
    const std::int64_t late = law.law == NormalLaw::exact_flow ? 1 : 0;
    GrainSimulation watch = start(stacked(pair_of(law.law, restitution, law.a)), law.law, step, false);
    double parting = 0;
    while (watch.step() < last) {
      watch.advance(1);
      for (const GrainContact& contact : watch.contacts()) {
        if (contact.i == 1 && contact.j == 2) parting = static_cast<double>(watch.step() + late) * step;
      }
    }
    const double speed = dimensionless_speed(run.grains()[1].velocity.x);
    return std::vector{unknown, std::abs(speed / exact_speed - 1), std::abs(parting / exact_parting - 1)};
  };
  return task_on(
      {.problem = "stacked spheres", .method = law.name, .values = {{"time_step", step}}, .resolution = step},
      [=] { return start(stacked(pair_of(law.law, restitution, law.a)), law.law, step, false); },
      [=](GrainSimulation& run) { run.advance(last); }, values);
}

}  // namespace
}  // namespace fujioka2005

Study collision_laws_study(bool quick) {
  using namespace fujioka2005;
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
    for (int k = 8; k <= (quick ? 16 : 18); ++k)
      study.tasks.push_back(one_impact_resolved(law, watched / std::pow(2.0, k - 3)));
    for (int k = 12; k <= (quick ? 18 : 22); ++k)
      study.tasks.push_back(stacked_spheres(law, std::pow(10.0, -0.25 * k)));
  }
  // exact_flow needs no step that resolves a contact: with a long one, rigid bodies are the limit of a stiff contact.
  for (int digits = 2; digits <= (quick ? 10 : 12); digits += 2)
    study.tasks.push_back(one_impact_in_long_steps(std::pow(10.0, digits)));
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
  for (const char* method :
       {"F five_case_map", "P energy_map", "X exact_flow, a = 0.1", "X exact_flow, a = 4", long_steps.name}) {
    study.orders.push_back({.problem = "one impact",
                            .method = method,
                            .order = 1,
                            .why = "a rigid ball would be on its way while an impact takes its steps"});
  }
  study.notes = {
      "T at one impact (its fixed share is small and is reached only at fine steps), d' of C (likewise), and F, P and "
      "X at the stacked spheres have no theoretical order: T0 is resolved to one step, so that errors scatter, and "
      "contacts that keep their energy chatter as they open."};
  return study;
}

}  // namespace equidem
