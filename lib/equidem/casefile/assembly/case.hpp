// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The case file of an assembly as typed values, and the tables that it is bound to.
#pragma once

#include <complex>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/files.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/breakage/load_path.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/casefile/contact_tables.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/engine/toml.hpp"
#include "equidem/casefile/motion_case.hpp"
#include "equidem/casefile/packing/pack_case.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/contact/materials.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/dynamics/time_step.hpp"
#include "equidem/homogenize/bounds.hpp"
#include "equidem/homogenize/ensemble/ensemble_statistics.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/material/elastic_moduli.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/material/spring_relations.hpp"
#include "equidem/material/viscoelasticity.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/size_distribution.hpp"
#include "equidem/statics/loads.hpp"

namespace equidem {

struct Case;

/// [viscoelastic]. The springs of the case, of whatever source, are the elastic ones that its models refer to.
struct ViscoelasticCase {
  Viscoelasticity springs;  ///< tables are completed by build_viscoelasticity
  std::optional<std::filesystem::path> path;
  /// Measured springs of the table of `path`, Pa, at a contact with the springs kN and kT of the case.
  struct Row {
    double frequency = 0;  ///< Hz
    SpringConstantsOf<std::complex<double>> springs;
  };
  std::vector<Row> rows;
  std::vector<double> frequencies;        ///< Hz; empty: by the other members
  std::optional<double> lowest, highest;  ///< Hz
};

/// The springs over the elastic ones, checked.
/// \param constants of the case before weighting; none where each contact has springs of its own
/// \throws Error (bad_input), with the line of the case file: as check(ViscoelasticSpring), a table in Pa beside
///         springs of their own, or of a kT where the case has none
Viscoelasticity build_viscoelasticity(const Case& resolved, const std::optional<SpringConstants>& constants);

/// Frequencies of [viscoelastic], Hz.
/// \throws Error (bad_input), with the line of the case file
std::vector<double> frequencies_of(const Case& resolved, const Viscoelasticity& springs);

enum class AssemblyKind { lattice, delaunay, packing, file };

/// [assembly]; the options of the other kinds keep their defaults.
struct AssemblyCase {
  AssemblyKind kind = AssemblyKind::lattice;
  const Lattice* arrangement = nullptr;  ///< the lattice, also of an assembly in memory; else null
  LatticeOptions lattice;
  DelaunayOptions delaunay;
  std::optional<ScalablePacking> packing;  ///< for the kind packing; else none
  std::optional<Rectangle> region;         ///< in which the packing is measured
  double gap_tolerance = 0;                ///< of the contacts of a packing
  std::filesystem::path path;              ///< path resolved against the folder of the file
  AssemblyFileOptions file;
  bool own_springs = true;                   ///< use the springs of the file
  std::optional<ContactPoints> levers = {};  ///< none: as made or given
  std::optional<double> density;             ///< kg/m³, of the discs themselves
  Body body = Body::disc;

  /// Whether each seed makes another assembly.
  [[nodiscard]] bool random() const { return kind == AssemblyKind::delaunay || kind == AssemblyKind::packing; }
  /// Whether opposite sides are joined; false for a file, which is not read yet.
  [[nodiscard]] bool periodic() const {
    return kind == AssemblyKind::packing ? packing->box.periodic() : lattice.periodic || delaunay.periodic;
  }
  /// Seed of a random assembly.
  [[nodiscard]] std::uint64_t seed() const { return packing ? packing->seed : delaunay.seed; }
};

/// [[group]]: discs listed, those with their centre inside a box, or a share of all at random.
struct GroupCase {
  std::string name;
  std::vector<std::int32_t> discs;
  std::optional<Rectangle> box;  ///< m
  std::optional<double> share;
  GroupDraw draw;  ///< of the share
};

/// [[load]] entries that act together.
struct NamedLoads {
  std::string name;  ///< empty if the file has no load cases
  LoadCase loads;
};

/// [quasistatic]: the path along which contacts break.
struct QuasistaticCase {
  std::optional<LoadControl> control;  ///< none: path, or with frictional contacts what lambda multiplies
  std::vector<double> legs;            ///< lambda at the end of each; empty: one without an end
  std::int64_t max_events = 0;         ///< 0: no limit
  std::int64_t frame_every = 0;        ///< events from one frame to the next; 0: no frames

