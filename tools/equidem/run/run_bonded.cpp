// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_bonded.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

#include "equidem/casefile/assembly/build.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/checksum.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/files/checkpoint.hpp"
#include "equidem/output/files/vtk.hpp"

#include "case_text.hpp"
#include "solve/solve.hpp"

namespace equidem {
namespace {

Vec2 mean_velocity(const std::vector<DiscMotion>& velocities, const std::vector<std::int32_t>& bodies) {
  Vec2 sum;
  for (const std::int32_t body : bodies) sum += velocities[static_cast<std::size_t>(body)].u;
  return sum / static_cast<double>(bodies.size());
}

/// Speeds of the plane waves along x and y whose bodies move along a component, beside a measured one. The stiffness is
/// that of long waves: c² = C_11/rho of the P wave along x, C_22/rho along y, C_33/rho of S waves.
void add_theory(Results& out, const std::string& key, double speed, bool along_x, const WaveStiffness& wave) {
  const double stiffness = wave.stiffness[along_x ? 0 : 1][along_x ? 0 : 1];
  const double pressure = std::sqrt(stiffness / wave.density), shear = std::sqrt(wave.stiffness[2][2] / wave.density);
  if (!(pressure > 0 && shear >= 0)) return;
  const bool is_pressure = std::abs(speed - pressure) <= std::abs(speed - shear);
  const double theory = is_pressure ? pressure : shear;
  out.line("")
      .note("long waves by the stiffness of the cell: ")
      .add(key + "theory/pressure", fmt::format("Vp along {} =", along_x ? 'x' : 'y'), pressure, "m/s")
      .add(key + "theory/shear", "Vs =", shear, "m/s")
      .note("; ")
      .add(key + "speed_over_theory", "measured", speed / theory, is_pressure ? "of Vp" : "of Vs");
  out.set(key + "theory/speed", theory);
}

}  // namespace

StandingWaves::StandingWaves(const AnySimulation& simulation, const std::vector<Probe>& probes)
    : simulation_(simulation) {
  for (const Probe& probe : probes)
    if (probe.wavelength) waves_.push_back({.probe = probe});
}

void StandingWaves::open(const std::filesystem::path& /*folder*/, bool /*overwrite*/, const Checkpoint* from) {
  if (from == nullptr) return;
  const SavedState saved{.step = 0, .arrays = {from->record.recorded.front()}};
  const auto rows = rows_in<SavedWave>(saved, saved.arrays.front().name, SavedWave::numbers);
  for (std::size_t k = 0; k < waves_.size() && k < rows.size(); ++k) {
    last_step_ = rows[k].last_step;
    waves_[k].component = rows[k].component;
    waves_[k].oscillation = rows[k].oscillation;
  }
}

void StandingWaves::record(std::int64_t step, double time, bool regular) {
  if (!regular) return;
  last_step_ = step;
  const std::vector<DiscMotion> velocities = simulation_.velocities();
  for (Wave& wave : waves_) {
    const Vec2 v = mean_velocity(velocities, wave.probe.bodies);
    if (wave.component == Component::none && (v.x != 0 || v.y != 0))
      wave.component = std::abs(v.x) >= std::abs(v.y) ? Component::x : Component::y;
    if (wave.component != Component::none) wave.oscillation.add(time, wave.component == Component::x ? v.x : v.y);
  }
}

void StandingWaves::save(Checkpoint& checkpoint) {
  std::vector<SavedWave> rows;
  for (const Wave& wave : waves_) rows.push_back({last_step_, wave.component, wave.oscillation});
  checkpoint.record.recorded.push_back(saved_rows("waves", std::move(rows), SavedWave::numbers));
}

Results StandingWaves::results(const std::optional<WaveStiffness>& stiffness) const {
  Results out;
  for (const Wave& wave : waves_) {
    const std::string key = fmt::format("waves/{}/", wave.probe.name);
    const auto period = wave.oscillation.period();
    out.line("wave " + wave.probe.name).set(key + "wavelength", *wave.probe.wavelength);
    if (!period) {
      out.note(last_step_ < 1 ? "not measured: [output] has no probe_interval"
                              : "not measured: the velocity passes through zero fewer than two times in this run; give "
                                "a longer duration, or start the wave with velocities of both signs");
      out.set(key + "period", nullptr).set(key + "speed", nullptr);
      continue;
    }
    out.add(key + "speed", "", *wave.probe.wavelength / *period, "m/s")
        .note(fmt::format(", wavelength {:.6g} m over a ", *wave.probe.wavelength))
        .add(key + "period", "period of", *period, "s")
        .note(fmt::format(" ({} through zero of {}, ", counted(wave.oscillation.passages(), "passage"),
                          wave.component == Component::x ? "vx" : "vy"))
        .add(key + "spread_of_half_periods", "half periods within", *wave.oscillation.spread(), "of their mean",
             {Shown::percent, 2})
        .note(")");
    out.set(key + "passages", wave.oscillation.passages());
    if (stiffness) add_theory(out, key, *wave.probe.wavelength / *period, wave.component == Component::x, *stiffness);
  }
  return out;
}

namespace {

/// Line of the fingerprint: "# step 1e-06 s, rule lanczos".
constexpr std::string_view step_rule = " s, rule ";

Case with_run(Case resolved) {
  if (!resolved.run) {
    bad_input_at(resolved.document.where(), "the case has no [run]",
                 "a run needs its duration, or to be told to come to rest", "Add [run] with duration or until_rest");
  }
  return resolved;
}

TimeStep step_of(Problem& problem, const Scene& scene, const std::optional<KeptStep>& kept) {
  const RunCase& run = *problem.resolved.run;
  Stopwatch watch;
  TimeStepOptions wanted = run.time_step;
  wanted.duration = run.duration.value_or(0);
  TimeStep step;
  if (run.until_rest) {  // inertia and steps of its own
    step.step = 1;
    return step;
  }
  if (kept && !wanted.step) {
    wanted.step = kept->step;
    wanted.step_of_rule = true;
    if (kept->rule == to_string(TimeStepRule::bound)) wanted.rule = TimeStepRule::bound;
  }
  step = casefile::with_place(problem.resolved.where(run.time_step.step ? "run.time_step" : "run"),
                              [&] { return choose_time_step(scene, simulation_options(problem.resolved, 1), wanted); });
  problem.times.add("time step", watch.lap());
  if (!wanted.step) step.step = std::min(step.step, wanted.duration);
  if (kept && step.step == kept->step) {
    step.rule = kept->rule;
    step.notes.emplace_back("The step is that of the checkpoint.");
  }
  return step;
}

/// Schedules that change faster than the steps can resolve.
void check_events(const Case& resolved, TimeStep& step) {
  constexpr double share_to_mention = 0.05;
  const double end = resolved.run->duration.value_or(0);
  const auto check = [&](const Schedule& schedule, const char* table, std::size_t k) {
    const MissedEvent missed =
        check_event(schedule, step.step, end, resolved.where(fmt::format("{}.{}.schedule", table, k)));
    if (missed.share > share_to_mention) {
      step.notes.push_back(fmt::format("Of the schedule of {} {} steps miss up to {:.0f} % of its range, at {:.6g} s.",
                                       table, k, 100 * missed.share, missed.time));
    }
  };
  const RunCase& run = *resolved.run;
  for (std::size_t k = 0; k < run.supports.size(); ++k) {
    const TimedSupport& support = run.supports[k];
    for (const auto* motion : {&support.ux, &support.uy, &support.rotation})
      if (*motion) check(**motion, "support", k);
  }
  for (std::size_t k = 0; k < run.loads.size(); ++k) check(run.loads[k].factor, "load", k);
  for (std::size_t k = 0; k < run.walls.size(); ++k)
    for (const Schedule* motion : {&run.walls[k].move_x, &run.walls[k].move_y}) check(*motion, "wall", k);
}

/// Tells whether files that a case names are still what they were.
std::string checksum_of(const Assembly& assembly) {
  Checksum sum;
  for (const Vec2 centre : assembly.centres) sum.add(centre.x), sum.add(centre.y);
  sum.add(assembly.radii);
  for (const Contact& contact : assembly.contacts) {
    for (const std::int32_t number : {contact.i, contact.j, contact.shift_x, contact.shift_y})
      sum.add(static_cast<std::uint64_t>(number));
    sum.add(contact.lever_i), sum.add(contact.lever_j);
  }
  return sum.text();
}

std::string checksum_of(const Assembly& assembly, const ContactSprings& springs) {
  Checksum sum;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) sum.add(springs[c].kN), sum.add(springs[c].kT);
  return sum.text();
}

std::string checksum_of_schedules(const Scene& scene) {
  Checksum sum;
  for (const TimedSupport& support : scene.supports)
    for (const auto* motion : {&support.ux, &support.uy, &support.rotation})
      if (*motion) add(sum, **motion);
  for (const TimedLoad& load : scene.loads) add(sum, load.factor);
  for (const Wall& wall : scene.walls) add(sum, wall.move_x), add(sum, wall.move_y);
  return sum.text();
}

void sort_keys(TomlValue& value) {
  std::ranges::stable_sort(value.entries, {}, [](const auto& entry) -> const std::string& { return entry.name; });
  for (auto& [name, entry] : value.entries) sort_keys(entry);
  for (TomlValue& item : value.items) sort_keys(item);
}

/// Waves that stand in a periodic cell are as long as the cell, or a whole fraction of it.
void check_wavelengths(const Problem& problem, const std::vector<Probe>& probes) {
  if (!problem.assembly.periodic()) return;
  const Vec2 cell = *problem.assembly.period;
  const double longest = std::max(cell.x, cell.y) * (1 + 1e-6);
  for (std::size_t k = 0; k < probes.size(); ++k) {
    if (!probes[k].wavelength || *probes[k].wavelength <= longest) continue;
    bad_input_at(problem.resolved.where(fmt::format("probe.{}.wavelength", k)),
                 fmt::format("a wave of {:.6g} m does not stand in a periodic cell of {:.6g} m by {:.6g} m",
                             *probes[k].wavelength, cell.x, cell.y),
                 "what repeats with the cell is at most as long as the cell",
                 "Give the width or the height of the cell");
  }
}

Simulation simulation_of(const Problem& problem, const Scene& scene, const SimulationOptions& options) {
  return casefile::with_place(problem.resolved.where("run"), [&] { return Simulation(scene, options); });
}

std::vector<ContactForce> forces_of(const Scene& scene, LoopKind::Motion motion,
                                    const std::vector<DiscMotion>& motions) {
  std::vector<ContactForce> forces;
  for (const BodyContact& contact : bonded_contacts(scene, motion, motions, 0))
    if (contact.j >= 0) forces.push_back({contact.normal_force, contact.tangential_force});
  return forces;
}

}  // namespace

