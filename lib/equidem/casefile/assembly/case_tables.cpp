// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/case_tables.hpp"

#include <algorithm>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {
namespace {

using Words = std::vector<std::string>;

void bind_assembly(File<CaseTables>& file) {
  const Words lattices = names_in(all_lattices()), delaunay = {"delaunay"}, from_file = {"file"};
  Words made = lattices;
  made.emplace_back("delaunay");
  Words kinds = made;
  for (const char* kind : {"packing", "file"}) kinds.emplace_back(kind);
  using A = AssemblyCase;
  using L = LatticeOptions;
  using D = DelaunayOptions;
  using F = AssemblyFileOptions;
  file.table("assembly", &CaseTables::assembly, required, "the discs and their contacts")
      .keys(
          {key_with<A, std::string>(
               "kind",
               [](A& assembly, const std::string& kind) {
                 assembly.arrangement = find_lattice(kind);
                 assembly.kind = assembly.arrangement != nullptr ? AssemblyKind::lattice
                                 : kind == "file"                ? AssemblyKind::file
                                 : kind == "packing"             ? AssemblyKind::packing
                                                                 : AssemblyKind::delaunay;
               },
               required, choices(kinds),
               "delaunay: random points, the edges of their triangulation are the contacts; packing: bodies that fill "
               "a "
               "box by [packing], its walls left out; file: read from a file; others: lattices of equal touching "
               "discs"),
           key("columns", &A::lattice, &L::columns, required, from(1, 1e6), when("kind", lattices),
               "discs in the longest row; " + lattice_counts()),
           key("rows", &A::lattice, &L::rows, required, from(1, 1e6), when("kind", lattices), "number of rows"),
           key_with<A, double>(
               "radius",
               [](A& a, const double& radius) {
                 a.lattice.radius = radius;
                 a.delaunay.radii = {radius, radius};
               },
               unit("m"), positive, or_instead({"radii"}, "they say the size of the discs"), when("kind", made),
               "radius of every disc; delaunay: half the mean spacing of neighbours, or give [assembly.radii]"),
           key("discs", &A::delaunay, &D::discs, optional, from(3, 1e9), when("kind", delaunay),
               not_beside({"box"}, "each says how many discs there are"),
               fmt::format(
                   "number wanted, {} if left out; the report says how many there are; not used with [ensemble]",
                   D{}.discs)),
           key("box", &A::delaunay, &D::box, unit("m"), when("kind", delaunay),
               "width and height, from the origin; the number of discs follows from their mean radius a: one for each "
               "2 sqrt3 a²"),
           key("points", &A::delaunay, &D::points, when("kind", delaunay),
               "poisson_disc: random but never close; perturbed_hexagonal: a lattice, disturbed; random: independent"),
           key("disorder", &A::delaunay, &D::disorder, range({.low = 0, .high = 0.5, .high_open = true}),
               when("points", {"perturbed_hexagonal"}), "largest shift of a point, in spacings"),
           key("seed", &A::delaunay, &D::seed, not_negative, when("kind", delaunay), "same seed, same assembly"),
           key("aspect", &A::delaunay, &D::aspect, optional, from(1e-3, 1e3), when("kind", delaunay),
               not_beside({"box"}, "each says how wide the rectangle is"),
               "width over height of the rectangle; left out: 1"),
           key_with<A, bool>(
               "periodic", [](A& a, const bool& joined) { a.lattice.periodic = a.delaunay.periodic = joined; },
               by_default(L{}.periodic), when("kind", made), "joined to itself left-right and top-bottom"),
           key("density", &A::density, unit("kg/m³"), positive,
               "density of the discs themselves; for waves, time steps and motion"),
           key("body", &A::body, "what a disc stands for: a cylinder per metre of depth, or a sphere; for its inertia"),
           key("path", &A::path, required, when("kind", from_file),
               "an assembly file: HDF5 where its name ends in .h5 or .hdf5, else JSON; or a packing of another "
               "program: "
               "a LAMMPS data file or dump, a text export of YADE, a table with the columns x, y and radius or "
               "diameter"),
           key("unit_of_length", &A::file, &F::unit_of_length, when("kind", from_file),
               "unit of lengths in a file of another program that does not say it: m, cm, mm, um, nm, or a length such "
               "as \"2.5 mm\""),
           key("frame", &A::file, &F::frame, from(0, 9e15), when("kind", from_file),
               "time step of the frame of a LAMMPS dump; left out: its last"),
           key("plane", &A::file, &F::plane, when("kind", from_file),
               "plane that such a sample lies in; its second axis is read as y"),
           key("contacts", &A::file, &F::contacts, when("kind", from_file),
               "table of the contacts of such a file, with the columns i and j (ids, or rows from 0) and, if wanted, "
               "lever_i and lever_j, normal_x, normal_y, offset_i and offset_j; left out: its bonds, or discs that "
               "touch"),
           key("periodic_box", &A::file, &F::periodic_box, when("kind", from_file),
               "whether the box of a LAMMPS file is the periodic cell; left out: as its flags say"),
           key("period", &A::file, &F::period, unit("m"), when("kind", from_file),
               "width and height of the periodic cell of such a file without a box; left out: free"),
           key("gap_tolerance", &A::file, &F::gap_tolerance, from(0, 1), when("kind", from_file),
               "of a file without contacts: discs are bonded where the gap between them is at most this share of the "
               "sum "
               "of their radii; 0: where they touch"),
           key("levers", &A::levers,
               "where the contact points of discs lie between their centres, also in place of levers of the file; " +
                   help_of(EnumNames<ContactPoints>::list) +
                   "; left out: as made or read. It matters to forces across gaps between unequal "
                   "discs, and to export"),
           key("own_springs", &A::own_springs, when("kind", from_file),
               "true: springs that the file gives are used; false: those of the case, or of calibrate")});
  file.table("assembly.radii", &CaseTables::assembly, &A::delaunay, &D::radii, when("kind", delaunay),
             "discs of different sizes, instead of radius")
      .keys({key("smallest", &RadiusDistribution::smallest, required, unit("m"), positive),
             key("largest", &RadiusDistribution::largest, required, unit("m"), positive,
                 "radii are uniform between the two")});
  bind_packing(file, &CaseTables::packing_tables, when("assembly.kind", {"packing"}));
}

void bind_material(File<CaseTables>& file) {
  using T = MaterialCase;
  using M = ElasticMaterial;
  file.table("material", &CaseTables::material, "the continuum that the springs shall stand for, instead of [springs]")
      .keys({key("shear_modulus", &T::given, &M::shear_modulus, unit("Pa"), positive,
                 "G; with poisson_ratio or bulk_modulus_2d"),
             key("young_modulus", &T::given, &M::young_modulus, unit("Pa"), positive, "E; with poisson_ratio"),
             key("poisson_ratio", &T::given, &M::poisson_ratio, between(-1, 1),
                 "with shear_modulus or young_modulus; lattices and the mean field reach at most 1/4 in plane strain, "
                 "1/3 in plane stress; calibrate finds the range of an assembly"),
             key("bulk_modulus_2d", &T::given, &M::bulk_modulus_2d, unit("Pa"), positive,
                 "K, mean stress of the plane over its change of area; with shear_modulus"),
             key("p_wave_speed", &T::given, &M::p_wave_speed, unit("m/s"), positive,
                 "Vp; with s_wave_speed and density: K + G = density Vp²"),
             key("s_wave_speed", &T::given, &M::s_wave_speed, unit("m/s"), positive,
                 "Vs; with p_wave_speed and density: G = density Vs²"),
             key("density", &T::given, &M::density, unit("kg/m³"), positive,
                 "density of the continuum, that is of discs and voids together: the discs have density / solid "
                 "fraction"),
             key("plane", &T::given, &M::plane, required,
                 "how Poisson's ratio and Young's modulus are meant: plane strain or plane stress; wave speeds and the "
                 "two-dimensional moduli are the same in both"),
             key("static_only", &T::static_only,
                 "allow kT < 0 for larger Poisson's ratios: no dynamics with such springs")});
  file.table("material")
      .keys({key_in<CaseTables>("weighting", &Case::weighting, "as in [springs]"),
             key_in<CaseTables>("bond_width", &Case::bending, &BendingOptions::bond_width, not_negative,
                                "as in [springs]")});
  file.table("effects", completed, "effects that may be switched off")
      .keys({key_in<CaseTables>("rotation", &Case::rotation, optional, choices({"free", "restrained"}),
                                "rotation of the discs; left out: free where a tangential spring turns them"),
             key_in<CaseTables>("prestress", &Case::prestress,
                                "whether the forces that contacts carry at rest count in the stiffness; auto: where "
                                "they are large, or nothing else may hold the bodies")});
}

void bind_supports_and_loads(File<CaseTables>& file) {
  file.table("test", &CaseTables::test, "a standard test, instead of [[support]] and [[load]]")
      .keys({unbound_key<TensionTest>("kind", KeyType::choice, required, choices({"uniaxial_tension"}),
                                      "pulled along x by its left and right sides (Abe 1996, section 3)"),
             key("stress", &TensionTest::stress, unit("Pa"), not_zero, "tension positive"),
             key("gauge", &TensionTest::gauge,
                 "where strain is read: two spacings or a quarter of the block either side of the middle, or side to "
                 "side")});
  file.table("group", &CaseTables::groups, "discs chosen by name")
      .keys({key("name", &GroupCase::name, required, "for use in [[support]] and [[load]]"),
             key("discs", &GroupCase::discs, or_instead({"box"}, "a group is a list of discs, or the discs in a box"),
                 "counted from 0"),
             key("box", &GroupCase::box, unit("m"), "the discs with their centre inside")});
  using S = Support;
  file.table("support", &CaseTables::supports, "prescribed motion of a group")
      .keys({key("group", &S::group, required,
                 "left, right, bottom, top, bottom_left, bottom_right, top_left, top_right, or your own"),
             key("ux", &S::ux, held, unit("m"), "prescribed motion; true: held at 0; left out: free"),
             key("uy", &S::uy, held, unit("m")), key("rotation", &S::rotation, held, unit("rad"), "counter-clockwise"),
             unbound_key<S>("schedule", KeyType::text, "in a run: the motion is multiplied by it")});
  using T = LoadTable;
  file.table("load", &CaseTables::load_tables, "forces and moments on a group")
      .keys({key("group", &T::load, &Load::group, required, "as in [[support]]"),
             key("kind", &T::load, &Load::kind,
                 "per_disc: on each disc; total: shared equally; traction: per area of the side that the group forms"),
             key("force", &T::load, &Load::force, optional, unit("N/m (traction: Pa)"), "[f_x, f_y]"),
             key("moment", &T::load, &Load::moment, optional, unit("N"), "N m per metre of depth, counter-clockwise"),
             key("case", &T::load_case, "loads of one name act together; a load without acts in every load case"),
             unbound_key<T>("schedule", KeyType::text, "in a run: force and moment are multiplied by it")});
}

void bind_run(File<CaseTables>& file) {
  using R = RunCase;
  using T = TimeStepOptions;
  file.table("run", &CaseTables::run, "motion in time, for the verb run")
      .keys({key("duration", &R::duration, run_duration,
                 or_instead({"until_rest"}, "a run ends after a time, or at rest")),
             key("time_step", &R::time_step, &T::step, run_time_step, "auto: by step_rule"),
             key("gravity", &R::gravity, run_gravity),
             key("until_rest", &R::until_rest, between(0, 1),
                 "relax until the unbalanced force is this small, relative, such as 1e-10"),
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
                 "printed, order 1; fourth_order: symplectic, four forces a step; all are of order 1 with dashpots, "
                 "viscoelastic springs or local damping"),
             key("motion", &R::motion,
                 "small: contacts keep their direction, exactly the stiffness of statics; finite: they follow the "
                 "discs")});
  file.table("run.damping", &CaseTables::run, &R::damping, "damping of a run; at most one of stiffness and contact")
      .keys({key("mass", &Damping::mass, unit("1/s"), not_negative, "alpha: force -alpha m v on every disc"),
             key("stiffness", &Damping::stiffness, unit("s"), not_negative,
                 "beta: dashpots beta kN, beta kT at contacts"),
             key("contact", &Damping::contact, not_negative,
                 "zeta: dashpots 2 zeta sqrt(m k) at contacts, m the reduced mass; instead of stiffness"),
             key("local", &Damping::local, range({.low = 0, .high = 1, .high_open = true}),
                 "non-viscous: this share of the resultant force, against the velocity")});
  bind_motion(file, BodyFamily::bonded, &CaseTables::run, &R::probes);
  file.table("velocity", &CaseTables::run, &R::velocities, "velocity of a group at the start of a run")
      .keys({key("group", &InitialVelocity::group, required, "as in [[support]]"),
             key("velocity", &InitialVelocity::velocity, unit("m/s")),
             key("spin", &InitialVelocity::spin, unit("rad/s"), "of each disc, counter-clockwise")});
}

