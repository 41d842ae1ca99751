// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_grains.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/files/checkpoint.hpp"
#include "equidem/output/files/frames.hpp"
#include "equidem/output/files/histories.hpp"
#include "equidem/output/pictures/field_files.hpp"
#include "equidem/output/pictures/grain_picture.hpp"
#include "equidem/output/plots/plot.hpp"

namespace equidem {
namespace {

/// The numbers of a moment behind its step, with their columns: visit("time_s", number).
template <class Moment, class Visit>
void for_each_number(Moment& m, const Visit& visit) {
  visit("time_s", m.time), visit("void_ratio", m.void_ratio), visit("porosity", m.porosity);
  visit("surface_height_m", m.surface.height), visit("surface_slope", m.surface.slope);
  visit("surface_roughness_m", m.surface.roughness);
  visit("centre_x_m", m.centre.x), visit("centre_y_m", m.centre.y), visit("outside", m.outside);
}

std::vector<std::string> columns_of_moments() {
  std::vector<std::string> columns{"step"};
  const MeasuredMoment none{};
  for_each_number(none, [&](const char* name, auto /*value*/) { columns.emplace_back(name); });
  return columns;
}

std::vector<double> cells_of(const MeasuredMoment& moment) {
  std::vector<double> cells;
  for_each_number(moment, [&](const char* /*name*/, auto value) { cells.push_back(static_cast<double>(value)); });
  return cells;
}

constexpr const char *table_name = "measures.csv", *profiles_name = "surface.csv";

/// Rows of numbers of a table that a checkpoint counts on.
std::vector<std::vector<double>> rows_of(const std::filesystem::path& folder, const FileMark& mark) {
  const auto cells = csv_cells(read_marked(folder / mark.name, mark));
  std::vector<std::vector<double>> rows;
  for (std::size_t k = 1; k < cells.size(); ++k) {
    rows.emplace_back();
    for (const std::string& cell : cells[k]) rows.back().push_back(csv_number(cell).value_or(not_measured));
  }
  return rows;
}

/// The shakings of a case, with the times of those that have begun.
std::vector<BoxShaking> shakings_of(const GrainCase& resolved, const StagedSimulation* simulation) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  if (resolved.shaking) return {{.shaking = *resolved.shaking}};
  std::vector<BoxShaking> shakings;
  for (std::size_t k = 0; k < resolved.stages.size(); ++k) {
    if (!resolved.stages[k].shaking) continue;
    BoxShaking& shaking = shakings.emplace_back(BoxShaking{.shaking = *resolved.stages[k].shaking, .from = unknown});
    if (simulation == nullptr || k >= simulation->reports().size()) continue;
    const StageReport& report = simulation->reports()[k];
    const double step = simulation->time_step();
    shaking.from = static_cast<double>(report.first) * step;
    if (report.over) shaking.until = static_cast<double>(report.last) * step;
  }
  return shakings;
}

BoxMeasures measures_of(const GrainCase& resolved) {
  return casefile::with_place(resolved.where(resolved.measures->cell ? "measures.cell" : "measures"), [&] {
    return BoxMeasures(resolved.scene, *resolved.measures, shakings_of(resolved, nullptr));
  });
}

}  // namespace

GrainMeasures::GrainMeasures(const GrainCase& resolved, const StagedSimulation& simulation)
    : resolved_(resolved), simulation_(simulation), measures_(measures_of(resolved)) {}

void GrainMeasures::open(const std::filesystem::path& folder, bool overwrite, const Checkpoint* from) {
  folder_ = folder;
  GrowingCsvOptions options{.overwrite = overwrite};
  if (from != nullptr) options.continue_from = from->mark_of(table_name);
  table_.emplace(folder / table_name, columns_of_moments(), options);
  std::vector<std::string> names{"step", "time_s"};
  const SurfaceProfile profile = measures_.empty_profile();
  for (std::size_t k = 0; k < measures_.columns(); ++k) names.push_back(fmt::format("x_{:.6g}_m", profile.place(k)));
  if (from != nullptr) options.continue_from = from->mark_of(profiles_name);
  profiles_.emplace(folder / profiles_name, names, options);
  if (from != nullptr) go_on(*from);
}

