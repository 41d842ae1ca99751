// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_grains.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/files/checkpoint.hpp"
#include "equidem/output/files/frames.hpp"
#include "equidem/output/files/histories.hpp"
#include "equidem/output/pictures/grain_picture.hpp"

#include "run/case_text.hpp"

namespace equidem {
namespace {

constexpr std::int64_t energy_samples = 200,
                       samples_of_few = 1000;  // of the energies, the latter where paths are drawn

void check_events(const GrainCase& resolved, double step) {
  const auto length_of = [&](const StageCase& stage) {
    return stage.duration ? *stage.duration : static_cast<double>(*stage.given_steps) * step;
  };
  const auto check_all = [&](const GrainScene& scene, double length, const auto& place_of_wall,
                             const std::string& place_of_cell) {
    for (std::size_t w = 0; w < scene.walls.size(); ++w)
      for (const Schedule* motion : {&scene.walls[w].move_x, &scene.walls[w].move_y})
        check_event(*motion, step, length, place_of_wall(w));
    if (!scene.cell) return;
    for (const Schedule* rate : {&scene.cell->rate_xx, &scene.cell->rate_yy, &scene.cell->rate_xy})
      check_event(*rate, step, length, resolved.where(place_of_cell + ".motion"));
    if (scene.cell->servo)
      for (const auto* stress : {&scene.cell->servo->stress_xx, &scene.cell->servo->stress_yy})
        if (*stress) check_event(**stress, step, length, resolved.where(place_of_cell + ".servo"));
  };
  for (std::size_t k = 0; k < resolved.stages.size(); ++k) {
    const std::string place = fmt::format("stage.{}", k);
    check_all(
        resolved.stages[k].scene, length_of(resolved.stages[k]), [&](std::size_t) { return resolved.where(place); },
        place + ".cell");
  }
  if (!resolved.stages.empty()) return;
  check_all(
      resolved.scene, resolved.duration,
      [&](std::size_t wall) { return resolved.where(fmt::format("wall.{}.schedule", wall)); }, "cell");
}

StagedSimulation simulation_of(const GrainCase& resolved, double step) {
  const GrainScene scene = build_grain_scene(resolved, step);
  const GrainOptions options = grain_options(resolved, step);
  if (scene.cell) casefile::with_place(resolved.where("cell"), [&] { check_cell(scene, options); });
  casefile::with_place(resolved.where("collisions"),
                       [&] { check(scene, options, [&](std::size_t grain) { return resolved.where_grain(grain); }); });
  for (std::size_t k = 0; k < resolved.stages.size(); ++k) {
    const StageCase& stage = resolved.stages[k];
    const std::string place = fmt::format("stage.{}", k);
    casefile::with_place(resolved.where(place), [&] { check_servos(stage.scene, options.law); });
    if (k > 0 && stage.scene.cell)
      casefile::with_place(resolved.where(place + ".cell"), [&] { check_cell(stage.scene, options); });
    if (!stage.bodies.added.empty()) {
      GrainScene added = stage.scene;  // among themselves: where the others will be is not known yet
      added.grains = stage.bodies.added;
      added.pairs = pairs_at(stage.contacts, options.law, step);
      added.walls.clear();
      added.bonds.clear();  // they tie bodies of the case
      added.strengths.reset();
      casefile::with_place(resolved.where(place), [&] { check(added, options); });
    }
    if (stage.bonds)
      casefile::with_place(resolved.where(place + ".bonds"), [&] { check(*stage.bonds, scene.grains, options); });
  }
  return {build_grain_stages(resolved, step), options};
}

std::int64_t count_all_steps(const GrainCase& resolved, double step) {
  std::int64_t sum = 0;
  for (const GrainStage& stage : build_grain_stages(resolved, step)) sum += stage.steps;
  return sum;
}

/// The walls of all stages, one of each name.
std::vector<Wall> all_walls(const GrainCase& resolved) {
  std::vector<Wall> walls = resolved.scene.walls;
  for (const StageCase& stage : resolved.stages)
    for (const Wall& wall : stage.scene.walls)
      if (std::ranges::find(walls, wall.name, &Wall::name) == walls.end()) walls.push_back(wall);
  return walls;
}

/// Possible error of kinetic and potential energy by the rounding of positions.
double rounding_of_energy(const GrainCase& resolved, double step, const std::vector<Grain>& grains) {
  constexpr double rounding = 1e-15;
  double sum = 0;
  for (const Grain& grain : grains) {
    const double lost_way = rounding * norm(grain.position) / step;
    sum += grain.inertia.mass *
           (lost_way * lost_way + 1e3 * rounding * norm(resolved.scene.gravity) * norm(grain.position));
  }
  return sum;
}

/// The deepest overlap of discs under the bonds of a run when these were unstretched, m.
double deepest_under_bonds(const GrainCase& resolved, std::span<const GrainBond> bonds) {
  const std::vector<Grain> grains = resolved.bodies();
  double deepest = 0;
  for (const GrainBond& bond : bonds)
    if (bond.rest) deepest = std::max(deepest, grains[bond.i].radius + grains[bond.j].radius - norm(bond.rest->branch));
  return deepest;
}

/// Stops a run whose kinetic energy exceeds several times all energy supplied; smaller errors of the balance are
/// reported at the end.
/// \throws Error (computation_failed)
void refuse_made_energy(const GrainCase& resolved, double step, const StagedSimulation& simulation,
                        const EnergyLedger& ledger) {
  if (!std::isfinite(ledger.error())) {
    computation_failed(fmt::format("step {}: an energy is not a number any more", simulation.step()),
                       "squares of speeds, or stiffnesses, are beyond all numbers", "Use smaller ones");
  }
  constexpr double most = 4;
  const double by_breaks = std::max(0.0, -ledger.lost_breaking);
  const double given = ledger.initial + std::abs(ledger.work_of_walls) + std::abs(ledger.potential) +
                       std::max(0.0, ledger.work_of_stages) + std::max(0.0, ledger.work_of_cell) + by_breaks;
  if (ledger.kinetic <= most * given) return;
  if (ledger.kinetic <= most * (given + rounding_of_energy(resolved, step, simulation.present().present_grains())))
    return;
  if (by_breaks > 0.5 * given) {
    throw Error(ErrorKind::computation_failed,
                fmt::format("step {}: the bodies move with {:.3g} times the energy that there was, most of it set free "
                            "by bonds that broke",
                            simulation.step(), ledger.kinetic / given),
                fmt::format("discs overlap by up to {:.3g} m under bonds, and push one another apart where these break",
                            deepest_under_bonds(resolved, simulation.bonds())),
                "Let bonded discs just touch, make collisions softer, or use a shorter time_step",
                resolved.where("strength"));
  }
  computation_failed(
      fmt::format("step {}: the bodies move with {:.3g} times the energy that there was", simulation.step(),
                  ledger.kinetic / given),
      "contacts make energy where steps are too long for them, and maps where several act on a body at once",
      "Use a shorter time_step, or the law exact_flow");
}

/// \param kept of the checkpoint with which the run begins: an automatic step gives way to it
GrainTimeStep step_of(const GrainCase& resolved, const std::optional<double>& kept) {
  const GrainTimeStep chosen = choose_grain_step(resolved);
  if (!kept || !chosen.automatic) return chosen;
  if (*kept > chosen.step * (1 + 1e-9))
    bad_input_at(resolved.where("run"),
                 fmt::format("the checkpoint has steps of {:.6g} s, and this case needs {:.6g} s", *kept, chosen.step),
                 "a run keeps its step through all stages",
                 fmt::format("Run the stages before with time_step = {:.6g}, or give time_step = {:.6g} here to go on "
                             "with the longer one",
                             chosen.step, *kept));
  GrainCase with_step = resolved;
  with_step.step.time_step = *kept;
  with_step.step.steps_per_contact.reset();
  GrainTimeStep step = choose_grain_step(with_step);
  step.automatic = true;
  return step;
}

bool bodies_come_and_go(const GrainCase& resolved) {
  return std::ranges::any_of(resolved.stages, [](const StageCase& stage) {
    return !stage.bodies.removed.empty() || !stage.bodies.added.empty();
  });
}

[[noreturn]] void refuse_beginning(const std::filesystem::path& checkpoint, const std::string& why,
                                   const std::string& remedy) {
  bad_input(fmt::format("cannot begin from '{}'", checkpoint.string()), why, remedy);
}

}  // namespace

double step_of_stages(const std::filesystem::path& checkpoint) {
  const std::string text = case_of_checkpoint(checkpoint);
  const auto found = step_in(text);
  if (found && stages_in(text) > 0) return found->step;
  refuse_beginning(checkpoint, "it is of no run in stages",
                   "Name run.STAGE.checkpoint.h5 of a run whose first stages this case has too");
}

std::optional<double> kept_grain_step(const std::string& text, const GrainCase& resolved) {
  const auto found = step_in(text);
  if (!found || found->step >= choose_grain_step(resolved).step) return {};
  return found->step;
}

GrainRun::GrainRun(GrainCase resolved, const std::optional<double>& kept_step)
    : case_(std::move(resolved)),
      step_(step_of(case_, kept_step)),
      steps_(count_all_steps(case_, step_.step)),
      walls_(all_walls(case_)),
      simulation_(simulation_of(case_, step_.step)) {
  check_events(case_, step_.step);
  if (case_.measures) measures_.emplace(case_, simulation_);
  frames_.contacts = case_.output.frame_contacts;
  const auto bends = [](const GrainBond& bond) { return bond.bending_spring > 0; };
  frames_.moments =
      std::ranges::any_of(case_.scene.bonds, bends) ||
      std::ranges::any_of(case_.stages, [&](const StageCase& s) { return s.bonds && bends(s.bonds->like); });
  frame_discs_ = discs_of_frames(case_.bodies(), case_.scene.clumps, bodies_come_and_go(case_), frames_);
}

std::vector<std::string> GrainRun::files() const {
  std::vector<std::string> names{"energy.csv"};
  if (case_.measures) names.emplace_back("measures.csv");
  if (case_.output.csv) names.emplace_back("grains.csv");
  if (case_.output.csv && !case_.scene.bonds.empty()) names.emplace_back("bonds.csv");
  if (case_.output.picture) names.emplace_back("picture.png");
  for (std::size_t k = 0; k + 1 < case_.stages.size(); ++k)
    names.push_back(fmt::format("run.{}.checkpoint.h5", case_.stages[k].name));
  return names;
}

void GrainRun::begin_from(const std::filesystem::path& path) {
  const std::string there = case_of_checkpoint(path);
  const SavedState state = read_checkpoint(path, there).state;
  const std::size_t begun = StagedSimulation::stages_begun(state);
  const auto refuse = [&](const std::string& why, const std::string& remedy) { refuse_beginning(path, why, remedy); };
  if (case_.stages.empty() || stages_in(there) < begun)
    refuse("this case is not in stages", "Give it the stages of that run, and what is to follow");
  if (begun > case_.stages.size())
    refuse(fmt::format("{} have begun in it, and this case has {}", counted(static_cast<long long>(begun), "stage"),
                       case_.stages.size()),
           "Give this case those stages, and what is to follow");
  const std::string& last = case_.stages[begun - 1].name;
  const std::string before = until_stage(there, begun), here = until_stage(case_text_of(case_, step_.step), begun);
  if (before != here)
    refuse(fmt::format("until the end of the stage '{}' its case is another one: {}", last,
                       first_differences(before, here)),
           "Change later stages only, or run all of this case");
  simulation_.restore(state);
  if (simulation_.over())
    refuse(fmt::format("the stage '{}' is over, and this case has no other", last), "Add the stages that follow");
  beginning_ = {.path = path.string(), .stage = last};
}

RunPlan GrainRun::plan() {
  const bool draws_paths = case_.bodies().size() <= most_drawn_paths;
  return {.steps = steps_,
          .time_step = step_.step,
          .case_text = case_text_of(case_, step_.step) + (beginning_ ? text_of(*beginning_) : ""),
          .frame_interval = case_.output.frame_interval,
          .probe_interval = case_.output.probe_interval,
          .checkpoint_interval = case_.output.checkpoint_interval,
          .frame_discs = &frame_discs_,
          .frames = frames_,
          .probes = case_.probes,
          .walls = names_of(walls_),
          .milestone_name = [this] { return simulation_.reports().back().name; },
          .cell = simulation_.cell().has_value(),
          .body = case_.body,
          .samples = draws_paths ? samples_of_few : energy_samples,
          .paths = draws_paths,
          .recorder = measures_ ? &*measures_ : nullptr,
          .watch = [this](const EnergyLedger& energy) { refuse_made_energy(case_, step_.step, simulation_, energy); },
          .step_place = case_.where("run.time_step")};
}

const ContactTable& GrainRun::present_contacts() const {
  return case_.stages.empty() ? case_.contacts : case_.stages[simulation_.reports().size() - 1].contacts;
}

/// A group keeps the colour of its first kind in all stages. Kinds of one group may differ by radius.
int GrainRun::colour_of(const std::string& group) const {
  const std::vector<std::string>& kinds = (case_.stages.empty() ? case_.contacts : case_.stages.back().contacts).kinds;
  return static_cast<int>(std::ranges::find(kinds, group) - kinds.begin());
}

GrainRun::Snapshot GrainRun::snapshot() const {
  const GrainSimulation& present = simulation_.present();
  Snapshot now{.grains = {}, .walls = present.placed_walls(), .bonds = simulation_.holding_bonds()};
  const std::vector<std::string>& kinds = present_contacts().kinds;
  for (const Grain& grain : present.grains()) {
    now.places.push_back(now.grains.size());
    if (!grain.present) continue;
    now.numbers.push_back(now.places.size() - 1);
    now.grains.push_back(grain);
    now.groups.push_back(kinds[static_cast<std::size_t>(grain.kind)]);
    now.colours.push_back(colour_of(now.groups.back()));
  }
  for (GrainBond& bond : now.bonds.bonds) bond.i = now.places[bond.i], bond.j = now.places[bond.j];
  return now;
}

void GrainRun::write_tables(const CommonOptions& into) const {
  const std::filesystem::path& folder = *into.out;
  const Snapshot now = snapshot();
  std::vector<double> densities;
  for (const std::size_t number : now.numbers) densities.push_back(case_.densities[number]);
  write_grain_csv(folder / "grains.csv",
                  {.grains = now.grains,
                   .clumps = case_.scene.clumps,
                   .groups = now.groups,
                   .densities = densities,
                   .numbers = bodies_come_and_go(case_) ? now.numbers : std::span<const std::size_t>()},
                  into.overwrite);
}

void GrainRun::draw(const CommonOptions& into, const RunResult& result) const {
  const Snapshot now = snapshot();
  std::vector<std::vector<Vec2>> paths;  // of the bodies that are there
  for (const std::vector<Vec2>& places : result.record.paths) {
    std::vector<Vec2>& shown = paths.emplace_back();
    for (const std::size_t number : now.numbers) shown.push_back(places[number]);
  }
  write_grain_picture(*into.out, "picture",
                      {.title = case_.title,
                       .time = simulation_.time(),
                       .grains = now.grains,
                       .clumps = case_.scene.clumps,
                       .groups = now.colours,
                       .bonds = now.bonds.bonds,
                       .walls = now.walls,
                       .started = case_.scene.grains,
                       .paths = paths},
                      into.overwrite);
}

std::vector<OutputPart> GrainRun::parts(const RunResult& result) const {
  static constexpr EnergyCurve further[] = {
      {"lost at impacts", PlotColour::orange,
       [](const EnergyLedger& l) { return l.lost_restitution + l.lost_dashpot + l.lost_release; }},
      {"lost by friction", PlotColour::purple,
       [](const EnergyLedger& l) { return l.lost_slip + l.lost_tangential_dashpot + l.lost_rolling; }},
      {"lost in bonds", PlotColour::yellow, [](const EnergyLedger& l) { return l.lost_bond + l.lost_breaking; }},
      {"work done by walls", PlotColour::sky_blue, [](const EnergyLedger& l) { return l.work_of_walls; }},
  };
  std::vector<OutputPart> parts;
  const auto part = [&](const char* name, std::function<void(const CommonOptions&)> write) {
    parts.push_back({name, std::move(write), OutputPart::page});
  };
  part("case.toml", [this](const CommonOptions& into) { write_case(into, case_.document); });
  part("energy.csv", [this, &result](const CommonOptions& into) {
    write_energy_csv(*into.out / "energy.csv", result.record.energies, BodyFamily::colliding, case_.body,
                     into.overwrite);
  });
  if (case_.output.csv) {
    part("grains.csv", [this](const CommonOptions& into) { write_tables(into); });
    part("contacts.csv", [this](const CommonOptions& into) {
      const Snapshot now = snapshot();
      std::vector<GrainContact> contacts = simulation_.present().contacts();
      const auto place = [&](std::int32_t body) { return static_cast<std::int32_t>(now.places[body]); };
      for (GrainContact& c : contacts) c.i = place(c.i), c.j = c.j < 0 ? c.j : place(c.j);
      write_grain_contact_csv(*into.out / "contacts.csv", contacts, now.walls, case_.body, into.overwrite);
    });
    if (!simulation_.bonds().empty())
      part("bonds.csv", [this](const CommonOptions& into) {
        const StagedSimulation::HoldingBonds holding = snapshot().bonds;
        write_bond_csv(*into.out / "bonds.csv", holding.bonds, holding.strengths, into.overwrite);
      });
  }
  part("the table of breaks", [this](const CommonOptions& into) { write_breaks(into); });
  if (case_.output.picture) {
    part("the picture", [this, &result](const CommonOptions& into) { draw(into, result); });
    part("the plot of energies", [this, &result](const CommonOptions& into) {
      write_energy_plot(into, "energy_plot", case_.title, case_.body, result.record.energies, further);
    });
    part("the paths of probes", [this](const CommonOptions& into) { write_probe_paths(into, case_); });
    part("the film", [this, &result](const CommonOptions& /*into*/) {
      std::vector<int> first_colours;
      for (const std::string& group : case_.groups) first_colours.push_back(colour_of(group));
      // where paths are drawn, pictures show where each body went
      const auto started =
          result.record.paths.empty() ? std::span<const Grain>(case_.scene.grains) : std::span<const Grain>();
      add_film(case_, walls_, first_colours, started, result.record.film);
    });
  }
  if (measures_ && measures_->last_step() >= 0)
    part("the measures", [this](const CommonOptions& into) { measures_->write_files(into); });
  return parts;
}

}  // namespace equidem