KeptStep kept_step(const std::filesystem::path& checkpoint) {
  const std::string text = case_of_checkpoint(checkpoint);
  if (const auto found = step_in(text); found && found->rest.starts_with(step_rule))
    return {found->step, std::string(found->rest.substr(step_rule.size()))};
  bad_input(fmt::format("cannot go on from '{}'", checkpoint.string()), "its case does not name the time step",
            "Start the run afresh");
}

BondedRun::BondedRun(Case resolved, const std::optional<KeptStep>& kept)
    : problem_(problem_of(with_run(std::move(resolved)), Purpose::step)),
      scene_(build_scene(problem_.resolved, problem_.assembly, problem_.springs.springs)),
      step_(step_of(problem_, scene_, kept)),
      options_(simulation_options(problem_.resolved, step_.step)),
      simulation_(simulation_of(problem_, scene_, options_)),
      probes_(build_probes(problem_.resolved, problem_.assembly)),
      waves_(simulation_, probes_),
      watch_(scene_, options_, {.growth = 100, .critical_step = step_.critical, .growth_rate = step_.growth_rate}) {
  if (!goes_to_rest()) check_events(problem_.resolved, step_);
  check_wavelengths(problem_, probes_);
}

std::int64_t BondedRun::steps() const {
  if (!run().duration) return 0;
  return casefile::with_place(problem_.resolved.where("run.duration"),
                              [&] { return count_steps(*run().duration, step_.step); });
}

