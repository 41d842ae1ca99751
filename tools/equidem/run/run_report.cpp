// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_report.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"
#include "equidem/output/files/energy_terms.hpp"
#include "equidem/output/plots/plot.hpp"

#include "solve/report.hpp"

namespace equidem {
namespace {

constexpr double balance_to_doubt = 0.1;  // of the largest energy
constexpr double balance_to_mention = 1e-3;

double disc_steps_per_second(const RunSetup& setup, const RunResult& result) {
  if (!(result.seconds > 0)) return 0;
  return static_cast<double>(result.steps_done) * static_cast<double>(setup.problem.assembly.size()) / result.seconds;
}

/// What the balance is held against: the most energy that there was.
double largest_energy(const EnergyLedger& ledger) {
  return std::max({std::abs(ledger.kinetic), std::abs(ledger.elastic), std::abs(ledger.potential),
                   std::abs(ledger.dissipated()), std::abs(ledger.input()), std::abs(ledger.initial)});
}

/// What the balance lacks now and at most, relative to the most energy that there was in the whole run.
struct Balance {
  double now = 0, most = 0;
};
Balance balance_of(const Simulation& simulation, const RunResult& result) {
  const EnergyLedger end = simulation.energy();
  double most = std::abs(end.error()), size = largest_energy(end);
  for (const EnergySample& sample : result.energies) {
    most = std::max(most, std::abs(sample.ledger.error()));
    size = std::max(size, largest_energy(sample.ledger));
  }
  return size > 0 ? Balance{end.error() / size, most / size} : Balance{};
}

/// What a case asks for that a run to rest does not heed.
std::string unused_at_rest(const RunSetup& setup) {
  const RunCase& run = setup.run();
  const OutputCase& output = setup.problem.resolved.output;
  std::string out;
  const auto name = [&](bool asked, const char* what) {
    if (asked) out += (out.empty() ? "" : ", ") + std::string(what);
  };
  name(run.time_step.step.has_value(), "time_step");
  name(run.integrator != Integrator::leapfrog, "integrator");
  name(run.damping.mass > 0 || run.damping.stiffness > 0 || run.damping.contact > 0 || run.damping.local > 0,
       "[run.damping]");
  name(!run.velocities.empty(), "[[velocity]]");
  name(output.frame_interval.has_value(), "frame_interval");
  name(!run.probes.empty() || output.probe_interval, "[[probe]]");
  return out;
}

/// Whether anything of the scene changes with time.
bool any_schedule(const Scene& scene) {
  const auto changes = [](const std::optional<Schedule>& motion) { return motion && motion->changes(); };
  return std::ranges::any_of(
             scene.supports,
             [&](const TimedSupport& s) { return changes(s.ux) || changes(s.uy) || changes(s.rotation); }) ||
         std::ranges::any_of(scene.loads, [](const TimedLoad& load) { return load.factor.changes(); }) ||
         std::ranges::any_of(scene.walls, [](const Wall& wall) { return wall.displacement.changes(); });
}

/// What of the output is not what a reader of the case would expect.
std::string describe_output(const RunSetup& setup) {
  const OutputCase& output = setup.problem.resolved.output;
  std::string out;
  if (!setup.run().probes.empty() && !output.probe_interval) {
    out += report_line("probes", "not recorded: [output] has no probe_interval");
  }
  for (const auto& [name, interval] :
       {std::pair{"frame", output.frame_interval}, std::pair{"probe", output.probe_interval}}) {
    if (!interval || *interval >= setup.step.step) continue;
    out += report_line(fmt::format("{}s", name),
                       fmt::format("at every step, which is longer than {}_interval = {} s", name, *interval));
  }
  return out;
}

void add_scene(JsonObject& object, const RunSetup& setup) {
  object.set("title", setup.problem.resolved.title)
      .set("discs", setup.problem.assembly.size())
      .set("contacts", setup.problem.assembly.contacts.size())
      .set("motion", setup.run().motion == LoopKind::Motion::small ? "small" : "finite");
}

std::string stages_of(const StageTimes& times) {
  std::string stages;
  for (const auto& [stage, seconds] : times.stages()) {
    if (seconds >= 0.02 * times.total()) stages += fmt::format(", {} {:.2g} s", stage, seconds);
  }
  return report_line("times", fmt::format("{:.2g} s in all{}", times.total(), stages));
}

}  // namespace

RelaxationOptions relaxation_options(const RunSetup& setup) {
  return {.motion = setup.run().motion,
          .rotation = setup.problem.resolved.rotation,
          .gravity = setup.run().gravity,
          .tolerance = *setup.run().until_rest};
}

std::string describe_run_setup(const RunSetup& setup, const Simulation& simulation) {
  std::string out = describe_problem(setup.problem, simulation.effects());
  const RunCase& run = setup.run();
  out += report_line("motions", run.motion == LoopKind::Motion::small
                                    ? "small: normals and contact points fixed, the forces are those of the matrix K"
                                    : "finite: normals and contact points follow the bodies");
  if (run.until_rest) {
    const std::string unused = unused_at_rest(setup);
    if (!unused.empty()) out += report_line("not used", unused + ": a run to rest has steps of its own and no time");
    if (any_schedule(setup.scene)) {
      out += report_line("schedules", "as they are at t = 0: a run to rest has no time, and starts from there");
    }
    return out;
  }
  const IntegrationScheme& facts = scheme_of(run.integrator);
  const bool late = run.damping.stiffness > 0 || run.damping.contact > 0 || run.damping.local > 0;
  const int order = late ? order_with_late_velocities : facts.order;
  out += report_line("integrator", fmt::format("{}, order {}{}, {} a step", to_string(run.integrator), order,
                                               order < facts.order ? " (dampers act half a step late)" : "",
                                               counted(facts.force_evaluations, "force evaluation")));
  const TimeStep& step = setup.step;
  if (std::isinf(step.critical)) {
    out += report_line("time step", fmt::format("{:.6g} s; nothing vibrates, any step is stable", step.step));
  } else {
    out += report_line("time step",
                       fmt::format("{:.6g} s, {:.4g} of the {} step {:.6g} s (rule: {})", step.step, step.ratio(),
                                   step.exact ? "critical" : "guaranteed", step.critical, step.rule));
    for (const std::string& note : step.notes) out += report_line("", note);
  }
  out += describe_output(setup);
  out += report_line("memory", fmt::format("{:.0f} bytes a disc in the loop", simulation.bytes_per_disc()));
  return out;
}

double estimate_seconds(const RunSetup& setup, Simulation& simulation) {
  constexpr double enough = 0.05;  // s of the clock on the wall
  const std::int64_t total = setup.steps();
  std::int64_t steps = 1;
  for (;;) {
    steps = std::min(steps, total);
    const Stopwatch watch;
    simulation.advance(steps);
    const double seconds = watch.seconds();
    if (seconds > enough || steps == total) return seconds / static_cast<double>(steps) * static_cast<double>(total);
    steps *= 4;
  }
}

std::string describe_estimate(const RunSetup& setup, double seconds) {
  return report_line(
      "steps", fmt::format("{}, about {:.2g} s with these threads, output aside", grouped(setup.steps()), seconds));
}

std::string describe_run(const RunSetup& setup, const Simulation& simulation, const RunResult& result,
                         const StageTimes& times) {
  std::string out =
      report_line("steps", fmt::format("{}, to t = {:.6g} s; {:.3g} disc-steps per second", grouped(simulation.step()),
                                       simulation.time(), disc_steps_per_second(setup, result)));
  const EnergyLedger ledger = simulation.energy();
  out +=
      report_line("energy", fmt::format("kinetic {:.6g}, elastic {:.6g}, potential {:.6g} N (J per m of depth, per m)",
                                        ledger.kinetic, ledger.elastic, ledger.potential));
  out +=
      report_line("", fmt::format("at the start {:.6g}; put in by loads {:.6g}, supports {:.6g}, walls {:.6g}",
                                  ledger.initial, ledger.work_of_loads, ledger.work_of_supports, ledger.work_of_walls));
  if (std::abs(ledger.sway) > balance_to_mention * largest_energy(ledger)) {
    out += report_line(
        "", fmt::format("leapfrog lets kinetic + elastic energy sway with the motion, now by {:.3g}", ledger.sway));
  }
  out += report_line("", fmt::format("dissipated by mass damping {:.6g}, contacts {:.6g}, local damping {:.6g}",
                                     ledger.damped_mass, ledger.damped_contact, ledger.damped_local));
  const Balance balance = balance_of(simulation, result);
  const double lacks = balance.most;
  out += report_line("balance",
                     fmt::format("lacks {:.1e} of the largest term of the run at its end, at most {:.1e} on the way",
                                 std::abs(balance.now), lacks));
  if (lacks > balance_to_mention) {
    const Scene& scene = setup.scene;  // the work of what drives a run is counted to the second order
    const bool driven = !scene.loads.empty() || !scene.supports.empty() || !scene.walls.empty();
    const int order = std::min(scheme_of(setup.run().integrator).order, driven ? 2 : 4);
    out += report_line(
        "", fmt::format("it falls as the step to the power {}: about {:g} with run.time_step={:.2g}", order,
                        balance_to_mention, setup.step.step * std::pow(balance_to_mention / lacks, 1.0 / order)));
  }
  if (lacks > balance_to_doubt) {
    out += report_line("", "that is much: compare with a shorter step before trusting the motion");
  }
  return out + stages_of(times);
}

std::string describe_rest(const RunSetup&, const Relaxation& rest, const StageTimes& times) {
  return report_line("rest", rest.report()) + stages_of(times);
}

void add_time_step(JsonObject& object, const TimeStep& step) {
  object.set("time_step", step.step)
      .set("critical_time_step", step.critical)
      .set("time_step_ratio", step.ratio())
      .set("time_step_rule", step.rule)
      .set("critical_time_step_exact", step.exact)
      .set("omega_max", step.omega_max);
}

void add_rest(JsonObject& object, const RunSetup& setup, const Relaxation& rest) {
  add_scene(object, setup);
  object.set("steps", rest.steps)
      .set("force_evaluations", rest.evaluations)
      .set("relative_unbalanced_force", rest.relative_unbalanced);
}

void add_run(JsonObject& object, const RunSetup& setup, const Simulation& simulation, const RunResult& result) {
  add_scene(object, setup);
  object.set("steps", simulation.step()).set("time", simulation.time());
  add_time_step(object, setup.step);
  const EnergyLedger ledger = simulation.energy();
  JsonObject energy;
  for (const EnergyTerm& term : energy_terms) energy.set(term.name, ledger.*term.value);
  energy.set("dissipated", ledger.dissipated())
      .set("input", ledger.input())
      .set("error", ledger.error())
      .set("relative_error", balance_of(simulation, result).now);
  object.set("energy", energy);
  object.set("integrator", to_string(setup.run().integrator));
  object.set("particle_steps_per_second", disc_steps_per_second(setup, result));
  object.set("bytes_per_disc", simulation.bytes_per_disc());
}

void write_energy_plot(const std::filesystem::path& folder, const RunSetup& setup, const RunResult& result,
                       bool overwrite) {
  Plot plot;
  plot.title = setup.problem.resolved.title;
  plot.x.label = "time, s";
  plot.y.label = "energy, J per m of depth";
  struct Curve {
    const char* label;
    PlotColour colour;
    double (*value)(const EnergyLedger&);
  };
  constexpr Curve curves[] = {
      {"kinetic", PlotColour::blue, [](const EnergyLedger& l) { return l.kinetic; }},
      {"elastic", PlotColour::vermilion, [](const EnergyLedger& l) { return l.elastic; }},
      {"potential", PlotColour::green, [](const EnergyLedger& l) { return l.potential; }},
      {"dissipated", PlotColour::orange, [](const EnergyLedger& l) { return l.dissipated(); }},
      {"put in", PlotColour::sky_blue, [](const EnergyLedger& l) { return l.input(); }},
      {"what the balance lacks", PlotColour::black, [](const EnergyLedger& l) { return l.error(); }},
  };
  for (const Curve& curve : curves) {
    Series series{.label = curve.label, .colour = curve.colour};
    bool any = false;
    for (const EnergySample& sample : result.energies) {
      series.x.push_back(sample.time);
      series.y.push_back(curve.value(sample.ledger));
      any = any || series.y.back() != 0;
    }
    if (any) plot.series.push_back(std::move(series));
  }
  if (!plot.series.empty()) write_plot(folder, "energy", plot, overwrite);
}

}  // namespace equidem
