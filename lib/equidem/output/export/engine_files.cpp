// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/export/engine_files.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/text.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

std::string exact(double value) {
  return fmt::format("{}", value);
}

std::string formula_of(const Schedule& schedule, const std::string& time) {
  const auto negative = [](double value) { return value < 0 ? fmt::format("({})", value) : exact(value); };
  const auto since = [&](double start) { return fmt::format("({0}-{1}+abs({0}-{1}))/2", time, negative(start)); };
  // The time between two instants, from 0 to their distance.
  const auto between = [&](double start, double end) {
    return fmt::format("(abs({0}-{1})-abs({0}-{2})+{3})/2", time, negative(start), negative(end), exact(end - start));
  };
  const auto slope_of = [&](std::size_t k) {
    return (schedule.values[k + 1] - schedule.values[k]) / (schedule.times[k + 1] - schedule.times[k]);
  };
  std::string sum;
  switch (schedule.kind) {
    case Schedule::Kind::constant:
      sum = exact(schedule.value);
      break;
    case Schedule::Kind::ramp:
      sum =
          fmt::format("{}*(1-cos({}*({})))", negative(0.5 * schedule.value),
                      exact(std::numbers::pi / (schedule.end - schedule.start)), between(schedule.start, schedule.end));
      break;
    case Schedule::Kind::sine:
      sum = fmt::format("{}*sin({}*({}))", negative(schedule.value), exact(2 * std::numbers::pi * schedule.frequency),
                        since(schedule.start));
      break;
    case Schedule::Kind::cycles:
      sum = fmt::format("{}*(1-cos({}*({})))", negative(schedule.value),
                        exact(2 * std::numbers::pi * schedule.frequency), between(schedule.start, schedule.end));
      break;
    case Schedule::Kind::table:
      sum = exact(schedule.values.front());
      for (std::size_t k = 0; k + 1 < schedule.times.size(); ++k) {
        if (slope_of(k) == 0) continue;
        sum += fmt::format("+{}*{}", negative(slope_of(k)), between(schedule.times[k], schedule.times[k + 1]));
      }
      break;
  }
  return sum;
}

namespace {

const char* start_of(Engine engine) {
  return engine == Engine::lammps ? "lmp -in in.equidem" : "yade -n -x run_equidem.py";
}

const char* results_of(Engine engine) {
  return engine == Engine::lammps ? "end.dump" : "end.txt";
}

}  // namespace

EngineFile readme_of(const EngineModel& model, Engine engine) {
  const std::string bodies = counted(std::ssize(model.bodies), model.body == Body::disc ? "disc" : "sphere");
  const std::string contacts = model.bonded ? " and " + counted(std::ssize(model.bonds), "bond") : " that collide";
  std::string text = fmt::format("{}{}{} for {}, written by equidem; start: {} (the state at the end: {}).\n",
                                 model.title.empty() ? "" : model.title + ": ", bodies, contacts, to_string(engine),
                                 start_of(engine), results_of(engine));
  text +=
      model.body == Body::disc
          ? "Units: SI. Masses, moments of inertia, springs and forces are those of one metre of depth: kg/m, kg m, "
            "N/m², N/m.\n"
          : "Units: SI; masses and forces are those of whole spheres; springs N/m.\n";
  text += fmt::format("Time step {} s, stable; {}.\n", exact(model.time_step),
                      model.bonded ? "motions are finite here, bonds neither break nor carry forces at the start"
                                   : "tangential springs are without force at the start");
  for (const auto& [feature, instance] : model.found) {
    const EngineFeatureRow& row = entry_of(feature);
    if (!row.carried_by(engine) && row.accept != nullptr) text += fmt::format("Accepted: {}; {}.\n", row.name, row.why);
  }
  return {"README", text};
}

std::int64_t steps_of(const EngineModel& model) {
  if (!model.to_rest) return std::max<std::int64_t>(1, count_steps(model.duration, model.time_step));
  double low = model.bodies.front().position.x, high = low, bottom = model.bodies.front().position.y, top = bottom;
  for (const EngineBody& body : model.bodies) {
    low = std::min(low, body.position.x), high = std::max(high, body.position.x);
    bottom = std::min(bottom, body.position.y), top = std::max(top, body.position.y);
  }
  double length = 0;
  for (const EngineBond& bond : model.bonds) length += bond.length;
  length /= static_cast<double>(std::max<std::size_t>(1, model.bonds.size()));
  const double across = 1 + std::max(high - low, top - bottom) / length;
  constexpr double steps_across = 2000;
  return static_cast<std::int64_t>(std::ceil(steps_across * across));
}

double force_scale(const EngineModel& model) {
  double stiffness = 0, force = 0;
  for (const EngineBond& bond : model.bonds) stiffness = std::max(stiffness, bond.springs.kN);
  for (const EngineBody& body : model.bodies) {
    force = std::max({force, norm(body.load.force), std::abs(body.load.moment) / body.radius,
                      body.inertia.mass * norm(model.gravity)});
    for (std::size_t k = 0; k < 3; ++k)
      if (body.held[k]) force = std::max(force, stiffness * std::abs(*body.held[k]) * (k == 2 ? body.radius : 1));
  }
  return force;
}

}  // namespace equidem