RunPlan BondedRun::plan() {
  const OutputCase& output = problem_.resolved.output;
  return {.steps = steps(),
          .time_step = step_.step,
          .case_text = fingerprint(),
          .frame_interval = output.frame_interval,
          .probe_interval = output.probe_interval,
          .checkpoint_interval = output.checkpoint_interval,
          .frame_discs = &problem_.assembly,
          .frames = {.contacts = output.frame_contacts},
          .probes = probes_,
          .walls = names_of(run().walls),
          .recorder = waves_.empty() ? nullptr : &waves_,
          .watch = [this](const EnergyLedger& energy) { watch_.look(simulation_, energy); },
          .watch_between = true};
}

std::string BondedRun::fingerprint() const {
  TomlValue known = deciding_tables(problem_.resolved.document, Decided::bonded_motion);
  sort_keys(known);
  return to_toml(std::move(known), {}) +
         fmt::format("{}{}{}{}\n# checksums: discs and contacts {}\n# springs {}\n# schedules {}\n", step_line,
                     toml_number(step_.step), step_rule, step_.rule, checksum_of(problem_.assembly),
                     checksum_of(problem_.assembly, problem_.springs.springs), checksum_of_schedules(scene_));
}

std::vector<OutputPart> BondedRun::parts(const RunResult& result) const {
  static constexpr EnergyCurve further[] = {
      {"dissipated", PlotColour::orange, [](const EnergyLedger& l) { return l.lost(); }},
      {"put in", PlotColour::sky_blue, [](const EnergyLedger& l) { return l.work(); }},
  };
  const OutputCase& output = problem_.resolved.output;
  std::vector<OutputPart> parts{case_part([this]() -> const Case& { return problem_.resolved; })};
  const auto state_part = [&](bool wanted, const char* name, std::vector<std::string> files, const auto& write) {
    if (!wanted) return;
    const auto write_state = [this, write](const CommonOptions& into) {
      if (goes_to_rest() && at_rest_.empty()) return;
      const std::vector<DiscMotion> motions = goes_to_rest() ? at_rest_ : simulation_.motions();
      std::vector<ContactForce> forces;
      if (run().motion == LoopKind::Motion::small) forces = forces_of(scene_, LoopKind::Motion::small, motions);
      write(into, {.assembly = problem_.assembly, .motions = motions, .contact_forces = forces, .stresses = {}});
    };
    parts.push_back({name, write_state, OutputPart::page, std::move(files)});
  };
  state_part(output.csv, "discs.csv", {"discs.csv"}, [](const CommonOptions& into, const AssemblyState& state) {
    write_disc_csv(*into.out / "discs.csv", state, into.overwrite);
  });
  state_part(output.vtk, "the state for ParaView", {"state.vtm", "state_discs.vtp", "state_contacts.vtp"},
             [](const CommonOptions& into, const AssemblyState& state) {
               write_vtk(*into.out, "state", state, into.overwrite);
             });
  const auto draw = [this](const CommonOptions& into, const AssemblyState& state) {
    const bool far = run().motion == LoopKind::Motion::finite;  // then where it began is worth seeing
    write_picture(*into.out, "picture", state, {.title = problem_.resolved.title, .undeformed = far}, into.overwrite);
  };
  state_part(output.picture, "the picture", {"picture.svg", "picture.png"}, draw);
  if (goes_to_rest()) return parts;
  std::ranges::move(files_of_steps(output), std::back_inserter(parts.front().files));
  const auto draw_energies = [this, &result](const CommonOptions& into) {
    write_energy_plot(into, "energy", problem_.resolved.title, Body::disc, result.record.energies, further);
  };
  parts.push_back({"the plot of energies", draw_energies, OutputPart::page, plot_files("energy")});
  const auto draw_film = [this, &result](const CommonOptions& /*into*/) {
    add_film(problem_.resolved.title, problem_.assembly, result.record.film);
  };
  if (output.picture) parts.push_back({"the film", draw_film, OutputPart::page});
  return parts;
}

