// SPDX-License-Identifier: GPL-3.0-or-later
#include "parallel_verbs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <sys/resource.h>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/bounds.hpp"
#include "equidem/output/files/vtk.hpp"
#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/statics/number_unknowns.hpp"
#include "equidem/statics/rigidity.hpp"

#include "command.hpp"
#include "homogenize/homogenize.hpp"
#include "petsc/statics.hpp"
#include "problem.hpp"
#include "solve/solve.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

Problem empty_problem(Case resolved) {
  return {std::move(resolved), {}, {ContactSprings(SpringConstants{}), {}, ""}, {}, {}, {}, {}};
}

/// The case on one rank. Parts refer to one another: it does not move.
struct PartProblem {
  explicit PartProblem(Case resolved) : problem(empty_problem(std::move(resolved))) {}
  PartProblem(const PartProblem&) = delete;
  PartProblem& operator=(const PartProblem&) = delete;

  Problem problem;  ///< its assembly is empty
  petsc::Part part;
  petsc::Whole whole;
  Effects effects;
  std::optional<RowLattice> lattice;  ///< of which the part is a block
  bool scattered = false;             ///< rank 0 has read or packed the whole assembly
  Results of_problem;                 ///< of a scattered assembly, on rank 0
  std::vector<std::int64_t> held;     ///< of homogenize: components that stop free motions, as Network::hold
  std::int64_t gears = 0, removed = 0, rattlers = 0;  ///< of homogenize of a scattered assembly
  std::vector<std::string> left_out;                  ///< likewise: sentences
};

using petsc::Part;
using petsc::Ranks;

void check_case(const Case& resolved, bool homogenize) {
  if (homogenize && resolved.ensemble) {
    bad_input_at(resolved.where("ensemble"), "the case has an ensemble", "equidem-mpi homogenizes one cell",
                 "Take [ensemble] out (--set ensemble=none), or use 'equidem homogenize'");
  }
  const auto& boundary = resolved.homogenize.boundary;
  if (homogenize && boundary && *boundary != Boundary::periodic) {
    bad_input_at(resolved.where("homogenize.boundary"), fmt::format("the boundary is \"{}\"", to_string(*boundary)),
                 "equidem-mpi homogenizes periodic cells", "Leave it out, or use 'equidem homogenize'");
  }
  if (homogenize || acts(resolved)) return;
  bad_input_at(resolved.document.where(), "nothing pulls or holds the assembly", "it would stay as it is",
               "Add [test], or [[support]] and [[load]]");
}

/// The groups of the case: discs by their names, or in a box.
void add_groups(Part& part, const Case& resolved) {
  for (std::size_t k = 0; k < resolved.groups.size(); ++k) {
    const GroupCase& wanted = resolved.groups[k];
    if (part.assembly.groups.contains(wanted.name))
      bad_input_at(resolved.where(fmt::format("group.{}.name", k)),
                   fmt::format("the assembly has a group '{}' of its own", wanted.name), "a name means one group",
                   "Choose another name");
    if (wanted.share)
      bad_input_at(resolved.where(fmt::format("group.{}.share", k)),
                   fmt::format("group '{}' is a share of all discs", wanted.name),
                   "it is drawn from the whole assembly, of which a rank holds a part",
                   "Write the assembly into a file ('equidem solve' with output.assembly), and solve that");
    std::vector<std::int64_t> names(wanted.discs.begin(), wanted.discs.end());
    std::ranges::sort(names);
    DiscGroup& group = part.assembly.groups[wanted.name];
    for (std::int32_t d = 0; d < part.owned; ++d) {
      const Vec2 x = part.assembly.centres[static_cast<std::size_t>(d)];
      const bool inside = wanted.box ? x.x >= wanted.box->low.x && x.x <= wanted.box->high.x &&
                                           x.y >= wanted.box->low.y && x.y <= wanted.box->high.y
                                     : std::ranges::binary_search(names, part.names[static_cast<std::size_t>(d)]);
      if (inside) group.discs.push_back(d);
    }
  }
}

