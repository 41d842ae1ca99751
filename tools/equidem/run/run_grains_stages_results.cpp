// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_grains_stages_results.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// "2 grains removed, 13 bonds made".
std::string changes_of(const StageReport& stage) {
  std::vector<std::string> changes;
  const auto add = [&](std::size_t count, const char* what, const char* done) {
    if (count > 0) changes.push_back(counted(static_cast<long long>(count), what) + done);
  };
  add(stage.removed, "grain", " removed");
  add(stage.renamed, "grain", " renamed");
  add(stage.added, "grain", " added");
  add(stage.bonds_made, "bond", " made");
  for (const WallRenaming& wall : stage.renamed_walls)
    changes.push_back(fmt::format("wall '{}' renamed '{}'", wall.from, wall.to));
  return joined(changes);
}

/// Removals and renamings of a stage that held no grain, and bonds that tied none: the line of each in the case and
/// what to do.
std::vector<std::string> idle_choices(const TomlValue& table, const StageReport& stage) {
  std::vector<std::string> told;
  const auto tell = [&](const char* list, const std::vector<std::size_t>& idle) {
    std::vector<const TomlValue*> choices;
    for (const TomlValue& choice : casefile::repeated(table, list))
      if (choice.find("wall") == nullptr) choices.push_back(&choice);
    for (const std::size_t k : idle)
      told.push_back(
          fmt::format("{}: stage.{}: {} of the stage '{}' held no grain where the stage began, and nothing "
                      "was {}d; correct {}, or leave the table out",
                      choices[k]->where(), list, choices[k]->find("box") != nullptr ? "the box" : "the group",
                      stage.name, list, choices[k]->find("box") != nullptr ? "the box" : "the group"));
  };
  tell("remove", stage.idle_removals);
  tell("rename", stage.idle_renamings);
  if (const TomlValue* bonds = table.find("bonds"); bonds != nullptr && stage.bonds_made == 0)
    told.push_back(
        fmt::format("{}: stage.bonds: no two discs were near enough in the stage '{}', and no bond was made; "
                    "give a larger gap_tolerance, or leave the table out",
                    bonds->where(), stage.name));
  return told;
}

/// "'lid' in the stage 'press'"
std::string in_stage(const GrainCase& resolved, const std::string& what, const std::string& stage) {
  return resolved.stages.empty() ? what : fmt::format("{} in the stage '{}'", what, stage);
}

}  // namespace

std::string describe(const Shaking& shaking) {
  return fmt::format("{:.4g} m/s² at most along ({:.4g}, {:.4g}), {} Hz, {} from {:.4g} s to {:.4g} s",
                     shaking.peak_acceleration, shaking.direction.x, shaking.direction.y, shaking.frequency,
                     counted(static_cast<long long>(shaking.cycles), "cycle"), shaking.displacement.start,
                     shaking.displacement.end);
}

Results shaking_results(const Shaking& shaking) {
  Results out;
  out.line("shaking", describe(shaking));
  out.line("")
      .add("peak_velocity", "at most", shaking.peak_velocity, "m/s", {.digits = 4})
      .add("peak_displacement", "", shaking.peak_displacement, "m", {.digits = 4});
  return out.set("peak_acceleration", shaking.peak_acceleration).set("direction", shaking.direction);
}

Results stage_results(const GrainCase& resolved, const std::vector<StageReport>& stages, double step) {
  const bool any_changes = std::ranges::any_of(stages, [](const StageReport& s) { return !changes_of(s).empty(); });
  std::vector<Results> rows;
  for (std::size_t k = 0; k < stages.size(); ++k) {
    const StageReport& stage = stages[k];
    const char* reason = stage.ended ? "met its end" : stage.over ? "duration" : "not over";
    Results& row = rows.emplace_back();
    row.add("name", "stage", stage.name)
        .add("start", "from, s", static_cast<double>(stage.first) * step)
        .add("end", "to, s", static_cast<double>(stage.last) * step)
        .add("steps", "steps", stage.last - stage.first)
        .add("ended_by", "ended by", reason)
        .set("effects", stage.effects);
    if (any_changes) row.add("", "began with", changes_of(stage));
    if (stage.kinetic > 0 || stage.unbalanced > 0)
      row.set("kinetic_over_elastic", stage.kinetic).set("unbalanced_force_ratio", stage.unbalanced);
    for (const auto& [key, count] : {std::pair{"removed", stage.removed},
                                     {"renamed", stage.renamed},
                                     {"added", stage.added},
                                     {"bonds_made", stage.bonds_made}})
      if (count > 0) row.set(key, count);
    if (!stage.renamed_walls.empty()) {
      std::vector<Results> names;
      for (const WallRenaming& wall : stage.renamed_walls)
        names.emplace_back().set("from", wall.from).set("to", wall.to);
      row.set("renamed_walls", std::move(names));
    }
    if (stage.strain > 0) row.set("strain", stage.strain, "", "strain of a stage when it was last looked at");
    if (stage.displacement > 0)
      row.set("displacement", stage.displacement, "m", "way of a wall in a stage when it was last looked at");
    if (const auto& shaking = resolved.stages[k].shaking)
      row.append(shaking_results(*shaking).hidden().under("shaking"));
  }
  Results out;
  out.line("stages", "what changes the energies of the scene between them is in the ledger:");
  out.table("stages", std::move(rows));
  for (std::size_t k = 0; k < stages.size(); ++k)
    for (const std::string& text : idle_choices(casefile::repeated(resolved.document, "stage")[k], stages[k]))
      out.line("WARNING", text);
  return out;
}

