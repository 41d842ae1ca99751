// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_job.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <functional>
#include <system_error>
#include <utility>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/histories.hpp"
#include "equidem/output/page/page.hpp"
#include "equidem/output/pictures/grain_picture.hpp"
#include "equidem/output/pictures/picture.hpp"

#include "state_files.hpp"

namespace equidem {
namespace {

constexpr double worth_telling = 1e-3;  // of the largest energy

/// Scale of the error of the balance: for bonded discs the largest energy of the whole run, for colliding bodies, whose
/// losses and works only grow, the largest at its end.
double scale_of(BodyFamily family, const EnergyLedger& end, const RunRecord& record) {
  double scale = end.largest();
  if (family == BodyFamily::colliding) return scale;
  for (const EnergySample& sample : record.energies) scale = std::max(scale, sample.ledger.largest());
  return scale;
}

Balance balance_of(const EnergyLedger& end, const RunRecord& record, double scale) {
  double most = std::abs(end.error());
  for (const EnergySample& sample : record.energies) most = std::max(most, std::abs(sample.ledger.error()));
  return scale > 0 ? Balance{end.error() / scale, most / scale} : Balance{};
}

/// The terms of a role that are not 0, after `lead`; false, and nothing added, where all are 0.
bool add_terms(Results& out, const char* lead, BodyFamily family, const EnergyLedger& ledger, EnergyRole role) {
  bool any = false;
  for (const EnergyTerm& term : energy_terms(family)) {
    if (term.role != role || ledger.*term.value == 0) continue;
    if (!std::exchange(any, true)) out.note(lead);
    out.add(fmt::format("energy/{}", term.key), term.label, ledger.*term.value);
  }
  return any;
}

Results energies_of(const RunJob& job, BodyFamily family, Body body, const EnergyLedger& l, const RunRecord& record) {
  const double scale = scale_of(family, l, record);
  Results out = energy_results(family, body, l, scale).under("energy");
  out.line("energy")
      .add("energy/kinetic", "kinetic", l.kinetic)
      .add("energy/elastic", "elastic", l.elastic())
      .add("energy/potential", "potential", l.potential, energy_unit(body));
  if (l.cohesion != 0) out.add("energy/cohesion", "cohesion", l.cohesion);
  out.line("").add("energy/initial", "at the start", l.initial);
  const double overlap = record.energies.empty() ? 0 : record.energies.front().ledger.elastic();
  if (overlap > 1e-6 * l.largest()) out.add("", "", overlap, "of it elastic");
  add_terms(out, "; work done by ", family, l, EnergyRole::work);
  if (std::abs(l.sway) > worth_telling * l.largest()) {
    out.line("", "leapfrog lets kinetic + elastic energy sway with the motion, now by ")
        .add("energy/sway", "", l.sway, "", {.digits = 3});
  }
  out.line("").add("energy/dissipated", "lost", l.lost());
  add_terms(out, ": ", family, l, EnergyRole::lost);
  const Balance balance = balance_of(l, record, scale);
  out.line("energy balance")
      .add("", "error", std::abs(balance.at_end),
           family == BodyFamily::bonded ? "of the largest term of the run at its end"
                                        : "of the largest term at the end of the run",
           {Shown::power, 1})
      .add("", "at most", balance.most, "on the way", {Shown::power, 1});
  return out.append(job.advice(balance));
}

Results memory_results(RunJob& job) {
  const std::string body = job.body_name();
  const double each = job.simulation().bytes_per_body();
  return Results()
      .line("memory")
      .add("bytes_per_" + body, "", each, "bytes a " + body + " in the loop", {Shown::decimals, 0})
      .add("loop_bytes", "", each * static_cast<double>(job.simulation().motions().size()), "in all", {Shown::bytes});
}

/// The time step, the intervals that it does not allow, probes without interval, memory.
Results step_results(RunJob& job, const RunPlan& plan) {
  Results out = job.step();
  if (!plan.probes.empty() && !plan.probe_interval) out.line("probes", "not recorded: [output] has no probe_interval");
  for (const auto& [name, interval] :
       {std::pair{"frame", plan.frame_interval}, std::pair{"probe", plan.probe_interval}}) {
    if (!interval || *interval >= plan.time_step) continue;
    out.line(fmt::format("{}s", name))
        .note(fmt::format("at every step, which is longer than {}_interval = {} s", name, *interval));
  }
  return out.append(memory_results(job));
}

}  // namespace

Results dry_run_results(RunJob& job, bool with_files) {
  const RunPlan plan = job.plan();
  Results out = job.scene();
  // the scene, its lists and its contacts at the end take their memory as in a run
  static_cast<void>(job.simulation().body_contacts());
  const double drawing = with_files ? job.bytes_of_drawing() : 0;
  out.line("process").add("peak_bytes", "", std::max(peak_resident_memory(), resident_memory() + drawing),
                          "of memory at the peak", {Shown::bytes});
  if (job.goes_to_rest()) return out.append(memory_results(job));
  out.append(step_results(job, plan));
  if (plan.frame_interval) {
    const double steps = static_cast<double>(plan.steps);
    const double frames = 1 + std::floor(std::min(steps, steps * plan.time_step / *plan.frame_interval));
    const double contacts = plan.frames.contacts ? static_cast<double>(job.simulation().body_contacts().size()) : 0;
    const double each = bytes_of_frame(static_cast<double>(plan.frame_discs->size()), contacts, plan.frames);
    out.line("frame files")
        .add("frame_bytes", "", each, "a frame with the contacts of the start", {Shown::bytes})
        .add("all_frames_bytes", "", frames * each, "in all", {Shown::bytes});
  }
  return out.line("steps")
      .add("steps", "", plan.steps, "", {Shown::count})
      .add("estimated_seconds", "about", estimate_seconds(job.simulation(), plan), "s with these threads, output aside",
           {.digits = 2});
}

Results run_results(RunJob& job, const RunPlan& plan, const RunResult& result, bool failed) {
  const AnySimulation& simulation = job.simulation();
  const double body_steps = static_cast<double>(result.steps_done) * static_cast<double>(simulation.motions().size());
  Results out = job.scene().append(step_results(job, plan));
  out.line("steps")
      .add("steps", "", simulation.step(), "", {Shown::count})
      .add("time", "to t =", simulation.time(), "s")
      .note("; ")
      .add("particle_steps_per_second", "", result.seconds > 0 ? body_steps / result.seconds : 0.0,
           fmt::format("{}-steps per second", job.body_name()), {.digits = 3});
  const auto add = [&](const std::function<Results()>& part) {
    try {
      out.append(part());
    } catch (const std::exception& error) {
      if (!failed) throw;
      out.line("missing", error.what());
    }
  };
  add([&] { return job.events(); });
  add([&] { return wall_results(simulation.walls(), simulation.family(), plan.body); });
  add([&] { return energies_of(job, simulation.family(), plan.body, simulation.energy(), result.record); });
  return out;
}

const char* energy_unit(Body body) {
  return body == Body::disc ? "J per m of depth" : "J";
}

void write_energy_plot(const CommonOptions& into, const std::string& name, const std::string& title, Body body,
                       std::span<const EnergySample> energies, std::span<const EnergyCurve> further) {
  Plot plot{.title = title, .x = {.label = "time, s"}, .y = {.label = fmt::format("energy, {}", energy_unit(body))}};
  const auto add = [&](const EnergyCurve& curve) {
    Series series{.label = curve.label, .colour = curve.colour};
    for (const EnergySample& sample : energies) series.add(sample.time, curve.value(sample.ledger));
    if (std::ranges::any_of(series.y, [](double y) { return y != 0; })) plot.series.push_back(std::move(series));
  };
  add({"kinetic", PlotColour::blue, [](const EnergyLedger& l) { return l.kinetic; }});
  add({"elastic", PlotColour::vermilion, [](const EnergyLedger& l) { return l.elastic(); }});
  add({"potential", PlotColour::green, [](const EnergyLedger& l) { return l.potential; }});
  for (const EnergyCurve& curve : further) add(curve);
  add({"energy balance error", PlotColour::black, [](const EnergyLedger& l) { return l.error(); }});
  if (!plot.series.empty()) write_plot(*into.out, name, plot, into.overwrite);
}

namespace {

std::filesystem::path temporary_folder() {
  std::string name = (std::filesystem::temp_directory_path() / "equidem_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    bad_input("no temporary folder for the histories of the run", std::generic_category().message(errno),
              "Make room there, or let TMPDIR name another folder");
  return name;
}

std::string text_of(const std::filesystem::path& path) {
  return std::filesystem::exists(path) ? read_file(path) : std::string();
}

void add_columns(std::vector<ResultArray>& arrays, const std::string& prefix, const std::string& csv) {
  if (csv.empty()) return;
  const std::vector<std::vector<std::string>> rows = csv_cells(csv);
  for (std::size_t c = 0; c < rows.front().size(); ++c) {
    std::vector<double> column;
    for (std::size_t r = 1; r < rows.size(); ++r) column.push_back(csv_number(rows[r].at(c)).value_or(std::nan("")));
    arrays.push_back(array_of(prefix + rows.front()[c], "", std::move(column), 1));
  }
}

}  // namespace

HistoryFolder::HistoryFolder(const std::optional<std::filesystem::path>& out, bool temporary)
    : path_(out), temporary_(!out && temporary) {
  if (temporary_) path_ = temporary_folder();
}

HistoryFolder::~HistoryFolder() {
  std::error_code ignored;
  if (temporary_) std::filesystem::remove_all(*path_, ignored);
}

std::string HistoryFolder::history() const {
  return path_ ? text_of(*path_ / "history.csv") : std::string();
}

std::vector<ResultArray> HistoryFolder::arrays(const std::vector<EnergySample>& energies, BodyFamily family,
                                               Body body) const {
  std::vector<ResultArray> arrays;
  if (path_) {
    add_columns(arrays, "history/", history());
    add_columns(arrays, "measures_history/", text_of(*path_ / "measures.csv"));
  }
  const std::vector<std::string> names = energy_columns(family, body);
  std::vector<double> times;
  std::vector<std::vector<double>> columns(names.size());
  for (const EnergySample& sample : energies) {
    times.push_back(sample.time);
    const std::vector<double> cells = energy_cells(family, sample.ledger);
    for (std::size_t c = 0; c < columns.size(); ++c) columns[c].push_back(cells[c]);
  }
  arrays.push_back(array_of("energies/time_s", "", std::move(times), 1));
  for (std::size_t c = 0; c < columns.size(); ++c)
    arrays.push_back(array_of("energies/" + names[c], "", std::move(columns[c]), 1));
  return arrays;
}

namespace {

constexpr std::size_t most_frames = 150, fewest_frames = 8;
constexpr double seconds_of_film = 8;

void add_player(GrainAnimation animation, std::span<const GrainFrame> frames) {
  animation.frames = frames;
  animation.speed = (frames.back().time - frames.front().time) / seconds_of_film;
  std::string title = animation.title.empty() ? "Motion" : animation.title;
  DrawnFigures::add({.name = "motion", .title = std::move(title), .player = grain_animation_player(animation)});
}

}  // namespace

std::int64_t frames_of_film(std::size_t bodies) {
  constexpr std::size_t room = 750'000, bytes_of_body = 17;  // of the page
  const std::size_t frames = std::min(most_frames, room / (bytes_of_body * std::max<std::size_t>(1, bodies)));
  return frames < fewest_frames ? 0 : static_cast<std::int64_t>(frames);
}

void add_film(const std::string& title, const Assembly& assembly, std::span<const FilmFrame> frames) {
  if (frames.size() < 2) return;
  Bounds rest;
  double largest = 0;
  std::vector<Grain> shapes(assembly.size());
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    rest.include(assembly.centres[disc], assembly.radii[disc]);
    shapes[disc].radius = assembly.radii[disc];
    for (const FilmFrame& frame : frames) largest = std::max(largest, norm(frame.motions[disc].u));
  }
  const double scale = visible_scale(largest, rest.larger_side());
  std::vector<GrainFrame> enlarged;
  for (const FilmFrame& frame : frames) {
    GrainFrame& shown = enlarged.emplace_back(GrainFrame{.time = frame.time, .places = {}, .angles = {}});
    for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
      shown.places.push_back(assembly.centres[disc] + scale * frame.motions[disc].u);
      shown.angles.push_back(scale * frame.motions[disc].theta);
    }
  }
  add_player({.title = title,
              .caption = fmt::format("Displacements {}; the bluer a disc, the further it is from where it began",
                                     scale == 1 ? "to scale" : fmt::format("× {:.6g}", scale)),
              .shapes = shapes,
              .by_motion = true},
             enlarged);
}

void add_film(const GrainCase& resolved, std::span<const Wall> walls, std::span<const int> colours,
              std::span<const Grain> started, std::span<const FilmFrame> frames) {
  if (frames.size() < 2) return;
  std::vector<GrainFrame> places;
  for (const FilmFrame& frame : frames) {
    GrainFrame& shown = places.emplace_back(GrainFrame{.time = frame.time, .places = {}, .angles = {}});
    for (const DiscMotion& motion : frame.motions) {
      shown.places.push_back(motion.u);
      shown.angles.push_back(motion.theta);
    }
    shown.walls = frame.walls;
  }
  const std::vector<Grain> bodies = resolved.bodies();
  add_player({.title = resolved.title,
              .caption = "The line in a body shows how it turns",
              .shapes = bodies,
              .clumps = resolved.scene.clumps,
              .groups = colours,
              .walls = walls,
              .started = started},
             places);
}

}  // namespace equidem