void GrainMeasures::go_on(const Checkpoint& from) {
  std::vector<MeasuredMoment> moments;
  for (const auto& row : rows_of(folder_, from.mark_of(table_name))) {
    MeasuredMoment& moment = moments.emplace_back();
    moment.step = static_cast<std::int64_t>(row[0]);
    const double* next = row.data();
    for_each_number(moment, [&](const char* /*name*/, auto& value) {
      value = static_cast<std::remove_reference_t<decltype(value)>>(*++next);
    });
  }
  std::vector<SurfaceProfile> profiles;
  for (const auto& row : rows_of(folder_, from.mark_of(profiles_name))) {
    profiles.push_back(measures_.empty_profile());
    profiles.back().heights = {row.begin() + 2, row.end()};
  }
  measures_.set_shakings(shakings_of(resolved_, &simulation_));
  measures_.restore(std::move(moments), profiles);
}

void GrainMeasures::record(std::int64_t step, double time, bool regular) {
  measures_.set_shakings(shakings_of(resolved_, &simulation_));
  const GrainSimulation& present = simulation_.present();
  const MeasuredMoment& moment = measures_.record(step, time, present.present_grains(), present.placed_walls());
  if (!table_) return;
  table_->add(step, cells_of(moment), regular);
  std::vector<double> cells{time};
  const std::vector<double>& heights = measures_.surface().heights;
  cells.insert(cells.end(), heights.begin(), heights.end());
  profiles_->add(step, cells, regular);
}

void GrainMeasures::save(Checkpoint& checkpoint) {
  table_->sync();
  profiles_->sync();
  checkpoint.files.push_back(table_->mark());
  checkpoint.files.push_back(profiles_->mark());
}

namespace {

/// A value before and after: "LABEL 0.2 before, 0.18 after".
void add_both(Results& out, const std::string& key, const std::string& label, double before, double after,
              const std::string& unit = {}) {
  const std::string space = unit.empty() ? "" : unit + " ";
  out.add(key + "/before", label, before, space + "before", {.digits = 4})
      .add(key + "/after", "", after, space + "after", {.digits = 4});
}

}  // namespace

Results GrainMeasures::results() const {
  const MeasuredMoment& before = measures_.before();
  const MeasuredMoment& after = measures_.moments().back();
  Results out;
  out.set("mean_diameter", measures_.mean_diameter());
  const bool shakes = resolved_.shaking || std::ranges::any_of(resolved_.stages, [](const StageCase& stage) {
                        return stage.shaking.has_value();
                      });
  if (shakes) {
    out.line("measured", "before, at ")
        .add("time/before", "t =", before.time, "s", {.digits = 4})
        .note(", and after, at ")
        .add("time/after", "", after.time, "s", {.digits = 4});
  } else {
    out.set("time/before", before.time).set("time/after", after.time);
  }
  out.line("void ratio");
  add_both(out, "void_ratio", "e =", before.void_ratio, after.void_ratio);
  out.note("; ");
  add_both(out, "porosity", "porosity", before.porosity, after.porosity);
  out.note(resolved_.measures->region ? "; in the region given" : "; away from walls and surface");
  out.line("surface");
  add_both(out, "surface_height", "height", before.surface.height, after.surface.height, "m");
  out.note("; ");
  add_both(out, "surface_slope", "slope", before.surface.slope, after.surface.slope);
  out.note("; ");
  add_both(out, "surface_roughness", "roughness", before.surface.roughness, after.surface.roughness, "m");
  out.line("settlement")
      .add("settlement", "of the surface", before.surface.height - after.surface.height, "m", {.digits = 4})
      .add("settlement_of_centre", "of the centre of mass", before.centre.y - after.centre.y, "m", {.digits = 4});
  out.line("outside").add("outside", "", after.outside, "grain", {Shown::count}).note(" outside the box at the end");
  if (resolved_.measures->region && std::isnan(after.void_ratio))
    out.warning("WARNING", resolved_.where("measures.region") +
                               ": no body is left in the region at the end, and there is no void ratio; end the run "
                               "earlier, or give another region");
  if (std::isnan(after.surface.height))
    out.warning("WARNING",
                resolved_.where("measures") +
                    ": no heap of bodies is left in the box at the end, and there is no surface; end the run "
                    "earlier, or close the box by walls");
  if (const auto [grid, why] = grid_of_fields(); !why.empty()) out.warning("WARNING", why);
  return out.under("measures");
}

