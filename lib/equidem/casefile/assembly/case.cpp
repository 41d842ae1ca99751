// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/case.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "equidem/assembly/lattices.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {
namespace {

constexpr const char* table_header = "frequency,kN_storage,kN_loss,kT_storage,kT_loss";

std::vector<ViscoelasticCase::Row> read_spring_table(const std::filesystem::path& path) {
  constexpr std::size_t columns = 5;
  TableFile::Names names;
  for (const std::string_view name : parts_of(table_header, ',')) names.push_back({std::string(name)});
  TableFile file(path, names);
  std::array<std::size_t, columns> places{};
  std::array<double, columns> units{};
  for (std::size_t c = 0; c < columns; ++c) {
    places[c] = file.names().empty() ? c : file.need(names[c], fmt::format("the columns are {}", table_header));
    units[c] = file.factor(places[c], c == 0 ? Dimension::frequency : Dimension::stress).value_or(1);
  }
  std::vector<ViscoelasticCase::Row> rows;
  while (file.next()) {
    if (file.cells().size() < columns)
      file.fail(fmt::format("this row is not of the columns {}", table_header), "five numbers with commas are needed",
                "Write it like 10,1.0e9,2.0e7,0.5e9,1.0e7: Hz and Pa");
    std::array<double, columns> numbers{};
    for (std::size_t c = 0; c < columns; ++c) numbers[c] = units[c] * file.number(places[c]);
    if (!(numbers[0] > 0)) {
      file.fail(fmt::format("the frequency {} Hz is not above 0", numbers[0]),
                "the springs of a frequency are those of motions that change as exp(i 2 pi frequency t)",
                "Begin with the lowest frequency that was measured");
    }
    if (!rows.empty() && numbers[0] <= rows.back().frequency) {
      file.fail(fmt::format("the frequency {} Hz comes after {} Hz", numbers[0], rows.back().frequency),
                "springs are read between neighbours", "Sort the rows and leave out repeated frequencies");
    }
    rows.push_back({numbers[0], {{numbers[1], numbers[2]}, {numbers[3], numbers[4]}}});
  }
  return rows;
}

std::vector<Key<ViscoelasticCase>> viscoelastic_keys() {
  using V = ViscoelasticCase;
  using L = Viscoelasticity;
  using S = ViscoelasticSpring;
  const std::vector<std::string> timed = {"kelvin_voigt", "maxwell", "standard_solid"}, armed = {"standard_solid"};
  const std::string
      model =
          "kN and kT of every contact at rest or at once; elastic; kelvin_voigt: a dashpot beside it, k (1 + i x) "
          "with x = 2 pi f tau; maxwell: a dashpot behind it, k i x/(1 + i x); standard_solid: a Maxwell arm beside "
          "it, k (1 + arm i x/(1 + i x)); table: by path",
      tau = "viscosity of the dashpot over the stiffness of its spring (of the arm: over that of the arm)",
      arm = "spring of the Maxwell arm over kN, over kT",
      range_of_frequencies = "five frequencies in a decade between these, evenly spaced over their logarithm";
  return {
      key("normal", &V::springs, &L::normal, &S::model, model),
      key("tangential", &V::springs, &L::tangential, &S::model, model),
      key("tauN", &V::springs, &L::normal, &S::time, required, unit("s"), not_negative, when("normal", timed), tau),
      key("tauT", &V::springs, &L::tangential, &S::time, required, unit("s"), not_negative, when("tangential", timed),
          tau),
      key("armN", &V::springs, &L::normal, &S::arm, positive, when("normal", armed), arm),
      key("armT", &V::springs, &L::tangential, &S::arm, positive, when("tangential", armed), arm),
      key("path", &V::path,
          fmt::format("a CSV file with the columns {}, Hz and Pa, of a contact with the kN and kT of the case; others "
                      "are scaled as their elastic springs are",
                      table_header)),
      key("frequencies", &V::frequencies, unit("Hz"), not_beside({"lowest"}, "each says which frequencies to take"),
          "of complex moduli; left out: 3 decades either side of 1/(2 pi tau), or those of the table"),
      key("lowest", &V::lowest, unit("Hz"), positive, only_with({"highest"}, "a range has two ends"),
          range_of_frequencies),
      key("highest", &V::highest, unit("Hz"), positive, only_with({"lowest"}, "a range has two ends"),
          range_of_frequencies)};
}

void complete_viscoelastic(const TomlValue& root, ViscoelasticCase& viscoelastic) {
  const TomlValue& table = *root.find("viscoelastic");
  const Viscoelasticity& springs = viscoelastic.springs;
  if (springs.normal.model == SpringModel::elastic && springs.tangential.model == SpringModel::elastic) {
    fail_at(table, "both springs are elastic", "[viscoelastic] would change nothing",
            "Choose a model for normal or tangential, or remove the table");
  }
  const bool tabulated = (springs.normal.model == SpringModel::table || springs.tangential.model == SpringModel::table);
  if (tabulated && !viscoelastic.path) {
    fail_at(table, "path", "the table of springs is missing", "the model \"table\" reads them there",
            "Add path = \"FILE.csv\"");
  }
  if (!tabulated && viscoelastic.path) {
    fail_at(*table.find("path"), "no spring is read from the table", "neither normal nor tangential is \"table\"",
            "Set one of them, or remove path");
  }
  if (viscoelastic.path) with_key(table, "path", [&] { viscoelastic.rows = read_spring_table(*viscoelastic.path); });
}

using Words = std::vector<std::string>;

constexpr const char* uniform_radii = "radii are uniform between the two";

void bind_assembly(File<CaseTables>& file) {
  const Words lattices = names_in(all_lattices()), delaunay = {"delaunay"}, from_file = {"file"};
  Words made = lattices;
  made.emplace_back("delaunay");
  Words kinds = made;
  for (const char* kind : {"packing", "file"}) kinds.emplace_back(kind);
  const std::string counts_of_lattice = "discs in the longest row, and number of rows; " + lattice_counts();
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
           key("columns", &A::lattice, &L::columns, required, from(1, 1e6), when("kind", lattices), counts_of_lattice),
           key("rows", &A::lattice, &L::rows, required, from(1, 1e6), when("kind", lattices), counts_of_lattice),
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
                   "; left out: as made or read. Halfway differs from the others wherever radii do, middle across "
                   "gaps"),
           key("own_springs", &A::own_springs, when("kind", from_file),
               "true: springs that the file gives are used; false: those of the case, or of calibrate")});
  file.table("assembly.radii", &CaseTables::assembly, &A::delaunay, &D::radii, when("kind", delaunay),
             "discs of different sizes, instead of radius")
      .keys({key("smallest", &RadiusDistribution::smallest, required, unit("m"), positive, uniform_radii),
             key("largest", &RadiusDistribution::largest, required, unit("m"), positive, uniform_radii)});
  bind_packing(file, &CaseTables::packing_tables, when("assembly.kind", {"packing"}));
}

