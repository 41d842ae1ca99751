// SPDX-License-Identifier: GPL-3.0-or-later
#include "case_text.hpp"

#include <algorithm>
#include <charconv>
#include <span>
#include <system_error>
#include <utility>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

void erase_key(TomlValue& table, std::string_view name) {
  std::erase_if(table.entries, [&](const TomlEntry& entry) { return entry.name == name; });
}

}  // namespace

TomlValue deciding_tables(TomlValue document, Decided result) {
  constexpr auto of = [](Decided one) { return 1U << static_cast<unsigned>(one); };
  constexpr unsigned assembly = of(Decided::assembly), bonded = of(Decided::bonded_motion),
                     colliding = of(Decided::colliding_motion), path = of(Decided::path),
                     all = assembly | bonded | colliding | path;
  // Tables, and keys of tables, each with the results that it does not decide; what is not listed decides all. Steps,
  // schedules and stages have parts of their own in the case texts of runs.
  constexpr std::pair<std::string_view, unsigned> undeciding[] = {{"title", all},
                                                                  {"output", all},
                                                                  {"homogenize", all},
                                                                  {"ensemble", all},
                                                                  {"strength_target", all},
                                                                  {"solver", assembly | bonded},
                                                                  {"effects", assembly},
                                                                  {"viscoelastic", assembly},
                                                                  {"strength", assembly | bonded},
                                                                  {"strain", assembly | bonded},
                                                                  {"dead_load", assembly | bonded},
                                                                  {"notch", assembly | bonded},
                                                                  {"quasistatic", assembly | bonded},
                                                                  {"quasistatic.max_events", path},
                                                                  {"quasistatic.frame_every", path},
                                                                  {"run", assembly | path},
                                                                  {"run.duration", bonded | colliding},
                                                                  {"run.time_step", bonded | colliding},
                                                                  {"run.allow_unstable_step", bonded},
                                                                  {"run.steps_per_contact", colliding},
                                                                  {"schedule", assembly | path | colliding},
                                                                  {"wall", assembly | path},
                                                                  {"velocity", path},
                                                                  {"probe", path | colliding},
                                                                  {"measures", colliding},
                                                                  {"stage", colliding}};
  for (const auto& [name, results] : undeciding) {
    if ((results & of(result)) == 0) continue;
    const std::size_t dot = name.find('.');
    TomlValue* const table = dot == std::string_view::npos ? &document : document.find(name.substr(0, dot));
    if (table != nullptr) erase_key(*table, name.substr(dot + 1));
  }
  const auto is_empty = [](const TomlEntry& entry) { return entry.value.is_table() && entry.value.entries.empty(); };
  std::erase_if(document.entries, is_empty);
  return document;
}

void add(Checksum& sum, const Schedule& schedule) {
  for (const double number :
       {static_cast<double>(schedule.kind), schedule.value, schedule.start, schedule.end, schedule.frequency})
    sum.add(number);
  for (const auto* numbers : {&schedule.times, &schedule.values}) sum.add(*numbers);
}

std::optional<StepInText> step_in(std::string_view text) {
  const std::size_t at = text.rfind(step_line);
  if (at == std::string_view::npos) return {};
  text.remove_prefix(at + step_line.size());
  StepInText found;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), found.step);
  if (failed != std::errc()) return {};
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  found.rest = text.substr(0, text.find('\n'));
  return found;
}

MissedEvent check_event(const Schedule& schedule, double step, double duration, const std::string& where) {
  constexpr double most = 0.5;
  const MissedEvent missed = missed_event(schedule, step, duration);
  if (missed.share <= most) return missed;
  bad_input_at(where,
               fmt::format("its schedule has an event at {:.6g} s that steps of {:.6g} s miss", missed.time, step),
               fmt::format("between two steps lie {:.0f} % of the range of its values", 100 * missed.share),
               "Give a time_step well below its length, or let it last longer");
}