void bind_breakage(File<CaseTables>& file) {
  bind_strength_file(file);
  file.table("strength", &CaseTables::strength, "strengths of the contacts, for quasistatic and calibrate")
      .keys(strength_keys());
  file.table("strength_target", &CaseTables::strength_target,
             "strengths of the material, for which calibrate finds those of the contacts")
      .keys(strength_target_keys());
  file.table("strain", &CaseTables::strain, "mean strain of a periodic cell times lambda, for the verb quasistatic")
      .keys({key("xx", &Voigt::xx, "positive: the cell grows longer along x"), key("yy", &Voigt::yy),
             key("xy", &Voigt::xy, "engineering shear strain, 2 e_xy")});
  file.table("dead_load", &CaseTables::dead_loads,
             "forces put on first, which stay while lambda grows, for the verb quasistatic")
      .keys({key("group", &Load::group, required, "as in [[support]]"), key("kind", &Load::kind, "as in [[load]]"),
             key("force", &Load::force, optional, unit("N/m (traction: Pa)"),
                 "[f_x, f_y]; where contacts rub it grows from none to this, event by event, before lambda does, "
                 "beside the "
                 "loads that forces at rest balance: the weight under which a packing fell is not given again"),
             key("moment", &Load::moment, optional, unit("N"), "N m per metre of depth, counter-clockwise")});
  file.table("notch", &CaseTables::notches, "a straight cut through contacts from the start, for the verb quasistatic")
      .keys({key("from", &Notch::from, required, unit("m"), "[x, y] of one end"),
             key("to", &Notch::to, required, unit("m"), "[x, y] of the other end")});
  using Q = QuasistaticCase;
  file.table("quasistatic", &CaseTables::quasistatic, completed,
             "the path of the verb quasistatic: loads, motions or [strain] times lambda")
      .keys(
          {key("control", &Q::control,
               "what does not fall while contacts break: path: nothing, lambda may fall from event to event "
               "(snap-back); load; motion: that through which the load works. Left out: path, or where contacts rub "
               "what lambda multiplies"),
           key("legs", &Q::legs, "lambda at the end of each leg, such as [1.0, 0.0, 2.0]; empty: until nothing breaks"),
           key("max_events", &Q::max_events, not_negative, "after so many events the path ends; 0: no limit"),
           key("frame_every", &Q::frame_every, not_negative,
               "events from one frame for ParaView to the next, with --out; 0: none")});
}

