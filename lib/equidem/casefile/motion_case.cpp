// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/motion_case.hpp"

#include <algorithm>
#include <iterator>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {
namespace {

Vec2 unit_vector(const Vec2& given, const TomlValue& table, const char* key, const std::string& use) {
  const double length = norm(given);
  if (length == 0)
    fail_at(*table.find(key), fmt::format("the {} of wall '{}' is zero", key, table.find("name")->text), use,
            "Give a direction, such as [0.0, 1.0]");
  return given / length;
}

}  // namespace

std::vector<Key<RunTable>> run_keys() {
  using R = RunTable;
  using T = TimeStepOptions;
  const auto of_assemblies = only_in({CaseKind::assembly}), of_colliding = only_in({CaseKind::colliding});
  const std::string length = "length of the run; of colliding bodies required without [[stage]]";
  return {
      key("duration", &R::duration, of_assemblies, unit("s"), positive,
          or_instead({"until_rest"}, "a run ends after a time, or at rest"), length),
      key("duration", &R::duration, of_colliding, unit("s"), positive, length),
      key("time_step", &R::time_step, &T::step, or_auto, unit("s"), positive,
          "auto: by step_rule; of colliding bodies the shortest contact over steps_per_contact"),
      key("gravity", &R::gravity, unit("m/s²"), "such as [0.0, -9.81]"),
      key("until_rest", &R::until_rest, of_assemblies, between(0, 1),
          "relax until the unbalanced force is this small, relative, such as 1e-10"),
      key("step_rule", &R::time_step, &T::rule, of_assemblies,
          "rule of an automatic step; lanczos: step_fraction of the exact critical step; bound: of a guaranteed lower "
          "bound of it, sooner known; thesis: an eighth of the period of one disc on one spring, no guarantee"),
      key("step_fraction", &R::time_step, &T::fraction, of_assemblies, range({.low = 0, .high = 1, .low_open = true}),
          "share of the critical step, for lanczos and bound"),
      key("steps_per_contact", &R::steps_per_contact, of_colliding, range({.low = 2}),
          not_beside({"time_step"}, "each says how long a step is"),
          "of an automatic step; left out: 50 for laws that give a force, 10 for the maps, pi (that is omega dt = 1) "
          "for exact_flow"),
      key("allow_unstable_step", &R::time_step, &T::allow_unstable, of_assemblies,
          "allow a step above the critical one, and kT < 0"),
      key("integrator", &R::integrator, of_assemblies,
          "leapfrog: central differences; velocity_verlet: the same motion; thesis: Sukegawa (3.14)-(3.17) as printed, "
          "order 1; fourth_order: symplectic, four forces a step; all are of order 1 with dashpots, viscoelastic "
          "springs or local damping"),
      key("integrator", &R::integrator_of_forces, of_colliding, optional,
          "of laws that give a force; semi_implicit_euler (default): first order, contacts that stick do not creep; "
          "velocity_verlet: second order, as LAMMPS steps"),
      key("motion", &R::motion, of_assemblies,
          "small: contacts keep their direction, exactly the stiffness of statics; finite: they follow the discs")};
}

std::vector<Key<ScheduleTable>> schedule_keys() {
  const std::vector<std::string> ramp = {"ramp"}, sine = {"sine"}, waves = {"ramp", "sine"}, table = {"table"};
  using T = ScheduleTable;
  return {
      key("name", &T::name, required, "for schedule = of [[support]], [[load]], [[wall]]"),
      key("kind", &T::schedule, &Schedule::kind, required,
          "ramp: smooth, from 0 at start to value at end; sine: value sin(2 pi frequency (t - start)), 0 before start; "
          "table: straight between points, constant outside"),
      key("value", &T::schedule, &Schedule::value, when("kind", waves)),
      key("start", &T::schedule, &Schedule::start, unit("s"), when("kind", waves)),
      key("end", &T::schedule, &Schedule::end, required, unit("s"), when("kind", ramp), "after start"),
      key("frequency", &T::schedule, &Schedule::frequency, required, unit("Hz"), positive, when("kind", sine)),
      key("times", &T::schedule, &Schedule::times, unit("s"), when("kind", table),
          or_instead({"path"}, "the points of a table are times and values, or a file"),
          only_with({"values"}, "a point is a time and a value"), "ascending, with values"),
      key("values", &T::schedule, &Schedule::values, optional, when("kind", table),
          only_with({"times"}, "a point is a time and a value"), "one for each time"),
      key("path", &T::path, when("kind", table), "a CSV file with two columns, time and value")};
}

