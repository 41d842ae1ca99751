// SPDX-License-Identifier: GPL-3.0-or-later
#include "part_problem.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <sys/resource.h>

#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/vtk.hpp"

#include "petsc/stiffness.hpp"

namespace equidem {
namespace {

using petsc::Part;
using petsc::Ranks;

/// Memory of this process at its peak.
double peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

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
  try {
    resolved.springs = springs_for(material.moduli, isotropic_relation, measures,
                                   material.static_only ? NegativeTangential::static_only : NegativeTangential::refuse);
  } catch (const Error& error) {
    throw error.at(resolved.where("material"));
  }
  resolved.material.reset();
  BuiltSprings built = build_springs(resolved, p.part.assembly);
  built.report = fmt::format("G = {:.6g} Pa, nu = {:.6g} (plane {}) gives {}", material.moduli.shear_modulus,
                             material.moduli.poisson_ratio, to_string(material.moduli.plane), built.report);
  return built;
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
        try {
          p.lattice.emplace(wanted.lattice, wanted.arrangement->rows(wanted.lattice.radius));
          p.part = petsc::lattice_part(ranks, *p.lattice);
        } catch (const Error& error) {
          throw error.at(where);
        }
      });
      break;
    case AssemblyKind::delaunay:
      try {
        p.part = petsc::delaunay_part(ranks, wanted.delaunay);
      } catch (const Error& error) {
        throw error.at(where);
      }
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
    try {
      if (!p.scattered) {
        p.problem.tension =
            petsc::tension_setup(ranks, p.part, p.whole, *p.problem.resolved.test, p.lattice ? &*p.lattice : nullptr);
      }
    } catch (const Error& error) {
      throw error.at(p.problem.resolved.where("test"));
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

Results rank_results(const Ranks& ranks, const petsc::Network& network, const petsc::Counted& before,
                     const petsc::Counted& after) {
  const double peak = ranks.largest(peak_bytes());
  const double messages = ranks.largest(after.messages - before.messages);
  const double bytes = ranks.largest(after.bytes - before.bytes);
  const double sums = ranks.largest(after.sums - before.sums);
  const double exchanged = ranks.largest(network.halo().bytes()) * static_cast<double>(network.block());
  const auto neighbours = static_cast<std::int64_t>(ranks.largest(network.halo().neighbours()));
  Results out;
  out.line("ranks")
      .add("ranks", "", ranks.count(), "rank", {Shown::count})
      .note("; on the one with most ")
      .add("discs_of_a_rank", "", network.whole().owned, "disc", {Shown::count})
      .add("ghosts_of_a_rank", "", network.whole().ghosts, "ghost", {Shown::count})
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

bool cells_are_known(const petsc::Part& part) {
  const auto& areas = part.assembly.cell_areas;
  return static_cast<std::int64_t>(areas.size()) >= part.owned &&
         std::all_of(areas.begin(), areas.begin() + part.owned, [](double area) { return area > 0; });
}

void expect_part_files(const OutputPlan& plan, const petsc::Ranks& ranks, const std::string& name) {
  plan.expect(name + ".vtm");
  for (int rank = 0; rank < ranks.count(); ++rank) {
    for (const std::string& file : vtk_piece_names(name, rank)) plan.expect(file);
  }
}

void write_part_files(const std::filesystem::path& folder, const std::string& name, const petsc::Ranks& ranks,
                      const petsc::Part& part, std::span<const DiscMotion> motions,
                      std::span<const ContactForce> forces, bool overwrite) {
  const AssemblyState state{.assembly = part.assembly, .motions = motions, .contact_forces = forces};
  const std::span<const std::int64_t> numbers(part.names.data(), static_cast<std::size_t>(part.owned));
  write_vtk_piece(folder, name, ranks.rank(), state, numbers, overwrite);
  if (ranks.first()) write_vtk_index(folder, name, ranks.count(), overwrite);
}

}  // namespace equidem
