// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem export: the model of a case as input of LAMMPS or YADE, refused where they do not carry it, or its equations
/// as Matrix Market files. A format is one function that makes its files, and one line in a table.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/breakage/strengths.hpp"
#include "equidem/casefile/assembly/build.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/time_step.hpp"
#include "equidem/homogenize/sample_solver.hpp"
#include "equidem/output/export/engine_model.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/matrix_market.hpp"
#include "equidem/statics/linear_system.hpp"

#include "problem.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

/// The files that a format makes of a case. It owns what its functions refer to.
struct Exported {
  StageTimes times = {};
  std::vector<OutputPart> files = {};
  Results results = {};      ///< lines of the report
  double bytes_of_text = 0;  ///< the largest text that is made when its file is written

  /// \param text is made when the file is written
  void add(const std::string& name, std::function<std::string()> text) {
    const auto write = [=](const CommonOptions& into) { write_file(*into.out / name, text(), into.overwrite); };
    files.push_back({name, write, OutputPart::folder, {name}});
  }
};

struct ExportOptions : CommonOptions {
  std::string to;                   ///< name of the format
  std::vector<std::string> accept;  ///< words of EngineFeatureRow::accept
};

constexpr double usual_density = 2500;  // kg/m³, where a case in equilibrium gives none: it does not change the rest

struct CaseModel {
  EngineModel model;
  Exported exported;
  std::vector<std::string> notes = {};
};

/// Refuses what the engine does not carry, before a step is chosen: a motion that grows has none.
void check_carried(const EngineModel& model, Engine engine, const ExportOptions& options, const std::string& where) {
  casefile::with_place(where, [&] { require_carried(model.found, engine, options.accept); });
  stop_if_interrupted();
}

/// The scene of a case without [run]: its supports and loads, there from the start.
Scene scene_at_rest(const Problem& problem) {
  const double density = disc_density(problem.resolved, problem.assembly).value_or(usual_density);
  Scene scene(problem.assembly, problem.springs.springs,
              inertia_of(problem.assembly, density, problem.resolved.assembly.body));
  add_constant_actions(scene, problem.supports, problem.load_cases.front().loads);
  return scene;
}

Problem problem_to_export(Case resolved) {
  if (resolved.run) return problem_of(std::move(resolved), Purpose::step);
  if (resolved.load_cases.size() > 1)
    bad_input_at(resolved.where("load"), fmt::format("the case has {} load cases", resolved.load_cases.size()),
                 "the exported model has one state at rest", "Export a case file for each");
  return build_problem(std::move(resolved));
}

/// Strengths of the bonds of a model, which are numbered as the contacts are.
void add_strengths(EngineModel& model, const Case& resolved, const Assembly& assembly) {
  if (!resolved.strength && assembly.contact_tension.empty()) return;
  constexpr double rounding = 1e-9;
  const StrengthOptions options = resolved.strength.value_or(StrengthOptions{});
  const ContactStrengths strengths =
      casefile::with_place(resolved.where("strength"), [&] { return contact_strengths(assembly, options); });
  model.found.emplace(EngineFeature::strengths, "[strength]");
  if (options.after_breaking == AfterBreaking::frictional)
    model.found.emplace(EngineFeature::other_strengths, "after_breaking = \"frictional\"");
  for (std::size_t k = 0; k < model.bonds.size(); ++k) {
    const double tension = strengths.tension[k], shear = strengths.shear[k];
    model.bonds[k].tension = tension, model.bonds[k].shear = shear;
    if (!(tension > 0 && std::abs(strengths.friction * tension - shear) <= rounding * shear))
      model.found.emplace(EngineFeature::other_strengths, fmt::format("friction {:g} where shear/tension is {:.6g}",
                                                                      strengths.friction, shear / tension));
  }
}