std::vector<Key<WallTable>> wall_keys() {
  using T = WallTable;
  using W = Wall;
  const auto of_colliding = only_in({CaseKind::colliding});
  const std::string why = "a wall moves by its displacement times a schedule; a wall at rest is placed by its point";
  return {
      key("name", &T::wall, &W::name, required, "for reports, and for [[collisions.pair]]"),
      key("shape", &T::wall, &W::shape, of_colliding,
          "line: endless, bodies on one side; segment: thin, with two sides and two ends; ends within a hundredth of "
          "the smallest radius, and of their lengths, of one another or of another wall that moves alike are joined "
          "there"),
      key("point", &T::wall, &W::point, required, unit("m"), when("shape", {"line", "segment"}),
          "on the line; the first end of the segment"),
      key("normal", &T::wall, &W::normal, required, when("shape", {"line"}),
          "towards the bodies, of any length; all bodies are on that side"),
      key("end", &T::wall, &W::end, of_colliding, required, unit("m"), when("shape", {"segment"})),
      key("shaken", &T::shaken, of_colliding, optional,
          "false: [shaking] does not move it; of a stage: nor does that of later ones"),
      key("kN", &T::wall, &W::kN, only_in({CaseKind::assembly}), required, unit("Pa"), positive,
          "spring that pushes discs out; there is no friction"),
      key("displacement", &T::displacement, unit("m"), only_with({"schedule"}, why),
          "along direction, times the schedule"),
      key("direction", &T::direction, only_with({"displacement"}, why),
          "of any length; left out: the normal of a line"),
      unbound_key<T>("schedule", KeyType::text, only_with({"displacement"}, why), "schedule of the displacement")};
}

std::vector<Key<Probe>> probe_keys(CaseKind kind) {
  using enum ProbeQuantity;
  const std::vector<ProbeQuantity> own = kind == CaseKind::assembly
                                             ? std::vector{displacement, velocity, rotation, spin}
                                             : std::vector{position, velocity, angle, spin, stress};
  const auto names = [](ProbeQuantity quantity) { return to_string(quantity); };
  std::vector<std::string> words;
  std::ranges::transform(own, std::back_inserter(words), names);
  return {
      key("name", &Probe::name, required, "begins the names of its columns"),
      key("group", &Probe::group, or_instead({"bodies"}, "they say whose history it is"), "a group"),
      key("bodies", &Probe::bodies, optional, "counted from 0; those of a file first"),
      key("quantities", &Probe::quantities, choices(std::move(words)), by_default(std::vector{own.front()}),
          refused({{"energy", "the energies of the whole scene are in every history", "Remove it"}}),
          "the means over these bodies; stress: of their contacts and bonds, over the box. The energies of the whole "
          "scene are in every history"),
      key("wavelength", &Probe::wavelength, only_in({CaseKind::assembly}), unit("m"), positive,
          "of a standing wave: the report gives the period of the mean velocity, from its passages through zero, and "
          "the speed, wavelength over period"),
      key("box", &Probe::box, only_in({CaseKind::colliding}), unit("m"),
          "how many of these bodies have their centre inside is recorded too, such as those that have left a hopper; "
          "for a stress, its region")};
}

