// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/grains/grain_tables.hpp"

#include "equidem/casefile/assembly/case_tables.hpp"

namespace equidem::casefile {
namespace {

void bind_bodies(File<GrainTables>& file) {
  file.table("grains", completed, "properties of all grains")
      .keys({key_in<GrainTables>("body", &GrainCase::body,
                                 "disc: a cylinder, kg and N per metre of depth; sphere: kg and N")});
  file.table("grains", &GrainTables::common).keys(common_body_keys());
  file.table("grain", &GrainTables::grain_tables, "one body").keys(grain_keys());
}

void bind_run(File<GrainTables>& file) {
  using T = GrainTables;
  file.table("run", required, "how long and in which steps")
      .keys({key_in<T>("duration", &GrainCase::duration, optional, run_duration,
                       "length of the run; required without [[stage]]"),
             key_in<T>("time_step", &GrainCase::step, &GrainStepOptions::time_step, run_time_step,
                       "auto: the shortest contact over steps_per_contact"),
             key_in<T>("gravity", &GrainCase::scene, &GrainScene::gravity, run_gravity),
             key_in<T>(
                 "steps_per_contact", &GrainCase::step, &GrainStepOptions::steps_per_contact, range({.low = 2}),
                 not_beside({"time_step"}, "each says how long a step is"),
                 "of an automatic step; left out: 50 for laws that give a force, 10 for the maps, pi (that is omega "
                 "dt = 1) for exact_flow"),
             key_in<T>(
                 "integrator", &GrainCase::options, &GrainOptions::integrator, optional,
                 "of laws that give a force; semi_implicit_euler (default): first order, contacts that stick do not "
                 "creep; velocity_verlet: second order, as LAMMPS steps")});
  bind_motion(file, BodyFamily::colliding, &GrainCase::probes);
  bind_shaking(file);
  bind_stages(file);
  using M = MeasureOptions;
  file.table("measures", &GrainCase::measures, "quantities measured on the bodies in a box")
      .keys({key("region", &M::region, unit("m"),
                 "[x_min, y_min, x_max, y_max] in which the void ratio is measured; it goes with the shaking box. Left "
                 "out: the box without two mean diameters at its walls and without three below the lowest place of the "
                 "surface, at each moment"),
             key("cell", &M::cell, unit("m"), positive,
                 "width of the cells of the fields of stress, velocity, solid fraction and coordination at the end, "
                 "some bodies wide; left out: no fields")});
}

}  // namespace

std::vector<Key<CommonBodyTable>> common_body_keys() {
  using C = CommonBodyTable;
  return {key("density", &C::density, unit("kg/m³"), positive, "density of every grain that has none of its own"),
          key("path", &C::path,
              "a CSV file of grains: the columns x, y, radius and, where wanted, short_half_axis (of an ellipse, "
              "radius being the long one), discs (of a clump: x y r; x y r), vx, vy, spin, angle, density, group; "
              "grains.csv of run and pack can be read back")};
}

std::vector<Key<GrainTable>> grain_keys() {
  using G = GrainTable;
  return {key("position", &G::grain, &Grain::position, required, unit("m"), "place of the mass centre"),
          key("radius", &G::radius, unit("m"), positive,
              or_instead({"half_axes", "discs"},
                         "a body has one shape: radius is for a disc, half_axes for an ellipse, discs for a clump"),
              "radius of a disc or sphere"),
          key("half_axes", &G::half_axes, unit("m"), positive,
              "[a, b] of an ellipse, the long one first: it lies along x at angle 0"),
          key("discs", &G::discs, optional, unit("m"),
              "discs of a clump, tied rigidly, in the frame of the body at angle 0; they may overlap, areas that "
              "two share count once; all are shifted so that their mass centre is the origin"),
          key("velocity", &G::grain, &Grain::velocity, unit("m/s")),
          key("spin", &G::grain, &Grain::spin, unit("rad/s"), "counter-clockwise"),
          key("angle", &G::grain, &Grain::angle, unit("rad")),
          key("density", &G::density, unit("kg/m³"), positive, "instead of that of [grains]"),
          key("group", &G::group, "for [[collisions.pair]] and [[probe]]")};
}

const File<GrainTables>& grain_file() {
  static const File<GrainTables> file = [] {
    File<GrainTables> made(case_schema, "case file of colliding bodies");
    bind_bodies(made);
    bind_bonds(made);
    bind_cell(made);
    bind_collisions(made);
    bind_run(made);
    made.table("output", &GrainTables::output, completed, "what is written with --out").keys(output_keys());
    return made;
  }();
  return file;
}

}  // namespace equidem::casefile
