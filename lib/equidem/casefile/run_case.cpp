// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/run_case.hpp"

#include <cmath>

#include "equidem/casefile/read_value.hpp"

namespace equidem {
namespace {

TimeStepOptions read_time_step(const TomlValue& run, const std::optional<double>& duration) {
  TimeStepOptions result{.rule = enum_from<TimeStepRule>(text(run, "step_rule")),
                         .fraction = number(run, "step_fraction"),
                         .step = {},
                         .duration = duration.value_or(0),
                         .allow_unstable = flag(run, "allow_unstable_step")};
  const TomlValue& step = *run.find("time_step");
  if (!step.is_number()) return result;
  result.step = step.real;
  if (duration && step.real > *duration) {
    fail_at(step, "run.time_step", fmt::format("time_step = {} s is longer than the run of {} s", step.real, *duration),
            "a run makes at least one step", "Shorten the step");
  }
  return result;
}

Damping read_damping(const TomlValue& run) {
  const TomlValue* table = run.find("damping");
  if (table == nullptr) return {};
  const Damping result{.mass = number(*table, "mass"),
                       .stiffness = number(*table, "stiffness"),
                       .contact = number(*table, "contact"),
                       .local = number(*table, "local")};
  if (result.stiffness > 0 && result.contact > 0) {
    fail_at(*table->find("contact"), "run.damping.contact", "stiffness and contact are both given",
            "each says which dashpots stand at the contacts", "Set one of them to 0");
  }
  return result;
}

Wall read_wall(const TomlValue& table, std::span<const NamedSchedule> schedules) {
  const Vec2 normal = vector(table, "normal");
  const double length = std::hypot(normal.x, normal.y);
  if (length == 0) {
    fail_at(*table.find("normal"), "wall.normal", fmt::format("the normal of wall '{}' is zero", text(table, "name")),
            "it says on which side the discs are", "Give a direction, such as [0.0, 1.0]");
  }
  const TomlValue* schedule = table.find("schedule");
  if (schedule != nullptr && table.find("displacement") == nullptr) {
    fail_at(*schedule, "wall.schedule",
            fmt::format("wall '{}' has a schedule and no displacement", text(table, "name")), "it would not move",
            "Add displacement = ... in m");
  }
  Wall wall;
  wall.name = text(table, "name");
  wall.point = vector(table, "point");
  wall.normal = normal / length;
  wall.kN = number(table, "kN");
  move_along(wall, wall.normal,
             scheduled(table, "wall", optional_number(table, "displacement").value_or(0), schedules));
  return wall;
}

ProbeCase read_probe(const TomlValue& table) {
  check_plain_name(*table.find("name"), "probe.name", "a probe", "it begins the names of columns");
  ProbeCase result{.name = text(table, "name"), .group = text(table, "group"), .quantities = {}};
  for (const TomlValue& word : table.find("quantities")->items) result.quantities.push_back(word.text);
  return result;
}

std::vector<TimedSupport> timed(std::span<const Support> supports, const std::vector<TomlValue>& tables,
                                std::span<const NamedSchedule> schedules) {
  std::vector<TimedSupport> result;
  for (std::size_t k = 0; k < supports.size(); ++k) {
    const auto motion = [&](const std::optional<double>& value) -> std::optional<Schedule> {
      if (!value) return {};
      return scheduled(tables[k], "support", *value, schedules);
    };
    result.push_back({.group = supports[k].group,
                      .ux = motion(supports[k].ux),
                      .uy = motion(supports[k].uy),
                      .rotation = motion(supports[k].rotation)});
  }
  return result;
}

void check_one_load_case(const std::vector<TomlValue>& tables) {
  const std::string* earlier = nullptr;
  for (const TomlValue& table : tables) {
    const std::string& name = text(table, "case");
    if (name.empty()) continue;
    if (earlier != nullptr && *earlier != name) {
      fail_at(*table.find("case"), "load.case", fmt::format("[run] has the load cases '{}' and '{}'", *earlier, name),
              "a run is one motion, in which all loads act", "Keep one, or remove [run]");
    }
    earlier = &name;
  }
}

/// Nothing that acts in a run alone is passed over in silence.
void check_no_run_needed(const TomlValue& root) {
  for (const char* list : {"wall", "velocity", "probe"}) {
    if (repeated(root, list).empty()) continue;
    fail_at(repeated(root, list).front(), list, fmt::format("[[{}]] is given and [run] is not", list),
            "it belongs to motion in time", "Add [run] with a duration, or remove it");
  }
}

}  // namespace

std::optional<RunCase> read_run(const TomlValue& root, std::span<const NamedSchedule> schedules,
                                std::span<const Support> supports, std::span<const Load> loads) {
  RunCase result;
  result.supports = timed(supports, repeated(root, "support"), schedules);
  std::vector<Schedule> factors;
  for (const TomlValue& table : repeated(root, "load")) factors.push_back(scheduled(table, "load", 1, schedules));
  const TomlValue* run = root.find("run");
  if (run == nullptr) {
    check_no_run_needed(root);
    return {};
  }
  check_one_load_case(repeated(root, "load"));
  for (std::size_t k = 0; k < factors.size(); ++k) result.loads.push_back({loads[k], factors[k]});
  for (const TomlValue& table : repeated(root, "wall")) result.walls.push_back(read_wall(table, schedules));
  for (const TomlValue& table : repeated(root, "velocity"))
    result.velocities.push_back({text(table, "group"), vector(table, "velocity"), number(table, "spin")});
  for (const TomlValue& table : repeated(root, "probe")) result.probes.push_back(read_probe(table));

  result.duration = optional_number(*run, "duration");
  result.until_rest = optional_number(*run, "until_rest");
  if (result.duration.has_value() == result.until_rest.has_value()) {
    fail_at(result.duration ? *run->find("until_rest") : *run, "run",
            result.duration ? "duration and until_rest are both given" : "it has neither duration nor until_rest",
            "a run ends after a time, or at rest",
            result.duration ? "Give one of the two; --set run.duration=none takes it out, or until_rest=none"
                            : "Give one of the two");
  }
  result.time_step = read_time_step(*run, result.duration);
  result.integrator = enum_from<Integrator>(text(*run, "integrator"));
  result.motion = text(*run, "motion") == "small" ? LoopKind::Motion::small : LoopKind::Motion::finite;
  result.gravity = vector(*run, "gravity");
  result.damping = read_damping(*run);
  return result;
}

}  // namespace equidem
