// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_grains.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/casefile/engine/echo.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/energies.hpp"
#include "equidem/output/files/grain_frames.hpp"
#include "equidem/output/files/grain_tables.hpp"
#include "equidem/output/pictures/grain_picture.hpp"

#include "run/run_bonds_report.hpp"
#include "run/run_grains_report.hpp"
#include "run/run_report.hpp"

namespace equidem {
namespace {

constexpr std::int64_t samples = 200, samples_of_few = 1000;  // of the energies, the latter where paths are drawn

/// Possible error of kinetic and potential energy by the rounding of positions.
double rounding_of_energy(const GrainSetup& setup, const std::vector<Grain>& grains) {
  constexpr double rounding = 1e-15;
  double sum = 0;
  for (const Grain& grain : grains) {
    const double lost_way = rounding * norm(grain.position) / setup.step.step;
    sum += grain.inertia.mass *
           (lost_way * lost_way + 1e3 * rounding * norm(setup.resolved.scene.gravity) * norm(grain.position));
  }
  return sum;
}

/// Losses may be counted badly where steps are long; motion out of nothing is no answer at all.
/// \throws Error (computation_failed)
void refuse_made_energy(const GrainSetup& setup, const GrainSimulation& simulation, const EnergyLedger& ledger) {
  if (!std::isfinite(ledger.error())) {
    computation_failed(fmt::format("step {}: an energy is not a number any more", simulation.step()),
                       "squares of speeds, or stiffnesses, are beyond all numbers", "Use smaller ones");
  }
  constexpr double most = 4;
  const double given = ledger.initial + std::abs(ledger.work_of_walls) + std::abs(ledger.potential);
  if (ledger.kinetic <= most * given) return;
  if (ledger.kinetic <= most * (given + rounding_of_energy(setup, simulation.grains()))) return;
  computation_failed(
      fmt::format("step {}: the bodies move with {:.3g} times the energy that there was", simulation.step(),
                  ledger.kinetic / given),
      "contacts make energy where steps are too long for them, and maps where several act on a body at once",
      "Use a shorter time_step, or the law exact_flow");
}

}  // namespace

GrainRun::GrainRun(const GrainSetup& setup) : setup_(setup), simulation_(setup.simulation()) {
  if (setup.resolved.measures) measures_.emplace(setup.resolved, simulation_);
  frame_discs_ = discs_of_frames(setup.resolved.scene.grains, setup.resolved.scene.clumps, frames_);
}

RunPlan GrainRun::plan() {
  const GrainCase& resolved = setup_.resolved;
  const bool draws_paths = resolved.scene.grains.size() <= most_drawn_paths;
  RunPlan plan{.steps = setup_.steps,
               .time_step = setup_.step.step,
               .case_text = setup_.fingerprint(),
               .frame_interval = output().frame_interval,
               .probe_interval = output().probe_interval,
               .checkpoint_interval = output().checkpoint_interval,
               .frame_discs = &frame_discs_,
               .frames = frames_,
               .body = resolved.body,
               .samples = draws_paths ? samples_of_few : samples,
               .paths = draws_paths,
               .recorder = measures_ ? &*measures_ : nullptr,
               .watch = [this](const EnergyLedger& energy) { refuse_made_energy(setup_, simulation_, energy); },
               .step_place = resolved.where("run.time_step")};
  for (const GrainProbe& wanted : resolved.probes) {
    Probe probe{wanted.name, wanted.grains, {}};
    for (const std::string& word : wanted.quantities) probe.quantities.push_back(enum_from<ProbeQuantity>(word));
    plan.probes.push_back(std::move(probe));
  }
  return plan;
}

std::string GrainRun::describe() const {
  return describe_grains(setup_, simulation_);
}

std::string GrainRun::describe_events() const {
  const GrainCounters& counters = simulation_.counters();
  return (measures_ ? measures_->describe() : "") +
         report_line("collisions", fmt::format("{} contacts begun, {} at the end; {} evaluations of the law",
                                               grouped(counters.contacts), simulation_.contacts().size(),
                                               grouped(counters.evaluations))) +
         describe_drift_of_bonds(simulation_.bonds());
}

std::string GrainRun::describe_balance(const Balance& balance) const {
  return describe_grain_balance(setup_, simulation_, balance);
}

void GrainRun::add_step(JsonObject& object) const {
  add_grain_step(object, setup_.step);
}

void GrainRun::add_results(JsonObject& object) const {
  add_grain_results(object, setup_, simulation_);
  add_shaking(object, setup_.resolved);
  if (measures_) measures_->add_to(object);
}

void GrainRun::write_files(const std::filesystem::path& folder, const RunResult& result, bool overwrite) const {
  constexpr EnergyCurve curves[] = {
      {"kinetic", PlotColour::blue, [](const EnergyLedger& l) { return l.kinetic; }},
      {"elastic", PlotColour::vermilion, [](const EnergyLedger& l) { return l.elastic(); }},
      {"potential", PlotColour::green, [](const EnergyLedger& l) { return l.potential; }},
      {"lost at impacts", PlotColour::orange,
       [](const EnergyLedger& l) { return l.lost_restitution + l.lost_dashpot + l.lost_release; }},
      {"lost by friction", PlotColour::purple,
       [](const EnergyLedger& l) { return l.lost_slip + l.lost_tangential_dashpot; }},
      {"lost in bonds", PlotColour::yellow, [](const EnergyLedger& l) { return l.lost_bond; }},
      {"put in by walls", PlotColour::sky_blue, [](const EnergyLedger& l) { return l.work_of_walls; }},
  };
  const GrainCase& resolved = setup_.resolved;
  const std::vector<Grain> grains = simulation_.grains();
  std::vector<std::string> groups;
  std::vector<int> colours;
  for (const Grain& grain : grains) {
    groups.push_back(resolved.contacts.kinds[static_cast<std::size_t>(grain.kind)]);
    // Kinds of one group may differ by radius: the first of them lends its colour.
    colours.push_back(
        static_cast<int>(std::find(resolved.contacts.kinds.begin(), resolved.contacts.kinds.end(), groups.back()) -
                         resolved.contacts.kinds.begin()));
  }
  if (resolved.output.csv) {
    write_grain_csv(folder / "grains.csv", {grains, resolved.scene.clumps, groups, resolved.densities}, overwrite);
    write_grain_contact_csv(folder / "contacts.csv", simulation_.contacts(), resolved.scene.walls, resolved.body,
                            overwrite);
  }
  if (resolved.output.csv && !resolved.scene.bonds.empty())
    write_bond_csv(folder / "bonds.csv", resolved.scene.bonds, simulation_.bond_drifts(), overwrite);
  if (resolved.output.picture) {
    write_grain_picture(folder, "picture",
                        {.title = resolved.title,
                         .time = simulation_.time(),
                         .grains = grains,
                         .clumps = resolved.scene.clumps,
                         .groups = colours,
                         .bonds = resolved.scene.bonds,
                         .walls = resolved.scene.walls,
                         .paths = result.record.paths},
                        overwrite);
    write_energy_plot(folder, "energy_plot", resolved.title, resolved.body, result.record.energies, curves, overwrite);
    write_probe_paths(folder, resolved, overwrite);
  }
  write_energy_csv(folder / "energy.csv", result.record.energies, BodyFamily::colliding, resolved.body, overwrite);
  write_file(folder / "case.toml", to_toml(resolved.document, folder), overwrite);
  if (measures_) measures_->write_files(folder, overwrite);
}

}  // namespace equidem