void bind_material(File<CaseTables>& file) {
  using T = MaterialCase;
  using M = ElasticMaterial;
  const std::string speeds = "Vp and Vs, with density: K + G = density Vp², G = density Vs²";
  file.table("material", &CaseTables::material, "the continuum that the springs shall stand for, instead of [springs]")
      .keys({key("shear_modulus", &T::given, &M::shear_modulus, unit("Pa"), positive,
                 "G; with poisson_ratio or bulk_modulus_2d"),
             key("young_modulus", &T::given, &M::young_modulus, unit("Pa"), positive, "E; with poisson_ratio"),
             key("poisson_ratio", &T::given, &M::poisson_ratio, between(-1, 1),
                 "with shear_modulus or young_modulus; lattices and the mean field reach at most 1/4 in plane strain, "
                 "1/3 in plane stress; calibrate finds the range of an assembly"),
             key("bulk_modulus_2d", &T::given, &M::bulk_modulus_2d, unit("Pa"), positive,
                 "K, mean stress of the plane over its change of area; with shear_modulus"),
             key("p_wave_speed", &T::given, &M::p_wave_speed, unit("m/s"), positive, speeds),
             key("s_wave_speed", &T::given, &M::s_wave_speed, unit("m/s"), positive, speeds),
             key("density", &T::given, &M::density, unit("kg/m³"), positive,
                 "density of the continuum, that is of discs and voids together: the discs have density / solid "
                 "fraction"),
             key("plane", &T::given, &M::plane, required,
                 "how Poisson's ratio and Young's modulus are meant: plane strain or plane stress; wave speeds and the "
                 "two-dimensional moduli are the same in both"),
             key("static_only", &T::static_only,
                 "allow kT < 0 for larger Poisson's ratios: no dynamics with such springs")});
  file.table("material")
      .keys({key_in<CaseTables>("weighting", &Case::weighting, "of these springs, see [springs]"),
             key_in<CaseTables>("bond_width", &Case::bending, &BendingOptions::bond_width, not_negative,
                                "of the bonds, see [springs]")});
  file.table("effects", completed, "effects that may be switched off")
      .keys({key_in<CaseTables>("rotation", &Case::rotation, optional, choices({"free", "restrained"}),
                                "rotation of the discs; left out: free where a tangential spring turns them"),
             key_in<CaseTables>("prestress", &Case::prestress,
                                "whether the forces that contacts carry at rest count in the stiffness; auto: where "
                                "they are large, or nothing else may hold the bodies")});
}

