// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/grains/scene/pair_options.hpp"
#include "equidem/grains/scene/wall_joints.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/histories.hpp"
#include "equidem/output/plots/plot.hpp"

#include "run/run_grains.hpp"

namespace equidem {
namespace {

/// "0.02", "0.01 to 0.02".
std::string range(double smallest, double largest) {
  return smallest == largest ? fmt::format("{:.6g}", smallest) : fmt::format("{:.6g} to {:.6g}", smallest, largest);
}

/// \param walls of all stages, one of each name
void add_bodies(Results& out, const GrainCase& resolved, const std::vector<Wall>& walls) {
  double mass = 0, smallest = INFINITY, largest = 0;
  std::map<std::string, std::int64_t> groups;
  std::array<std::int64_t, 3> counts{};  // in the order of GrainShape
  for (const Grain& grain : resolved.scene.grains) {
    mass += grain.inertia.mass;
    smallest = std::min(smallest, grain.radius);
    largest = std::max(largest, grain.radius);
    ++groups[resolved.contacts.kinds[static_cast<std::size_t>(grain.kind)]];
    ++counts[static_cast<std::size_t>(grain.shape())];
  }
  const auto [round, ellipses, clumps] = counts;
  out.set("body", to_string(resolved.body)).set("grains", resolved.scene.grains.size()).line("bodies");
  for (const auto& [count, name] :
       {std::pair{round, to_string(resolved.body)}, std::pair{ellipses, std::string("ellipse")},
        std::pair{clumps, std::string("clump")}}) {
    const std::string key = fmt::format("shapes/{}s", name);
    count > 0 ? out.add(key, "", count, name, {Shown::count}) : out.set(key, count);
  }
  out.add("", ellipses + clumps == 0 ? "radius" : "radius of the circle around each", range(smallest, largest), "m")
      .add("", "", mass, resolved.body == Body::disc ? "kg per m of depth in all" : "kg in all");
  if (const std::size_t later = resolved.groups.size() - resolved.scene.grains.size(); later > 0)
    out.line("").add("added_in_stages", "stages add", later, "", {Shown::count}).note(" more");
  if (clumps > 0) {
    const auto [fewest, most] =
        std::ranges::minmax(resolved.scene.clumps, {}, [](const Clump& clump) { return clump.discs.size(); });
    out.line("",
             fmt::format("clumps of {}", fewest.discs.size() == most.discs.size()
                                             ? counted(std::ssize(most.discs), "disc")
                                             : fmt::format("{} to {} discs", fewest.discs.size(), most.discs.size())));
  }
  if (ellipses > 0)
    out.line("", resolved.options.ellipse_law == GrainOptions::EllipseLaw::exact
                     ? "ellipses meet at their closest points (exact)"
                     : "ellipses meet by the test of enlarged ellipses: shallow contacts are missed, and the normal is "
                       "that of the body with the lower number");
  if (groups.size() > 1)
    out.line("groups",
             joined(groups, [](const auto& group) { return fmt::format("{} {}", group.first, group.second); }));
  out.set("walls", resolved.scene.walls.size());
  if (walls.empty()) return;
  const auto any_stage = [&](const Wall& wall, auto has) {
    return has(wall) || std::ranges::any_of(resolved.stages, [&](const StageCase& stage) {
             return std::ranges::any_of(stage.scene.walls,
                                        [&](const Wall& w) { return w.name == wall.name && has(w); });
           });
  };
  out.line("walls", joined(walls, [&](const Wall& wall) {
             constexpr const char* shapes[] = {"line", "segment", "arc"};
             return fmt::format("{} ({}{}{})", wall.name, shapes[static_cast<int>(wall.shape)],
                                any_stage(wall, [](const Wall& w) { return w.servo.has_value(); }) ? ", servo" : "",
                                any_stage(wall, [](const Wall& w) { return w.moves(); }) ? ", moves" : "");
           }));
}

std::string describe_pair(const GrainCase& resolved, const PairContact& pair) {
  const PairProperties& p = pair.properties;
  std::string text = fmt::format("restitution {}", p.restitution);
  if (describe(resolved.options.law).has_dashpot && p.restitution < 1)
    text += p.end == ContactEnd::at_zero_force ? " (never pulls)" : " (may pull at the end)";
  if (pair.duration > 0) {
    text += fmt::format(", contacts of {:.6g} s", pair.duration);
  } else if (p.dimensionless > 0) {
    text += fmt::format(", k dt²/m = {:.6g}", p.dimensionless);
  } else {
    text += fmt::format(", k = {:.6g} {}", p.stiffness, describe(resolved.options.law).stiffness_unit);
  }
  const auto effects = [&] {
    std::string found;
    if (p.rolling_friction > 0)
      found += fmt::format(", rolling friction {}, k_r/(kN R²) {:.6g}", p.rolling_friction, p.rolling_ratio);
    if (p.rolling_damping > 0) found += fmt::format(", rolling damping {}", p.rolling_damping);
    if (p.cohesion > 0)
      found += fmt::format(", cohesion {:.6g} {} within {:.6g} m", p.cohesion,
                           resolved.body == Body::disc ? "N/m" : "N", p.cohesion_range);
    return found;
  };
  if (p.friction == 0) return text + ", no friction" + effects();
  text += fmt::format(", friction {}, kT/kN {:.6g}", p.friction, p.tangential_ratio);
  if (p.tangential_ratio == 0) text += " (slides always)";
  if (p.tangential_damping > 0) text += fmt::format(", tangential damping {}", p.tangential_damping);
  return text + effects();
}

/// Every two kinds that can meet; pairs with equal contacts on one line.
std::vector<std::string> lines_of_pairs(const GrainCase& resolved, const ContactTable& contacts,
                                        const GrainScene& scene) {
  constexpr int most_kinds = 8;
  if (contacts.kind_count() > most_kinds)
    return {fmt::format("{} kinds of bodies, each pair with its own stiffness", contacts.kind_count())};
  const auto masses = masses_of_kinds(scene.grains, scene.kinds);
  std::vector<std::pair<std::string, std::vector<std::string>>> found;  // contact, pairs
  for (int a = 0; a < contacts.kind_count(); ++a) {
    for (int b = a; b < contacts.kind_count(); ++b) {
      if (!reduced_masses(masses, a, b)) continue;
      const std::string contact = describe_pair(resolved, contacts.between(a, b));
      auto at = std::ranges::find(found, contact, [](const auto& line) { return line.first; });
      if (at == found.end()) at = found.insert(at, {contact, {}});
      at->second.push_back(fmt::format("{} and {}", contacts.kinds[static_cast<std::size_t>(a)],
                                       contacts.kinds[static_cast<std::size_t>(b)]));
    }
  }
  std::vector<std::string> lines;
  for (const auto& [contact, pairs] : found)
    lines.push_back(found.size() == 1 ? contact : fmt::format("{}: {}", joined(pairs), contact));
  return lines;
}

void add_pairs(Results& out, const GrainCase& resolved) {
  std::vector<std::string> last = lines_of_pairs(resolved, resolved.contacts, resolved.scene);
  for (const std::string& line : last) out.line(&line == last.data() ? "contacts" : "", line);
  for (const StageCase& stage : resolved.stages) {
    std::vector<std::string> now = lines_of_pairs(resolved, stage.contacts, stage.scene);
    if (now == last) continue;
    for (const std::string& line : now) out.line("", fmt::format("from the stage '{}' on: {}", stage.name, line));
    last = std::move(now);
  }
}

void add_law(Results& out, const GrainCase& resolved) {
  const LawDescription& law = describe(resolved.options.law);
  out.line("law")
      .add("law", "", to_string(resolved.options.law))
      .note(fmt::format(" ({}): {}", law.letter, law.summary));
  if (law.kind == LawKind::force) {
    out.note(resolved.options.verlet() ? ", velocity Verlet" : ", semi-implicit Euler");
  }
  // A map reverses the approach of two bodies as if nothing else acted on them: summed at one body, that is too much.
  if (!is_map(resolved.options.law) || resolved.scene.grains.size() + resolved.scene.walls.size() <= 2) return;
  out.line("",
           "for bodies that meet two by two: each contact is taken as if nothing else acted on its bodies, and where "
           "they press on one another energy comes and goes; for beds exact_flow or linear_dashpot");
}

void add_bonds(Results& out, const GrainCase& resolved, const GrainTimeStep& step) {
  const bool later =
      std::ranges::any_of(resolved.stages, [](const StageCase& stage) { return stage.bonds.has_value(); });
  if (resolved.scene.bonds.empty() && !later) return;
  out.line("bonds")
      .add("bonds/number", "", resolved.scene.bonds.size(), "", {Shown::count})
      .note(later ? " at the start" : "")
      .note(", each decays exactly over a step");
  if (step.chain_limit > 0) {
    out.line("", "where a disc has several bonds, their dashpots lose too little energy: some per cent at ")
        .add("bonds/explicit_time_step", "", step.chain_limit, "s")
        .note(fmt::format(", in proportion to the step, which is {:.3g} of that", step.step / step.chain_limit));
  }
  if (step.bond_limit == 0) {
    out.line("", "they do not limit the step").set("bonds/critical_time_step", nullptr);
    return;
  }
  out.line("")
      .add("bonds/critical_time_step", "they limit the step to", step.bond_limit, "s")
      .add("", "it is", step.step / step.bond_limit, "of that", {.digits = 3});
}

/// Likely cause of a large error of the balance, and the remedy.
std::string advice_on_balance(const GrainCase& resolved, const EnergyLedger& ledger) {
  if (is_map(resolved.options.law)) {
    return fmt::format(
        "{:.3g} {} {}, as this law takes each contact as if nothing else acted on its bodies; take exact_flow or "
        "linear_dashpot where they press on one another",
        std::abs(ledger.error()), energy_unit(resolved.body),
        ledger.error() > 0 ? "came from nothing" : "vanished uncounted");
  }
  return "compare with a shorter step before trusting the motion";
}

/// Of the walls at the start, and of those of later stages that no stage before has moved.
std::vector<std::string> gaps_in_walls(const GrainCase& resolved) {
  const double smallest = smallest_inscribed_radius(resolved.scene);
  std::vector<std::string> sentences = gaps_of_walls(resolved.scene.walls, smallest), moved;
  for (const StageCase& stage : resolved.stages) {
    std::vector<Wall> standing = stage.scene.walls;
    std::erase_if(standing, [&](const Wall& wall) { return std::ranges::find(moved, wall.name) != moved.end(); });
    for (const std::string& sentence : gaps_of_walls(standing, smallest))
      if (std::ranges::find(sentences, sentence) == sentences.end()) sentences.push_back(sentence);
    for (const Wall& wall : standing)
      if (wall.moves() || wall.servo) moved.push_back(wall.name);
  }
  return sentences;
}

struct CountedChange {
  const char* key;
  std::size_t count;
  const char *what, *done;
};
std::array<CountedChange, 4> counts_of(const StageReport& stage) {
  return {{{"removed", stage.removed, "grain", " removed"},
           {"renamed", stage.renamed, "grain", " renamed"},
           {"added", stage.added, "grain", " added"},
           {"bonds_made", stage.bonds_made, "bond", " made"}}};
}

/// "2 grains removed, 13 bonds made".
std::string changes_of(const StageReport& stage) {
  std::vector<std::string> changes;
  for (const auto& [key, count, what, done] : counts_of(stage))
    if (count > 0) changes.push_back(counted(static_cast<long long>(count), what) + done);
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
          fmt::format("{0}: stage.{1}: the {2} of the stage '{3}' held no grain where the stage began, and nothing was "
                      "{1}d; correct the {2}, or leave the table out",
                      choices[k]->where(), list, choices[k]->find("box") != nullptr ? "box" : "group", stage.name));
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

/// "2 m/s² at most along (1, 0), 10 Hz, 2 cycles from 0 s to 0.2 s".
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
    for (const CountedChange& change : counts_of(stage))
      if (change.count > 0) row.set(change.key, change.count);
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
      out.warning("WARNING", text);
  return out;
}

/// A value of a servo since it came near the wanted one; null before.
template <class Report>
ResultValue since_reached(const Report& servo, double value) {
  return servo.reached && std::isfinite(value) ? ResultValue(value) : ResultValue(nullptr);
}

/// A row for each servo of each stage. \param present of the last stage
template <class Report, class Add>
std::vector<Results> servo_rows(const GrainCase& resolved, const std::vector<StageReport>& stages,
                                std::vector<Report> StageReport::*of, const std::vector<Report>& present,
                                const Add& add) {
  std::vector<Results> rows;
  for (const StageReport& stage : stages) {
    for (const Report& servo : &stage == &stages.back() ? present : stage.*of) {
      Results& row = rows.emplace_back();
      if (!resolved.stages.empty()) row.add("stage", "stage", stage.name);
      add(row, stage.name, servo);
    }
  }
  return rows;
}

Results servo_results(const GrainCase& resolved, const std::vector<StageReport>& stages,
                      const std::vector<ServoReport>& present) {
  const char* force = resolved.body == Body::disc ? "N/m" : "N";
  std::vector<std::string> missed, alone;
  const auto add = [&](Results& row, const std::string& stage, const ServoReport& servo) {
    if (!servo.reached && (servo.wanted > 0 || servo.present > 0))
      (servo.touched ? missed : alone).push_back(in_stage(resolved, fmt::format("'{}'", servo.wall), stage));
    row.add("wall", "servo", servo.mirror.empty() ? servo.wall : fmt::format("{} and {}", servo.wall, servo.mirror))
        .set("wanted", servo.wanted, force, "force that a servo wall was to have in the last step")
        .set("force", servo.present, force, "force with which a servo wall pushed in the last step")
        .set("touched", servo.touched)
        .set("reached", servo.reached);
    row.add("", fmt::format("wanted, {}", force), servo.wanted).add("", "force", servo.present);
    row.add("max_speed", "limit, m/s", servo.max_speed, "", {.digits = 3})
        .add("overshoot", "overshoot", since_reached(servo, servo.overshoot), "", {.digits = 3})
        .set("peak", since_reached(servo, servo.peak), "",
             "the same of the force in single steps, in which bodies knock")
        .add("", "in a step", since_reached(servo, servo.peak), "", {.digits = 3})
        .add("mean_error", "mean error", since_reached(servo, servo.mean_error), "", {.digits = 3});
  };
  std::vector<Results> rows = servo_rows(resolved, stages, &StageReport::servos, present, add);
  Results out;
  if (rows.empty()) return out;
  out.line("servo walls",
           "limit of their speed; overshoot, in the mean over a contact and in a step, and mean error since the force "
           "came within 1 % of the wanted one in its stage:");
  out.table("servos", std::move(rows));
  if (!missed.empty())
    out.warning("WARNING",
                fmt::format("the force of servo walls never came within 1 % of the wanted one: {}; let them move "
                            "faster (max_speed), or for longer",
                            joined(missed)));
  if (!alone.empty())
    out.warning("WARNING", fmt::format("servo walls met no body, and nothing was pressed: {}; let them move faster "
                                       "(max_speed), or for longer",
                                       joined(alone)));
  return out;
}

Results cell_servo_results(const GrainCase& resolved, const std::vector<StageReport>& stages,
                           const std::vector<CellServoReport>& present) {
  std::vector<std::string> missed;
  bool pulls = false;
  const auto add = [&](Results& row, const std::string& stage, const CellServoReport& servo) {
    if (!servo.reached && servo.wanted != 0) {
      missed.push_back(in_stage(resolved, servo.component, stage));
      pulls = pulls || servo.wanted > 0;
    }
    row.add("component", "stress", servo.component)
        .set("reached", servo.reached)
        .add("wanted", "wanted, Pa", servo.wanted)
        .add("stress", "in the last step", servo.present)
        .add("overshoot", "overshoot", since_reached(servo, servo.overshoot), "", {.digits = 3})
        .add("mean_error", "mean error", since_reached(servo, servo.mean_error), "", {.digits = 3});
  };
  std::vector<Results> rows = servo_rows(resolved, stages, &StageReport::cell_servos, present, add);
  Results out;
  if (rows.empty()) return out;
  out.line("", "overshoot and mean error since the stress came within 1 % of the wanted one:");
  out.table("servos", std::move(rows));
  if (!missed.empty())
    out.warning("WARNING",
                fmt::format("the stress of the cell never came within 1 % of the wanted one: {}; let it deform "
                            "faster (max_rate), or for longer{}",
                            joined(missed), pulls ? "; contacts carry no tension, bonds do" : ""));
  return out.under("cell");
}

constexpr std::pair<BreakMode, PlotColour> modes_of_bonds[] = {{BreakMode::tension, PlotColour::vermilion},
                                                               {BreakMode::shear, PlotColour::blue},
                                                               {BreakMode::bending, PlotColour::green}};
}  // namespace

