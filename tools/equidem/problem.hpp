// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A case made ready to be solved, and what is evaluated once it is.
/// Bodies that no contact holds in place, left out before an assembly is solved.
/// The forces at rest of the contacts of a problem.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/casefile/assembly/build.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/output/results.hpp"
#include "equidem/statics/equilibrium.hpp"

namespace equidem {

/// Bodies that are not solved for.
struct LeftOut {
  std::vector<std::int64_t> bodies;    ///< numbers in the whole assembly
  std::vector<std::string> sentences;  ///< "3 rattlers (...) touch nothing and are left out"
};

/// The input of an EquilibriumSolver, which refers to it: it must outlive the solver and not move.
struct Problem {
  Case resolved;
  Assembly assembly;
  BuiltSprings springs;
  std::optional<TensionSetup> tension;
  std::vector<Support> supports;
  std::vector<NamedLoads> load_cases;
  StageTimes times;  ///< of building it
  LeftOut left_out = {};
  std::optional<PrestressedSprings> prestress = {};  ///< what prestressed() decided
  bool breaks = false;                               ///< contacts break: notches and dead loads are used
  std::string wide_region = {};                      ///< a warning; empty: discs without contacts do not widen it

  /// Networks of chance may have mechanisms that no load moves; of lattices and triangulations one is a mistake.
  [[nodiscard]] EquilibriumOptions options() const {
    const AssemblyKind kind = resolved.assembly.kind;
    const bool by_chance = kind == AssemblyKind::packing || kind == AssemblyKind::file;
    return {.rotation = resolved.rotation,
            .solver = resolved.solver,
            .mechanisms = by_chance ? Mechanisms::hold : Mechanisms::refuse};
  }
  [[nodiscard]] Effects effects() const { return derive_effects(assembly, springs.springs, resolved.rotation); }
};

/// The assembly with its cells, or as it is where it has no contacts or its cells cannot be measured.
Assembly with_cells(Assembly assembly);

/// Use of an assembly; the memory is estimated by it before the assembly is built.
enum class Purpose { factorize, step };

/// While one exists, assembly_of builds each assembly once and keeps it for cases with the same one. At most one
/// exists.
class SharedAssemblies {
 public:
  SharedAssemblies();
  ~SharedAssemblies();
  SharedAssemblies(const SharedAssemblies&) = delete;
  SharedAssemblies& operator=(const SharedAssemblies&) = delete;

  /// \throws Error as build_assembly
  Assembly operator()(const Case& resolved);

 private:
  static constexpr std::size_t most_discs = 1000000;  ///< of all that are kept