std::vector<Key<Load>> keys_of_load() {
  return {key("group", &Load::group, required, "the discs that it acts on"),
          key("kind", &Load::kind,
              "per_disc: on each disc; total: shared equally; traction: per area of the side that the group forms"),
          key("force", &Load::force, optional, unit("N/m (traction: Pa)"), "[f_x, f_y]"),
          key("moment", &Load::moment, optional, unit("N"), "N m per metre of depth, counter-clockwise")};
}

void bind_supports_and_loads(File<CaseTables>& file) {
  file.table("test", &CaseTables::test, "a standard test, instead of [[support]] and [[load]]")
      .keys({unbound_key<TensionTest>("kind", KeyType::choice, required, choices({"uniaxial_tension"}),
                                      "pulled along x by its left and right sides (Abe 1996, section 3)"),
             key("stress", &TensionTest::stress, unit("Pa"), not_zero, "tension positive"),
             key("gauge", &TensionTest::gauge,
                 "where strain is read: two spacings or a quarter of the block either side of the middle, or side to "
                 "side")});
  const std::string drawn = "it is how the share is drawn";
  file.table("group", &CaseTables::groups, "discs chosen by name")
      .keys(
          {key("name", &GroupCase::name, required, "for use in [[support]], [[load]], [[springs.between]] and others"),
           key("discs", &GroupCase::discs,
               or_instead({"box", "share"}, "a group is a list of discs, the discs in a box, or a share of all"),
               "counted from 0"),
           key("box", &GroupCase::box, unit("m"), "the discs with their centre inside"),
           key("share", &GroupCase::share, range({.low = 0, .high = 1, .low_open = true}),
               "of all discs, at random; groups with a share have no disc in common"),
           key("cells", &GroupCase::draw, &GroupDraw::cells, from(1, 1e7), only_with({"share"}, drawn),
               "the share is of whole Voronoi cells of so many random points, the grains of a rock, the same for all "
               "groups with a share; the discs of each are a group too: cell_0, cell_1, ..."),
           key("seed", &GroupCase::draw, &GroupDraw::seed, optional, not_negative, only_with({"share"}, drawn),
               "of the share, the same for all such groups; left out: 1")});
  using S = Support;
  const std::string prescribed = "prescribed motion; true: held at 0; left out: free";
  file.table("support", &CaseTables::supports, "prescribed motion of a group")
      .keys({key("group", &S::group, required,
                 "left, right, bottom, top, bottom_left, bottom_right, top_left, top_right, or your own"),
             key("ux", &S::ux, held, unit("m"), prescribed), key("uy", &S::uy, held, unit("m"), prescribed),
             key("rotation", &S::rotation, held, unit("rad"), "counter-clockwise"),
             unbound_key<S>("schedule", KeyType::text, "in a run: the motion is multiplied by it")});
  using T = LoadTable;
  std::vector<Key<T>> load = keys_of_member(&T::load, keys_of_load());
  load.push_back(key("case", &T::load_case, "loads of one name act together; a load without acts in every load case"));
  load.push_back(unbound_key<T>("schedule", KeyType::text, "in a run: force and moment are multiplied by it"));
  file.table("load", &CaseTables::load_tables, "forces and moments on a group").keys(load);
}