void check_groups(const PartProblem& p) {
  const Case& resolved = p.problem.resolved;
  for (std::size_t k = 0; k < resolved.groups.size(); ++k) {
    const GroupCase& wanted = resolved.groups[k];
    if (!wanted.box && !wanted.discs.empty()) {
      const std::int32_t last = *std::ranges::max_element(wanted.discs);
      if (last >= p.whole.discs)
        bad_input_at(resolved.where(fmt::format("group.{}.discs", k)),
                     fmt::format("group '{}' names disc {}", wanted.name, last),
                     fmt::format("the assembly has {}, numbered from 0", counted(p.whole.discs, "disc")),
                     "Correct the list");
    }
    if (p.whole.groups.at(wanted.name) == 0)
      bad_input_at(resolved.where(fmt::format("group.{}.{}", k, wanted.box ? "box" : "discs")),
                   fmt::format("group '{}' holds no disc", wanted.name), "no centre lies in its box",
                   "Choose another box");
  }
}

/// Springs of the part. Measures of the whole decide what moduli mean; what needs all contacts of a disc is refused.
BuiltSprings springs_of(const PartProblem& p) {
  Case resolved = p.problem.resolved;
  if (resolved.weighting == SpringWeighting::contact_density ||
      resolved.weighting == SpringWeighting::local_contact_density) {
    bad_input_at(resolved.where("springs.weighting"),
                 fmt::format("the weighting is \"{}\"", to_string(resolved.weighting)),
                 "it needs the contacts of the whole assembly, of which a rank holds a part",
                 "Write the assembly into a file ('equidem solve' with output.assembly), and solve that");
  }
  if (!resolved.material || p.lattice) return build_springs(resolved, p.part.assembly);
  const MaterialCase& material = *resolved.material;
  const bool voronoi = resolved.weighting == SpringWeighting::voronoi;
  const double z = 2 * static_cast<double>(p.whole.contacts) / static_cast<double>(p.whole.discs);
  const IsotropicMeasures measures =
      voronoi ? IsotropicMeasures{0.5, 1.0} : IsotropicMeasures{p.whole.solid_fraction, z / (2 * std::numbers::pi)};
  resolved.springs = casefile::with_place(resolved.where("material"), [&] {
    return springs_for(material.moduli, isotropic_relation, measures,
                       material.static_only ? NegativeTangential::static_only : NegativeTangential::refuse);
  });
  resolved.material.reset();
  BuiltSprings built = build_springs(resolved, p.part.assembly);
  built.report = fmt::format("G = {:.6g} Pa, nu = {:.6g} (plane {}) gives {}", material.moduli.shear_modulus,
                             material.moduli.poisson_ratio, to_string(material.moduli.plane), built.report);
  return built;
}

/// The whole assembly on rank 0, until it is given out.
struct WholeProblem {
  std::optional<Problem> problem;
  Effects effects;
  LoadBearingNetwork bearing;

  [[nodiscard]] const Assembly& assembly() const { return bearing.part ? bearing.part->assembly : problem->assembly; }
  [[nodiscard]] const ContactSprings& springs() const {
    return bearing.part ? bearing.part->springs : problem->springs.springs;
  }
};

void check_whole(WholeProblem& whole) {
  const Problem& problem = *whole.problem;
  const Assembly& assembly = problem.assembly;
  const DegreesOfFreedom unknowns = number_unknowns(assembly, problem.springs.springs, whole.effects, problem.supports);
  check_rigidity(assembly, ContactGraph(assembly), problem.springs.springs, unknowns);
}

/// Leaves out what carries no load, and finds the motions to hold.
void prune_whole(WholeProblem& whole, PartProblem& p) {
  const Problem& problem = *whole.problem;
  if (!problem.assembly.periodic()) {
    bad_input("the assembly is not periodic", "equidem-mpi homogenizes periodic cells",
              "Use 'equidem homogenize' for free samples");
  }
  whole.bearing = load_bearing_network(problem.assembly, problem.springs.springs, whole.effects, {});
  const LoadBearingNetwork& bearing = whole.bearing;
  if (bearing.spanned != 2 || bearing.pieces == 0) {
    bad_input("the network does not span the cell in both directions",
              bearing.sentences.empty() ? "some mean strain costs it no energy" : joined(bearing.sentences, "; "),
              "It has no modulus. Add contacts, or pack the discs more densely");
  }
  DegreesOfFreedom unknowns = number_unknowns(whole.assembly(), whole.springs(), whole.effects, {});
  const HeldMotions held =
      hold_free_motions(whole.assembly(), ContactGraph(whole.assembly()), whole.springs(), unknowns);
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  for (const std::size_t component : held.components)
    p.held.push_back(static_cast<std::int64_t>(3 * (component / b) + component % b));
  p.gears = std::ssize(held.gears);
  p.removed = bearing.removed();
  p.rattlers = bearing.rattlers;
  p.left_out = bearing.sentences;
}