Results GrainRun::breaks() const {
  Results out;
  if (!case_.scene.strengths) return out;
  const std::vector<BondBreak> breaks = simulation_.breaks();
  double energy = 0;
  for (const BondBreak& event : breaks) energy += event.energy;
  out.line("broken bonds")
      .add("breaks/number", "", breaks.size(), "", {Shown::count})
      .note(fmt::format(" of {}", simulation_.bonds().size()));
  for (const auto& [mode, colour] : modes_of_bonds) {
    out.add(fmt::format("breaks/{}", to_string(mode)), to_string(mode),
            std::ranges::count(breaks, mode, &BondBreak::mode), "", {Shown::count});
  }
  out.set("breaks/energy", energy);
  if (breaks.empty()) return out;
  const BondBreak& first = breaks.front();
  const GrainBond& bond = simulation_.bonds()[first.bond];
  out.line("", fmt::format("the first, of grains {} and {}, in {}: ", bond.i, bond.j, to_string(first.mode)))
      .add("breaks/first/time", "", static_cast<double>(first.step) * step_.step, "s")
      .set("breaks/first/bond", first.bond)
      .set("breaks/first/mode", to_string(first.mode));
  return out;
}

/// breaks.csv, in the order of time; with pictures breaks_plot, their places by mode.
void GrainRun::write_breaks(const CommonOptions& into) const {
  const std::filesystem::path& folder = *into.out;
  const std::vector<BondBreak> breaks = simulation_.breaks();
  if (case_.output.csv) {
    Table table;
    const auto bond = [&](const BondBreak& event) -> const GrainBond& { return simulation_.bonds()[event.bond]; };
    table.add("step", breaks, &BondBreak::step);
    table.add("time_s", breaks, [&](const BondBreak& event) { return static_cast<double>(event.step) * step_.step; });
    table.add("bond", breaks, &BondBreak::bond);
    table.add("i", breaks, [&](const BondBreak& event) { return bond(event).i; });
    table.add("j", breaks, [&](const BondBreak& event) { return bond(event).j; });
    table.add("x_m", breaks, [](const BondBreak& event) { return event.place.x; });
    table.add("y_m", breaks, [](const BondBreak& event) { return event.place.y; });
    table.add("mode", breaks, [](const BondBreak& event) { return std::string(to_string(event.mode)); });
    table.add(std::string("energy_J") + per_depth(case_.body), breaks, &BondBreak::energy);
    write_csv(folder / "breaks.csv", table, into.overwrite);
  }
  if (!case_.output.picture || breaks.empty()) return;
  Plot plot{.title = case_.title, .x = {.label = "x, m"}, .y = {.label = "y, m"}, .places = true};
  for (const auto& [mode, colour] : modes_of_bonds) {
    Series series{.label = to_string(mode), .style = SeriesStyle::points, .colour = colour};
    for (const BondBreak& event : breaks) {
      if (event.mode != mode) continue;
      series.add(event.place.x, event.place.y);
    }
    if (!series.x.empty()) plot.series.push_back(std::move(series));
  }
  write_plot(folder, "breaks_plot", plot, into.overwrite);
}

