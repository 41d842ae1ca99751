// SPDX-License-Identifier: GPL-3.0-or-later
#include "problem.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/assembly/least_rectangle.hpp"
#include "equidem/assembly/power_cells.hpp"
#include "equidem/assembly/touching.hpp"
#include "equidem/assembly/voids.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/homogenize/viscoelastic_stiffness.hpp"
#include "equidem/linear/multigrid/multigrid_solver.hpp"
#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/solver_choice.hpp"

#include "case_text.hpp"

namespace equidem {
namespace {

/// Size of a generated assembly, about; no discs for one from a file.
struct ExpectedSize {
  double discs = 0, narrow_side = 0;  ///< the latter in discs
};
ExpectedSize expected_size(const AssemblyCase& assembly) {
  switch (assembly.kind) {
    case AssemblyKind::lattice: {
      const double columns = assembly.lattice.columns, rows = assembly.lattice.rows;
      return {columns * rows, std::min(columns, rows)};
    }
    case AssemblyKind::delaunay: {
      const auto discs = static_cast<double>(assembly.delaunay.discs);
      return {discs, std::sqrt(discs * std::min(assembly.delaunay.aspect, 1 / assembly.delaunay.aspect))};
    }
    case AssemblyKind::packing: {
      const auto discs = static_cast<double>(assembly.packing->radii.size());
      const Vec2 box = assembly.packing->box.size;
      const double aspect = box.y > 0 ? std::min(box.x / box.y, box.y / box.x) : 1;
      return {discs, std::sqrt(discs * aspect)};
    }
    case AssemblyKind::file:
      return {};
  }
  return {};
}

void add_left_out(Results& results, const LeftOut& left_out) {
  results.set("left_out", left_out.bodies);
  if (left_out.bodies.empty()) return;
  results.line("left out", joined(left_out.sentences, "; "));
  results.line("", "results number the others from 0 on");
}

/// Says by which tolerance contacts were found, and what a larger one would find.
void add_found_contacts(Results& results, const Assembly& assembly) {
  if (!assembly.gap_tolerance) return;
  results.line("").add("gap_tolerance", "contacts where the gap is at most", *assembly.gap_tolerance,
                       "of the sum of the radii");
  if (!assembly.sections.empty()) return;
  const std::string larger = suggested_tolerance(bond_counts(assembly), *assembly.gap_tolerance);
  if (!larger.empty()) results.note("; " + larger);
}

/// Warns of discs of a file that lie almost on each other, as rows that are there twice do.
void add_deep_overlap(Results& results, const Assembly& assembly) {
  constexpr double deep = 0.5, noticeable = 1e-6;  // of the smaller radius
  if (!assembly.sections.empty() || !assembly.gap_tolerance || assembly.kind != "file") return;
  const auto overlap_of = [&](const Contact& contact) {
    const double ri = assembly.radii[contact.i], rj = assembly.radii[contact.j];
    return (ri + rj - norm(assembly.branch(contact))) / std::min(ri, rj);
  };
  const auto deepest = std::ranges::max_element(assembly.contacts, {}, overlap_of);
  if (deepest == assembly.contacts.end()) return;
  const double overlap = overlap_of(*deepest);
  if (!(overlap > noticeable)) return;
  results.line("").note(fmt::format("overlap at most {:.3g} of the smaller radius", overlap));
  if (overlap <= deep) return;
  const auto count = std::ranges::count_if(assembly.contacts, [&](const Contact& c) { return overlap_of(c) > deep; });
  const auto place = [&](std::int32_t disc) {
    const Vec2 x = assembly.centres[static_cast<std::size_t>(disc)];
    return fmt::format("{} at ({:.6g}, {:.6g}) m", disc, x.x, x.y);
  };
  results.set("overlapping_discs",
              std::vector<double>{static_cast<double>(deepest->i), static_cast<double>(deepest->j)});
  results.line("warning", fmt::format("{} of discs overlap by more than half a radius, most of all discs {} and {}, "
                                      "counted from 0 in the order of their ids: one may be there twice, or the unit "
                                      "of the radii wrong",
                                      counted(count, "pair"), place(deepest->i), place(deepest->j)));
}

/// Says where contacts join discs that do not just touch, as edges of a triangulation do.
void add_gaps(Results& results, const AssemblySummary& assembly) {
  const GapRange& gaps = assembly.gaps;
  constexpr double noticeable = 0.01;
  results.set("largest_overlap", std::max(0.0, -gaps.smallest)).set("largest_gap", std::max(0.0, gaps.largest));
  if (assembly.contacts_found || (gaps.smallest > -noticeable && gaps.largest < noticeable)) return;
  // A given list whose numbers begin with 1 joins discs that lie anywhere; random triangulations have long edges too.
  constexpr double far_apart = 1;
  if (gaps.largest > far_apart && (assembly.kind == "file" || assembly.kind == "arrays"))
    results.warning("warning",
                    fmt::format("contacts join discs that are up to {} of the sum of their radii apart. Discs "
                                "are numbered from 0, or by the ids of their file: check that the contacts "
                                "are too.",
                                percent(gaps.largest)));
  results.line("");
  if (gaps.smallest > -noticeable) {
    results.note(fmt::format("contacts are bonds: their discs are up to {} of the sum of the radii apart",
                             percent(gaps.largest)));
    return;
  }
  results.note(
      fmt::format("contacts are bonds: their discs overlap by up to {} and are up to {} apart, of the sum of "
                  "their radii. For bodies that collide take an assembly of kind = \"packing\".",
                  percent(-gaps.smallest), percent(std::max(gaps.largest, 0.0))));
}

/// Questions springs that are softer than any solid, 1e4 Pa being a gel. Assemblies of large discs may have no units.
void question_springs(Results& results, double mean_radius, double largest) {
  constexpr double soft = 1e4, large = 0.1;  // Pa, m
  if (!(largest > 0 && largest < soft && mean_radius < large)) return;
  results.warning("", fmt::format("springs of {:.3g} Pa between discs of {:.3g} m are softer than any solid: moduli or "
                                  "springs may be in MPa or GPa where Pa are meant",
                                  largest, mean_radius));
}

/// The tables that decide the assembly, as text. Springs move bodies that fall.
std::string tables_of_assembly(const Case& resolved) {
  const auto& packing = resolved.assembly.packing;
  TomlValue document = deciding_tables(resolved.document, Decided::assembly);
  if (!packing || !entry_of(packing->method).open_top)
    std::erase_if(document.entries,
                  [](const auto& entry) { return entry.name == "springs" || entry.name == "material"; });
  return to_toml(std::move(document), {});
}

/// A free sample has the least rectangle that holds all discs as its region. A warning where discs that touch nothing
/// make it wider; empty: they do not.
std::string warning_of_wide_region(const Assembly& assembly) {
  constexpr double noticeable = 1e-6;
  if (assembly.periodic() || assembly.kind != "file" || assembly.cell_areas.empty()) return {};
  std::vector<char> touches(assembly.size(), 0);
  for (const Contact& contact : assembly.contacts) touches[contact.i] = touches[contact.j] = 1;
  std::vector<Vec2> centres;
  std::vector<double> radii;
  std::vector<std::size_t> loose;
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    if (touches[disc] == 0) {
      loose.push_back(disc);
      continue;
    }
    centres.push_back(assembly.centres[disc]);
    radii.push_back(assembly.radii[disc]);
  }
  if (loose.empty() || centres.size() < 2) return {};
  const double region = least_rectangle(assembly.centres, assembly.radii).area();
  const double share = region / least_rectangle(centres, radii).area() - 1;
  const bool is_given = std::abs(assembly.area() / region - 1) > noticeable;
  if (is_given || !(share > noticeable)) return {};
  Vec2 middle;
  for (const Vec2& centre : centres) middle += (1 / static_cast<double>(centres.size())) * centre;
  const std::size_t farthest =
      *std::ranges::max_element(loose, {}, [&](std::size_t disc) { return norm(assembly.centres[disc] - middle); });
  const Vec2 x = assembly.centres[farthest];
  return fmt::format(
      "{} without contacts, the farthest disc {} at ({:.6g}, {:.6g}) m, {} the region of the sample {} larger: "
      "stresses, moduli and solid fraction are means over it. Remove {}, or give the file a box.",
      counted(std::ssize(loose), "disc"), farthest, x.x, x.y, loose.size() == 1 ? "makes" : "make", percent(share),
      loose.size() == 1 ? "it" : "them");
}

AssemblySummary summary_of(const Assembly& a, const ContactSprings& springs) {
  AssemblySummary summary{.kind = a.kind,
                          .discs = std::ssize(a.centres),
                          .contacts = std::ssize(a.contacts),
                          .area = {},
                          .solid_fraction = 0,
                          .mean_radius = a.mean_radius(),
                          .stiffest = springs.largest(),
                          .gaps = gaps_at_contacts(a),
                          .periodic = a.periodic(),
                          .contacts_found = a.gap_tolerance.has_value()};
  if (!a.periodic() && a.cell_areas.empty()) return summary;
  summary.area = a.area();
  summary.solid_fraction = a.solid_fraction();
  return summary;
}

/// Reports what was decided on forces at rest, or that the verb takes none.
void add_prestress_decision(Results& results, const Problem& problem) {
  if (!problem.prestress) {
    if (carries_forces(problem.assembly))
      results.line("not used",
                   "forces at rest: solve, homogenize, stability, and quasistatic with frictional contacts, take them");
    return;
  }
  results.line("forces at rest", problem.prestress->sentence);
  results.set("prestress/counts", problem.prestress->springs.prestressed())
      .set("prestress/largest", problem.prestress->largest)
      .set("prestress/imbalance", problem.prestress->balance.relative);
}

std::atomic<SharedAssemblies*> shared_assemblies{nullptr};

}  // namespace