  friend bool operator==(const QuasistaticCase&, const QuasistaticCase&) = default;
};

enum class OutputFile { csv, vtk, picture };

template <>
struct EnumNames<OutputFile> {
  static constexpr const char* what = "kind of output";
  static constexpr NamedValue<OutputFile> list[] = {
      {OutputFile::csv, "csv"}, {OutputFile::vtk, "vtk"}, {OutputFile::picture, "picture"}};
};

/// [output]: files written with --out, in addition to result.json and case.toml.
struct OutputCase {
  bool csv = true;
  bool vtk = true;
  bool picture = true;
  std::optional<AssemblyFormat> assembly;  ///< assembly.json, assembly.h5; none: what the verb does by itself
  std::optional<double> frame_interval;    ///< s, of a run
  bool frame_contacts = true;              ///< in frames: contacts with their forces
  std::optional<double> probe_interval;    ///< s, of the histories of a run
  double checkpoint_interval = 60;         ///< s, wall-clock time
};

/// [ensemble]: random samples of one kind, from the seeds s, s + 1, ..., s that of the assembly.
struct EnsembleCase {
  EnsemblePlan plan;               ///< its sizes are instead of that of the assembly
  std::optional<double> accuracy;  ///< target relative accuracy of the moduli
};

/// [material].
struct MaterialCase {
  ElasticMaterial given;
  ElasticModuli moduli;
  bool static_only = false;  ///< kT < 0 allowed
};

/// [run] and the tables that act in a run alone; exactly one of duration and until_rest is given.
struct RunCase : casefile::RunTable {
  Damping damping;
  std::vector<TimedSupport> supports;  ///< supports of the case with their schedules; empty with [test], like loads
  std::vector<TimedLoad> loads;
  std::vector<Wall> walls;
  std::vector<InitialVelocity> velocities;
  std::vector<Probe> probes;
};

/// A checked case file: complete, in range and without contradiction; in its document a
/// springs file is replaced by its content. Conditions that depend on the assembly (non-empty
/// groups, sufficient supports) are checked when the case is built and solved.
struct Case : CaseDocument {
  AssemblyCase assembly;
  std::optional<SpringConstants> springs;                ///< or
  std::vector<OfPair<SpringConstants>> springs_between;  ///< Pa, before weighting
  std::optional<MaterialCase> material;
  std::optional<ViscoelasticCase> viscoelastic;
  SpringWeighting weighting = SpringWeighting::uniform;
  BendingOptions bending;
  Rotation rotation = Rotation::from_scene;
  PrestressChoice prestress = PrestressChoice::automatic;
  std::optional<TensionTest> test;     ///< or
  std::vector<Support> supports;       ///< with
  std::vector<NamedLoads> load_cases;  ///< at least one: without [[load]] one empty case
  std::vector<GroupCase> groups;
  BoundsOptions homogenize;  ///< [homogenize]: boundary and bounds
  std::optional<EnsembleCase> ensemble;
  std::vector<NamedSchedule> schedules;  ///< for a run; statics takes the factor 1
  std::optional<RunCase> run;
  std::optional<StrengthOptions> strength;
  std::optional<StrengthTargetCase> strength_target;
  std::optional<Voigt> strain;  ///< mean strain of a periodic cell, xy engineering
  LoadCase dead_loads;
  std::vector<Notch> notches;
  QuasistaticCase quasistatic;
  SolverOptions solver;
  OutputCase output;
};

/// Read and check a case file.
/// \param overrides "springs.kT=0.3e9", in order
/// \throws Error (bad_input) with file, line and key: unreadable file, no TOML, unknown or missing key, wrong type,
///         out of range, contradiction
Case read_case(const std::filesystem::path& path, std::span<const std::string> overrides = {});

/// Read and check a case from text.
/// \param name of the file, for messages
/// \param folder to which paths in the text are relative
Case parse_case(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                std::span<const std::string> overrides = {});

/// Every key of every kind of case file with type, unit, range, default and meaning, as text of at most 100 columns.
std::string describe_case_file();
/// The keys of one table, "springs", "[strength]" or that of a key, "springs.kT", in each kind of case that has it.
/// \throws Error (bad_input) with the nearest name where there is none
std::string describe_case_table(const std::string& name);

/// The help of the case file as a page in Markdown, docs/case_file.md.
std::string case_file_page();

/// A key as --set takes it, "load.0.moment" for the first entry of a repeated table, and the words that it accepts, if
/// they can be listed.
struct CaseKey {
  std::string path;
  std::vector<std::string> words;
};
/// The keys of all case files that have verbs with --set: all but studies. No path occurs twice.
std::vector<CaseKey> case_keys();

/// The kinds of case files that have a table or key, "springs" or "springs.kM"; no entries of lists.
std::vector<CaseKind> kinds_with(std::string_view path);

/// The unit, "" for none, of the key of a case file of any kind that a path such as "springs.kT" or "load.0.moment"
/// names; nothing where there is no such key.
std::optional<std::string> unit_of_case_key(std::string_view path);

/// The resolved case as TOML: every default written out, overrides applied. Reading it back gives the same case.
/// \param folder of the new file: paths are written relative to it
std::string to_toml(const Case& resolved, const std::filesystem::path& folder);

}  // namespace equidem

namespace equidem::casefile {

/// [[load]].
struct LoadTable {
  Load load;
  std::string load_case;  ///< empty: acts in every case
};

/// A Case and the tables from which it is completed.
struct CaseTables : Case, MotionTables {
  std::vector<LoadTable> load_tables;
  PackingTables packing_tables;
  std::optional<SpringsTable> springs_table;
  std::vector<OfPair<PairStrengths>> strength_between;
};

/// The case file, schema "equidem/1".
const File<CaseTables>& case_file();

std::vector<Key<OutputCase>> output_keys();

/// Binds [output].
template <class F, class Link>
void bind_output(File<F>& file, Link output) {
  file.table("output", output, completed, "what is written with --out").keys(output_keys());
}

}  // namespace equidem::casefile
