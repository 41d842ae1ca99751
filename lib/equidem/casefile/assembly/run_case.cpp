// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/run_case.hpp"

#include "equidem/casefile/assembly/case_tables.hpp"
#include "equidem/casefile/engine/read_value.hpp"

namespace equidem {
namespace {

using casefile::fail_at;
using casefile::repeated;

void check_time(const TomlValue& table, const RunCase& run) {
  casefile::check_one_of(table, "run", {"duration", "until_rest"}, "it has neither duration nor until_rest",
                         "a run ends after a time, or at rest", "Give one of the two",
                         "Give one of the two; --set run.duration=none takes it out, or until_rest=none");
  check_step(table, run);
}

TimedSupport timed(const Support& support, const TomlValue& table, std::span<const NamedSchedule> schedules) {
  const auto motion = [&](const std::optional<double>& value) -> std::optional<Schedule> {
    if (!value) return {};
    return scheduled(table, "support", *value, schedules);
  };
  return {support.group, motion(support.ux), motion(support.uy), motion(support.rotation)};
}

void check_one_load_case(const std::vector<TomlValue>& tables) {
  const std::string* earlier = nullptr;
  for (const TomlValue& table : tables) {
    const std::string& name = table.find("case")->text;
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

void casefile::complete_run(const TomlValue& root, CaseTables& tables) {
  std::vector<TimedSupport> supports;
  for (std::size_t k = 0; k < tables.supports.size(); ++k)
    supports.push_back(timed(tables.supports[k], repeated(root, "support")[k], tables.schedules));
  std::vector<Schedule> factors;
  for (const TomlValue& table : repeated(root, "load"))
    factors.push_back(scheduled(table, "load", 1, tables.schedules));
  if (!tables.run) return check_no_run_needed(root);
  RunCase& run = *tables.run;
  run.supports = std::move(supports);
  check_one_load_case(repeated(root, "load"));
  for (std::size_t k = 0; k < factors.size(); ++k)
    run.loads.push_back({tables.load_cases.front().loads[k], factors[k]});
  run.walls = read_walls(root, tables.wall_tables, tables.schedules);
  run.velocities = tables.velocities;
  check_probes(root);
  run.probes = tables.probe_tables;
  const TomlValue& table = *root.find("run");
  check_time(table, run);
  run.time_step.step = run.given_step;
  run.time_step.duration = run.duration.value_or(0);
  const Damping& damping = run.damping;
  if (damping.stiffness > 0 && damping.contact > 0) {
    fail_at(*table.find("damping")->find("contact"), "run.damping.contact", "stiffness and contact are both given",
            "each says which dashpots stand at the contacts", "Set one of them to 0");
  }
}

}  // namespace equidem