namespace {

constexpr std::string_view stage_heading = "\n# stage ", schedule_heading = "\n# schedules\n",
                           checksum_line = "\n# checksum of grains and schedules ",
                           beginning_heading = "\n# begun behind stage ";

void add_bodies(Checksum& sum, std::span<const Grain> grains, std::span<const double> densities) {
  for (std::size_t g = 0; g < grains.size(); ++g) {
    const Grain& grain = grains[g];
    for (const double value :
         {grain.position.x, grain.position.y, grain.radius, grain.velocity.x, grain.velocity.y, grain.spin, grain.angle,
          densities[g], static_cast<double>(grain.kind), grain.short_half_axis, static_cast<double>(grain.clump)})
      sum.add(value);
  }
}

void add_shapes(Checksum& sum, std::span<const Grain> grains, std::span<const Clump> clumps) {
  for (const Grain& grain : grains)
    if (grain.shape() == GrainShape::clump)
      for (const Clump::Disc& disc : clumps[static_cast<std::size_t>(grain.clump)].discs)
        for (const double value : {disc.offset.x, disc.offset.y, disc.radius}) sum.add(value);
}

/// Motions of walls and of the cell.
void add_motions(Checksum& sum, const GrainScene& scene) {
  for (const Wall& wall : scene.walls) {
    add(sum, wall.move_x), add(sum, wall.move_y);
    if (wall.servo) add(sum, wall.servo->wanted);
  }
  if (!scene.cell) return;
  for (const Schedule* rate : {&scene.cell->rate_xx, &scene.cell->rate_yy, &scene.cell->rate_xy}) add(sum, *rate);
  if (scene.cell->servo)
    for (const auto* stress : {&scene.cell->servo->stress_xx, &scene.cell->servo->stress_yy})
      if (*stress) add(sum, **stress);
}

/// Tells whether files that a case names are still what they were.
std::string checksum_of(const GrainCase& resolved) {
  Checksum sum;
  add_bodies(sum, resolved.scene.grains, resolved.densities);
  for (const GrainBond& bond : resolved.scene.bonds)
    for (const double value :
         {static_cast<double>(bond.i), static_cast<double>(bond.j), bond.normal_dashpot, bond.tangential_dashpot,
          bond.rolling_dashpot, bond.normal_spring, bond.tangential_spring, bond.bending_spring})
      sum.add(value);
  if (const auto& strengths = resolved.scene.strengths)
    for (std::size_t b = 0; b < strengths->tension.size(); ++b)
      sum.add(strengths->tension[b]), sum.add(strengths->shear[b]);
  add_shapes(sum, resolved.scene.grains, resolved.scene.clumps);
  if (resolved.stages.empty()) add_motions(sum, resolved.scene);
  return sum.text();
}

/// Likewise, of one stage. \param first_added number of the first body that it adds
std::string checksum_of(const GrainCase& resolved, std::size_t stage, std::size_t first_added) {
  Checksum sum;
  const StageCase& of = resolved.stages[stage];
  add_bodies(sum, of.bodies.added, std::span(resolved.densities).subspan(first_added));
  add_shapes(sum, of.bodies.added, resolved.scene.clumps);
  add_motions(sum, of.scene);
  return sum.text();
}

}  // namespace

std::string case_text_of(const GrainCase& resolved, double step) {
  TomlValue schedules;
  schedules.type = TomlValue::Type::table;
  if (const TomlValue* given = resolved.document.find("schedule")) schedules.entries.push_back({"schedule", *given});
  std::string text = to_toml(deciding_tables(resolved.document, Decided::colliding_motion), {}) +
                     fmt::format("{}{} s{}{}\n", step_line, toml_number(step), checksum_line, checksum_of(resolved));
  std::size_t bodies = resolved.scene.grains.size();
  for (std::size_t k = 0; k < resolved.stages.size(); ++k) {
    TomlValue stage = casefile::repeated(resolved.document, "stage")[k];
    if (stage.find("until") != nullptr) erase_key(stage, "duration"), erase_key(stage, "steps");  // a limit alone
    text += fmt::format("{}{}\n{}{}{}\n", stage_heading, resolved.stages[k].name, to_toml(std::move(stage), {}),
                        checksum_line, checksum_of(resolved, k, bodies));
    bodies += resolved.stages[k].bodies.added.size();
  }
  return text + std::string(schedule_heading) + to_toml(std::move(schedules), {});
}

std::string text_of(const Beginning& beginning) {
  return fmt::format("{}{}\n{}", beginning_heading, beginning.stage, beginning.path);
}

std::optional<Beginning> beginning_in(std::string_view text) {
  const std::size_t at = text.rfind(beginning_heading);
  if (at == std::string_view::npos) return {};
  text.remove_prefix(at + beginning_heading.size());
  const std::size_t end = text.find('\n');
  return Beginning{.path = std::string(text.substr(end + 1)), .stage = std::string(text.substr(0, end))};
}

std::size_t stages_in(std::string_view text) {
  std::size_t count = 0;
  for (std::size_t at = text.find(stage_heading); at != std::string_view::npos; at = text.find(stage_heading, at + 1))
    ++count;
  return count;
}

std::string until_stage(std::string_view text, std::size_t stages) {
  std::size_t at = 0;
  for (std::size_t k = 0; k < stages; ++k) at = text.find(stage_heading, at) + 1;
  return std::string(text.substr(0, std::min(text.find(stage_heading, at), text.find(schedule_heading, at))));
}

}  // namespace equidem