void bind_tasks(File<CaseTables>& file) {
  file.table("homogenize", &CaseTables::homogenize, completed, "how the effective stiffness is found")
      .keys(
          {key("boundary", &BoundsOptions::boundary, or_auto,
               "how the mean strain enters; auto: periodic where the assembly is, else displacement and traction side "
               "by "
               "side"),
           key("bounds", &BoundsOptions::bounds,
               "affine: those that need no solution; all: also by uniform displacements and tractions at the boundary; "
               "auto: all up to 20000 discs")});
  file.table("ensemble", &CaseTables::ensemble,
             "many random samples (kind = delaunay or packing): mean, scatter, the size needed")
      .keys(
          {key("discs", &EnsembleCase::plan, &EnsemblePlan::discs, from(3, 1e9),
               "sizes of the samples, ascending; in place of assembly.discs or packing.grains; a box keeps its shape"),
           key("samples", &EnsembleCase::plan, &EnsemblePlan::samples, from(2, 1e6),
               "samples of each size, made from the seed of the assembly, seed + 1, ..."),
           key("accuracy", &EnsembleCase::accuracy, between(0, 1),
               "wanted of the moduli, relative, such as 0.01: the report says which size reaches it")});
  file.table("solver", &CaseTables::solver, completed, "how the equations are solved")
      .keys({key("method", &SolverOptions::method, help_of(EnumNames<SolverMethod>::list)),
             key("ordering", &SolverOptions::ordering, when("method", {to_string(SolverMethod::cholmod)}),
                 "order of elimination: " + help_of(EnumNames<CholmodOrdering>::list)),
             key("max_refinements", &SolverOptions::max_refinements, from(0, 100), "steps of iterative refinement"),
             key("memory_limit", &SolverOptions::memory_limit, bytes, not_negative,
                 "largest memory of the factor, also as \"4 GB\"; 0: what the machine has free")});
  file.table("output", &CaseTables::output, completed, "what is written with --out").keys(output_keys());
}

}  // namespace