/// An assembly that rank 0 reads or packs, with the checks of the serial verb on the whole of it.
/// \throws Error on all ranks
void scatter_problem(const Ranks& ranks, PartProblem& p, bool homogenize) {
  WholeProblem whole;
  p.scattered = true;
  ranks.together([&] {
    if (!ranks.first()) return;
    Case resolved = p.problem.resolved;
    whole.problem.emplace(
        prestressed(homogenize ? problem_of(std::move(resolved)) : build_problem(std::move(resolved))));
    const Problem& problem = *whole.problem;
    whole.effects = problem.effects();
    p.of_problem = problem_results(problem, whole.effects);
    p.problem.tension = problem.tension;
    if (homogenize) {
      prune_whole(whole, p);
    } else {
      check_whole(whole);
    }
    p.problem.springs.constants = problem.springs.constants;
    p.problem.springs.report = problem.springs.report;
  });
  p.held = ranks.joined(p.held);
  petsc::ScatteredPart scattered = petsc::scattered_part(ranks, ranks.first() ? &whole.assembly() : nullptr,
                                                         ranks.first() ? &whole.springs() : nullptr);
  p.part = std::move(scattered.part);
  p.problem.springs.springs = std::move(*scattered.springs);
  // The gauges that rank 0 has placed.
  if (!p.problem.resolved.test || homogenize) return;
  std::vector<std::int64_t> gauges;
  double height = 0;
  if (ranks.first()) {
    const TensionSetup& setup = *p.problem.tension;
    gauges = {setup.horizontal.first, setup.horizontal.second, setup.vertical.first, setup.vertical.second};
    height = setup.height;
  }
  gauges = ranks.joined(gauges);
  height = ranks.sum(height);
  TensionSetup setup = tension_loads(*p.problem.resolved.test, height, height);
  const auto gauge = [&](std::size_t k) {
    return StrainGauge{static_cast<std::int32_t>(gauges[k]), static_cast<std::int32_t>(gauges[k + 1])};
  };
  setup.horizontal = gauge(0);
  setup.vertical = gauge(2);
  p.problem.tension = setup;
}

void make_part(const Ranks& ranks, PartProblem& p, bool homogenize) {
  const AssemblyCase& wanted = p.problem.resolved.assembly;
  const std::string where = p.problem.resolved.where("assembly");
  switch (wanted.kind) {
    case AssemblyKind::lattice:
      ranks.together([&] {
        if (wanted.arrangement->rows == nullptr) {
          bad_input_at(where,
                       fmt::format("equidem-mpi does not make the lattice \"{}\" in parts", wanted.arrangement->name),
                       "its file gives no rows", "Write the assembly into a file, and solve that");
        }
        p.lattice.emplace(wanted.lattice, wanted.arrangement->rows(wanted.lattice.radius));
        p.part = casefile::with_place(where, [&] { return petsc::lattice_part(ranks, *p.lattice); });
      });
      break;
    case AssemblyKind::delaunay:
      p.part = casefile::with_place(where, [&] { return petsc::delaunay_part(ranks, wanted.delaunay); });
      break;
    case AssemblyKind::packing:
    case AssemblyKind::file:
      scatter_problem(ranks, p, homogenize);
      break;
  }
}