SharedAssemblies::SharedAssemblies() {
  shared_assemblies = this;
}

SharedAssemblies::~SharedAssemblies() {
  shared_assemblies = nullptr;
}

Assembly SharedAssemblies::operator()(const Case& resolved) {
  const std::string tables = tables_of_assembly(resolved);
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = known_.find(tables); found != known_.end()) return found->second;
  }
  Assembly assembly = build_assembly(resolved);
  const std::lock_guard lock(mutex_);
  if (discs_ + assembly.size() <= most_discs && known_.emplace(tables, assembly).second) discs_ += assembly.size();
  return assembly;
}

Assembly assembly_of(const Case& resolved) {
  SharedAssemblies* const shared = shared_assemblies;
  return shared != nullptr ? (*shared)(resolved) : build_assembly(resolved);
}

void require_memory_for(const Case& resolved, Purpose purpose) {
  // The factor of N discs, w across the narrow side, has about c N log2(w) bytes, with c = 520 on a hexagonal lattice
  // and 660 on Delaunay networks of 10⁵ to 10⁶ discs; half of what two unknowns a disc need is taken.
  const ExpectedSize size = expected_size(resolved.assembly);
  if (size.discs < 1) return;
  constexpr double factor = 100, loop = 450;  // bytes a disc
  const SolverMethod method = resolved.solver.method;
  const bool may_iterate = method == SolverMethod::multigrid || method == SolverMethod::automatic;
  const double of_factor = factor * std::log2(std::max(size.narrow_side, 1.0));
  const double of_grids = bytes_of_multigrid(1, 2);  // two contacts a disc: a square lattice
  const double beside = purpose != Purpose::factorize ? loop : may_iterate ? std::min(of_factor, of_grids) : of_factor;
  require_memory(
      bytes_of_network(size.discs) + size.discs * beside,
      fmt::format("{} of {} discs needs at least", purpose == Purpose::factorize ? "solving a network" : "a run",
                  grouped(static_cast<std::int64_t>(size.discs))));
}