Results GrainRun::scene(const std::string& history) const {
  Results out;
  if (!case_.title.empty()) out.block(case_.title + "\n\n");
  out.set("title", case_.title);
  if (!history.empty()) {
    if (const auto test = SampleTest::read(history, loaded_sample())) out.append(test->results());
  } else if (!case_.output.probe_interval && needs_history()) {
    out.line("test", "no stress over strain: the walls or the cell load a sample, but [output] has no probe_interval");
  }
  add_bodies(out, case_, walls_);
  add_effects(out, simulation_.effects());
  add_law(out, case_);
  add_pairs(out, case_);
  if (case_.shaking) out.append(shaking_results(*case_.shaking).under("shaking"));
  for (const StageCase& stage : case_.stages)
    if (stage.shaking) out.line("shaking", fmt::format("in the stage '{}': {}", stage.name, describe(*stage.shaking)));
  for (const std::string& sentence : gaps_in_walls(case_)) out.warning("WARNING", sentence);
  add_bonds(out, case_, step_);
  return out;
}

std::vector<std::pair<std::string, std::vector<double>>> GrainRun::curves(const std::string& history) const {
  std::vector<std::pair<std::string, std::vector<double>>> curves;
  if (!needs_history()) return curves;
  const auto test = SampleTest::read(history, loaded_sample());
  if (!test) return curves;
  for (const auto& [name, plot] : test->plots("")) {
    for (const Series& series : plot.series) {
      if (curves.empty()) curves.emplace_back("strain", series.x);
      curves.emplace_back(series.column, series.y);
    }
  }
  return curves;
}