/// Makes the part of this rank: of a lattice a block, of a triangulation a strip; an assembly that is read or packed
/// comes from rank 0.
/// \throws Error on all ranks
std::unique_ptr<PartProblem> build_part_problem(const Ranks& ranks, const CommonOptions& options, bool homogenize) {
  std::unique_ptr<PartProblem> made;
  ranks.together([&] {
    if (options.dry_run)
      bad_input("equidem-mpi has no --dry-run", "what it takes is planned by hand",
                "See data/petsc.md, or leave it out");
    Case resolved = read_case(options);
    check_taken(resolved, "equidem-mpi", {.prestress = true, .bending = true});
    made = std::make_unique<PartProblem>(std::move(resolved));
    check_case(made->problem.resolved, homogenize);
  });
  PartProblem& p = *made;
  Stopwatch watch;
  make_part(ranks, p, homogenize);
  if (!p.scattered) ranks.together([&] { add_groups(p.part, p.problem.resolved); });
  p.whole = petsc::whole_of(ranks, p.part);
  if (!p.scattered) {
    ranks.together([&] {
      check_groups(p);
      p.problem.springs = springs_of(p);
    });
  }
  p.effects = petsc::effects_of(ranks, p.part, p.problem.springs.springs, p.problem.resolved.rotation);
  if (homogenize && !p.scattered) {
    p.held = petsc::free_components(p.part, p.effects);
    p.gears = std::ssize(p.held) - 2;
  }
  p.problem.supports = p.problem.resolved.supports;
  p.problem.load_cases = p.problem.resolved.load_cases;
  if (!homogenize && p.problem.resolved.test) {
    const RowLattice* const lattice = p.lattice ? &*p.lattice : nullptr;
    if (!p.scattered) {
      p.problem.tension = casefile::with_place(p.problem.resolved.where("test"), [&] {
        return petsc::tension_setup(ranks, p.part, p.whole, *p.problem.resolved.test, lattice);
      });
    }
    p.problem.supports = p.problem.tension->supports;
    p.problem.load_cases = {{"", p.problem.tension->loads}};
  }
  p.problem.times.add("assembly", watch.lap());
  return made;
}

/// Title, assembly, springs, effects; all ranks call it.
Results part_problem_results(const Ranks& ranks, const PartProblem& p) {
  if (p.scattered) return p.of_problem;
  const GapRange gaps = gaps_at_contacts(p.part.assembly);
  const bool known = p.whole.area > 0;
  const AssemblySummary summary{.kind = p.part.assembly.kind,
                                .discs = p.whole.discs,
                                .contacts = p.whole.contacts,
                                .area = known ? std::optional(p.whole.area) : std::nullopt,
                                .solid_fraction = p.whole.solid_fraction,
                                .mean_radius = p.whole.mean_radius,
                                .stiffest = ranks.largest(p.problem.springs.springs.largest()),
                                .gaps = {ranks.smallest(gaps.smallest), ranks.largest(gaps.largest)},
                                .periodic = p.part.assembly.periodic()};
  return problem_results(p.problem, summary, {}, p.effects);
}

/// Whether every disc that the rank owns has a cell of some area.
bool cells_are_known(const petsc::Part& part) {
  const auto& areas = part.assembly.cell_areas;
  return static_cast<std::int64_t>(areas.size()) >= part.owned &&
         std::all_of(areas.begin(), areas.begin() + part.owned, [](double area) { return area > 0; });
}

/// NAME_discs_K.vtp and NAME_contacts_K.vtp of rank K, by rank 0 also NAME.vtm.
/// \param motions per disc of the part
void write_part_files(const CommonOptions& options, const std::string& name, const petsc::Ranks& ranks,
                      const petsc::Part& part, const ContactSprings& springs, std::span<const DiscMotion> motions,
                      std::span<const ContactForce> forces) {
  const std::vector<ContactForce> total = forces_in_total(part.assembly, springs, {forces.begin(), forces.end()});
  const AssemblyState state{.assembly = part.assembly, .motions = motions, .contact_forces = total};
  const std::span<const std::int64_t> numbers(part.names.data(), static_cast<std::size_t>(part.owned));
  write_vtk_piece(*options.out, name, ranks.rank(), state, numbers, options.overwrite);
  if (ranks.first()) write_vtk_index(*options.out, name, ranks.count(), options.overwrite);
}

std::string suffix_of_case(const std::string& load_case) {
  return load_case.empty() ? "" : "_" + load_case;
}

SolvedCase evaluated(const petsc::Ranks& ranks, const PartProblem& p, const petsc::Network& network,
                     const std::string& name, const petsc::PartEquilibrium& solved) {
  SolvedCase result{.name = name, .equilibrium = solved.state};
  result.deformation = {solved.largest_deformation, p.whole.largest_radius};
  if (p.whole.area > 0) {
    result.stress = solved.stress;
    result.stress_scale = solved.stress_scale;
    result.moment_per_area = solved.moment_per_area;
    result.empty_cells = ranks.any(!cells_are_known(p.part));
  }
  if (p.problem.tension)
    result.tension = petsc::evaluate_tension(network, *p.problem.resolved.test, *p.problem.tension, solved);
  return result;
}

