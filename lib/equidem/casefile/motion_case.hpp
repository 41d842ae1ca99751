// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The tables of a run that bonded and colliding bodies share: [run], [[schedule]], [[wall]], [[probe]]; and
/// [wall.servo].
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/dynamics/time_step.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/motion/ledger.hpp"
#include "equidem/motion/saved_state.hpp"
#include "equidem/motion/schedule.hpp"
#include "equidem/motion/wall.hpp"

namespace equidem::casefile {

/// [wall.servo].
struct ServoTable {
  Servo servo;                                  ///< `between` is `from` and `to`
  std::optional<double> force;                  ///< N
  std::optional<double> stress;                 ///< Pa
  std::optional<Vec2> direction;                ///< none: the normal of a line
  std::optional<double> length;                 ///< m
  std::optional<std::string> from, to, mirror;  ///< names of walls
  std::optional<std::string> schedule;          ///< its name
};

std::vector<Key<ServoTable>> servo_keys();

/// The servo of a wall, if its table has one.
/// \param table checked, of the wall
/// \throws Error (bad_input) with line and key: a direction of length 0 or that is missing, a stress without a length,
///         a schedule that is not there, as check(Servo)
void read_servo(const TomlValue& table, std::span<const NamedSchedule> schedules, Wall& wall);

/// [[schedule]]: a name for a schedule, whose points may be in a file.
struct ScheduleTable {
  std::string name;
  Schedule schedule{.kind = Schedule::Kind::ramp, .value = 1};
  std::optional<std::filesystem::path> path;
};

/// [[wall]].
struct WallTable {
  Wall wall;
  std::optional<double> displacement;  ///< m, along `direction`
  std::optional<Vec2> direction;       ///< none: the normal of a line
  bool shaken = true;                  ///< colliding bodies
};

/// The tables of a case of either family.
struct MotionTables {
  std::vector<ScheduleTable> schedule_tables;
  std::vector<WallTable> wall_tables;
};

/// [run], less the damping of bonded discs.
struct RunTable {
  std::optional<double> duration;    ///< s; of assemblies this or until_rest
  std::optional<double> until_rest;  ///< unbalanced force, relative
  TimeStepOptions time_step;
  std::optional<double> steps_per_contact;
  Integrator integrator = SimulationOptions{}.integrator;
  GrainOptions::Integrator integrator_of_forces = GrainOptions{}.integrator;  ///< colliding bodies
  LoopKind::Motion motion = SimulationOptions{}.motion;
  Vec2 gravity;  ///< m/s²
};

std::vector<Key<RunTable>> run_keys();
std::vector<Key<ScheduleTable>> schedule_keys();
/// Bonded discs meet lines with a spring kN; colliding bodies meet all shapes, which may be shaken.
std::vector<Key<WallTable>> wall_keys();
/// \param kind of the case: the quantities are those of its bodies, the first is the default
std::vector<Key<Probe>> probe_keys(CaseKind kind);

/// Bind [run], [[schedule]], [[wall]] and [[probe]] in a file of an F that is a MotionTables.
/// \param run pointer to the member that is a RunTable; \param probes chain of members to a std::vector of Probe
template <class F, class Run, class... Links>
void bind_motion(File<F>& file, Run run, Links... probes) {
  const CaseKind kind = file.spec().kind;
  file.table(
          "run", run, [=](TableSpec& table) { table.required = kind == CaseKind::colliding; },
          "motion in time, for the verb run")
      .keys(run_keys());
  file.table("schedule", &MotionTables::schedule_tables,
             "how a motion or load changes in a run; without one it acts from the start")
      .keys(schedule_keys());
  file.table("wall", &MotionTables::wall_tables, "a wall of infinite mass, in a run").keys(wall_keys());
  if (kind == CaseKind::colliding)
    file.table("wall.servo", "the wall moves so that it pushes the bodies with a wanted force or stress")
        .described(servo_keys());
  file.table("probe", probes..., "a history of some bodies in a run").keys(probe_keys(kind));
}

/// The schedules of a document, checked, with the points of their files.
/// \param root checked; the list [[schedule]] that the tables were read from
/// \throws Error (bad_input) with line and key: two schedules of one name, an end before the start, points that do not
///         ascend, a file that is not a table of two columns
std::vector<NamedSchedule> read_schedules(const TomlValue& root, const std::vector<ScheduleTable>& tables);

/// `value` times the schedule that the table names; constant if it names none.
/// \throws Error (bad_input) if there is no schedule of that name
Schedule scheduled(const TomlValue& table, double value, std::span<const NamedSchedule> schedules);

/// The walls of a document with their motion.
/// \throws Error (bad_input) with line and key: two walls of one name, a normal or direction of length 0, a segment
///         that `check` refuses, a displacement without a direction
std::vector<Wall> read_walls(const TomlValue& root, const std::vector<WallTable>& tables,
                             std::span<const NamedSchedule> schedules);

/// One wall of a table with its motion by a displacement.
/// \throws Error (bad_input) as read_walls
Wall wall_of(const TomlValue& table, const WallTable& read, std::span<const NamedSchedule> schedules);
/// Set the displacement of a wall; nothing where the table has none.
void set_motion(const TomlValue& table, const WallTable& read, std::span<const NamedSchedule> schedules, Wall& wall);

/// Check the names of the probes of a document.
/// \throws Error (bad_input) with line and key: two probes of one name, a name that is not plain
void check_probes(const TomlValue& root);

/// Check that the bodies that a probe names are there.
/// \param table of the probe
/// \throws Error (bad_input) with line and key
void check_bodies(const TomlValue& table, const Probe& probe, std::size_t bodies);

/// \throws Error (bad_input) if the time step is longer than the run
void check_step(const TomlValue& run, const std::optional<double>& step, const std::optional<double>& duration);

}  // namespace equidem::casefile