Results BondedRun::relax(StageTimes& times) {
  Stopwatch watch;
  Relaxation rest = equidem::relax(
      scene_, {.motion = run().motion, .rotation = problem_.resolved.rotation, .tolerance = *run().until_rest});
  times.add("relaxation", watch.lap());
  at_rest_ = std::move(rest.motions);
  Results out = scene("")
                    .line("rest", rest.report())
                    .set("steps", rest.steps)
                    .set("force_evaluations", rest.evaluations)
                    .set("relative_unbalanced_force", rest.relative_unbalanced);
  add_deformation(out, deformation_at(at_rest_), run().motion == LoopKind::Motion::small);
  if (const std::optional<TensionTest>& test = problem_.resolved.test) {
    problem_.tension = tension_setup(problem_.assembly, *test);
    Equilibrium reached;
    reached.motions = at_rest_;
    out.append(tension_results(
        problem_, evaluate_tension(problem_.assembly, problem_.springs.springs, *test, *problem_.tension, reached)));
  }
  return out;
}

LargestDeformation BondedRun::deformation_at(const std::vector<DiscMotion>& motions) const {
  return largest_deformation(problem_.assembly, problem_.springs.springs, forces_of(scene_, run().motion, motions));
}

Results BondedRun::events() const {
  Results out = waves_.results(stiffness_of_waves());
  add_deformation(out, deformation_at(simulation_.motions()), run().motion == LoopKind::Motion::small);
  return out;
}

std::optional<WaveStiffness> BondedRun::stiffness_of_waves() const {
  constexpr std::size_t most_discs = 200000;  // more take longer to homogenize than most runs
  const Assembly& assembly = problem_.assembly;
  if (waves_.empty() || !assembly.periodic() || assembly.size() > most_discs || simulation_.effects().restrained)
    return std::nullopt;
  double mass = 0;
  for (const Inertia& inertia : scene_.inertia) mass += inertia.mass;
  try {
    const EffectiveStiffness effective =
        effective_stiffness(assembly, problem_.springs.springs,
                            {.rotation = problem_.resolved.rotation, .solver = problem_.resolved.solver});
    return WaveStiffness{effective.stiffness, mass / assembly.area()};
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    return std::nullopt;
  }
}