Problem problem_of(Case resolved, Purpose purpose) {
  require_memory_for(resolved, purpose);
  StageTimes times;
  Stopwatch watch;
  Assembly assembly = assembly_of(resolved);
  if (resolved.assembly.kind == AssemblyKind::file) resolved.assembly.arrangement = lattice_of(assembly);
  times.add("assembly", watch.lap());
  stop_if_interrupted();
  BuiltSprings springs = build_springs(resolved, assembly);
  times.add("springs", watch.lap());
  stop_if_interrupted();
  Problem problem{std::move(resolved), std::move(assembly), std::move(springs), {}, {}, {}, std::move(times)};
  problem.wide_region = warning_of_wide_region(problem.assembly);
  return problem;
}

Assembly with_cells(Assembly assembly) {
  if (assembly.contacts.empty()) return assembly;
  Assembly measured = assembly;
  const auto refused = failure_of([&] { measure_cells(measured); });
  if (refused && refused->kind() != ErrorKind::bad_input && refused->kind() != ErrorKind::computation_failed)
    throw Error(*refused);
  return refused ? assembly : measured;
}

bool acts(const Case& resolved) {
  return resolved.test || !resolved.supports.empty() || !resolved.load_cases.front().loads.empty();
}

void add_actions(Problem& problem) {
  problem.supports = problem.resolved.supports;
  problem.load_cases = problem.resolved.load_cases;
  if (problem.resolved.test) {
    problem.tension = casefile::with_place(problem.resolved.where("test"),
                                           [&] { return tension_setup(problem.assembly, *problem.resolved.test); });
    problem.supports = problem.tension->supports;
    problem.load_cases = {{"", problem.tension->loads}};
  }
}