void bind_run(File<CaseTables>& file) {
  using R = RunCase;
  bind_motion(file, &CaseTables::run, &CaseTables::run, &R::probes);
  file.table("run.damping", &CaseTables::run, &R::damping, "damping of a run; at most one of stiffness and contact")
      .keys({key("mass", &Damping::mass, unit("1/s"), not_negative, "alpha: force -alpha m v on every disc"),
             key("stiffness", &Damping::stiffness, unit("s"), not_negative,
                 "beta: dashpots beta kN, beta kT at contacts"),
             key("contact", &Damping::contact, not_negative,
                 "zeta: dashpots 2 zeta sqrt(m k) at contacts, m the reduced mass; instead of stiffness"),
             key("local", &Damping::local, range({.low = 0, .high = 1, .high_open = true}),
                 "non-viscous: this share of the resultant force, against the velocity")});
  file.table("velocity", &CaseTables::run, &R::velocities, "velocity of a group at the start of a run")
      .keys({key("group", &InitialVelocity::group, required, "the discs that have it"),
             key("velocity", &InitialVelocity::velocity, unit("m/s")),
             key("spin", &InitialVelocity::spin, unit("rad/s"), "of each disc, counter-clockwise")});
}

void bind_breakage(File<CaseTables>& file) {
  bind_strength(file, &CaseTables::strength);
  bind_strength_between(file, &CaseTables::strength_between);
  file.table("strength_target", &CaseTables::strength_target,
             "strengths of the material, for which calibrate finds those of the contacts")
      .keys(strength_target_keys());
  const std::string components =
      "xx, yy positive: the cell grows longer along x, along y; xy: engineering shear strain, 2 e_xy";
  file.table("strain", &CaseTables::strain, "mean strain of a periodic cell times lambda, for the verb quasistatic")
      .keys({key("xx", &Voigt::xx, components), key("yy", &Voigt::yy, components), key("xy", &Voigt::xy, components)});
  file.table(
          "dead_load", &CaseTables::dead_loads, like("load"),
          "forces put on first, which stay while lambda grows, for the verb quasistatic; with frictional contacts they "
          "grow from none to this, event by event, before lambda does, beside the loads that forces at rest balance: "
          "the weight under which a packing fell is not given again")
      .keys(keys_of_load());
  file.table("notch", &CaseTables::notches, "a straight cut through contacts from the start, for the verb quasistatic")
      .keys({key("from", &Notch::from, required, unit("m"), "its ends"),
             key("to", &Notch::to, required, unit("m"), "its ends")});
  using Q = QuasistaticCase;
  file.table("quasistatic", &CaseTables::quasistatic, completed,
             "the path of the verb quasistatic: loads, motions or [strain] times lambda")
      .keys(
          {key("control", &Q::control,
               "what does not fall while contacts break: path: nothing, lambda may fall from event to event "
               "(snap-back); load; motion: that through which the load works. Left out: path, or with frictional "
               "contacts what lambda multiplies"),
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
  bind_output(file, &CaseTables::output);
}

}  // namespace

std::vector<Key<OutputCase>> output_keys() {
  const auto of_runs = only_in({CaseKind::assembly, CaseKind::colliding});
  const std::string interval =
      "from one frame of a run, bodies and contacts for ParaView, to the next, and from one row of its histories";
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
          "csv: tables of bodies and contacts, grains.csv of a packing for [grains] path; vtk: an assembly for "
          "ParaView; picture: picture.svg, picture.png, of "
          "bodies that collide at segments, and whose paths are not drawn, without those that lie farther from "
          "the box round these walls and the start than half its larger side; [] for none of them"),
      key("assembly", &OutputCase::assembly,
          "discs and contacts in assembly.json or, read and written faster, assembly.h5 (HDF5); without it pack and "
          "calibrate write json, solve and homogenize none"),
      key("frame_interval", &OutputCase::frame_interval, of_runs, unit("s"), positive, interval),
      key("probe_interval", &OutputCase::probe_interval, of_runs, unit("s"), positive, interval),
      key("frame_contacts", &OutputCase::frame_contacts, of_runs,
          "contacts with their forces in every frame: some 50 bytes a body and 84 a contact, beside 100 a disc"),
      key("checkpoint_interval", &OutputCase::checkpoint_interval, of_runs, unit("s"), positive,
          "wall-clock time from one checkpoint of a run, or of the events of quasistatic, to the next")};
}

