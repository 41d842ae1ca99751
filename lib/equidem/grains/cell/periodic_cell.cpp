// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/cell/periodic_cell.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"

namespace equidem {
namespace {

void check_periods(const GrainScene& scene) {
  const PeriodicCell& cell = *scene.cell;
  const bool rows = cell.along == PeriodicCell::Along::xy;
  if (!std::isfinite(cell.corner.x + cell.corner.y + cell.shift))
    bad_input("the corner or the shift of the periodic cell is not a number",
              "they say where the cell and its images lie", "Give finite numbers");
  if (!rows && (cell.height != 0 || cell.shift != 0))
    bad_input(fmt::format("a cell that repeats along x alone has {} = {} m", cell.height != 0 ? "height" : "shift",
                          cell.height != 0 ? cell.height : cell.shift),
              "walls bound it along y", "Leave it out, or repeat along xy");
  double largest = 0;
  for (const Grain& grain : scene.present()) largest = std::max(largest, grain.radius);
  const auto check_period = [&](const char* name, double period) {
    check_positive(period, fmt::format("{} of the periodic cell", name), "m");
    if (period > 4 * largest) return;
    bad_input(fmt::format("the periodic cell has {} = {:.6g} m, and the largest body a diameter of {:.6g} m", name,
                          period, 2 * largest),
              "a body would meet several images of another one", "Make it larger than two of these diameters");
  };
  check_period("width", cell.width);
  if (rows) check_period("height", cell.height);
}

/// Walls repeat with a cell only where they are lines along x.
void check_walls_of_cell(const GrainScene& scene) {
  const bool rows = scene.cell->along == PeriodicCell::Along::xy;
  for (const Wall& wall : scene.walls) {
    if (rows)
      bad_input(fmt::format("there is a wall '{}' in a cell that repeats along x and y", wall.name),
                "it would cross the sides of the cell", "Remove it, or repeat along x alone");
    if (wall.shape == Wall::Shape::line && wall.normal.x == 0) continue;
    bad_input(fmt::format("the wall '{}' is no line along x, and the cell repeats along x", wall.name),
              "it crosses the sides of the cell, or its images are missing beyond them",
              "Give lines with the normal [0, 1] or [0, -1]");
  }
}

void check_contents(const GrainScene& scene, const GrainOptions& options) {
  if (!gives_force(options.law))
    bad_input(fmt::format("a periodic cell is stepped by the law {}", to_string(options.law)),
              "images need a law that gives a force", "Use " + names_of_laws(LawKind::force));
  if (!has_shapes(scene)) return;
  if (options.ellipse_law != GrainOptions::EllipseLaw::exact)
    bad_input(fmt::format("ellipses of a periodic cell meet by the law {}", to_string(options.ellipse_law)),
              "their images need the exact contact", "Leave ellipse_contact out");
}

void check_weight(const GrainScene& scene) {
  if (scene.weighs() && scene.cell->along == PeriodicCell::Along::xy)
    bad_input("there is gravity in a cell that repeats along x and y",
              "no floor carries the bodies: they would fall for ever",
              "Remove it, or repeat along x alone and give walls");
}

void check_deformation(const GrainScene& scene, const GrainOptions& options) {
  const PeriodicCell& cell = *scene.cell;
  for (const Schedule* rate : {&cell.rate_xx, &cell.rate_yy, &cell.rate_xy}) check(*rate);
  if (!cell.deforms()) return;
  if (cell.along != PeriodicCell::Along::xy)
    bad_input("a cell that repeats along x alone deforms", "walls bound it along y and would not follow",
              "Let it repeat along xy, or move the walls");
  if (options.integrator != GrainOptions::Integrator::velocity_verlet)
    bad_input(fmt::format("a cell that deforms is stepped by {}", to_string(options.integrator)),
              "its work is counted for velocity_verlet", "Set integrator = \"velocity_verlet\"");
  if (!cell.servo) return;
  const CellServo& servo = *cell.servo;
  if (!servo.stress_xx && !servo.stress_yy)
    bad_input("the servo of the periodic cell keeps no stress", "it has nothing to do", "Give stress_xx or stress_yy");
  const auto check_one = [](const char* name, const std::optional<Schedule>& stress, const Schedule& rate) {
    if (!stress) return;
    check(*stress);
    if (!rate.changes() && rate.value == 0) return;
    bad_input(fmt::format("the periodic cell has both a rate_{} and a stress_{}", name, name),
              "one of them determines the other", "Remove one");
  };
  check_one("xx", servo.stress_xx, cell.rate_xx);
  check_one("yy", servo.stress_yy, cell.rate_yy);
  constexpr Bound<CellServo> bounds[] = {{"max_rate", &CellServo::max_rate, Range::positive(), "1/s"},
                                         {"relaxation", &CellServo::relaxation, Range::above_zero_to(1)}};
  check_bounds(servo, bounds, [] { return " of the periodic cell"; });
}

/// As refuse_long_ways_in_cell, before candidates are looked for as far as bodies may come.
void check_speeds(const GrainScene& scene, const GrainOptions& options) {
  const double smallest = smallest_inscribed_radius(scene);
  for (const Grain& grain : scene.present()) {
    const double turning = grain.shape() == GrainShape::disc ? 0 : std::abs(grain.spin) * grain.radius;
    const double speed = norm(grain.velocity) + turning;
    if (speed * options.time_step <= smallest) continue;
    bad_input(fmt::format("grain {} of the periodic cell moves {:.4g} m in a step of {:.4g} s",
                          &grain - scene.grains.data(), speed * options.time_step, options.time_step),
              fmt::format("it would pass through others: the smallest radius is {:.4g} m", smallest),
              fmt::format("Use a step below {:.3g} s, or give it a lower speed", 0.5 * smallest / speed));
  }
}

}  // namespace

void check_cell(const GrainScene& scene, const GrainOptions& options) {
  check_periods(scene);
  check_walls_of_cell(scene);
  check_contents(scene, options);
  check_weight(scene);
  check_deformation(scene, options);
  check_speeds(scene, options);
}

}  // namespace equidem