LargestDeformation largest_deformation(const Assembly& assembly, const ContactSprings& springs,
                                       std::span<const ContactForce> forces) {
  LargestDeformation largest;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const double kN = springs[c].kN;
    if (kN == 0) continue;
    const double radii = assembly.radii[contact.i] + assembly.radii[contact.j];
    largest.of_radii = std::max(largest.of_radii, std::abs(forces[c].normal / kN) / radii);
  }
  for (const double radius : assembly.radii) largest.radius = std::max(largest.radius, radius);
  return largest;
}

SolvedCase solve_case(const Problem& problem, EquilibriumSolver& solver, const NamedLoads& loads) {
  SolvedCase result{.name = loads.name, .equilibrium = solver.solve(loads.loads)};
  const Equilibrium& equilibrium = result.equilibrium;
  if (!problem.assembly.cell_areas.empty()) {
    const ScaledStress found = scaled_stress(problem.assembly, equilibrium.contact_forces);
    result.stress = found.stress;
    result.stress_scale = found.scale;
    result.moment_per_area = outer_moment(problem.assembly, loads.loads, equilibrium) / problem.assembly.area();
    result.empty_cells = !cells_hold_area(problem.assembly);
  }
  result.deformation = largest_deformation(problem.assembly, problem.springs.springs, equilibrium.contact_forces);
  if (problem.tension)
    result.tension = evaluate_tension(problem.assembly, problem.springs.springs, *problem.resolved.test,
                                      *problem.tension, equilibrium);
  return result;
}

