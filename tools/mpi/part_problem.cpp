// SPDX-License-Identifier: GPL-3.0-or-later
#include "part_problem.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/statics/number_unknowns.hpp"
#include "equidem/statics/rigidity.hpp"

namespace equidem {
namespace {

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
    whole.problem.emplace(homogenize ? problem_of(std::move(resolved)) : build_problem(std::move(resolved)));
    const Problem& problem = *whole.problem;
    refuse_prestress(problem, "equidem-mpi");
    whole.effects = derive_effects(problem.assembly, problem.springs.springs, problem.resolved.rotation);
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

Problem empty_problem(Case resolved) {
  return {std::move(resolved), {}, {ContactSprings(SpringConstants{}), {}, ""}, {}, {}, {}, {}};
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

}  // namespace

PartProblem::PartProblem(Case resolved) : problem(empty_problem(std::move(resolved))) {}

std::unique_ptr<PartProblem> build_part_problem(const Ranks& ranks, const CommonOptions& options, bool homogenize) {
  std::unique_ptr<PartProblem> made;
  ranks.together([&] {
    if (options.dry_run)
      bad_input("equidem-mpi has no --dry-run", "what it takes is planned by hand",
                "See data/petsc.md, or leave it out");
    Case resolved = read_case(options);
    check_viscoelastic(resolved, "equidem-mpi");
    check_taken(resolved, "equidem-mpi");
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

}  // namespace equidem
