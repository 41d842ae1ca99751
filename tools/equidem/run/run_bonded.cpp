// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_bonded.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/vtk.hpp"
#include "equidem/output/pictures/picture.hpp"

#include "run/run_report.hpp"
#include "solve/report.hpp"

namespace equidem {
namespace {

constexpr double balance_to_mention = 1e-3;  // of the largest energy

bool has_late_dampers(const Damping& damping) {
  return damping.stiffness > 0 || damping.contact > 0 || damping.local > 0;
}

/// Keys of the case that have no effect on a run to rest.
std::string unused_at_rest(const RunSetup& setup) {
  const RunCase& run = setup.run();
  const OutputCase& output = setup.problem.resolved.output;
  std::string out;
  const auto name = [&](bool asked, const char* what) {
    if (asked) out += (out.empty() ? "" : ", ") + std::string(what);
  };
  name(run.time_step.step.has_value(), "time_step");
  name(run.integrator != Integrator::leapfrog, "integrator");
  name(run.damping.mass > 0 || has_late_dampers(run.damping), "[run.damping]");
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
         std::ranges::any_of(scene.walls, [](const Wall& wall) { return wall.moves(); });
}

/// Contact forces of small motions, for pictures.
std::vector<ContactForce> forces_of(const Problem& problem, const std::vector<DiscMotion>& motions) {
  std::vector<ContactForce> forces(problem.assembly.contacts.size());
  for (std::size_t c = 0; c < forces.size(); ++c) {
    const Contact& contact = problem.assembly.contacts[c];
    forces[c] = linear_spring_force(problem.springs.springs[c],
                                    deformation(frame_of(problem.assembly, c), motions[contact.i], motions[contact.j]));
  }
  return forces;
}

}  // namespace

BondedRun::BondedRun(const RunSetup& setup)
    : setup_(setup),
      simulation_(setup.simulation()),
      watch_(setup.scene, setup.options,
             {.growth = 100, .critical_step = setup.step.critical, .growth_rate = setup.step.growth_rate}) {}

RunPlan BondedRun::plan() {
  RunPlan plan{.steps = setup_.steps(),
               .time_step = setup_.step.step,
               .case_text = setup_.fingerprint(),
               .frame_interval = output().frame_interval,
               .probe_interval = output().probe_interval,
               .checkpoint_interval = output().checkpoint_interval,
               .frame_discs = &setup_.problem.assembly,
               .watch = [this](const EnergyLedger& energy) { watch_.look(simulation_, energy); },
               .watch_between = true};
  for (const ProbeCase& wanted : setup_.run().probes) {
    Probe probe{wanted.name, group(setup_.problem.assembly, wanted.group).discs, {}};
    for (const std::string& word : wanted.quantities)
      if (word != "energy")  // energies have columns of their own
        probe.quantities.push_back(enum_from<ProbeQuantity>(word));
    if (!probe.quantities.empty()) plan.probes.push_back(std::move(probe));
  }
  return plan;
}

std::string BondedRun::describe() const {
  std::string out = describe_problem(setup_.problem, simulation_.effects());
  const RunCase& run = setup_.run();
  out += report_line("motions", run.motion == LoopKind::Motion::small
                                    ? "small: normals and contact points fixed, the forces are those of the matrix K"
                                    : "finite: normals and contact points follow the bodies");
  if (run.until_rest) {
    const std::string unused = unused_at_rest(setup_);
    if (!unused.empty()) out += report_line("not used", unused + ": a run to rest has steps of its own and no time");
    if (any_schedule(setup_.scene)) {
      out += report_line("schedules", "as they are at t = 0: a run to rest has no time, and starts from there");
    }
    return out;
  }
  const IntegrationScheme& facts = scheme_of(run.integrator);
  const int order = has_late_dampers(run.damping) ? order_with_late_velocities : facts.order;
  out += report_line("integrator", fmt::format("{}, order {}{}, {} a step", to_string(run.integrator), order,
                                               order < facts.order ? " (dampers act half a step late)" : "",
                                               counted(facts.force_evaluations, "force evaluation")));
  const TimeStep& step = setup_.step;
  if (std::isinf(step.critical)) {
    return out + report_line("time step", fmt::format("{:.6g} s; nothing vibrates, any step is stable", step.step));
  }
  out += report_line("time step",
                     fmt::format("{:.6g} s, {:.4g} of the {} step {:.6g} s (rule: {})", step.step, step.ratio(),
                                 step.exact ? "critical" : "guaranteed", step.critical, step.rule));
  for (const std::string& note : step.notes) out += report_line("", note);
  return out;
}

std::string BondedRun::describe_balance(const Balance& balance) const {
  std::string out;
  if (balance.most > balance_to_mention) {
    const Scene& scene = setup_.scene;  // the work of what drives a run is counted to the second order
    const bool driven = !scene.loads.empty() || !scene.supports.empty() || !scene.walls.empty();
    const int order = std::min(scheme_of(setup_.run().integrator).order, driven ? 2 : 4);
    out += report_line("", fmt::format("it falls as the step to the power {}: about {:g} with run.time_step={:.2g}",
                                       order, balance_to_mention,
                                       setup_.step.step * std::pow(balance_to_mention / balance.most, 1.0 / order)));
  }
  if (balance.most > balance_to_doubt) {
    out += report_line("", "that is much: compare with a shorter step before trusting the motion");
  }
  return out;
}

void BondedRun::add_step(JsonObject& object) const {
  const TimeStep& step = setup_.step;
  object.set("time_step", step.step)
      .set("critical_time_step", step.critical)
      .set("time_step_ratio", step.ratio())
      .set("time_step_rule", step.rule)
      .set("critical_time_step_exact", step.exact)
      .set("omega_max", step.omega_max);
}

void BondedRun::add_results(JsonObject& object) const {
  object.set("title", setup_.problem.resolved.title)
      .set("discs", setup_.problem.assembly.size())
      .set("contacts", setup_.problem.assembly.contacts.size())
      .set("motion", setup_.run().motion == LoopKind::Motion::small ? "small" : "finite");
  if (!setup_.run().until_rest) object.set("integrator", to_string(setup_.run().integrator));
}

void BondedRun::write_state(const std::filesystem::path& folder, const std::vector<DiscMotion>& motions,
                            bool overwrite) const {
  std::vector<ContactForce> forces;
  if (setup_.run().motion == LoopKind::Motion::small) forces = forces_of(setup_.problem, motions);
  const AssemblyState state{
      .assembly = setup_.problem.assembly, .motions = motions, .contact_forces = forces, .stresses = {}};
  if (output().csv) write_disc_csv(folder / "discs.csv", state, overwrite);
  if (output().vtk) write_vtk(folder, "state", state, overwrite);
  if (output().picture) {
    const bool far = setup_.run().motion == LoopKind::Motion::finite;  // then where it began is worth seeing
    write_picture(folder, "picture", state, {.title = setup_.problem.resolved.title, .undeformed = far}, overwrite);
  }
  write_file(folder / "case.toml", to_toml(setup_.problem.resolved, folder), overwrite);
}

void BondedRun::write_files(const std::filesystem::path& folder, const RunResult& result, bool overwrite) const {
  constexpr EnergyCurve curves[] = {
      {"kinetic", PlotColour::blue, [](const EnergyLedger& l) { return l.kinetic; }},
      {"elastic", PlotColour::vermilion, [](const EnergyLedger& l) { return l.elastic(); }},
      {"potential", PlotColour::green, [](const EnergyLedger& l) { return l.potential; }},
      {"dissipated", PlotColour::orange, [](const EnergyLedger& l) { return l.lost(); }},
      {"put in", PlotColour::sky_blue, [](const EnergyLedger& l) { return l.work(); }},
  };
  write_state(folder, simulation_.motions(), overwrite);
  write_energy_plot(folder, "energy", setup_.problem.resolved.title, Body::disc, result.record.energies, curves,
                    overwrite);
}

int BondedRun::relax_to_rest(const CommonOptions& common) const {
  StageTimes times = this->times();
  Stopwatch watch;
  const Relaxation rest = relax(setup_.scene, {.motion = setup_.run().motion,
                                               .rotation = setup_.problem.resolved.rotation,
                                               .gravity = setup_.run().gravity,
                                               .tolerance = *setup_.run().until_rest});
  times.add("relaxation", watch.lap());
  if (common.out) write_state(*common.out, rest.motions, common.overwrite);
  const std::string report = describe() + report_line("rest", rest.report()) + describe_times(times);
  JsonObject object;
  add_common(object, "at_rest", report, times, simulation_.effects());
  add_results(object);
  object.set("steps", rest.steps)
      .set("force_evaluations", rest.evaluations)
      .set("relative_unbalanced_force", rest.relative_unbalanced);
  deliver(common, report, object);
  return 0;
}

}  // namespace equidem