void add_largest_void(Results& results, const Assembly& assembly) {
  const std::optional<EmptyCircle> found = largest_void(assembly);
  if (!found) return;
  const double relative = found->radius / assembly.mean_radius();
  results.line("largest void")
      .add("largest_void/radius", "radius", found->radius, "m", {.digits = 3})
      .add("largest_void/over_mean_radius", "", relative, "of the mean radius", {.digits = 3})
      .note(fmt::format(", at ({:.4g}, {:.4g}) m", found->centre.x, found->centre.y));
  results.set("largest_void/centre", found->centre);
  if (relative > 1) results.line("", "a hole that would hold another disc: moduli and speeds of such packings scatter");
}

const char* status_of(std::optional<std::int64_t> unstable_modes) {
  return !unstable_modes ? "unjudged" : *unstable_modes > 0 ? "unstable" : "solved";
}

Results problem_results(const Problem& problem, const Effects& effects, AssemblyKeys keys) {
  const Assembly& a = problem.assembly;
  Results of_whole;
  if (!a.periodic() && !a.cell_areas.empty() && !a.sections.empty() && a.box == least_rectangle(a.centres, a.radii)) {
    of_whole.line("",
                  "The area is that of the rectangle around the discs of equal area: the file gives no \"box\", and "
                  "the outlines of the bodies are not known.");
  }
  add_found_contacts(of_whole, a);
  add_deep_overlap(of_whole, a);
  constexpr std::size_t most_discs = 200000;  // beyond them the void costs as much as the solution
  if (problem.resolved.assembly.kind == AssemblyKind::packing && a.sections.empty() && a.size() <= most_discs)
    add_largest_void(of_whole, a);
  return problem_results(problem, summary_of(a, problem.springs.springs), of_whole, effects, keys);
}

Results problem_results(const Problem& problem, const AssemblySummary& a, const Results& of_whole,
                        const Effects& effects, AssemblyKeys keys) {
  const auto key = [&](const char* name) { return keys == AssemblyKeys::all ? name : ""; };
  Results results;
  results.set("title", problem.resolved.title);
  if (!problem.resolved.title.empty()) results.block(problem.resolved.title + "\n\n");
  const double coordination = a.discs == 0 ? 0 : 2 * static_cast<double>(a.contacts) / static_cast<double>(a.discs);
  results.line("assembly", a.kind)
      .add("discs", "", a.discs, "disc", {Shown::count})
      .add("contacts", "", a.contacts, "contact", {Shown::count})
      .add(key("coordination_number"), "z =", coordination, "", {.digits = 4});
  if (a.area) {
    results.line("")
        .add(key("area"), "area", *a.area, "m²")
        .add(key("solid_fraction"), "solid fraction", a.solid_fraction)
        .note(a.periodic ? ", periodic" : "");
  }
  if (a.area && a.solid_fraction > 1) {
    results.line("",
                 "The solid fraction exceeds 1, since discs overlap and each is counted whole: it is the sum of their "
                 "areas over the area, not the share that they cover.");
  }
  results.append(of_whole);
  add_gaps(results, a);
  add_left_out(results, problem.left_out);
  if (!problem.wide_region.empty()) results.warning("warning", problem.wide_region);
  const bool notched = !problem.resolved.notches.empty(), dead = !problem.resolved.dead_loads.empty();
  if ((notched || dead) && !problem.breaks) {
    results.line("not used", fmt::format("{}{}{}: quasistatic alone takes them", notched ? "[[notch]]" : "",
                                         notched && dead ? " and " : "", dead ? "[[dead_load]]" : ""));
  }
  results.line("springs", problem.springs.report);
  if (problem.resolved.viscoelastic)
    results.line("viscoelastic", describe(build_viscoelasticity(problem.resolved, problem.springs.constants)));
  add_prestress_decision(results, problem);
  question_springs(results, a.mean_radius, a.stiffest);
  if (problem.springs.constants && keys == AssemblyKeys::all)
    results.set("kN", problem.springs.constants->kN).set("kT", problem.springs.constants->kT);
  add_effects(results, effects);
  return results;
}