/// The grid at the end; empty, with the reason, where there is nothing to measure.
std::pair<CoarseGrid, std::string> GrainMeasures::grid_of_fields() const {
  if (!resolved_.measures->cell) return {};
  try {
    return {measures_.grid_of_fields(simulation_.present()), ""};
  } catch (const Error& error) {
    return {CoarseGrid{.region = {}, .columns = 0, .rows = 0},
            fmt::format("{}: there are no fields at the end: {}", resolved_.where("measures.cell"), error.what())};
  }
}

std::vector<std::string> GrainMeasures::files(const GrainCase& resolved) {
  std::vector<std::string> files{table_name, profiles_name};
  if (resolved.output.picture)
    for (const char* plot : {"surface_plot", "void_ratio_plot"})
      std::ranges::move(plot_files(plot), std::back_inserter(files));
  if (resolved.measures->cell) files.insert(files.end(), {"fields.csv", "fields.vti", "fields.png"});
  return files;
}

void GrainMeasures::write_files(const CommonOptions& into) const {
  const std::filesystem::path& folder = *into.out;
  if (resolved_.output.picture) {
    Plot plot{.title = resolved_.title, .x = {.label = "x, m"}, .y = {.label = "surface, m"}};
    const auto add = [&](const SurfaceProfile& profile, double time, PlotColour colour) {
      Series series{
          .label = fmt::format("t = {:.4g} s", time), .style = SeriesStyle::line_with_points, .colour = colour};
      for (std::size_t k = 0; k < profile.heights.size(); ++k) series.add(profile.place(k), profile.heights[k]);
      plot.series.push_back(std::move(series));
    };
    add(measures_.surface_before(), measures_.before().time, PlotColour::sky_blue);
    add(measures_.surface(), measures_.moments().back().time, PlotColour::vermilion);
    write_plot(folder, "surface_plot", plot, into.overwrite);
    Series ratio{.label = "", .colour = PlotColour::blue, .column = "void_ratio"};
    for (const MeasuredMoment& moment : measures_.moments()) ratio.add(moment.time, moment.void_ratio);
    if (std::ranges::any_of(ratio.y, [](double e) { return std::isfinite(e); })) {
      Plot history{.title = resolved_.title, .x = {.label = "time, s"}, .y = {.label = "void ratio e"}};
      history.series.push_back(std::move(ratio));
      write_plot(folder, "void_ratio_plot", history, into.overwrite);
    }
  }
  if (!resolved_.measures->cell) return;
  write_fields(folder, "fields", measures_.fields(simulation_.present(), grid_of_fields().first), into.overwrite);
}

void write_probe_paths(const CommonOptions& into, const GrainCase& resolved) {
  constexpr PlotColour colours[] = {PlotColour::blue,     PlotColour::vermilion, PlotColour::green,  PlotColour::orange,
                                    PlotColour::sky_blue, PlotColour::purple,    PlotColour::yellow, PlotColour::black};
  const auto cells = csv_cells(read_file(*into.out / "history.csv"));
  Plot plot{.title = resolved.title, .x = {.label = "x, m"}, .y = {.label = "y, m"}, .places = true};
  const auto& names = cells.front();
  for (const Probe& probe : resolved.probes) {
    const auto at = std::ranges::find(names, probe.name + "_x_m");
    if (at == names.end() || plot.series.size() == std::size(colours)) continue;
    const auto column = static_cast<std::size_t>(at - names.begin());
    Series series{.label = probe.name, .colour = colours[plot.series.size()]};
    for (std::size_t k = 1; k < cells.size(); ++k)
      series.add(csv_number(cells[k].at(column)).value_or(not_measured),
                 csv_number(cells[k].at(column + 1)).value_or(not_measured));
    plot.series.push_back(std::move(series));
  }
  if (!plot.series.empty()) write_plot(*into.out, "paths_plot", plot, into.overwrite);
}

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
                       .cell = simulation_.present().placed_cell(),
                       .started = case_.scene.grains,
                       .paths = paths},
                      into.overwrite);
}