  std::mutex mutex_;
  std::map<std::string, Assembly> known_;  ///< by the tables of the case that decide it
  std::size_t discs_ = 0;
};

/// The assembly of a case, built or taken from SharedAssemblies.
/// \throws Error as build_assembly
Assembly assembly_of(const Case& resolved);

/// Assembly and springs of the case, without supports and loads.
/// \throws Error (bad_input) as build_assembly and build_springs; (computation_failed) where memory would not suffice
Problem problem_of(Case resolved, Purpose purpose = Purpose::factorize);

/// Refuses before anything is built what surely does not fit; nothing where the size of the assembly is not known yet.
/// \throws Error (computation_failed)
void require_memory_for(const Case& resolved, Purpose purpose);

/// Whether the case has supports or loads, those of a tension test among them.
bool acts(const Case& resolved);

/// Sets supports and loads: those of the case, or of its tension test.
/// \throws Error (bad_input) as tension_setup does
void add_actions(Problem& problem);

/// \throws Error (bad_input) as build_assembly and build_springs do; neither [test] nor anything that acts
Problem build_problem(Case resolved);

/// The largest change of a contact under normal forces.
struct LargestDeformation {
  double of_radii = 0;  ///< of the sum of its radii
  double radius = 0;    ///< m, the largest
};
LargestDeformation largest_deformation(const Assembly& assembly, const ContactSprings& springs,
                                       std::span<const ContactForce> forces);

/// One load case, solved and evaluated.
struct SolvedCase {
  std::string name;  ///< name of the load case, may be empty
  Equilibrium equilibrium;
  LargestDeformation deformation = {};
  std::optional<Tensor2> stress = {};  ///< Pa, of the assembly, not made symmetric
  double stress_scale = 0;             ///< Pa, of the terms that the stress is the sum of
  bool empty_cells = false;            ///< some disc has a cell without area, so that its stress is not known
  /// Pa: all moments that act on discs from outside (restrained rotation, supports, loads) over the area. It equals
  /// the asymmetry of the stress, xy - yx (Abe 1996, eq. 55).
  double moment_per_area = 0;
  std::optional<TensionResult> tension = {};
};
/// "solved"; "unstable" where the assembly is; "unjudged" where the solver cannot tell.
const char* status_of(std::optional<std::int64_t> unstable_modes);

SolvedCase solve_case(const Problem& problem, EquilibriumSolver& solver, const NamedLoads& loads);

/// The stability where the solver cannot judge it.
inline constexpr const char* stability_not_known =
    "NOT KNOWN: this solver does not count the negative pivots that would tell; method = \"auto\" does";

/// Keys of the assembly in the JSON.
enum class AssemblyKeys {
  size,  ///< title, discs, contacts
  all,   ///< also coordination_number, area, solid_fraction, kN, kT
};
/// Title, assembly, springs, effects.
Results problem_results(const Problem& problem, const Effects& effects, AssemblyKeys keys = AssemblyKeys::all);

/// Numbers of an assembly in a report.
struct AssemblySummary {
  std::string kind;
  std::int64_t discs = 0, contacts = 0;
  std::optional<double> area;  ///< m²; none: not known
  double solid_fraction = 0;   ///< where the area is known
  double mean_radius = 0;      ///< m
  double stiffest = 0;         ///< Pa: the largest spring
  GapRange gaps;
  bool periodic = false;
  bool contacts_found = false;  ///< by a tolerance
};
/// Gives the results from a summary. \param of_whole lines that need the whole assembly, after those of its area
Results problem_results(const Problem& problem, const AssemblySummary& summary, const Results& of_whole,
                        const Effects& effects, AssemblyKeys keys = AssemblyKeys::all);

/// The largest circle that no disc reaches into; nothing where there is none.
void add_largest_void(Results& results, const Assembly& assembly);

/// What takes memory beside one solution of K u = f.
struct MoreMemory {
  bool of_complex = false;             ///< factors of complex numbers follow, beside that of the others
  std::optional<double> inertia = {};  ///< L D L^T decides it, with so many vectors kept beside it
  double bytes_of_disc = 0;            ///< kept while it solves
  double bytes_of_picture = 0;         ///< drawn when the solver is there no longer
  int at_once = 1;                     ///< solutions beside each other
};
/// --dry-run: delivers the problem, further results, size, memory and work of a factorization.
void dry_run(const CommonOptions& options, const Problem& problem, const Results& further, AssemblyKeys keys,
             const MoreMemory& more = {});

/// K <= G/3, that is nu <= -1 in plane strain.
inline constexpr const char* no_solid = "no isotropic solid has these moduli: K <= G/3";

/// Two-dimensional moduli, with Poisson's ratio and Young's modulus in plane strain and in plane stress.
/// \param name of the line of the report
/// \param of_solid null in plane strain where no solid has these moduli
Results moduli_results(const EffectiveModuli& moduli, const std::string& name = "moduli", bool of_solid = false);

/// The problem with the decision whether the forces at rest count, as the case asks; where they do, its springs have
/// their geometric stiffness.
/// \throws Error (bad_input) as choose_prestress
Problem prestressed(Problem problem);

/// Forces of the contacts with those at rest, where these count. \param changes by the loads
std::vector<ContactForce> forces_in_total(const Assembly& assembly, const ContactSprings& springs,
                                          std::vector<ContactForce> changes);

}  // namespace equidem
