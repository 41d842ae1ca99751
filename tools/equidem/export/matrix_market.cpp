// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The equations of a case as Matrix Market files.
#include "equidem/output/files/matrix_market.hpp"

#include <memory>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/sample_solver.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/statics/linear_system.hpp"

#include "command.hpp"
#include "export/formats.hpp"
#include "problem.hpp"

namespace equidem {
namespace {

constexpr const char* stiffness_file = "stiffness.mtx";
constexpr const char* loads_file = "right_hand_sides.mtx";
constexpr const char* motions_file = "rigid_motions.mtx";
constexpr const char* unknowns_file = "unknowns.csv";
constexpr const char* held_file = "held.csv";
constexpr const char* readme_file = "README.txt";
constexpr const char* units = "SI units per metre of depth; README.txt says more";
constexpr const char* component_names[] = {"ux", "uy", "rotation"};

struct Component {
  std::int64_t disc;
  int k;
  double scale;  ///< of the unknown to m or rad
};

Component component_of(const LinearSystem& system, std::int64_t component) {
  const int b = system.unknowns.per_disc;
  const std::int64_t disc = component / b;
  const int k = static_cast<int>(component % b);
  return {system.discs.empty() ? disc : system.discs[static_cast<std::size_t>(disc)], k,
          k == 2 ? 1 / system.unknowns.rotation_scale : 1};
}

Table table_of_unknowns(const LinearSystem& system) {
  std::vector<std::int64_t> unknown, disc;
  std::vector<std::string> name;
  std::vector<double> scale;
  for (const std::int64_t index : system.stiffness.component) {
    const Component c = component_of(system, index);
    unknown.push_back(std::ssize(unknown));
    disc.push_back(c.disc);
    name.emplace_back(component_names[c.k]);
    scale.push_back(c.scale);
  }
  Table table;
  table.add("unknown", std::move(unknown)).add("disc", std::move(disc));
  return table.add("component", std::move(name)).add("scale", std::move(scale));
}

Table table_of_held(const LinearSystem& system) {
  std::vector<std::int64_t> disc;
  std::vector<std::string> name;
  std::vector<double> value;
  for (std::size_t k = 0; k < system.unknowns.held.size(); ++k) {
    if (system.unknowns.held[k] == DegreesOfFreedom::free) continue;
    const Component c = component_of(system, static_cast<std::int64_t>(k));
    disc.push_back(c.disc);
    name.emplace_back(component_names[c.k]);
    value.push_back(system.unknowns.prescribed[k] * c.scale);
  }
  Table table;
  return table.add("disc", std::move(disc)).add("component", std::move(name)).add("value", std::move(value));
}

std::string readme(const Problem& problem, const LinearSystem& system) {
  const std::string& title = problem.resolved.title;
  return fmt::format(
      "{}{}K u = f of {}: K in {} (lower triangle), the right-hand sides ({}) as columns of {}.\n"
      "SI units per metre of depth: K in Pa, f in N/m, u in m. {} says which component of which disc each\n"
      "unknown is; times its scale it is a displacement in m or a rotation in rad. {} has the components that\n"
      "are not unknown, in m and rad. {} spans the near-null space (translations along x and y, rotation),\n"
      "for algebraic multigrid.\n",
      title, title.empty() ? "" : "\n", counted(system.size(), "unknown"), stiffness_file, listed(system.names),
      loads_file, unknowns_file, held_file, motions_file);
}

/// The equations of the verb solve where something acts on the assembly, else of homogenize on the periodic cell.
LinearSystem equations_of(const Problem& problem) {
  const Rotation rotation = problem.resolved.rotation;
  if (!problem.supports.empty() || problem.tension) {
    std::vector<LoadCase> loads;
    std::vector<std::string> names;
    for (const NamedLoads& acting : problem.load_cases) {
      loads.push_back(acting.loads);
      names.push_back(acting.name.empty() ? "loads" : acting.name);
    }
    LinearSystem system =
        equilibrium_system(problem.assembly, problem.springs.springs, problem.supports, loads, rotation);
    system.names = std::move(names);
    return system;
  }
  if (!problem.assembly.periodic())
    bad_input_at(problem.resolved.document.where(), "nothing holds the assembly, and it is not periodic",
                 "its stiffness matrix is singular", "Add [[support]] and [[load]], [test], or set periodic = true");
  return strain_system(problem.assembly, problem.springs.springs, rotation);
}

}  // namespace

Exported export_to_matrix_market(const ExportOptions& options) {
  if (!options.accept.empty())
    bad_input("--accept with --to matrix-market", "the matrices leave nothing out and approximate nothing",
              "Leave it out");
  Case resolved = read_case(options);
  const bool loaded = acts(resolved);
  const auto problem =
      std::make_shared<const Problem>(loaded ? build_problem(std::move(resolved)) : problem_of(std::move(resolved)));
  refuse_prestress(*problem, "export --to matrix-market");
  StageTimes times = problem->times;
  Stopwatch watch;
  const auto system = std::make_shared<const LinearSystem>(equations_of(*problem));
  times.add("assemble", watch.lap());
  Exported made;
  made.results = problem_results(
      *problem, derive_effects(problem->assembly, problem->springs.springs, problem->resolved.rotation));
  made.results.line("equations")
      .add("unknowns", "", system->size(), "unknown", {Shown::count})
      .add("stiffness_entries", "", system->stiffness.first.back(), "entries in the lower triangle")
      .note(fmt::format(", right-hand sides: {}", joined(system->names)));
  made.results.set("right_hand_sides", system->names);
  made.times = std::move(times);
  const auto file = [&](const char* name, const auto& text) { made.files.push_back({name, text}); };
  file(stiffness_file,
       [system] { return matrix_market(system->stiffness, fmt::format("K, lower triangle, Pa\n{}", units)); });
  file(loads_file, [system] {
    return matrix_market(system->right_hand_sides,
                         fmt::format("f, N/m; columns: {}\n{}", joined(system->names), units));
  });
  file(motions_file, [system] {
    return matrix_market(
        system->rigid_motions,
        fmt::format("unit translations along x and y, rotation by 1 rad about the mean centre, m\n{}", units));
  });
  file(unknowns_file, [system] { return table_of_unknowns(*system).csv(); });
  file(held_file, [system] { return table_of_held(*system).csv(); });
  file(readme_file, [system, problem] { return readme(*problem, *system); });
  made.write_case = [problem](const CommonOptions& into) { write_case(into, problem->resolved); };
  return made;
}

}  // namespace equidem
