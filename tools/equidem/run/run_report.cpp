// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_report.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/text.hpp"
#include "equidem/output/files/energies.hpp"

#include "solve/report.hpp"

namespace equidem {
namespace {

constexpr double worth_telling = 1e-3;  // of the largest energy

double body_steps_per_second(const AnySimulation& simulation, const RunResult& result) {
  if (!(result.seconds > 0)) return 0;
  return static_cast<double>(result.steps_done) * static_cast<double>(simulation.motions().size()) / result.seconds;
}

double largest_energy(const EnergyLedger& end, const RunRecord& record) {
  double size = end.largest();
  for (const EnergySample& sample : record.energies) size = std::max(size, sample.ledger.largest());
  return size;
}

/// "slip 0.1, bonds 0.02": the terms of a role that are not 0.
std::string list_terms(const AnySimulation& simulation, const EnergyLedger& ledger, EnergyRole role) {
  std::string list;
  for (const EnergyTerm& term : energy_terms(simulation.family()))
    if (term.role == role && ledger.*term.value != 0)
      list += fmt::format("{}{} {:.6g}", list.empty() ? "" : ", ", term.label, ledger.*term.value);
  return list;
}

std::string describe_energies(const RunPlan& plan, const AnySimulation& simulation, const RunResult& result) {
  const EnergyLedger l = simulation.energy();
  std::string out = report_line("energy", fmt::format("kinetic {:.6g}, elastic {:.6g}, potential {:.6g} {}", l.kinetic,
                                                      l.elastic(), l.potential, energy_unit(plan.body)));
  const double overlap = result.record.energies.front().ledger.elastic();
  const std::string work = list_terms(simulation, l, EnergyRole::work);
  out += report_line("", fmt::format("at the start {:.6g}{}{}", l.initial,
                                     overlap > 1e-6 * l.largest() ? fmt::format(", {:.6g} of it elastic", overlap) : "",
                                     work.empty() ? "" : "; put in by " + work));
  if (std::abs(l.sway) > worth_telling * l.largest()) {
    out += report_line(
        "", fmt::format("leapfrog lets kinetic + elastic energy sway with the motion, now by {:.3g}", l.sway));
  }
  const std::string lost = list_terms(simulation, l, EnergyRole::lost);
  return out + report_line("", lost.empty() ? "nothing lost" : fmt::format("lost {:.6g}: {}", l.lost(), lost));
}

}  // namespace

Balance balance_of(const EnergyLedger& end, const RunRecord& record) {
  double most = std::abs(end.error());
  for (const EnergySample& sample : record.energies) most = std::max(most, std::abs(sample.ledger.error()));
  const double size = largest_energy(end, record);
  return size > 0 ? Balance{end.error() / size, most / size} : Balance{};
}

std::string describe_output(const RunJob& job, const RunPlan& plan, const AnySimulation& simulation) {
  std::string out;
  if (!plan.probes.empty() && !plan.probe_interval)
    out += report_line("probes", "not recorded: [output] has no probe_interval");
  for (const auto& [name, interval] :
       {std::pair{"frame", plan.frame_interval}, std::pair{"probe", plan.probe_interval}}) {
    if (!interval || *interval >= plan.time_step) continue;
    out += report_line(fmt::format("{}s", name),
                       fmt::format("at every step, which is longer than {}_interval = {} s", name, *interval));
  }
  return out + report_line("memory",
                           fmt::format("{:.0f} bytes a {} in the loop", simulation.bytes_per_body(), job.body_name()));
}

std::string describe_times(const StageTimes& times) {
  std::string stages;
  for (const auto& [stage, seconds] : times.stages())
    if (seconds >= 0.02 * times.total()) stages += fmt::format(", {} {:.2g} s", stage, seconds);
  return report_line("times", fmt::format("{:.2g} s in all{}", times.total(), stages));
}

std::string describe_run(const RunJob& job, const RunPlan& plan, const AnySimulation& simulation,
                         const RunResult& result, const StageTimes& times) {
  const Balance balance = balance_of(simulation.energy(), result.record);
  return report_line("steps",
                     fmt::format("{}, to t = {:.6g} s; {:.3g} {}-steps per second", grouped(simulation.step()),
                                 simulation.time(), body_steps_per_second(simulation, result), job.body_name())) +
         job.describe_events() + describe_energies(plan, simulation, result) +
         report_line("balance",
                     fmt::format("lacks {:.1e} of the largest term of the run at its end, at most {:.1e} on the way",
                                 std::abs(balance.now), balance.most)) +
         job.describe_balance(balance) + describe_times(times);
}

void add_run(JsonObject& object, const RunJob& job, const AnySimulation& simulation, const RunResult& result) {
  job.add_step(object);
  job.add_results(object);
  const EnergyLedger ledger = simulation.energy();
  object.set("steps", simulation.step())
      .set("time", simulation.time())
      .set("energy", energy_json(simulation.family(), ledger, largest_energy(ledger, result.record)))
      .set("particle_steps_per_second", body_steps_per_second(simulation, result))
      .set(fmt::format("bytes_per_{}", job.body_name()), simulation.bytes_per_body());
}

const char* energy_unit(Body body) {
  return body == Body::disc ? "J per m of depth" : "J";
}

void write_energy_plot(const std::filesystem::path& folder, const std::string& name, const std::string& title,
                       Body body, std::span<const EnergySample> energies, std::span<const EnergyCurve> curves,
                       bool overwrite) {
  Plot plot;
  plot.title = title;
  plot.x.label = "time, s";
  plot.y.label = fmt::format("energy, {}", energy_unit(body));
  const auto add = [&](const EnergyCurve& curve) {
    Series series{.label = curve.label, .colour = curve.colour};
    for (const EnergySample& sample : energies) {
      series.x.push_back(sample.time);
      series.y.push_back(curve.value(sample.ledger));
    }
    if (std::ranges::any_of(series.y, [](double y) { return y != 0; })) plot.series.push_back(std::move(series));
  };
  for (const EnergyCurve& curve : curves) add(curve);
  add({"what the balance lacks", PlotColour::black, [](const EnergyLedger& l) { return l.error(); }});
  if (!plot.series.empty()) write_plot(folder, name, plot, overwrite);
}

}  // namespace equidem