/// Checks that the files of the states can be written, and keeps others from the folder.
std::unique_ptr<FolderLock> lock_files(const petsc::Ranks& ranks, const CommonOptions& options,
                                       const std::vector<std::string>& states) {
  std::unique_ptr<FolderLock> lock;
  ranks.together([&] {
    if (!ranks.first()) return;
    OutputPart files{"the states", {}, OutputPart::folder, {"case.toml"}};
    for (const std::string& state : states) {
      files.files.push_back(state + ".vtm");
      for (int rank = 0; rank < ranks.count(); ++rank)
        std::ranges::move(vtk_piece_names(state, rank), std::back_inserter(files.files));
    }
    expect_results(options, {files});
    if (options.out) lock = std::make_unique<FolderLock>(*options.out);
  });
  return lock;
}

/// Memory of this process at its peak.
double peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

/// The ranks: their number, discs, memory, messages of an exchange and in all since `before`.
Results rank_results(const petsc::Ranks& ranks, const petsc::Network& network, const petsc::Counted& before) {
  const petsc::Counted after = petsc::counted_messages();
  const double peak = ranks.largest(peak_bytes());
  const double messages = ranks.largest(after.messages - before.messages);
  const double bytes = ranks.largest(after.bytes - before.bytes);
  const double sums = ranks.largest(after.sums - before.sums);
  const double exchanged = ranks.largest(network.halo.bytes()) * static_cast<double>(network.block());
  const auto neighbours = static_cast<std::int64_t>(ranks.largest(network.halo.neighbours()));
  Results out;
  out.line("ranks")
      .add("ranks", "", ranks.count(), "rank", {Shown::count})
      .note("; on the one with most ")
      .add("discs_of_a_rank", "", network.whole.owned, "disc", {Shown::count})
      .add("ghosts_of_a_rank", "", network.whole.ghosts, "ghost", {Shown::count})
      .add("peak_bytes", "", peak, "at the peak", {Shown::bytes});
  out.line("messages")
      .add("neighbours", "", neighbours, "neighbour", {Shown::count})
      .add("exchange_bytes", "", exchanged, "to send for one value of each unknown", {Shown::bytes})
      .note("; in all ")
      .add("messages", "", static_cast<std::int64_t>(messages), "message", {Shown::count})
      .add("message_bytes", "of", bytes, "", {Shown::bytes})
      .add("sums_over_ranks", "", static_cast<std::int64_t>(sums), "sum", {Shown::count})
      .note(" over all ranks");
  return out;
}

void deliver_of_ranks(const petsc::Ranks& ranks, const CommonOptions& options, const PartProblem& p,
                      const std::string& status, Results all, StageTimes times) {
  if (!ranks.first()) return;
  deliver(options, status, std::move(all), std::move(times),
          {{"case.toml", [&](const CommonOptions& into) { write_case(into, p.problem.resolved); }}});
}

void solve(const petsc::Ranks& ranks, const CommonOptions& options) {
  const petsc::Counted before = petsc::counted_messages();
  const auto made = build_part_problem(ranks, options, false);
  const PartProblem& p = *made;
  std::vector<std::string> states;
  for (const NamedLoads& loads : p.problem.load_cases) states.push_back("state" + suffix_of_case(loads.name));
  const auto lock = lock_files(ranks, options, states);
  const petsc::Network network(ranks, p.part, p.whole, p.problem.springs.springs, p.effects, p.problem.supports);
  if (!p.scattered) petsc::check_held(network);
  StageTimes times = p.problem.times;
  petsc::PetscSolver solver(network, p.problem.resolved.solver.method, times);
  std::vector<SolvedCase> results;
  for (std::size_t k = 0; k < states.size(); ++k) {
    const NamedLoads& loads = p.problem.load_cases[k];
    const petsc::PartEquilibrium solved = petsc::solve_loads(network, solver, loads.loads);
    results.push_back(evaluated(ranks, p, network, loads.name, solved));
    times.add(solved.state.times);
    if (!options.out) continue;
    ranks.together([&] {
      write_part_files(options, states[k], ranks, p.part, p.problem.springs.springs, solved.state.motions,
                       solved.state.contact_forces);
    });
  }
  Results all = solve_results(p.problem, part_problem_results(ranks, p), results);
  all.append(rank_results(ranks, network, before));
  deliver_of_ranks(ranks, options, p, status_of(results.front().equilibrium.unstable_modes), std::move(all),
                   std::move(times));
}