Results GrainRun::step() const {
  const LawDescription& law = describe(case_.options.law);
  Results out;
  out.line("time step").add("time_step", "", step_.step, "s").note(step_.automatic ? ", automatic" : "");
  out.set("time_step_automatic", step_.automatic);
  if (beginning_)
    out.line("begun with")
        .add("begun_from", "the state in", beginning_->path)
        .note(fmt::format(", stage '{}'", beginning_->stage));
  if (step_.contact > 0) {
    out.line("")
        .add("contact_duration", "the shortest contact lasts", step_.contact, "s", {.digits = 4})
        .add("steps_in_contact", "", step_.steps_in_contact(), "steps", {.digits = 3})
        .note(fmt::format(" ({})", step_.between));
  } else {
    out.line("", "how long contacts last is not known: ")
        .note(law.spring_power != 1 ? "with this law it depends on the speed (give closing_speed)"
                                    : "no two bodies can meet");
    out.set("contact_duration", nullptr).set("steps_in_contact", nullptr);
  }
  const bool limited = step_.omega_step > 0 && step_.limit > 0;
  if (step_.omega_step > 0) out.line("").add("omega_time_step", "omega dt =", step_.omega_step, "", {.digits = 4});
  if (limited) {
    out.add("", "", step_.omega_step / step_.limit, "of", {.digits = 3})
        .note(fmt::format(" {:.4g}, {}", step_.limit,
                          is_map(case_.options.law) ? "past which a contact is over in a step"
                                                    : "the limit of stability of one contact; several at a body lower "
                                                      "it"));
  } else if (step_.omega_step > 0) {
    out.note("; a single contact is exact at any step");
  } else {
    out.set("omega_time_step", nullptr);
  }
  return out.set("critical_time_step",
                 limited ? ResultValue(step_.step * step_.limit / step_.omega_step) : ResultValue(nullptr));
}