LoadedSample GrainRun::loaded_sample() const {
  LoadedSample sample{.discs = case_.scene.grains};
  if (case_.body != Body::disc) return sample;
  sample.bonded = !case_.scene.bonds.empty();
  const std::vector<StageReport>& begun = simulation_.reports();
  if (case_.stages.empty()) sample.stages.push_back({0, &case_.scene});
  for (std::size_t k = 0; k < case_.stages.size(); ++k) {
    sample.stages.push_back(
        {k < begun.size() ? static_cast<double>(begun[k].first) * step_.step : INFINITY, &case_.stages[k].scene});
    sample.bonded = sample.bonded || case_.stages[k].bonds.has_value();
  }
  if (bodies_come_and_go(case_)) return sample;
  for (std::size_t k = 0; k < case_.scene.grains.size(); ++k)
    sample.solid_area += case_.scene.grains[k].inertia.mass / case_.densities[k];
  return sample;
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
  std::vector<OutputPart> parts{case_part([this]() -> const TomlValue& { return case_.document; })};
  const auto part = [&](const char* name, std::vector<std::string> files,
                        std::function<void(const CommonOptions&)> write) {
    parts.push_back({name, std::move(write), OutputPart::page, std::move(files)});
  };
  const auto write_energies = [this, &result](const CommonOptions& into) {
    write_energy_csv(*into.out / "energy.csv", result.record.energies, BodyFamily::colliding, case_.body,
                     into.overwrite);
  };
  part("energy.csv", {"energy.csv"}, write_energies);
  if (case_.output.csv) {
    part("grains.csv", {"grains.csv"}, [this](const CommonOptions& into) { write_tables(into); });
    part("contacts.csv", {"contacts.csv"}, [this](const CommonOptions& into) {
      const Snapshot now = snapshot();
      std::vector<GrainContact> contacts = simulation_.present().contacts();
      const auto place = [&](std::int32_t body) { return static_cast<std::int32_t>(now.places[body]); };
      for (GrainContact& c : contacts) c.i = place(c.i), c.j = c.j < 0 ? c.j : place(c.j);
      write_grain_contact_csv(*into.out / "contacts.csv", contacts, now.walls, case_.body, into.overwrite);
    });
    const auto write_bonds = [this](const CommonOptions& into) {
      if (simulation_.bonds().empty()) return;
      const StagedSimulation::HoldingBonds holding = snapshot().bonds;
      write_bond_csv(*into.out / "bonds.csv", holding.bonds, holding.strengths, into.overwrite);
    };
    part("bonds.csv", std::vector<std::string>(case_.scene.bonds.empty() ? 0 : 1, "bonds.csv"), write_bonds);
  }
  if (case_.scene.strengths) {
    std::vector<std::string> files = case_.output.picture ? plot_files("breaks_plot") : std::vector<std::string>{};
    if (case_.output.csv) files.emplace_back("breaks.csv");
    part("the table of breaks", files, [this](const CommonOptions& into) { write_breaks(into); });
  }
  if (case_.output.picture) {
    if (case_.output.probe_interval && needs_history()) {
      std::vector<std::string> files;
      for (const char* plot : SampleTest::plot_names) std::ranges::move(plot_files(plot), std::back_inserter(files));
      part("the plots of the test", std::move(files), [this](const CommonOptions& into) {
        if (const auto test = SampleTest::read(read_file(*into.out / "history.csv"), loaded_sample()))
          for (const auto& [name, plot] : test->plots(case_.title)) write_plot(*into.out, name, plot, into.overwrite);
      });
    }
    part("the picture", {"picture.svg", "picture.png"},
         [this, &result](const CommonOptions& into) { draw(into, result); });
    if (case_.output.probe_interval && !case_.probes.empty())
      part("the paths of probes", plot_files("paths_plot"),
           [this](const CommonOptions& into) { write_probe_paths(into, case_); });
    part("the film", {}, [this, &result](const CommonOptions& /*into*/) {
      std::vector<int> first_colours;
      for (const std::string& group : case_.groups) first_colours.push_back(colour_of(group));
      // where paths are drawn, pictures show where each body went
      const auto started =
          result.record.paths.empty() ? std::span<const Grain>(case_.scene.grains) : std::span<const Grain>();
      add_film(case_, walls_, first_colours, started, result.record.film);
    });
    part("the plot of energies", plot_files("energy_plot"), [this, &result](const CommonOptions& into) {
      write_energy_plot(into, "energy_plot", case_.title, case_.body, result.record.energies, further);
    });
  }
  if (measures_) {
    const auto write_measures = [this](const CommonOptions& into) {
      if (measures_->last_step() >= 0) measures_->write_files(into);
    };
    part("the measures", GrainMeasures::files(case_), write_measures);
  }
  std::ranges::move(files_of_steps(case_.output), std::back_inserter(parts.front().files));
  for (std::size_t k = 0; k + 1 < case_.stages.size(); ++k)  // the run itself writes them
    parts.front().files.push_back(fmt::format("run.{}.checkpoint.h5", case_.stages[k].name));
  return parts;
}

}  // namespace equidem
