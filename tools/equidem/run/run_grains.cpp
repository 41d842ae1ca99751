// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_grains.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/files/energies.hpp"
#include "equidem/output/files/grain_frames.hpp"
#include "equidem/output/pictures/grain_picture.hpp"

#include "run/break_files.hpp"
#include "run/run_case_text.hpp"
#include "run/run_film.hpp"
#include "run/run_results.hpp"

namespace equidem {
namespace {

constexpr std::int64_t energy_samples = 200,
                       samples_of_few = 1000;  // of the energies, the latter where paths are drawn

/// Tells whether files that a case names are still what they were.
std::string checksum_of(const GrainCase& resolved) {
  Checksum sum;
  for (std::size_t g = 0; g < resolved.scene.grains.size(); ++g) {
    const Grain& grain = resolved.scene.grains[g];
    for (const double value : {grain.position.x, grain.position.y, grain.radius, grain.velocity.x, grain.velocity.y,
                               grain.spin, grain.angle, resolved.densities[g], static_cast<double>(grain.kind),
                               grain.short_half_axis, static_cast<double>(grain.clump)})
      sum.add(value);
  }
  for (const GrainBond& bond : resolved.scene.bonds)
    for (const double value :
         {static_cast<double>(bond.i), static_cast<double>(bond.j), bond.normal_dashpot, bond.tangential_dashpot,
          bond.rolling_dashpot, bond.normal_spring, bond.tangential_spring, bond.bending_spring})
      sum.add(value);
  if (const auto& strengths = resolved.scene.strengths)
    for (std::size_t b = 0; b < strengths->tension.size(); ++b)
      sum.add(strengths->tension[b]), sum.add(strengths->shear[b]);
  for (const Clump& clump : resolved.scene.clumps)
    for (const Clump::Disc& disc : clump.discs)
      for (const double value : {disc.offset.x, disc.offset.y, disc.radius}) sum.add(value);
  const auto add_walls = [&](const std::vector<Wall>& walls) {
    for (const Wall& wall : walls) {
      add(sum, wall.move_x), add(sum, wall.move_y);
      if (wall.servo) add(sum, wall.servo->wanted);
    }
  };
  add_walls(resolved.scene.walls);
  if (const auto& cell = resolved.scene.cell) {
    for (const Schedule* rate : {&cell->rate_xx, &cell->rate_yy, &cell->rate_xy}) add(sum, *rate);
    if (cell->servo)
      for (const auto* stress : {&cell->servo->stress_xx, &cell->servo->stress_yy})
        if (*stress) add(sum, **stress);
  }
  for (const StageCase& stage : resolved.stages) add_walls(stage.scene.walls);
  return sum.text();
}

void check_events(const GrainCase& resolved, double step) {
  const auto length_of = [&](const StageCase& stage) {
    return stage.duration ? *stage.duration : static_cast<double>(*stage.steps) * step;
  };
  for (std::size_t k = 0; k < resolved.stages.size(); ++k)
    for (const Wall& wall : resolved.stages[k].scene.walls)
      for (const Schedule* motion : {&wall.move_x, &wall.move_y})
        check_event(*motion, step, length_of(resolved.stages[k]), resolved.where(fmt::format("stage.{}", k)));
  if (const auto& cell = resolved.scene.cell) {
    for (const Schedule* rate : {&cell->rate_xx, &cell->rate_yy, &cell->rate_xy})
      check_event(*rate, step, resolved.duration, resolved.where("cell.motion"));
    if (cell->servo)
      for (const auto* stress : {&cell->servo->stress_xx, &cell->servo->stress_yy})
        if (*stress) check_event(**stress, step, resolved.duration, resolved.where("cell.servo"));
  }
  if (!resolved.stages.empty()) return;
  for (std::size_t k = 0; k < resolved.scene.walls.size(); ++k)
    for (const Schedule* motion : {&resolved.scene.walls[k].move_x, &resolved.scene.walls[k].move_y})
      check_event(*motion, step, resolved.duration, resolved.where(fmt::format("wall.{}.schedule", k)));
}

StagedSimulation simulation_of(const GrainCase& resolved, double step) {
  const GrainScene scene = build_grain_scene(resolved, step);
  const GrainOptions options = grain_options(resolved, step);
  if (scene.cell) casefile::with_place(resolved.where("cell"), [&] { check_cell(scene, options); });
  try {
    check(scene, options, [&](std::size_t grain) { return resolved.where_grain(grain); });
  } catch (const Error& error) {
    throw error.at(resolved.where("collisions"));
  }
  for (std::size_t k = 0; k < resolved.stages.size(); ++k)
    casefile::with_place(resolved.where(fmt::format("stage.{}", k)),
                         [&] { check_servos(resolved.stages[k].scene, options.law); });
  for (std::size_t k = 0; k < resolved.stages.size(); ++k)
    if (const auto& bonds = resolved.stages[k].bonds)
      casefile::with_place(resolved.where(fmt::format("stage.{}.bonds", k)),
                           [&] { check(*bonds, scene.grains, options); });
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

/// Strengths of the bonds that have not broken, in their order. \param strengths null: none
ContactStrengths strengths_left(const ContactStrengths* strengths, std::span<const BondBreak> breaks) {
  ContactStrengths left;
  if (strengths == nullptr) return left;
  std::vector<char> broken(strengths->tension.size(), 0);
  for (const BondBreak& event : breaks) broken[event.bond] = 1;
  for (std::size_t b = 0; b < broken.size(); ++b) {
    if (broken[b] != 0) continue;
    left.tension.push_back(strengths->tension[b]);
    left.shear.push_back(strengths->shear[b]);
  }
  return left;
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

/// Stops a run whose kinetic energy exceeds several times all energy supplied; smaller errors of the balance are
/// reported at the end.
/// \throws Error (computation_failed)
void refuse_made_energy(const GrainCase& resolved, double step, const GrainSimulation& simulation,
                        const EnergyLedger& ledger) {
  if (!std::isfinite(ledger.error())) {
    computation_failed(fmt::format("step {}: an energy is not a number any more", simulation.step()),
                       "squares of speeds, or stiffnesses, are beyond all numbers", "Use smaller ones");
  }
  constexpr double most = 4;
  const double given = ledger.initial + std::abs(ledger.work_of_walls) + std::abs(ledger.potential) +
                       std::max(0.0, ledger.work_of_stages) + std::max(0.0, ledger.work_of_cell);
  if (ledger.kinetic <= most * given) return;
  if (ledger.kinetic <= most * (given + rounding_of_energy(resolved, step, simulation.grains()))) return;
  computation_failed(
      fmt::format("step {}: the bodies move with {:.3g} times the energy that there was", simulation.step(),
                  ledger.kinetic / given),
      "contacts make energy where steps are too long for them, and maps where several act on a body at once",
      "Use a shorter time_step, or the law exact_flow");
}

/// \throws Error (computation_failed) where a servo wall has met no body until the end of a stage
void refuse_idle_servos(const GrainCase& resolved, const StagedSimulation& simulation) {
  for (const ServoReport& servo : simulation.present().servos()) {
    if (servo.touched || servo.wanted == 0) continue;
    const auto at = std::ranges::find(resolved.scene.walls, servo.wall, &Wall::name) - resolved.scene.walls.begin();
    throw Error(ErrorKind::computation_failed, fmt::format("the servo wall '{}' met no body until the end", servo.wall),
                "nothing pushes back that its force could be held", "Let it move faster or the run last longer",
                resolved.stages.empty() ? resolved.where(fmt::format("wall.{}.servo", at))
                                        : resolved.where(fmt::format("stage.{}", simulation.reports().size() - 1)));
  }
}

}  // namespace

GrainRun::GrainRun(GrainCase resolved)
    : case_(std::move(resolved)),
      step_(choose_grain_step(case_)),
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
  frame_discs_ = discs_of_frames(case_.scene.grains, case_.scene.clumps, frames_);
}

std::vector<std::string> GrainRun::files() const {
  std::vector<std::string> names{"energy.csv"};
  if (case_.measures) names.emplace_back("measures.csv");
  if (case_.output.csv) names.emplace_back("grains.csv");
  if (case_.output.picture) names.emplace_back("picture.png");
  for (std::size_t k = 0; k + 1 < case_.stages.size(); ++k)
    names.push_back(fmt::format("run.{}.checkpoint.h5", case_.stages[k].name));
  return names;
}

RunPlan GrainRun::plan() {
  const bool draws_paths = case_.scene.grains.size() <= most_drawn_paths;
  return {.steps = steps_,
          .time_step = step_.step,
          .case_text = fingerprint(),
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
          .watch =
              [this](const EnergyLedger& energy) {
                refuse_made_energy(case_, step_.step, simulation_.present(), energy);
                if (simulation_.milestone() >= 0) refuse_idle_servos(case_, simulation_);
              },
          .step_place = case_.where("run.time_step")};
}

std::string GrainRun::fingerprint() const {
  TomlValue known = case_.document;
  erase_keys(*known.find("run"), {"duration", "time_step", "steps_per_contact"});  // the step is below
  if (TomlValue* stages = known.find("stage"))
    for (TomlValue& stage : stages->items)
      if (stage.find("until") != nullptr) erase_keys(stage, {"duration", "steps"});  // a limit alone
  erase_keys(known, {"title", "output", "probe", "measures"});
  return to_toml(std::move(known), {}) + fmt::format("\n# step {} s\n# checksum of grains and schedules {}\n",
                                                     toml_number(step_.step), checksum_of(case_));
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
      {"lost in bonds", PlotColour::yellow, [](const EnergyLedger& l) { return l.lost_bond + l.lost_breaking; }},
      {"work done by walls", PlotColour::sky_blue, [](const EnergyLedger& l) { return l.work_of_walls; }},
  };
  const GrainCase& resolved = case_;
  const std::vector<Grain> grains = simulation_.present().grains();
  const std::vector<Wall> walls = simulation_.present().placed_walls();
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
    write_grain_contact_csv(folder / "contacts.csv", simulation_.present().contacts(), walls, resolved.body, overwrite);
  }
  const std::vector<BondBreak> breaks = simulation_.present().breaks();
  const std::vector<GrainBond> bonds = bonds_left(simulation_.bonds(), breaks);
  if (resolved.output.csv && !simulation_.bonds().empty())
    write_bond_csv(folder / "bonds.csv", bonds, simulation_.present().bond_drifts(),
                   strengths_left(simulation_.strengths(), breaks), overwrite);
  write_breaks(folder, resolved, {simulation_.bonds(), breaks}, step_.step, overwrite);
  if (resolved.output.picture) {
    write_grain_picture(folder, "picture",
                        {.title = resolved.title,
                         .time = simulation_.time(),
                         .grains = grains,
                         .clumps = resolved.scene.clumps,
                         .groups = colours,
                         .bonds = bonds,
                         .walls = walls,
                         .paths = result.record.paths},
                        overwrite);
    write_energy_plot(folder, "energy_plot", resolved.title, resolved.body, result.record.energies, curves, overwrite);
    write_probe_paths(folder, resolved, overwrite);
    add_film(resolved, walls_, colours, result.record.film);
  }
  write_energy_csv(folder / "energy.csv", result.record.energies, BodyFamily::colliding, resolved.body, overwrite);
  write_file(folder / "case.toml", to_toml(resolved.document, folder), overwrite);
  if (measures_) measures_->write_files(folder, overwrite);
}

}  // namespace equidem
