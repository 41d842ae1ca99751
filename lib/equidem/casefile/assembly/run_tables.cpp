// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/case_tables.hpp"

namespace equidem::casefile {

void bind_run_tables(File<CaseTables>& file) {
  using R = RunCase;
  using T = TimeStepOptions;
  std::vector<Key<R>> keys = run_keys<R>("; or give until_rest", "by step_rule");
  keys.insert(
      keys.end(),
      {key("until_rest", &R::until_rest, between(0, 1),
           "relax until the unbalanced force is this small, relative, such as 1e-10; instead of duration"),
       key("step_rule", &R::time_step, &T::rule,
           "rule of an automatic step; lanczos: step_fraction of the exact critical step; bound: of a guaranteed lower "
           "bound of it, sooner known; thesis: an eighth of the period of one disc on one spring, no guarantee"),
       key("step_fraction", &R::time_step, &T::fraction, range({.low = 0, .high = 1, .low_open = true}),
           "share of the critical step, for lanczos and bound"),
       key("allow_unstable_step", &R::time_step, &T::allow_unstable, "allow a step above the critical one, and kT < 0"),
       key("integrator", &R::integrator,
           "leapfrog: central differences; velocity_verlet: the same motion; thesis: Sukegawa (3.14)-(3.17) as "
           "printed, order 1; fourth_order: symplectic, four forces a step"),
       key("motion", &R::motion,
           "small: contacts keep their direction, exactly the stiffness of statics; finite: they follow the discs")});
  file.table("run", &CaseTables::run, "motion in time, for the verb run").keys(std::move(keys));
  file.table("run.damping", &CaseTables::run, &R::damping, "damping of a run; at most one of stiffness and contact")
      .keys({key("mass", &Damping::mass, unit("1/s"), not_negative, "alpha: force -alpha m v on every disc"),
             key("stiffness", &Damping::stiffness, unit("s"), not_negative,
                 "beta: dashpots beta kN, beta kT at contacts"),
             key("contact", &Damping::contact, not_negative,
                 "zeta: dashpots 2 zeta sqrt(m k) at contacts, m the reduced mass; instead of stiffness"),
             key("local", &Damping::local, range({.low = 0, .high = 1, .high_open = true}),
                 "non-viscous: this share of the resultant force, against the velocity")});
  bind_motion(file, BodyFamily::bonded);
  file.table("velocity", &CaseTables::velocities, "velocity of a group at the start of a run")
      .keys({key("group", &InitialVelocity::group, required, "as in [[support]]"),
             key("velocity", &InitialVelocity::velocity, unit("m/s")),
             key("spin", &InitialVelocity::spin, unit("rad/s"), "of each disc, counter-clockwise")});
}

}  // namespace equidem::casefile