namespace {

constexpr double balance_to_mention = 1e-3;  // of the largest energy

/// Keys of the case that have no effect on a run to rest.
std::string unused_at_rest(const RunCase& run, const OutputCase& output) {
  std::vector<std::string> names;
  const auto name = [&](bool given, const char* key) {
    if (given) names.emplace_back(key);
  };
  name(run.time_step.step.has_value(), "time_step");
  name(run.integrator != Integrator::leapfrog, "integrator");
  name(run.damping.mass > 0 || run.damping.acts_late(), "[run.damping]");
  name(!run.velocities.empty(), "[[velocity]]");
  name(output.frame_interval.has_value(), "frame_interval");
  name(!run.probes.empty() || output.probe_interval, "[[probe]]");
  return joined(names);
}

bool any_schedule(const Scene& scene) {
  const auto changes = [](const std::optional<Schedule>& motion) { return motion && motion->changes(); };
  return std::ranges::any_of(
             scene.supports,
             [&](const TimedSupport& s) { return changes(s.ux) || changes(s.uy) || changes(s.rotation); }) ||
         std::ranges::any_of(scene.loads, [](const TimedLoad& load) { return load.factor.changes(); }) ||
         std::ranges::any_of(scene.walls, [](const Wall& wall) { return wall.moves(); });
}

}  // namespace

int BondedRun::order() const {
  return order_of(options_);
}

Results BondedRun::scene(const std::string& /*history*/) const {
  const RunCase& run = this->run();
  const bool small = run.motion == LoopKind::Motion::small;
  Results out = problem_results(problem_, simulation_.effects(), AssemblyKeys::size);
  if (const auto& springs = problem_.springs.constants) out.set("springs/ratio", springs->ratio());
  out.line("motions")
      .add("motion", "", small ? "small" : "finite")
      .note(small ? ": normals and contact points fixed, the forces are those of the matrix K"
                  : ": normals and contact points follow the bodies");
  if (run.until_rest) {
    const std::string unused = unused_at_rest(run, problem_.resolved.output);
    if (!unused.empty()) out.line("not used", unused + ": a run to rest has steps of its own and no time");
    if (any_schedule(scene_))
      out.line("schedules", "as they are at t = 0: a run to rest has no time, and starts from there");
    return out;
  }
  const IntegrationScheme& scheme = scheme_of(run.integrator);
  return out.line("integrator")
      .add("integrator", "", to_string(run.integrator))
      .add("", "order", order())
      .note(order() < scheme.order ? " (dampers act half a step late)"
            : order() > 2 && !scene_.walls.empty()
                ? " (2 over steps in which a disc touches or leaves a wall: its force has a kink)"
                : "")
      .add("", "", static_cast<int>(scheme.stages(1, 0).size()), "force evaluation", {Shown::count})
      .note(" a step");
}

Results BondedRun::step() const {
  Results out;
  out.line("time step").add("time_step", "", step_.step, "s");
  if (std::isinf(step_.critical)) {
    out.note("; nothing vibrates, any step is stable");
    out.set("critical_time_step", step_.critical).set("time_step_ratio", step_.ratio());
    out.set("time_step_rule", step_.rule);
  } else {
    out.add("time_step_ratio", "", step_.ratio(), step_.exact ? "of the critical step" : "of the guaranteed step",
            {.digits = 4})
        .note(" ")
        .add("critical_time_step", "", step_.critical, "s")
        .note(" (")
        .add("time_step_rule", "rule:", step_.rule)
        .note(")");
  }
  out.set("critical_time_step_exact", step_.exact).set("omega_max", step_.omega_max);
  for (const std::string& note : step_.notes) out.line("", note);
  return out;
}

Results BondedRun::advice(const Balance& balance) const {
  Results out;
  if (balance.most > balance_to_mention) {
    // The work of what drives a run is counted to the second order.
    const bool driven = !scene_.loads.empty() || !scene_.supports.empty() || !scene_.walls.empty();
    const int order = std::min(scheme_of(run().integrator).order, driven ? 2 : 4);
    out.line("",
             fmt::format("it falls as the step to the power {}: about {:g} with run.time_step={:.2g}", order,
                         balance_to_mention, step_.step * std::pow(balance_to_mention / balance.most, 1.0 / order)));
  }
  if (balance.most > Balance::doubtful)
    out.warning("", "that is much: compare with a shorter step before trusting the motion");
  return out;
}

}  // namespace equidem
