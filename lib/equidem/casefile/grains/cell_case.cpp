// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [cell] of colliding bodies: a cell whose content repeats.
#include <optional>
#include <string>
#include <vector>

#include "equidem/casefile/engine/value.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"

namespace equidem::casefile {
namespace {

/// [cell.motion].
struct CellMotionTable {
  std::optional<double> xx, yy, xy;  ///< 1/s
  std::optional<std::string> schedule;
};

std::vector<Key<CellMotionTable>> cell_motion_keys() {
  using M = CellMotionTable;
  return {
      key("xx", &M::xx, unit("1/s"), "rate of the logarithm of the width"),
      key("yy", &M::yy, unit("1/s"), "rate of the logarithm of the height"),
      key("xy", &M::xy, unit("1/s"), "rate of simple shear: the images above move along x at this rate times height"),
      key("schedule", &M::schedule, "factor of these rates; without one they are constant")};
}

/// [cell.servo].
struct CellServoTable {
  CellServo servo;
  std::optional<double> stress_xx, stress_yy;  ///< Pa
  std::optional<std::string> schedule;
};

std::vector<Key<CellServoTable>> cell_servo_keys() {
  using S = CellServoTable;
  return {key("stress_xx", &S::stress_xx, unit("Pa"), "tension positive; the width follows it"),
          key("stress_yy", &S::stress_yy, unit("Pa"), "tension positive; the height follows it"),
          key("schedule", &S::schedule, "factor of the stresses; without one they are constant"),
          key("max_rate", &S::servo, &CellServo::max_rate, required, unit("1/s"), positive,
              "width and height never change faster, and shrink by it while nothing touches and the wanted stress is a "
              "pressure"),
          key("relaxation", &S::servo, &CellServo::relaxation, range({.low = 0, .high = 1, .low_open = true}),
              "share of the difference that a step mends, by stiffness and dashpots of the contacts")};
}

/// \param holder table of the cell
void refuse_deformation_along_x(const TomlValue& holder, const std::string& path, const PeriodicCell& cell) {
  if (cell.along == PeriodicCell::Along::xy) return;
  for (const char* name : {"motion", "servo"})
    if (const TomlValue* given = holder.find(name))
      fail_at(*given, path + "." + name, "a cell that repeats along x alone deforms", "walls bound it along y",
              "Let periodic = \"xy\", or move the walls");
}

/// The rates that a table gives; a component with a rate keeps no stress.
void take_motion(const TomlValue& table, const std::string& path, std::span<const NamedSchedule> schedules,
                 PeriodicCell& cell) {
  CellMotionTable read;
  read_table(cell_motion_keys(), table, read);
  const auto take = [&](const std::optional<double>& value, Schedule& rate,
                        std::optional<Schedule> CellServo::*stress) {
    if (!value) return;
    rate = *value == 0 ? Schedule{} : scheduled(table, path, *value, schedules);
    if (stress != nullptr && cell.servo) ((*cell.servo).*stress).reset();
  };
  take(read.xx, cell.rate_xx, &CellServo::stress_xx);
  take(read.yy, cell.rate_yy, &CellServo::stress_yy);
  take(read.xy, cell.rate_xy, nullptr);
  if (cell.servo && !cell.servo->stress_xx && !cell.servo->stress_yy) cell.servo.reset();
}

/// The stresses that a table gives, beside those that the cell keeps.
void take_servo(const TomlValue& table, const std::string& path, std::span<const NamedSchedule> schedules,
                PeriodicCell& cell) {
  CellServoTable read;
  read_table(cell_servo_keys(), table, read);
  if (cell.servo) {  // stresses that are not named stay as they were
    read.servo.stress_xx = cell.servo->stress_xx, read.servo.stress_yy = cell.servo->stress_yy;
    read.servo.goes_on_xx = !read.stress_xx, read.servo.goes_on_yy = !read.stress_yy;
  }
  if (read.stress_xx) read.servo.stress_xx = scheduled(table, path, *read.stress_xx, schedules);
  if (read.stress_yy) read.servo.stress_yy = scheduled(table, path, *read.stress_yy, schedules);
  cell.servo = read.servo;
}

/// Schedules that would count from the start of a stage that is not named.
void refuse_motion_beside_stages(const TomlValue& root, const TomlValue& given) {
  if (repeated(root, "stage").empty()) return;
  const std::string why = "the run is in stages, and schedules count from the start of a stage";
  if (const TomlValue* motion = given.find("motion"))
    fail_at(*motion, "cell.motion", "the cell has rates outside of the stages", why,
            "Give them in [stage.cell.motion]");
  const TomlValue* servo = given.find("servo");
  if (servo == nullptr) return;
  if (const TomlValue* schedule = servo->find("schedule"))
    fail_at(*schedule, "cell.servo.schedule", "stresses have a schedule outside of the stages", why,
            "Give it in [stage.cell.servo]");
}

}  // namespace

void bind_cell(File<GrainTables>& file) {
  using C = CellTable;
  file.table("cell", &GrainTables::cell_table,
             "a rectangular cell whose content repeats: bodies under laws that give a force")
      .keys({key("periodic", &C::cell, &PeriodicCell::along,
                 "xy: along x and y, without walls and gravity; x: along x, between walls that are lines along x"),
             key("corner", &C::cell, &PeriodicCell::corner, unit("m"),
                 "lower left corner; bodies outside are taken as their images inside"),
             key("width", &C::cell, &PeriodicCell::width, required, unit("m"), positive,
                 "period along x; more than two of the largest diameters, as the height"),
             key("height", &C::cell, &PeriodicCell::height, optional, unit("m"), positive, "period along y"),
             key("shift", &C::cell, &PeriodicCell::shift, unit("m"),
                 "along x, of the images above against the cell: a cell that is sheared at the start")});
  file.table("cell.motion", "rates at which the cell and its bodies deform; with integrator = \"velocity_verlet\"")
      .described(cell_motion_keys());
  file.table("cell.servo", "the cell deforms so that its mean stress is the wanted one").described(cell_servo_keys());
}

void bind_stage_cell(File<GrainTables>& file) {
  file.table("stage.cell", "how the periodic cell deforms from now on").holds_tables();
  file.table("stage.cell.motion", "rates until the stage ends, 0 too; a component given here keeps no stress")
      .described(cell_motion_keys());
  file.table("stage.cell.servo", "stresses from now on; a component that is not given keeps the stress that it has")
      .described(cell_servo_keys());
}

std::optional<PeriodicCell> cell_of_stage(const TomlValue& stage, std::span<const NamedSchedule> schedules,
                                          std::optional<PeriodicCell> cell) {
  if (cell) cell->rate_xx = cell->rate_yy = cell->rate_xy = {};
  if (cell && cell->servo) cell->servo->goes_on_xx = cell->servo->goes_on_yy = true;
  const TomlValue* given = stage.find("cell");
  if (given == nullptr) return cell;
  if (!cell)
    fail_at(*given, "stage.cell", "the case has no [cell]", "there is nothing to deform", "Add [cell], or remove it");
  refuse_deformation_along_x(*given, "stage.cell", *cell);
  cell->place = given->where() + ": stage.cell";
  if (const TomlValue* motion = given->find("motion")) take_motion(*motion, "stage.cell.motion", schedules, *cell);
  if (const TomlValue* servo = given->find("servo")) take_servo(*servo, "stage.cell.servo", schedules, *cell);
  return cell;
}

void complete_cell(const TomlValue& root, std::span<const NamedSchedule> schedules, GrainTables& tables) {
  const TomlValue* given = root.find("cell");
  if (given == nullptr) return;
  PeriodicCell cell = tables.cell_table->cell;
  if (cell.along == PeriodicCell::Along::xy && given->find("height") == nullptr)
    fail_at(*given, "cell.height", "missing key", "a cell that repeats along xy has one", "Add height = ... to [cell]");
  refuse_motion_beside_stages(root, *given);
  if (const TomlValue* measures = root.find("measures"))
    fail_at(*measures, "measures", "a run in a periodic cell measures the bodies in a box",
            "a branch across a side of the cell would be taken for one through it",
            "Remove it: the histories have stress, void ratio and coordination number of the cell");
  if (tables.body == Body::sphere && cell.along == PeriodicCell::Along::xy)
    fail_at(*given, "cell", "a cell that repeats along xy holds spheres",
            "its stress is by area, and a plane of spheres has no thickness",
            "Let body = \"disc\", or periodic = \"x\"");
  refuse_deformation_along_x(*given, "cell", cell);
  cell.place = given->where() + ": cell";
  if (const TomlValue* motion = given->find("motion")) {
    take_motion(*motion, "cell.motion", schedules, cell);
    if (!cell.has_rates())
      fail_at(*motion, "cell.motion", "all rates are 0", "nothing would move",
              "Give xx, yy or xy, or remove the table");
  }
  if (const TomlValue* servo = given->find("servo")) take_servo(*servo, "cell.servo", schedules, cell);
  tables.scene.cell = cell;
}

}  // namespace equidem::casefile