std::vector<Key<OutputCase>> output_keys() {
  return {
      key_with<OutputCase, std::vector<OutputFile>>(
          "files",
          [](OutputCase& output, const std::vector<OutputFile>& wanted) {
            const auto has = [&](OutputFile file) { return std::ranges::find(wanted, file) != wanted.end(); };
            output.csv = has(OutputFile::csv);
            output.vtk = has(OutputFile::vtk);
            output.picture = has(OutputFile::picture);
          },
          choices(names_of<OutputFile>()), or_empty,
          by_default(std::vector{OutputFile::csv, OutputFile::vtk, OutputFile::picture}),
          "csv: tables of bodies and contacts; vtk: an assembly for ParaView; picture: picture.svg, picture.png, of "
          "bodies that collide at segments, and whose paths are not drawn, without those that lie farther from "
          "the box round these walls and the start than half its larger side; [] for none of them"),
      key("assembly", &OutputCase::assembly,
          "discs and contacts in assembly.json or, read and written faster, assembly.h5 (HDF5); without it pack and "
          "calibrate write json, solve and homogenize none"),
      key("frame_interval", &OutputCase::frame_interval, unit("s"), positive,
          "from one frame of a run to the next: bodies and contacts for ParaView"),
      key("frame_contacts", &OutputCase::frame_contacts,
          "contacts with their forces in every frame: some 50 bytes a body and 84 a contact, beside 100 a disc"),
      key("probe_interval", &OutputCase::probe_interval, unit("s"), positive,
          "from one row of the histories of a run to the next"),
      key("checkpoint_interval", &OutputCase::checkpoint_interval, unit("s"), positive,
          "wall-clock time from one checkpoint of a run, or of the events of quasistatic, to the next")};
}

const File<CaseTables>& case_file() {
  static const File<CaseTables> file = [] {
    File<CaseTables> made(case_schema, "case file");
    bind_springs_file(made);
    bind_assembly(made);
    made.table("springs", &CaseTables::springs_table, "the springs of a contact").keys(springs_keys());
    made.table("springs", &CaseTables::springs_table).keys(bond_keys());
    made.table("viscoelastic", &CaseTables::viscoelastic,
               "dashpots at the springs: complex moduli over frequency (homogenize), motion (run)")
        .keys(viscoelastic_keys());
    bind_material(made);
    bind_supports_and_loads(made);
    bind_run(made);
    bind_breakage(made);
    bind_tasks(made);
    return made;
  }();
  return file;
}

}  // namespace equidem::casefile
