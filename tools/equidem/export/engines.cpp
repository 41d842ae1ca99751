// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Export to discrete-element codes: the case as their model, refused where they do not carry it.
#include <algorithm>
#include <memory>
#include <utility>

#include "equidem/casefile/assembly/build.hpp"
#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/time_step.hpp"
#include "equidem/output/export/engine_model.hpp"

#include "export/formats.hpp"
#include "problem.hpp"

namespace equidem {
namespace {

constexpr double usual_density = 2500;  // kg/m³, where a case in equilibrium gives none: it does not change the rest

/// A model with the case that it comes from.
struct CaseModel {
  EngineModel model;
  StageTimes times = {};
  std::function<void(const CommonOptions&)> write_case = {};
  std::vector<std::string> notes = {};
};

/// Refuses what the engine does not carry, then chooses the step: a motion that grows has none.
template <typename Step>
void finish(EngineModel& model, Engine engine, const ExportOptions& options, const std::string& where,
            const Step& step) {
  try {
    require_carried(model.found, engine, options.accept);
  } catch (const Error& error) {
    throw error.at(where);
  }
  model.time_step = step();
}

/// The scene of a case without [run]: its supports and loads, there from the start.
Scene scene_at_rest(const Problem& problem) {
  const double density = disc_density(problem.resolved, problem.assembly).value_or(usual_density);
  Scene scene(problem.assembly, problem.springs.springs,
              inertia_of(problem.assembly, density, problem.resolved.assembly.body));
  const auto constant = [](const std::optional<double>& value) -> std::optional<Schedule> {
    if (!value) return {};
    return Schedule{.value = *value};
  };
  for (const Support& support : problem.supports)
    scene.supports.push_back({support.group, constant(support.ux), constant(support.uy), constant(support.rotation)});
  for (const Load& load : problem.load_cases.front().loads)
    scene.loads.push_back({.load = load, .factor = {.value = 1}});
  return scene;
}

Problem problem_to_export(Case resolved) {
  if (resolved.run) return problem_of(std::move(resolved), Purpose::step);
  if (resolved.load_cases.size() > 1)
    bad_input_at(resolved.where("load"), fmt::format("the case has {} load cases", resolved.load_cases.size()),
                 "the exported model has one state at rest", "Export a case file for each");
  return build_problem(std::move(resolved));
}

CaseModel bonded_model(const ExportOptions& options, Engine engine) {
  constexpr double damping_to_rest = 0.2;
  const auto problem = std::make_shared<const Problem>(problem_to_export(read_case(options)));
  const Case& resolved = problem->resolved;
  const std::optional<RunCase>& run = resolved.run;
  const Scene scene =
      run ? build_scene(resolved, problem->assembly, problem->springs.springs) : scene_at_rest(*problem);
  SimulationOptions settings = run ? simulation_options(resolved, 1) : SimulationOptions{.rotation = resolved.rotation};
  CaseModel made{.model = engine_model(scene, settings, resolved.assembly.body), .times = problem->times};
  EngineModel& model = made.model;
  model.title = resolved.title;
  model.to_rest = !run || run->until_rest;
  if (resolved.strength || !problem->assembly.contact_tension.empty() || !resolved.notches.empty() ||
      !resolved.dead_loads.empty())
    model.found.emplace(EngineFeature::bonds, "strengths, notches or dead loads");
  if (model.to_rest && (!model.motions.empty() || !model.timed_loads.empty()))
    model.found.emplace(EngineFeature::schedules, "in a run until rest");
  if (model.to_rest) model.found.erase(EngineFeature::given_at_start);
  if (model.to_rest && model.local_damping == 0) model.local_damping = settings.damping.local = damping_to_rest;
  if (run) model.duration = run->duration.value_or(0);
  finish(model, engine, options, resolved.document.where(), [&] {
    TimeStepOptions wanted = run ? run->time_step : TimeStepOptions{};
    if (run) wanted.duration = run->duration.value_or(0);
    const double step = choose_time_step(scene, settings, wanted).step;
    return run && run->duration ? std::min(step, *run->duration) : step;
  });
  made.notes = problem->left_out.sentences;
  if (!disc_density(resolved, problem->assembly))
    made.notes.push_back(
        fmt::format("density {} kg/m³ assumed: the state at rest does not depend on it", usual_density));
  made.write_case = [problem](const CommonOptions& into) { write_case(into, problem->resolved); };
  return made;
}

CaseModel grain_model(const ExportOptions& options, Engine engine) {
  const auto resolved = std::make_shared<const GrainCase>(read_grain_case(options.case_file, options.set));
  if (!resolved->stages.empty())
    bad_input_at(resolved->where("stage"), "the case is in stages", "an exported model is one scene from its start on",
                 "Export a case of one stage");
  const double step = choose_grain_step(*resolved).step;
  const GrainScene scene = build_grain_scene(*resolved, step);
  CaseModel made{.model = engine_model(scene, grain_options(*resolved, step), resolved->body)};
  made.model.title = resolved->title;
  made.model.duration = resolved->duration;
  finish(made.model, engine, options, resolved->document.where(), [&] { return step; });
  made.write_case = [resolved](const CommonOptions& into) { write_case(into, resolved->document); };
  return made;
}

Exported export_to(const ExportOptions& options, Engine engine,
                   std::vector<EngineFile> (*files_of)(const EngineModel& model)) {
  const bool grains = describes_grains(casefile::read_document(options.case_file, options.set));
  CaseModel made = grains ? grain_model(options, engine) : bonded_model(options, engine);
  const EngineModel& model = made.model;
  Exported exported;
  if (!model.title.empty()) exported.results.line("title", model.title).set("title", model.title);
  exported.results.line("model").add(grains ? "grains" : "discs", "", std::ssize(model.bodies),
                                     grains ? "grain" : "disc", {Shown::count});
  if (!grains) exported.results.add("bonds", "", std::ssize(model.bonds), "bond", {Shown::count});
  exported.results.line("time step").add("time_step", "", model.time_step, "s");
  exported.results.add("steps", "", steps_of(model), "step", {Shown::count});
  if (model.to_rest) exported.results.note(" at most, to rest");
  for (const std::string& note : made.notes) exported.results.line("", note);
  for (const auto& [feature, instance] : model.found) {
    const EngineFeatureRow& row = entry_of(feature);
    if (!row.carried_by(engine)) exported.results.line("accepted", fmt::format("{}: {}", row.name, row.why));
  }
  for (EngineFile& file : files_of(model))
    exported.files.push_back({file.name, [text = std::move(file.text)] { return text; }});
  exported.times = std::move(made.times);
  exported.write_case = std::move(made.write_case);
  return exported;
}

}  // namespace

Exported export_to_lammps(const ExportOptions& options) {
  return export_to(options, Engine::lammps, lammps_files);
}

Exported export_to_yade(const ExportOptions& options) {
  return export_to(options, Engine::yade, yade_files);
}

}  // namespace equidem