namespace {

/// \param resident bytes of the process before it solves
/// \param drawing further bytes while the state is drawn, when the solver is there no longer
/// \param memory_limit bytes; 0: what is available
Results estimate_results(const SolveEstimate& e, double resident, double drawing, double memory_limit) {
  Results results;
  results.line("unknowns").add("unknowns", "", e.unknowns, "", {Shown::count});
  results.line("memory")
      .add("peak_bytes", "", std::max(peak_resident_memory(), resident + std::max(e.peak_bytes, drawing)),
           "at the peak", {Shown::bytes})
      .add("solver_bytes", "", e.peak_bytes, "of it to solve", {Shown::bytes});
  if (e.factor_nonzeros > 0) {
    results.add("factor_bytes", "", e.factor_bytes, "of that for the factor", {Shown::bytes})
        .add("factor_nonzeros", "", e.factor_nonzeros, "entries in the factor", {.digits = 3});
  }
  try {
    check_memory(e, memory_limit);
    results.set("refusal", nullptr);
  } catch (const Error& error) {
    results.set("refusal", error.what()).line("", fmt::format("The computation would be refused: {}", error.what()));
  }
  if (e.factor_nonzeros > 0)
    results.line("work").add("operations", "", e.operations, "multiplications and additions to factorize",
                             {.digits = 3});
  results.line("method", to_string(e.method));
  results.set("method", to_string(e.method));
  return results.block("nothing was solved (--dry-run)\n");
}

}  // namespace

void dry_run(const CommonOptions& given, const Problem& problem, const Results& further, AssemblyKeys keys,
             const MoreMemory& more) {
  const double resident = resident_memory();
  const Effects effects = problem.effects();
  EquilibriumOptions options = problem.options();
  if (more.inertia) options.solver.method = SolverMethod::multifrontal;
  SolveEstimate estimate =
      estimate_solve(problem.assembly, problem.springs.springs, problem.supports, options, more.inertia.has_value());
  if (more.inertia) {
    const double vectors = sizeof(double) * *more.inertia * static_cast<double>(estimate.unknowns);
    estimate.peak_bytes = std::max(estimate.peak_bytes, estimate.factor_bytes + vectors);
  }
  // Forces, motions and histories of contacts that break: measured, with friction and without.
  constexpr double bytes_of_breaking_contact = 380;
  // UMFPACK's own order fills tangents of contacts with friction 1.15 to 1.45 times as much as K of a block.
  constexpr double more_fill = 1.3;
  if (problem.breaks && estimate.method == SolverMethod::umfpack) estimate.peak_bytes *= more_fill;
  if (problem.breaks)
    estimate.peak_bytes += bytes_of_breaking_contact * static_cast<double>(problem.assembly.contacts.size());
  estimate.peak_bytes *= more.at_once;
  estimate.peak_bytes += more.bytes_of_disc * static_cast<double>(problem.assembly.size());
  if (more.of_complex) {
    estimate.peak_bytes = std::max(
        estimate.peak_bytes,
        estimate.factor_bytes + estimate_viscoelastic(problem.assembly, problem.springs.springs, effects).peak_bytes);
  }
  // Motions, forces and stresses of the state that is drawn.
  constexpr double bytes_of_drawn_disc = 80, bytes_of_drawn_contact = 32;
  const double drawing = more.bytes_of_picture + bytes_of_drawn_disc * static_cast<double>(problem.assembly.size()) +
                         bytes_of_drawn_contact * static_cast<double>(problem.assembly.contacts.size());
  deliver(given, "dry_run",
          problem_results(problem, effects, keys)
              .append(further)
              .append(estimate_results(estimate, resident, drawing, problem.resolved.solver.memory_limit)),
          problem.times);
}