CaseModel bonded_model(const ExportOptions& options, Engine engine) {
  constexpr double damping_to_rest = 0.2;
  Case given = read_case(options);
  check_taken(given, fmt::format("export --to {}", options.to), {.bending = true});
  const auto problem = std::make_shared<const Problem>(problem_to_export(std::move(given)));
  const Case& resolved = problem->resolved;
  const std::optional<RunCase>& run = resolved.run;
  const Scene scene =
      run ? build_scene(resolved, problem->assembly, problem->springs.springs) : scene_at_rest(*problem);
  SimulationOptions settings = run ? simulation_options(resolved, 1) : SimulationOptions{.rotation = resolved.rotation};
  CaseModel made{engine_model(scene, settings, resolved.assembly.body),
                 {problem->times, {case_part([problem]() -> const Case& { return problem->resolved; })}}};
  EngineModel& model = made.model;
  model.title = resolved.title;
  model.to_rest = !run || run->until_rest;
  add_strengths(model, resolved, problem->assembly);
  if (!resolved.notches.empty() || !resolved.dead_loads.empty())
    model.found.emplace(EngineFeature::bonds, "notches or dead loads");
  if (model.to_rest && (!model.motions.empty() || !model.timed_loads.empty()))
    model.found.emplace(EngineFeature::schedules, "in a run until rest");
  if (model.to_rest) model.found.erase(EngineFeature::given_at_start);
  if (model.to_rest && model.local_damping == 0) model.local_damping = settings.damping.local = damping_to_rest;
  if (run) model.duration = run->duration.value_or(0);
  check_carried(model, engine, options, resolved.document.where());
  TimeStepOptions wanted = run ? run->time_step : TimeStepOptions{};
  wanted.duration = model.duration;
  model.time_step = choose_time_step(scene, settings, wanted).step;
  if (run && run->duration) model.time_step = std::min(model.time_step, *run->duration);
  made.notes = problem->left_out.sentences;
  if (carries_forces(problem->assembly)) made.notes.emplace_back("the exported contacts start without forces at rest");
  if (!disc_density(resolved, problem->assembly))
    made.notes.push_back(
        fmt::format("density {} kg/m³ assumed: the state at rest does not depend on it", usual_density));
  return made;
}

CaseModel grain_model(const ExportOptions& options, Engine engine) {
  const auto resolved = std::make_shared<const GrainCase>(read_grain_case(options.case_file, options.set));
  if (!resolved->stages.empty())
    bad_input_at(resolved->where("stage"), "the case is in stages", "an exported model is one scene from its start on",
                 "Export a case of one stage");
  const double step = choose_grain_step(*resolved).step;
  const GrainScene scene = build_grain_scene(*resolved, step);
  CaseModel made{engine_model(scene, grain_options(*resolved, step), resolved->body),
                 {{}, {case_part([resolved]() -> const TomlValue& { return resolved->document; })}}};
  made.model.title = resolved->title;
  made.model.duration = resolved->duration;
  made.model.time_step = step;
  check_carried(made.model, engine, options, resolved->document.where());
  return made;
}

Exported export_to(const ExportOptions& options, Engine engine,
                   std::vector<EngineFile> (*files_of)(const EngineModel& model)) {
  const bool grains = describes_grains(casefile::read_document(options.case_file, options.set));
  CaseModel made = grains ? grain_model(options, engine) : bonded_model(options, engine);
  stop_if_interrupted();
  const EngineModel& model = made.model;
  Results& results = made.exported.results;
  if (!model.title.empty()) results.line("title", model.title).set("title", model.title);
  const char* body = grains ? "grain" : "disc";
  results.line("model").add(fmt::format("{}s", body), "", std::ssize(model.bodies), body, {Shown::count});
  if (!grains) results.add("bonds", "", std::ssize(model.bonds), "bond", {Shown::count});
  results.line("time step").add("time_step", "", model.time_step, "s");
  results.add("steps", "", steps_of(model), "step", {Shown::count}).note(model.to_rest ? " at most, to rest" : "");
  for (const std::string& note : made.notes) results.line("", note);
  for (const auto& [feature, instance] : model.found) {
    const EngineFeatureRow& row = entry_of(feature);
    if (!row.carried_by(engine)) results.line("accepted", fmt::format("{}: {}", row.name, row.why));
  }
  for (EngineFile& file : files_of(model)) made.exported.add(file.name, [text = std::move(file.text)] { return text; });
  return std::move(made.exported);
}

constexpr const char* stiffness_file = "stiffness.mtx";
constexpr const char* loads_file = "right_hand_sides.mtx";
constexpr const char* motions_file = "rigid_motions.mtx";
constexpr const char* unknowns_file = "unknowns.csv";
constexpr const char* held_file = "held.csv";
constexpr const char* readme_file = "README.txt";
constexpr const char* units = "SI units per metre of depth; README.txt says more";

struct Component {
  std::int64_t place;  ///< among those of all discs
  std::int64_t disc;
  std::string name;
  double scale;  ///< of the unknown to m or rad
};

Component component_of(const LinearSystem& system, std::int64_t place) {
  constexpr const char* names[] = {"ux", "uy", "rotation"};
  const std::int64_t disc = place / system.unknowns.per_disc, k = place % system.unknowns.per_disc;
  return {place, system.discs.empty() ? disc : system.discs[static_cast<std::size_t>(disc)], names[k],
          k == 2 ? 1 / system.unknowns.rotation_scale : 1};
}

Table table_of_unknowns(const LinearSystem& system) {
  std::vector<Component> unknowns;
  for (const std::int64_t place : system.stiffness.component) unknowns.push_back(component_of(system, place));
  Table table;
  table.add("unknown", unknowns, [&](const Component& c) { return &c - unknowns.data(); });
  table.add("disc", unknowns, &Component::disc).add("component", unknowns, &Component::name);
  return table.add("scale", unknowns, &Component::scale);
}