std::vector<NamedSchedule> read_schedules(const TomlValue& root, const std::vector<ScheduleTable>& tables) {
  using Kind = Schedule::Kind;
  check_names(root, "schedule");
  std::vector<NamedSchedule> schedules;
  for (std::size_t k = 0; k < tables.size(); ++k) {
    const TomlValue& table = repeated(root, "schedule")[k];
    const ScheduleTable& read = tables[k];
    Schedule& schedule = schedules.emplace_back(NamedSchedule{read.name, read.schedule}).schedule;
    const bool points = schedule.kind == Kind::table;
    if (points) schedule.value = 0;
    if (read.path) with_key(table, "path", [&] { read_points(*read.path, schedule, "value"); });
    const char* culprit = schedule.kind == Kind::ramp ? "end" : !points ? "frequency" : read.path ? "path" : "times";
    with_key(table, culprit, [&] { check(schedule); });
  }
  return schedules;
}

Schedule scheduled(const TomlValue& table, double value, std::span<const NamedSchedule> schedules) {
  const TomlValue* wanted = table.find("schedule");
  if (wanted == nullptr) return Schedule{.value = value};
  std::vector<std::string> names;
  for (const NamedSchedule& known : schedules) {
    if (known.name == wanted->text) return value == 0 ? Schedule{} : scaled(known.schedule, value);
    names.push_back(known.name);
  }
  const auto meant = nearest(wanted->text, names);
  fail_at(*wanted, fmt::format("there is no schedule {}", wanted->shown()),
          schedules.empty() ? "the case has no [[schedule]]"
                            : fmt::format("the case has {}", counted(static_cast<long long>(names.size()), "other")),
          meant ? fmt::format("Did you mean \"{}\"?", *meant) : "Add a [[schedule]] of that name, or correct it");
}

void set_motion(const TomlValue& table, const WallTable& read, std::span<const NamedSchedule> schedules, Wall& wall) {
  if (!read.displacement) return;
  if (!read.direction && wall.shape != Wall::Shape::line)
    fail_at(*table.find("displacement"), fmt::format("wall '{}' has no direction", wall.name),
            "only a line has a normal to move along", "Add direction = [..., ...]");
  const Vec2 direction =
      read.direction ? unit_vector(*read.direction, table, "direction", "it says where the wall moves") : wall.normal;
  move_along(wall, direction, scheduled(table, *read.displacement, schedules));
}

Wall wall_of(const TomlValue& table, const WallTable& read, std::span<const NamedSchedule> schedules) {
  Wall wall = read.wall;
  if (wall.shape == Wall::Shape::line)
    wall.normal = unit_vector(wall.normal, table, "normal", "it says on which side the bodies are");
  with_key(table, wall.shape == Wall::Shape::line ? "normal" : "end", [&] { check(wall); });
  set_motion(table, read, schedules, wall);
  return wall;
}

std::vector<Wall> read_walls(const TomlValue& root, const std::vector<WallTable>& tables,
                             std::span<const NamedSchedule> schedules) {
  check_names(root, "wall");
  std::vector<Wall> walls;
  for (std::size_t k = 0; k < tables.size(); ++k) {
    const TomlValue& table = repeated(root, "wall")[k];
    walls.push_back(wall_of(table, tables[k], schedules));
    read_servo(table, schedules, walls.back());
  }
  return walls;
}

void check_probes(const TomlValue& root) {
  check_names(root, "probe");
  for (const TomlValue& table : repeated(root, "probe")) {
    check_plain_name(*table.find("name"), "a probe", "it begins the names of columns");
  }
}

void check_bodies(const TomlValue& table, const Probe& probe, std::size_t bodies) {
  for (std::size_t k = 0; k < probe.bodies.size(); ++k) {
    if (static_cast<std::size_t>(probe.bodies[k]) < bodies) continue;
    fail_at(table.find("bodies")->items[k], fmt::format("there is no body {}", probe.bodies[k]),
            fmt::format("they are counted 0 to {}", static_cast<long long>(bodies) - 1), "Correct the number");
  }
}

