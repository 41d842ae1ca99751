// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/case_tables.hpp"

namespace equidem::casefile {

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
      key("times", &T::schedule, &Schedule::times, optional, unit("s"), when("kind", table),
          "ascending; with values, or give path"),
      key("values", &T::schedule, &Schedule::values, optional, when("kind", table), "one for each time"),
      key("path", &T::path, when("kind", table),
          "a CSV file with two columns, time and value, instead of times and values")};
}

void bind_run_tables(File<CaseTables>& file) {
  using R = RunCase;
  using T = TimeStepOptions;
  file.table("run", &CaseTables::run, "motion in time, for the verb run")
      .keys(
          {key("duration", &R::duration, unit("s"), positive, "length of the run; or give until_rest"),
           key("until_rest", &R::until_rest, between(0, 1),
               "relax until the unbalanced force is this small, relative, such as 1e-10; instead of duration"),
           key("time_step", &R::time_step, &T::step, or_auto, unit("s"), positive, "auto: by step_rule"),
           key("step_rule", &R::time_step, &T::rule,
               "rule of an automatic step; lanczos: step_fraction of the exact critical step; bound: of a guaranteed "
               "lower "
               "bound of it, sooner known; thesis: an eighth of the period of one disc on one spring, no guarantee"),
           key("step_fraction", &R::time_step, &T::fraction, range({.low = 0, .high = 1, .low_open = true}),
               "share of the critical step, for lanczos and bound"),
           key("allow_unstable_step", &R::time_step, &T::allow_unstable,
               "allow a step above the critical one, and kT < 0"),
           key("integrator", &R::integrator,
               "leapfrog: central differences; velocity_verlet: the same motion; thesis: Sukegawa (3.14)-(3.17) as "
               "printed, order 1; fourth_order: symplectic, four forces a step"),
           key("motion", &R::motion,
               "small: contacts keep their direction, exactly the stiffness of statics; finite: they follow the discs"),
           key("gravity", &R::gravity, unit("m/s²"), "such as [0.0, -9.81]")});
  file.table("run.damping", &CaseTables::run, &R::damping, "damping of a run; at most one of stiffness and contact")
      .keys({key("mass", &Damping::mass, unit("1/s"), not_negative, "alpha: force -alpha m v on every disc"),
             key("stiffness", &Damping::stiffness, unit("s"), not_negative,
                 "beta: dashpots beta kN, beta kT at contacts"),
             key("contact", &Damping::contact, not_negative,
                 "zeta: dashpots 2 zeta sqrt(m k) at contacts, m the reduced mass; instead of stiffness"),
             key("local", &Damping::local, range({.low = 0, .high = 1, .high_open = true}),
                 "non-viscous: this share of the resultant force, against the velocity")});
  file.table("schedule", &CaseTables::schedule_tables,
             "how a motion or load changes in a run; without one it is there from the start")
      .keys(schedule_keys());
  using W = WallTable;
  file.table("wall", &CaseTables::wall_tables, "a straight wall without friction, in a run")
      .keys({key("name", &W::wall, &Wall::name, required, "for reports"),
             key("point", &W::wall, &Wall::point, required, unit("m"), "on the wall"),
             key("normal", &W::wall, &Wall::normal, required,
                 "towards the discs, of any length; all discs are on that side"),
             key("kN", &W::wall, &Wall::kN, required, unit("Pa"), positive,
                 "spring that pushes discs out; there is no friction"),
             key("displacement", &W::displacement, unit("m"), "along the normal, times the schedule"),
             key("schedule", &W::schedule, "schedule of the displacement")});
  file.table("velocity", &CaseTables::velocities, "velocity of a group at the start of a run")
      .keys({key("group", &InitialVelocity::group, required, "as in [[support]]"),
             key("velocity", &InitialVelocity::velocity, unit("m/s")),
             key("spin", &InitialVelocity::spin, unit("rad/s"), "of each disc, counter-clockwise")});
  file.table("probe", &CaseTables::probes, "a history of a group in a run")
      .keys({key("name", &ProbeCase::name, required, "begins the names of its columns"),
             key("group", &ProbeCase::group, required, "as in [[support]]"),
             key("quantities", &ProbeCase::quantities,
                 choices({"displacement", "velocity", "rotation", "spin", "energy"}),
                 "displacement, velocity, rotation, spin: the means over the group; energy: also the ledger of all "
                 "discs")});
}

}  // namespace equidem::casefile
