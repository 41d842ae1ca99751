// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [cell] of colliding bodies: a cell whose content repeats.
#include <optional>
#include <string>
#include <vector>

#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"

namespace equidem::casefile {
namespace {

/// [cell.motion].
struct CellMotionTable {
  double xx = 0, yy = 0, xy = 0;  ///< 1/s
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

void refuse_cell_key(const TomlValue& cell, const char* name, const std::string& problem, const std::string& why,
                     const std::string& remedy) {
  if (const TomlValue* given = cell.find(name)) fail_at(*given, std::string("cell.") + name, problem, why, remedy);
}

}  // namespace

void bind_cell(File<GrainTables>& file) {
  using C = CellTable;
  file.table("cell", &GrainTables::cell_table,
             "a rectangular cell whose content repeats: discs under laws that give a force")
      .keys({key("periodic", &C::cell, &PeriodicCell::along,
                 "xy: along x and y, without walls and gravity; x: along x, between walls that are lines along x"),
             key("corner", &C::cell, &PeriodicCell::corner, unit("m"),
                 "lower left corner; bodies outside are taken as their images inside"),
             key("width", &C::cell, &PeriodicCell::width, required, unit("m"), positive,
                 "period along x; more than two of the largest diameters, as the height"),
             key("height", &C::cell, &PeriodicCell::height, optional, unit("m"), positive, "period along y")});
  file.table("cell.motion", "rates at which the cell and its bodies deform; with integrator = \"velocity_verlet\"")
      .described(cell_motion_keys());
  file.table("cell.servo", "the cell deforms so that its mean stress is the wanted one").described(cell_servo_keys());
}

void complete_cell(const TomlValue& root, std::span<const NamedSchedule> schedules, GrainTables& tables) {
  const TomlValue* given = root.find("cell");
  if (given == nullptr) return;
  PeriodicCell cell = tables.cell_table->cell;
  if (cell.along == PeriodicCell::Along::xy && given->find("height") == nullptr)
    fail_at(*given, "cell.height", "missing key", "a cell that repeats along xy has one", "Add height = ... to [cell]");
  if (const TomlValue* stage = root.find("stage"))
    fail_at(stage->items.front(), "stage", "a run in a periodic cell is in stages",
            "stages change walls, and do not carry a cell on",
            "Let schedules of [cell.motion] and [cell.servo] change it");
  if (const TomlValue* measures = root.find("measures"))
    fail_at(*measures, "measures", "a run in a periodic cell measures the bodies in a box",
            "a branch across a side of the cell would be taken for one through it",
            "Remove it: the histories have stress, void ratio and coordination number of the cell");
  if (tables.body == Body::sphere && cell.along == PeriodicCell::Along::xy)
    fail_at(*given, "cell", "a cell that repeats along xy holds spheres",
            "its stress is by area, and a plane of spheres has no thickness",
            "Let body = \"disc\", or periodic = \"x\"");
  if (cell.along == PeriodicCell::Along::x)
    for (const char* name : {"motion", "servo"})
      refuse_cell_key(*given, name, "a cell that repeats along x alone deforms", "walls bound it along y",
                      "Let periodic = \"xy\", or move the walls");
  if (const TomlValue* motion = given->find("motion")) {
    CellMotionTable read;
    read_table(cell_motion_keys(), *motion, read);
    if (read.xx == 0 && read.yy == 0 && read.xy == 0)
      fail_at(*motion, "cell.motion", "all rates are 0", "nothing would move",
              "Give xx, yy or xy, or remove the table");
    const auto rate = [&](double value) {
      return value == 0 ? Schedule{} : scheduled(*motion, "cell.motion", value, schedules);
    };
    cell.rate_xx = rate(read.xx);
    cell.rate_yy = rate(read.yy);
    cell.rate_xy = rate(read.xy);
  }
  if (const TomlValue* servo = given->find("servo")) {
    CellServoTable read;
    read_table(cell_servo_keys(), *servo, read);
    if (read.stress_xx) read.servo.stress_xx = scheduled(*servo, "cell.servo", *read.stress_xx, schedules);
    if (read.stress_yy) read.servo.stress_yy = scheduled(*servo, "cell.servo", *read.stress_yy, schedules);
    cell.servo = read.servo;
  }
  tables.scene.cell = cell;
}

}  // namespace equidem::casefile