Results servo_results(const GrainCase& resolved, const std::vector<StageReport>& stages,
                      const std::vector<ServoReport>& present) {
  const char* force = resolved.body == Body::disc ? "N/m" : "N";
  std::vector<Results> rows;
  std::vector<std::string> missed, alone;
  const auto add = [&](const std::string& stage, const ServoReport& servo) {
    if (!servo.reached && (servo.wanted > 0 || servo.force > 0))
      (servo.touched ? missed : alone).push_back(in_stage(resolved, fmt::format("'{}'", servo.wall), stage));
    Results& row = rows.emplace_back();
    if (!resolved.stages.empty()) row.add("stage", "stage", stage);
    row.add("wall", "servo", servo.mirror.empty() ? servo.wall : fmt::format("{} and {}", servo.wall, servo.mirror))
        .set("wanted", servo.wanted, force, "force that a servo wall was to have in the last step")
        .set("force", servo.force, force, "force with which a servo wall pushed in the last step")
        .set("touched", servo.touched)
        .set("reached", servo.reached);
    row.add("", fmt::format("wanted, {}", force), servo.wanted).add("", "force", servo.force);
    const auto share = [&](double value) {
      return servo.reached && std::isfinite(value) ? ResultValue(value) : ResultValue(nullptr);
    };
    row.add("max_speed", "limit, m/s", servo.max_speed, "", {.digits = 3})
        .add("overshoot", "overshoot", share(servo.overshoot), "", {.digits = 3})
        .set("peak", share(servo.peak), "", "the same of the force in single steps, in which bodies knock")
        .add("", "in a step", share(servo.peak), "", {.digits = 3})
        .add("mean_error", "mean error", share(servo.mean_error), "", {.digits = 3});
  };
  for (const StageReport& stage : stages)
    for (const ServoReport& servo : &stage == &stages.back() ? present : stage.servos) add(stage.name, servo);
  Results out;
  if (rows.empty()) return out;
  out.line("servo walls",
           "limit of their speed; overshoot, in the mean over a contact and in a step, and mean error since the force "
           "came within 1 % of the wanted one in its stage:");
  out.table("servos", std::move(rows));
  if (!missed.empty())
    out.line("WARNING",
             fmt::format("the force of servo walls never came within 1 % of the wanted one: {}; let them move "
                         "faster (max_speed), or for longer",
                         joined(missed)));
  if (!alone.empty())
    out.line("WARNING", fmt::format("servo walls met no body, and nothing was pressed: {}; let them move faster "
                                    "(max_speed), or for longer",
                                    joined(alone)));
  return out;
}

Results cell_servo_results(const GrainCase& resolved, const std::vector<StageReport>& stages,
                           const std::vector<CellServoReport>& present) {
  std::vector<Results> rows;
  std::vector<std::string> missed;
  bool pulls = false;
  const auto add = [&](const std::string& stage, const CellServoReport& servo) {
    if (!servo.reached && servo.wanted != 0) {
      missed.push_back(in_stage(resolved, servo.component, stage));
      pulls = pulls || servo.wanted > 0;
    }
    const auto share = [&](double value) {
      return servo.reached && std::isfinite(value) ? ResultValue(value) : ResultValue(nullptr);
    };
    Results& row = rows.emplace_back();
    if (!resolved.stages.empty()) row.add("stage", "stage", stage);
    row.add("component", "stress", servo.component)
        .set("reached", servo.reached)
        .add("wanted", "wanted, Pa", servo.wanted)
        .add("stress", "in the last step", servo.stress)
        .add("overshoot", "overshoot", share(servo.overshoot), "", {.digits = 3})
        .add("mean_error", "mean error", share(servo.mean_error), "", {.digits = 3});
  };
  for (const StageReport& stage : stages)
    for (const CellServoReport& servo : &stage == &stages.back() ? present : stage.cell_servos) add(stage.name, servo);
  Results out;
  if (rows.empty()) return out;
  out.line("", "overshoot and mean error since the stress came within 1 % of the wanted one:");
  out.table("servos", std::move(rows));
  if (!missed.empty())
    out.line("WARNING", fmt::format("the stress of the cell never came within 1 % of the wanted one: {}; let it deform "
                                    "faster (max_rate), or for longer{}",
                                    joined(missed), pulls ? "; contacts carry no tension, bonds do" : ""));
  return out.under("cell");
}

}  // namespace equidem