Table table_of_held(const LinearSystem& system) {
  const auto& held = system.unknowns.held;
  std::vector<Component> all;
  for (std::size_t k = 0; k < held.size(); ++k)
    if (held[k] != DegreesOfFreedom::free) all.push_back(component_of(system, static_cast<std::int64_t>(k)));
  Table table;
  table.add("disc", all, &Component::disc).add("component", all, &Component::name);
  return table.add("value", all, [&](const Component& c) { return system.unknowns.prescribed[c.place] * c.scale; });
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

Exported export_to_matrix_market(const ExportOptions& options) {
  if (!options.accept.empty())
    bad_input("--accept with --to matrix-market", "the matrices leave nothing out and approximate nothing",
              "Leave it out");
  Case resolved = read_case(options);
  const bool loaded = acts(resolved);
  const auto problem = std::make_shared<const Problem>(
      prestressed(loaded ? build_problem(std::move(resolved)) : problem_of(std::move(resolved))));
  Exported made{problem->times, {case_part([problem]() -> const Case& { return problem->resolved; })}};
  Stopwatch watch;
  const auto system = std::make_shared<const LinearSystem>(equations_of(*problem));
  made.times.add("assemble", watch.lap());
  made.results = problem_results(*problem, problem->effects());
  made.results.line("equations")
      .add("unknowns", "", system->size(), "unknown", {Shown::count})
      .add("stiffness_entries", "", system->stiffness.first.back(), "entries in the lower triangle")
      .note(fmt::format(", right-hand sides: {}", joined(system->names)));
  made.results.set("right_hand_sides", system->names);
  const auto text_of = [system](const auto& part, const std::string& comment) {
    return [=] { return matrix_market((*system).*part, fmt::format("{}\n{}", comment, units)); };
  };
  made.bytes_of_text = bytes_of_text(system->stiffness);
  made.add(stiffness_file, text_of(&LinearSystem::stiffness, "K, lower triangle, Pa"));
  made.add(loads_file,
           text_of(&LinearSystem::right_hand_sides, fmt::format("f, N/m; columns: {}", joined(system->names))));
  made.add(motions_file, text_of(&LinearSystem::rigid_motions,
                                 "unit translations along x and y, rotation by 1 rad about the mean centre, m"));
  made.add(unknowns_file, [system] { return table_of_unknowns(*system).csv(); });
  made.add(held_file, [system] { return table_of_held(*system).csv(); });
  made.add(readme_file, [system, problem] { return readme(*problem, *system); });
  return made;
}

struct ExportFormat {
  const char* name;                                ///< as --to takes it
  const char* help;                                ///< files of the folder
  Exported (*make)(const ExportOptions& options);  ///< throws Error (bad_input) on what it cannot carry
};

constexpr std::array export_formats{
    ExportFormat{"lammps", "in.equidem and its data file",
                 [](const ExportOptions& options) { return export_to(options, Engine::lammps, lammps_files); }},
    ExportFormat{"yade", "run_equidem.py",
                 [](const ExportOptions& options) { return export_to(options, Engine::yade, yade_files); }},
    ExportFormat{"matrix-market", "K, right-hand sides, rigid motions (.mtx)", export_to_matrix_market},
};

void export_case(const ExportOptions& options) {
  prepare(options);
  casefile::refuse_removed_word(options.to, "export");
  const ExportFormat& format = entry_named(export_formats, options.to, "format of --to");
  if (!options.out && !options.dry_run)
    bad_input("export without --out", "its files need a folder", "Name one: --out DIR");
  expect_results(options, {});
  const auto lock = lock_out(options);
  Exported made = format.make(options);
  expect_results(options, made.files);
  const std::vector others(made.files.begin() + 1, made.files.end());  // but the case
  made.results.line("files", joined(others, &OutputPart::name));
  made.results.set("format", format.name);
  if (options.dry_run) {
    made.results.line("memory").add("peak_bytes", "",
                                    std::max(peak_resident_memory(), resident_memory() + made.bytes_of_text),
                                    "at the peak", {Shown::bytes});
  }
  deliver(options, options.dry_run ? "dry_run" : "done", made.results, made.times,
          options.dry_run ? std::vector<OutputPart>{} : made.files);
}

}  // namespace

Run declare_export(CLI::App& command) {
  const auto options = std::make_shared<ExportOptions>();
  add_common_options(command, *options);
  command.add_option("--to", options->to, "the program or format: " + help_of(export_formats))
      ->required()
      ->type_name("FORMAT");
  command
      .add_option("--accept", options->accept,
                  fmt::format("export this although the program computes it otherwise, as its refusal says: {}",
                              joined(acceptable_features(), ", ")))
      ->type_name("WHAT")
      ->allow_extra_args(false);
  return [options] { return export_case(*options); };
}

}  // namespace equidem