constexpr std::array strain_states{"state_strain_xx", "state_strain_yy", "state_strain_xy"};
constexpr double strain_of_states = 1e-3;

/// The sum over the contacts of all ranks; the area is that of the period.
Matrix3 voigt_of_all(const petsc::Ranks& ranks, const PartProblem& p) {
  Matrix3 stiffness = voigt_stiffness(p.part.assembly, p.problem.springs.springs);
  for (auto& row : stiffness) ranks.sum(row);
  return stiffness;
}

/// Moduli by the relation of Abe (1996), where the springs stand for an isotropic continuum.
std::optional<RelationBeside> relation_of_all(const PartProblem& p) {
  const auto& constants = p.problem.springs.constants;
  if (!constants || !p.lattice) return {};
  return relation_beside(*constants, spring_relation(p.problem.resolved, p.part.assembly));
}

void write_strained(const petsc::Ranks& ranks, const CommonOptions& options, const PartProblem& p,
                    const EffectiveStiffness& result) {
  ranks.together([&] {
    const std::vector<StrainedState> states =
        strained_states(p.part.assembly, p.problem.springs.springs, result, strain_of_states);
    for (std::size_t k = 0; k < states.size(); ++k) {
      std::vector<DiscMotion> motions = states[k].fluctuations;
      for (std::size_t d = 0; d < motions.size(); ++d) motions[d].u += states[k].gradient * p.part.assembly.centres[d];
      write_part_files(options, strain_states[k], ranks, p.part, p.problem.springs.springs, motions, states[k].forces);
    }
  });
}

void homogenize(const petsc::Ranks& ranks, const CommonOptions& options) {
  const petsc::Counted before = petsc::counted_messages();
  const auto made = build_part_problem(ranks, options, true);
  const PartProblem& p = *made;
  const auto lock = lock_files(ranks, options, {strain_states.begin(), strain_states.end()});
  petsc::Network network(ranks, p.part, p.whole, p.problem.springs.springs, p.effects, {});
  network.hold(p.held);
  StageTimes times = p.problem.times;
  petsc::PetscSolver solver(network, p.problem.resolved.solver.method, times);
  BoundedStiffness homogenized{petsc::cell_stiffness(network, solver), {}};
  EffectiveStiffness& result = homogenized.result;
  if (options.out) write_strained(ranks, options, p, result);
  result.gear_modes = p.gears;
  result.discs_removed = p.removed;
  result.rattlers = p.rattlers;
  result.removed = p.left_out;
  // Voigt's stiffness of the springs alone is no bound where forces at rest count.
  if (!result.effects.prestress) homogenized.beside.push_back({"voigt", voigt_of_all(ranks, p), {}});
  times.add(result.times);
  Results all = homogenized_results(p.problem, part_problem_results(ranks, p), p.part.assembly.periodic(), homogenized,
                                    {}, relation_of_all(p));
  all.set("strain_of_states", strain_of_states);
  all.append(rank_results(ranks, network, before));
  deliver_of_ranks(ranks, options, p, status_of(result.unstable_modes), std::move(all), std::move(times));
}

template <void (*verb)(const petsc::Ranks&, const CommonOptions&)>
Run declare_on_all_ranks(CLI::App& command) {
  const auto options = std::make_shared<CommonOptions>();
  add_common_options(command, *options);
  add_require_stable(command, *options);
  return on_all_ranks([options](const petsc::Ranks& ranks) { verb(ranks, *options); });
}

}  // namespace

Run declare_parallel_solve(CLI::App& command) {
  return declare_on_all_ranks<solve>(command);
}
Run declare_parallel_homogenize(CLI::App& command) {
  return declare_on_all_ranks<homogenize>(command);
}

}  // namespace equidem