Results moduli_results(const EffectiveModuli& m, const std::string& name, bool of_solid) {
  Results results;
  results.line(name)
      .add("bulk_modulus_2d", "K =", m.bulk_modulus_2d, "Pa (two-dimensional bulk modulus)", {.digits = 9})
      .add("shear_modulus", "G =", m.shear_modulus, "Pa", {.digits = 9});
  if (of_solid && m.poisson_strain <= -1) {
    results.line("  plane strain", no_solid);
    results.set("poisson_ratio/plane_strain", nullptr).set("young_modulus/plane_strain", nullptr);
  } else {
    results.line("  plane strain")
        .add("poisson_ratio/plane_strain", "nu =", m.poisson_strain, "", {.digits = 9})
        .add("young_modulus/plane_strain", "E =", m.young_strain, "Pa", {.digits = 9});
  }
  results.line("  plane stress")
      .add("poisson_ratio/plane_stress", "nu =", m.poisson_stress, "", {.digits = 9})
      .add("young_modulus/plane_stress", "E =", m.young_stress, "Pa", {.digits = 9});
  return results;
}

namespace {

/// The sides and corners of a free assembly that were measured: those that its file does not give.
std::set<std::string> names_of_measured_sides(const Assembly& assembly) {
  std::set<std::string> names;
  if (assembly.periodic()) return names;
  for (const auto& [name, side] : measured_sides(assembly)) {
    const auto found = assembly.groups.find(name);
    if (found != assembly.groups.end() && found->second.discs == side.discs &&
        found->second.tributary_lengths == side.tributary_lengths)
      names.insert(name);
  }
  return names;
}

/// Holds bodies whose forces at rest do not balance: something outside loads them, which the case need not give.
void hold_loaded_at_rest(const Assembly& assembly, std::vector<std::uint8_t>& held) {
  const RestSums sums = sums_at_rest(assembly);
  for (std::size_t d = 0; d < held.size(); ++d)
    if (norm(sums.forces[d]) > largest_imbalance * sums.mean_force) held[d] = 1;
}

std::optional<PrestressedSprings> choice_for(const Problem& problem) {
  return casefile::with_place(problem.resolved.where("effects.prestress"), [&] {
    return choose_prestress(problem.assembly, problem.springs.springs, problem.resolved.prestress);
  });
}

/// 1 for the bodies with a support or load of their own; on a measured side for those with two contacts or more where
/// it is supported, with three where it is loaded, since fewer may roll.
/// \param all those on measured sides too, whatever contacts they have
std::vector<std::uint8_t> held_by_the_case(const Problem& problem, bool all = false) {
  const Assembly& assembly = problem.assembly;
  std::vector<int> contacts(assembly.size(), 0);
  for (const Contact& c : assembly.contacts)
    ++contacts[static_cast<std::size_t>(c.i)], ++contacts[static_cast<std::size_t>(c.j)];
  // Sides are measured only where one could matter.
  const bool dangling = !all && std::ranges::any_of(contacts, [](int count) { return count <= 2; });
  const std::set<std::string> sides = dangling ? names_of_measured_sides(assembly) : std::set<std::string>{};
  std::vector<std::uint8_t> held(assembly.size(), 0);
  const auto hold = [&](const std::string& name, int enough) {
    const auto found = assembly.groups.find(name);
    if (found == assembly.groups.end()) return;
    for (const std::int32_t disc : found->second.discs) {
      const auto k = static_cast<std::size_t>(disc);
      if (contacts[k] >= enough || !sides.contains(name)) held[k] = 1;
    }
  };
  for (const Support& support : problem.resolved.supports) hold(support.group, 2);
  for (const NamedLoads& loads : problem.resolved.load_cases)
    for (const Load& load : loads.loads) hold(load.group, 3);
  if (!carries_forces(assembly)) return held;
  if (const auto choice = choice_for(problem); choice && choice->springs.prestressed())
    hold_loaded_at_rest(assembly, held);
  return held;
}

/// Whether no body is left of those that the case loads.
bool loses_its_loads(const Problem& problem, const LoadBearingNetwork& network) {
  if (!network.part) return false;
  std::set<std::int32_t> loaded;
  for (const NamedLoads& loads : problem.resolved.load_cases)
    for (const Load& load : loads.loads)
      if (const auto found = problem.assembly.groups.find(load.group); found != problem.assembly.groups.end())
        loaded.insert(found->second.discs.begin(), found->second.discs.end());
  return !loaded.empty() &&
         std::ranges::none_of(network.part->discs, [&](std::int32_t disc) { return loaded.contains(disc); });
}

/// Leaves out of a packing, or of an assembly from a file, the bodies that no contact holds in place (LeaveOut::loose)
/// and that have no support or load of their own; on a side of the assembly they are left out even so. The cells and
/// sides of the rest are measured again. Bodies and contacts are then numbered anew.
void leave_out_loose(Problem& problem) {
  const AssemblyKind kind = problem.resolved.assembly.kind;
  if (kind != AssemblyKind::packing && kind != AssemblyKind::file) return;
  Assembly& assembly = problem.assembly;
  const Effects effects = problem.effects();
  LoadBearingNetwork network =
      load_bearing_network(assembly, problem.springs.springs, effects, held_by_the_case(problem), LeaveOut::loose);
  const auto none_left = [&] { return network.part && network.part->discs.empty(); };
  if (none_left() || loses_its_loads(problem, network)) {  // a row: its ends are what the case holds and loads
    network = load_bearing_network(assembly, problem.springs.springs, effects, held_by_the_case(problem, true),
                                   LeaveOut::loose);
  }
  if (!network.part) return;
  if (none_left())
    bad_input_at(problem.resolved.where("assembly"), "no body is held in place by the others and by supports",
                 joined(network.sentences, "; "),
                 "Hold or load bodies by a [[group]] of their own, take a larger gap_tolerance, or pack them denser");
  std::vector<std::uint8_t> kept(assembly.size(), 0);
  for (const std::int32_t disc : network.part->discs) kept[static_cast<std::size_t>(disc)] = 1;
  for (std::size_t disc = 0; disc < kept.size(); ++disc)
    if (!kept[disc]) problem.left_out.bodies.push_back(static_cast<std::int64_t>(disc));
  problem.left_out.sentences = std::move(network.sentences);
  if (Case& resolved = problem.resolved; resolved.material && resolved.assembly.body == Body::disc) {
    // The solid fraction, by which the density of the continuum gives that of the discs, is that of all of them.
    resolved.assembly.density = disc_density(resolved, assembly);
    resolved.material->given.density.reset();
  }
  const std::set<std::string> sides = names_of_measured_sides(assembly);
  Assembly rest = std::move(network.part->assembly);
  std::erase_if(rest.groups, [&](const auto& group) { return sides.contains(group.first); });
  measure_cells(rest);
  problem.springs.springs = std::move(network.part->springs);
  assembly = std::move(rest);
}

}  // namespace

Problem build_problem(Case resolved) {
  if (!acts(resolved)) {
    bad_input_at(resolved.document.where(), "nothing pulls or holds the assembly", "it would stay as it is",
                 "Add [test], or [[support]] and [[load]]");
  }
  Problem problem = problem_of(std::move(resolved));
  leave_out_loose(problem);
  add_actions(problem);
  return problem;
}

std::vector<ContactForce> forces_in_total(const Assembly& assembly, const ContactSprings& springs,
                                          std::vector<ContactForce> changes) {
  for (std::size_t c = 0; springs.prestressed() && c < changes.size(); ++c) {
    const ContactForce at_rest = force_at_rest(assembly, c);
    changes[c].normal += at_rest.normal;
    changes[c].tangential += at_rest.tangential;
  }
  return changes;
}

Problem prestressed(Problem problem) {
  problem.prestress = choice_for(problem);
  if (problem.prestress) problem.springs.springs = problem.prestress->springs;
  return problem;
}

}  // namespace equidem