void check_step(const TomlValue& run, const std::optional<double>& step, const std::optional<double>& duration) {
  if (!step || !duration || *step <= *duration) return;
  fail_at(*run.find("time_step"), fmt::format("time_step = {} s is longer than the run of {} s", *step, *duration),
          "a run makes at least one step", "Shorten the step");
}

std::vector<Key<ServoTable>> servo_keys() {
  const std::string over_length = "it is the length on which a stress acts";
  const std::string ends = "instead: the walls at both ends of that length";
  const auto of_stress = only_with({"stress"}, over_length);
  return {
      key("force", &ServoTable::force, unit("N (discs: N/m)"), not_negative,
          or_instead({"stress"}, "a servo holds a force or a stress"), "with which the wall pushes the bodies"),
      key("stress", &ServoTable::stress, unit("Pa"), not_negative,
          "of discs, over the length of a segment, over length, or over the present length between two walls"),
      key("schedule", &ServoTable::schedule, "factor of force or stress; without one it is constant"),
      key("max_speed", &ServoTable::servo, &Servo::max_speed, optional, unit("m/s"), positive,
          "the wall is never faster, and approaches bodies with it where it touches none; left out: the speed at which "
          "the heaviest body pushes it by 5 % of the wanted force, or of the present one where that is larger"),
      key("direction", &ServoTable::direction, "in which it pushes, of any length; left out: the normal of a line"),
      key("length", &ServoTable::length, unit("m"), positive, of_stress, not_beside({"from"}, over_length),
          "on which the stress acts"),
      key("from", &ServoTable::from, of_stress, only_with({"to"}, over_length), ends),
      key("to", &ServoTable::to, of_stress, only_with({"from"}, over_length), ends),
      key("mirror", &ServoTable::mirror,
          "name of a wall that moves the same way in the opposite direction; force or stress is then the mean of both"),
      key("relaxation", &ServoTable::servo, &Servo::relaxation, range({.low = 0, .high = 1, .low_open = true}),
          "share of the difference that a step mends, by stiffness and dashpots of the contacts on the wall")};
}

void read_servo(const TomlValue& table, std::span<const NamedSchedule> schedules, Wall& wall) {
  const TomlValue* const given = table.find("servo");
  if (given == nullptr) return;
  ServoTable read;
  read_table(servo_keys(), *given, read);
  Servo servo = read.servo;
  servo.is_stress = read.stress.has_value();
  servo.wanted = scheduled(*given, servo.is_stress ? *read.stress : *read.force, schedules);
  if (!read.direction && wall.shape != Wall::Shape::line)
    fail_at(*given, fmt::format("the servo of wall '{}' has no direction", wall.name),
            "only a line has a normal to push along", "Add direction = [..., ...]");
  servo.direction = read.direction.value_or(wall.normal);
  if (norm(servo.direction) == 0)
    fail_at(*given->find("direction"), "the direction is zero", "it says where the wall pushes",
            "Give a direction, such as [0.0, -1.0]");
  servo.direction = servo.direction / norm(servo.direction);
  servo.length = read.length.value_or(0);
  servo.mirror = read.mirror.value_or("");
  servo.between = {read.from.value_or(""), read.to.value_or("")};
  if (servo.is_stress && servo.length == 0 && !read.from) {
    if (wall.shape != Wall::Shape::segment)
      fail_at(*given, fmt::format("the stress of wall '{}' has no length to act on", wall.name), "a line is endless",
              "Give length, or the walls from and to which it is measured");
    servo.length = norm(wall.end - wall.point);
  }
  servo.place = given->place();
  with_place(servo.place, [&] { check(servo, wall.name); });
  wall.servo = servo;
}

}  // namespace equidem::casefile