Results GrainRun::events() const {
  const GrainCounters& counters = simulation_.present().counters();
  Results out = measures_ && measures_->last_step() >= 0 ? measures_->results() : Results();
  if (!case_.stages.empty()) out.append(stage_results(case_, simulation_.reports(), step_.step));
  out.append(servo_results(case_, simulation_.reports(), simulation_.present().servos()));
  if (const auto cell = simulation_.cell())
    out.append(cell_results(*cell)).append(cell_servo_results(case_, simulation_.reports(), cell->servos));
  out.line("collisions")
      .add("contacts", "", counters.contacts, "contact", {Shown::count})
      .note(" begun")
      .add("touching", "", simulation_.present().contacts().size(), "at the end")
      .add("evaluations", "", counters.evaluations, "evaluation", {Shown::count})
      .note(" of the law");
  if (const auto contacts = simulation_.present().contacts(); !contacts.empty()) {
    const std::vector<Grain> grains = simulation_.present().grains();
    double largest = 0;
    for (const GrainContact& contact : contacts) {
      const auto radius = [&](std::int32_t body) { return grains[static_cast<std::size_t>(body)].radius; };
      const double smaller = contact.j < 0 ? radius(contact.i) : std::min(radius(contact.i), radius(contact.j));
      largest = std::max(largest, contact.overlap / smaller);
    }
    out.line("").add("largest_overlap", "they overlap by at most", largest, "of the smaller radius", {.digits = 3});
  } else {
    out.set("largest_overlap", nullptr);
  }
  out.set("sweeps", counters.sweeps).set("rebuilds", counters.rebuilds);
  return out.append(breaks());
}

Results GrainRun::advice(const Balance& balance) const {
  Results out;
  if (std::abs(balance.at_end) > Balance::doubtful)
    out.warning("", "that is much: " + advice_on_balance(case_, simulation_.energy()));
  if (const std::int64_t doubtful = simulation_.present().counters().doubtful; doubtful > 0) {
    out.line("", fmt::format("of all evaluations {} were of contacts pressed together in a step that may feed their "
                             "vibration: the step is safe for one contact, not for any cluster; compare with one a "
                             "third as long",
                             grouped(doubtful)));
  }
  return out;
}

}  // namespace equidem