const File<CaseTables>& case_file() {
  static const File<CaseTables> file = [] {
    File<CaseTables> made(case_schema, "case file", CaseKind::assembly);
    made.ask(kinds_with);
    bind_assembly(made);
    bind_springs(made, &CaseTables::springs_table);
    bind_springs_between(made, &CaseTables::springs_between);
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

namespace equidem {
namespace {

namespace fs = std::filesystem;

using namespace casefile;

void check_radii(const TomlValue& table, const RadiusDistribution& radii) {
  if (table.find("radii") != nullptr && radii.smallest > radii.largest)
    fail_at(*table.find("radii"),
            fmt::format("smallest = {} is larger than largest = {}", radii.smallest, radii.largest), "",
            "Exchange them");
}

void check_support(const TomlValue& table, const Support& support) {
  if (support.ux || support.uy || support.rotation) return;
  fail_at(table, fmt::format("the support of '{}' holds nothing", support.group),
          "ux, uy and rotation are all left out", "Add one, such as uy = true");
}

void check_load(const TomlValue& table, const Load& load) {
  check_plain_name(*table.find("case"), "a load case", "it becomes part of the names of files");
  const TomlValue* moment = table.find("moment");
  if (table.find("force") == nullptr && moment == nullptr)
    fail_at(table, fmt::format("the load on '{}' has neither force nor moment", load.group), "it would do nothing",
            "Add one, such as force = [1.0e3, 0.0]");
  if (moment != nullptr && load.kind == LoadKind::traction)
    fail_at(*moment, "a traction has no moment", "it is a force per area of a side",
            "Give the moment in a [[load]] of its own");
}

/// Loads with a name act in the case of that name, loads without in every case.
std::vector<NamedLoads> load_cases_of(const std::vector<LoadTable>& tables) {
  std::vector<NamedLoads> cases;
  for (const LoadTable& table : tables)
    if (!table.load_case.empty() && std::ranges::find(cases, table.load_case, &NamedLoads::name) == cases.end())
      cases.push_back({table.load_case, {}});
  if (cases.empty()) cases.push_back({});
  for (const LoadTable& table : tables)
    for (NamedLoads& loads : cases)
      if (table.load_case.empty() || table.load_case == loads.name) loads.loads.push_back(table.load);
  return cases;
}

/// Before keys are checked: of two tables that exclude each other neither misses a key.
void check_one_source_of_springs(const TomlValue& root) {
  const TomlValue* material = root.find("material");
  if (root.find("springs") == nullptr || material == nullptr) return;
  fail_at(*material, "springs and [material] are both given", "[material] says which springs to take",
          "Remove one of them");
}

void check_contradictions(const TomlValue& root, const AssemblyCase& assembly) {
  const TomlValue* springs = root.find("springs");
  const TomlValue* material = root.find("material");
  const bool springs_in_file = assembly.kind == AssemblyKind::file;
  if (springs == nullptr && material == nullptr && !springs_in_file) {
    fail_at(root, "springs", "the springs are missing",
            "every contact has a normal spring kN and a tangential spring kT",
            "Add [springs] with kN and kT, or [material], or springs = \"FILE\"");
  }
  if (const TomlValue* ensemble = root.find("ensemble"); ensemble != nullptr && !assembly.random()) {
    fail_at(*ensemble, "an ensemble needs random assemblies",
            fmt::format("kind = \"{}\" makes the same one every time", root.find("assembly")->find("kind")->text),
            "Set kind = \"delaunay\" or \"packing\", or remove [ensemble]");
  }
  const TomlValue* test = root.find("test");
  for (const char* other : {"support", "load"}) {
    if (test == nullptr || repeated(root, other).empty()) continue;
    fail_at(repeated(root, other).front(), fmt::format("[test] and [[{}]] are both given", other),
            "the test brings its own supports and loads", "Remove one of them");
  }
  if (test != nullptr && (assembly.lattice.periodic || assembly.delaunay.periodic)) {
    fail_at(*root.find("assembly")->find("periodic"), "a periodic assembly has no sides to pull",
            "[test] pulls at the left and right sides", "Set periodic = false, or remove [test]");
  }
  if (test != nullptr && assembly.packing && assembly.packing->box.periodic()) {
    fail_at(*root.find("packing")->find("sides"), "a periodic assembly has no sides to pull",
            "[test] pulls at the left and right sides", "Set sides = \"walls\", or remove [test]");
  }
}

TimedSupport timed(const Support& support, const TomlValue& table, std::span<const NamedSchedule> schedules) {
  const auto motion = [&](const std::optional<double>& value) -> std::optional<Schedule> {
    if (!value) return {};
    return scheduled(table, *value, schedules);
  };
  return {support.group, motion(support.ux), motion(support.uy), motion(support.rotation)};
}

void check_one_load_case(const std::vector<TomlValue>& tables, const std::string& first) {
  for (const TomlValue& table : tables) {
    const TomlValue& name = *table.find("case");
    if (!name.text.empty() && name.text != first)
      fail_at(name, fmt::format("[run] has the load cases '{}' and '{}'", first, name.text),
              "a run is one motion, in which all loads act", "Keep one, or remove [run]");
  }
}

/// Nothing that acts in a run alone is passed over in silence.
void check_no_run_needed(const TomlValue& root) {
  for (const char* list : {"wall", "velocity", "probe"}) {
    if (repeated(root, list).empty()) continue;
    fail_at(repeated(root, list).front(), fmt::format("[[{}]] is given and [run] is not", list),
            "it belongs to motion in time", "Add [run] with a duration, or remove it");
  }
}

/// Complete [run] by the tables that act in a run, with their schedules.
void complete_run(const TomlValue& root, CaseTables& tables) {
  std::vector<TimedSupport> supports;
  for (std::size_t k = 0; k < tables.supports.size(); ++k)
    supports.push_back(timed(tables.supports[k], repeated(root, "support")[k], tables.schedules));
  std::vector<Schedule> factors;
  for (const TomlValue& table : repeated(root, "load")) factors.push_back(scheduled(table, 1, tables.schedules));
  const TomlValue* table = root.find("run");
  if (table == nullptr) return check_no_run_needed(root);
  RunCase& run = *tables.run;
  run.supports = std::move(supports);
  check_one_load_case(repeated(root, "load"), tables.load_cases.front().name);
  for (std::size_t k = 0; k < factors.size(); ++k)
    run.loads.push_back({tables.load_cases.front().loads[k], factors[k]});
  run.walls = read_walls(root, tables.wall_tables, tables.schedules);
  check_probes(root);
  check_step(*table, run.time_step.step, run.duration);
  run.time_step.duration = run.duration.value_or(0);
  if (run.damping.stiffness > 0 && run.damping.contact > 0)
    fail_at(*table->find("damping")->find("contact"), "stiffness and contact are both given",
            "each says which dashpots stand at the contacts", "Set one of them to 0");
}

/// The packing of an assembly that is one: its contacts have the springs of the case.
void complete_packing(const TomlValue& root, CaseTables& tables) {
  AssemblyCase& assembly = tables.assembly;
  assembly.gap_tolerance = tables.packing_tables.gap_tolerance;
  assembly.region = tables.packing_tables.region;
  PackingAmount& amount = tables.packing_tables.amount;
  if (tables.ensemble && !amount.grains && !amount.box) amount.grains = tables.ensemble->plan.discs.front();
  ScalablePacking packing = packing_options(root, tables.packing_tables);
  if (assembly.density) packing.settling.density = *assembly.density;
  if (tables.springs) packing.settling.springs = *tables.springs;
  if (entry_of(packing.method).open_top && !tables.springs)
    fail_at(*root.find("packing")->find("method"), "bodies fall, and the case gives no springs",
            "they collide by kN and kT; [material] gives springs only for an assembly that is there",
            "Give [springs], or pack by growth");
  assembly.packing = std::move(packing);
}

/// A triangulation in a box: the number of discs follows from their size.
void complete_delaunay(const TomlValue& root, DelaunayOptions& options) {
  if (!options.box) return;
  options.discs = with_key(*root.find("assembly"), "box", [&] { return discs_that_fill(*options.box, options.radii); });
  options.aspect = options.box->x / options.box->y;
}

/// All groups with a share are drawn together, by the first of them.
void check_draws(const TomlValue& root, const std::vector<GroupCase>& groups) {
  const auto first = std::ranges::find_if(groups, [](const GroupCase& group) { return group.share.has_value(); });
  for (std::size_t k = 0; k < groups.size(); ++k)
    if (groups[k].share && groups[k].draw != first->draw)
      fail_at(
          repeated(root, "group")[k],
          fmt::format("the groups '{}' and '{}' have shares of different cells or seeds", first->name, groups[k].name),
          "groups with a share are drawn together, so that none has a disc of another",
          "Give both the same cells and seed");
}

/// \param table "springs" or "strength", which has the pairs in [[TABLE.between]]
template <class Property>
void check_pairs(const TomlValue& root, const std::string& table, const std::vector<OfPair<Property>>& pairs) {
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const auto [first, second] = std::minmax(pairs[k].groups[0], pairs[k].groups[1]);
    for (std::size_t earlier = 0; earlier < k; ++earlier) {
      const auto& other = pairs[earlier];
      if (other.across != pairs[k].across || std::min(other.groups[0], other.groups[1]) != first ||
          std::max(other.groups[0], other.groups[1]) != second)
        continue;
      fail_at(*repeated(*root.find(table), "between")[k].find("groups"),
              fmt::format("the pair '{}', '{}' is named twice", pairs[k].groups[0], pairs[k].groups[1]),
              "one of the two would not count", "Remove one of them");
    }
  }
}

/// Samples take the seeds first, first + 1, ..., each of which a case can have.
void check_seeds(const TomlValue& root, const std::string& key, std::uint64_t first, std::int64_t samples) {
  constexpr auto most = std::numeric_limits<std::int64_t>::max();
  if (first <= static_cast<std::uint64_t>(most - samples + 1)) return;
  fail_at(value_at(root, key), fmt::format("{} take the seeds from {} on", counted(samples, "sample"), first),
          fmt::format("the largest seed is {}", most), fmt::format("Give at most {}", most - samples + 1));
}

void check_seeds(const TomlValue& root, const CaseTables& tables) {
  const std::string of_assembly = tables.assembly.packing ? "packing.seed" : "assembly.seed";
  if (tables.ensemble) check_seeds(root, of_assembly, tables.assembly.seed(), tables.ensemble->plan.samples);
  if (!tables.strength_target) return;
  const std::int64_t samples = tables.strength_target->samples;
  if (tables.assembly.random()) check_seeds(root, of_assembly, tables.assembly.seed(), samples);
  if (tables.strength) check_seeds(root, "strength.seed", tables.strength->seed, samples);
}

}  // namespace

Case parse_case(std::string_view content, const std::string& name, const fs::path& folder,
                std::span<const std::string> overrides) {
  TomlValue root = parse_document(content, name, overrides);
  if (describes_grains(root))
    bad_input_at(root.where(), "the case describes grains that collide, and this verb needs an [assembly]",
                 "its contacts are there from the start and stay", "Use 'equidem run', or give an [assembly]");
  if (root.find("packing") != nullptr && root.find("assembly") == nullptr)
    bad_input_at(root.where(), "the case fills a box, and this verb needs an [assembly]", "",
                 "Use 'equidem pack', or add [assembly] with kind = \"packing\"");
  check_one_source_of_springs(root);
  resolve_springs_file(root, folder);
  resolve_strength_file(root, folder, CaseKind::assembly);
  CaseTables tables = case_file().read(root, folder);

  const std::optional<SpringsTable>& springs = tables.springs_table;
  if (springs) {
    tables.springs = springs->constants;
    tables.weighting = springs->weighting;
    tables.bending = springs->bending;
  }
  if (tables.viscoelastic) complete_viscoelastic(root, *tables.viscoelastic);
  tables.assembly.density = one_density(root, {{"assembly", tables.assembly.density},
                                               {"springs", springs ? springs->density : std::nullopt},
                                               {"packing", tables.packing_tables.density}});
  check_radii(*root.find("assembly"), tables.assembly.delaunay.radii);
  if (tables.assembly.kind == AssemblyKind::packing) complete_packing(root, tables);
  if (tables.assembly.kind == AssemblyKind::delaunay) complete_delaunay(root, tables.assembly.delaunay);
  check_contradictions(root, tables.assembly);
  check_strength_target(root);
  check_seeds(root, tables);
  if (tables.material)
    tables.material->moduli = at_key(*root.find("material"), [&] { return moduli_of(tables.material->given); });
  check_names(root, "group");
  check_draws(root, tables.groups);
  check_pairs(root, "springs", tables.springs_between);
  check_pairs(root, "strength", tables.strength_between);
  if (tables.strength) tables.strength->between = tables.strength_between;
  for (std::size_t k = 0; k < tables.groups.size(); ++k)
    if (const auto& box = tables.groups[k].box) check_box(*repeated(root, "group")[k].find("box"), box->low, box->high);
  for (std::size_t k = 0; k < tables.supports.size(); ++k)
    check_support(repeated(root, "support")[k], tables.supports[k]);
  for (std::size_t k = 0; k < tables.load_tables.size(); ++k)
    check_load(repeated(root, "load")[k], tables.load_tables[k].load);
  tables.load_cases = load_cases_of(tables.load_tables);
  tables.schedules = read_schedules(root, tables.schedule_tables);
  complete_run(root, tables);
  tables.document = std::move(root);
  return tables;
}

std::string to_toml(const Case& resolved, const fs::path& folder) {
  return to_toml(resolved.document, folder);
}

Case read_case(const fs::path& path, std::span<const std::string> overrides) {
  return parse_case(read_file(path), path.string(), path.parent_path(), overrides);
}

Viscoelasticity build_viscoelasticity(const Case& resolved, const std::optional<SpringConstants>& constants) {
  const ViscoelasticCase& given = *resolved.viscoelastic;
  return with_place(resolved.where("viscoelastic"), [&] {
    Viscoelasticity result = given.springs;
    if (!given.rows.empty() && !constants) {
      bad_input("a table of springs in Pa is given, and each contact has springs of its own",
                "it is not known to which of them the table belongs",
                "Give one pair of springs in [springs] (own_springs = false of a file), or choose other models");
    }
    const auto fill = [&](ViscoelasticSpring& spring, const std::string& of, double elastic, auto measured) {
      if (spring.model == SpringModel::table) {
        if (elastic == 0) {
          bad_input(
              fmt::format("the table gives {} springs, and the case has {} = 0", of, of == "normal" ? "kN" : "kT"),
              "a contact without such a spring has no dashpot either", "Give the case the spring, or another model");
        }
        for (const ViscoelasticCase::Row& row : given.rows)
          spring.table.push_back({row.frequency, measured(row.springs) / elastic});
      }
      check(spring, of);
    };
    const SpringConstants k = constants.value_or(SpringConstants{1, 1});
    fill(result.normal, "normal", k.kN, [](const auto& springs) { return springs.kN; });
    fill(result.tangential, "tangential", k.kT, [](const auto& springs) { return springs.kT; });
    return result;
  });
}

std::vector<double> frequencies_of(const Case& resolved, const Viscoelasticity& springs) {
  constexpr int frequencies_in_a_decade = 5;
  const ViscoelasticCase& given = *resolved.viscoelastic;
  if (!given.frequencies.empty()) return given.frequencies;
  return with_place(resolved.where("viscoelastic"), [&] {
    return given.lowest ? logarithmic_frequencies(*given.lowest, *given.highest, frequencies_in_a_decade)
                        : frequencies_of_interest(springs, frequencies_in_a_decade);
  });
}

}  // namespace equidem
