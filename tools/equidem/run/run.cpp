// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/checkpoint.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/histories.hpp"
#include "equidem/output/page/page.hpp"
#include "equidem/output/pictures/grain_picture.hpp"
#include "equidem/output/pictures/picture.hpp"

#include "accuracy.hpp"
#include "command.hpp"
#include "run/run_bonded.hpp"
#include "run/run_grains.hpp"
#include "run/run_job.hpp"
#include "state_files.hpp"
#include "verbs.hpp"

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

/// Steps and their estimated wall-clock seconds, memory, the time step. The first steps are performed.
/// \param with_files whether the run draws its end
Results dry_run_results(RunJob& job, bool with_files) {
  const RunPlan plan = job.plan();
  Results out = job.scene("");
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

/// time_step, ...; steps, time, energy {terms, elastic, dissipated, input, error, relative_error},
/// particle_steps_per_second, bytes_per_disc or bytes_per_grain, and the results of the job.
/// \param failed the run did not come to its end: what then cannot be computed is left out
/// \param history text of history.csv
Results run_results(RunJob& job, const RunPlan& plan, const RunResult& result, bool failed,
                    const std::string& history) {
  const AnySimulation& simulation = job.simulation();
  const double body_steps = static_cast<double>(result.steps_done) * static_cast<double>(simulation.motions().size());
  Results out = job.scene(history).append(step_results(job, plan));
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

/// The folder that the loop of a run writes its tables into: that of --out, or a temporary one.
class HistoryFolder {
 public:
  /// \param temporary whether tables are wanted where there is no --out
  HistoryFolder(const std::optional<std::filesystem::path>& out, bool temporary)
      : path_(out), temporary_(!out && temporary) {
    if (temporary_) path_ = temporary_folder();
  }
  ~HistoryFolder() {
    std::error_code ignored;
    if (temporary_) std::filesystem::remove_all(*path_, ignored);
  }
  HistoryFolder(const HistoryFolder&) = delete;
  HistoryFolder& operator=(const HistoryFolder&) = delete;

  [[nodiscard]] const std::optional<std::filesystem::path>& path() const { return path_; }
  [[nodiscard]] bool is_temporary() const { return temporary_; }
  /// The text of history.csv; empty: none was written.
  [[nodiscard]] std::string history() const { return path_ ? text_of(*path_ / "history.csv") : std::string(); }
  /// history/COLUMN and measures_history/COLUMN of the tables that were written, energies/COLUMN of the samples.
  [[nodiscard]] std::vector<ResultArray> arrays(const std::vector<EnergySample>& energies, BodyFamily family,
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

 private:
  std::optional<std::filesystem::path> path_;
  bool temporary_ = false;
};

constexpr std::size_t most_frames = 150, fewest_frames = 8;
constexpr double seconds_of_film = 8;

void add_player(GrainAnimation animation, std::span<const GrainFrame> frames) {
  animation.frames = frames;
  animation.speed = (frames.back().time - frames.front().time) / seconds_of_film;
  std::string title = animation.title.empty() ? "Motion" : animation.title;
  DrawnFigures::add({.name = "motion", .title = std::move(title), .player = grain_animation_player(animation)});
}

/// The number of frames that a page has room for; 0 where the bodies are too many for any motion to be seen.
std::int64_t frames_of_film(std::size_t bodies) {
  constexpr std::size_t room = 750'000, bytes_of_body = 17;  // of the page
  const std::size_t frames = std::min(most_frames, room / (bytes_of_body * std::max<std::size_t>(1, bodies)));
  return frames < fewest_frames ? 0 : static_cast<std::int64_t>(frames);
}

struct RunVerb : CommonOptions {
  bool resume = false;
  std::optional<std::filesystem::path> begin_from;
  std::optional<double> accuracy;
};

/// Before the run, so that no hour is lost to a full folder.
void check_outputs(const RunVerb& options, const RunJob& job) {
  options.resume ? expect_json(options) : expect_results(options, job.parts({}));
}

/// Delivers the results of a run with its files, which keep job and result.
/// \param history of probes, whose paths are drawn, for a page in memory
void deliver_run(const RunVerb& options, const char* status, Results results, StageTimes times,
                 const std::shared_ptr<RunJob>& job, const std::shared_ptr<const RunResult>& result,
                 const std::optional<Error>& failure, const std::string& history = {}) {
  std::vector<OutputPart> parts = job->parts(*result);
  for (OutputPart& part : parts)
    part.write = [job, result, write = std::move(part.write)](const CommonOptions& into) { write(into); };
  if (!history.empty()) {
    const auto write = [history](const CommonOptions& into) {
      const std::filesystem::path path = *into.out / "history.csv";
      if (!std::filesystem::exists(path)) write_file(path, history, false);
    };
    parts.insert(parts.begin(), {"history.csv", write, OutputPart::page});
  }
  RunVerb written = options;
  written.overwrite |= options.resume;
  deliver(written, status, std::move(results), std::move(times), parts, failure);
}

constexpr const char* plan_of_steps =
    "first runs with the step of the case, that over root 2 and its half; the longest step that reaches it follows "
    "from them; above is the run with the step of the case";

constexpr std::int64_t finest = 4096;  // times as many steps as the case has

/// Steps between which the user may interrupt.
constexpr std::int64_t steps_at_once = 1000;

double relative_distance(const std::vector<double>& a, const std::vector<double>& b) {
  double apart = 0, largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    apart = std::max(apart, std::abs(a[k] - b[k]));
    largest = std::max(largest, std::abs(b[k]));
  }
  return apart > 0 ? apart / largest : 0;
}

std::vector<double> searched_values(const std::vector<DiscMotion>& motions) {
  std::vector<double> values;
  for (const DiscMotion& motion : motions) values.push_back(motion.u.x), values.push_back(motion.u.y);
  return values;
}

std::vector<double> run_pilot(Case resolved) {
  BondedRun pilot(std::move(resolved));
  Simulation& simulation = pilot.simulation();
  const std::int64_t steps = pilot.steps();
  Progress progress(fmt::format("a run of {} to choose the step:", counted(steps, "step")));
  for (std::int64_t done = 0; done < steps; done += steps_at_once) {
    progress.update(static_cast<double>(done) / static_cast<double>(steps));
    simulation.advance(std::min(steps_at_once, steps - done));
  }
  return searched_values(simulation.motions());
}

/// The longest step for which the displacements at the end are within the accuracy, relative to the largest one. Pilots
/// are runs with the step of the case, that over root 2, and its half (and finer ones, until the motions at the end
/// converge by the order of the integrator); they write nothing.
/// \param given the run with the step of the case
/// \throws Error (bad_input) where the run goes to rest
SearchedSetting searched_step(const BondedRun& given, double accuracy) {
  if (given.goes_to_rest()) {
    bad_input_at(given.where("run.until_rest"), "--accuracy does not act on a run to rest",
                 "run.until_rest is its accuracy",
                 "Leave it out, or set run.until_rest to the unbalanced force wanted");
  }
  const double duration = given.run().duration.value_or(0);
  return {.refinement = {.accuracy = accuracy,
                         .order = static_cast<double>(given.order()),
                         .first = given.steps(),
                         .most = finest * given.steps(),
                         .unit = "steps",
                         .apart = std::numbers::sqrt2,
                         .distance = relative_distance},
          .setting_of =
              [duration](std::int64_t steps) {
                return AccuracySetting{{"run.time_step", duration / static_cast<double>(steps)}};
              },
          .values_of = run_pilot,
          .of =
              "displacements at the end of the run, over the largest of them, against those of a step of 0, "
              "extrapolated",
          .knob = fmt::format("the time step, {:.6g} s in the case", given.time_step().step)};
}

ReachedAccuracy reached_by_step(const CaseSearch& search) {
  ReachedAccuracy reached = search.reached();
  std::vector<std::string> numbers;
  double steps = 0;
  for (const std::int64_t count : search.before()) {
    steps += static_cast<double>(count);
    numbers.push_back(fmt::format("{}", count));
  }
  reached.pilots_factor = steps / static_cast<double>(search.level());
  reached.pilots = fmt::format("runs of {} steps", listed(std::move(numbers)));
  return reached;
}

/// Make all steps and deliver the results; false, and nothing delivered, where the step that the search proposed is too
/// long.
bool step_through(const RunVerb& options, const std::shared_ptr<RunJob>& shared_job, CaseSearch* search = nullptr) {
  RunJob& job = *shared_job;
  RunPlan plan = job.plan();
  if (options.out || arrays_wanted()) plan.film_frames = frames_of_film(job.simulation().motions().size());
  const bool tables_wanted = (plan.probe_interval && (arrays_wanted() || job.needs_history())) ||
                             (plan.recorder != nullptr && arrays_wanted());
  const HistoryFolder tables(options.out, tables_wanted);
  if (tables.is_temporary()) plan.frame_interval.reset();
  const auto shared_result = std::make_shared<RunResult>();
  const RunResult& result = *shared_result;
  const std::optional<Error> failure = failure_of([&] {
    try {
      run_through(job.simulation(), plan,
                  {.folder = tables.path(), .overwrite = options.overwrite, .resume = options.resume}, *shared_result);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::interrupted) throw;
      throw_stopped(options, fmt::format("{} of {} steps are done", job.simulation().step(), plan.steps));
    }
  });
  if (failure && failure->kind() == ErrorKind::bad_input && result.steps_done == 0) throw *failure;
  if (!failure && search != nullptr && !search->accepts(searched_values(job.simulation().motions()), result.seconds))
    return false;
  const StopsHeldBack held_back(failure);
  StageTimes times = job.times();
  times.add("steps", result.seconds);
  Results results = run_results(job, plan, result, failure.has_value(), tables.history());
  results.set("complete", true);
  if (!failure && search != nullptr) results.append(accuracy_results(reached_by_step(*search)));
  deliver_run(options, "done", std::move(results), std::move(times), shared_job, shared_result, failure,
              arrays_wanted() ? tables.history() : "");
  if (!arrays_wanted()) return true;
  std::vector<ResultArray> arrays = tables.arrays(result.record.energies, job.simulation().family(), plan.body);
  for (auto& [name, column] : job.curves(tables.history()))
    arrays.push_back(array_of("curves/" + name, "", std::move(column), 1));
  hand_over(std::move(arrays));
  return true;
}

void relax_to_rest(const RunVerb& options, const std::shared_ptr<RunJob>& shared_job) {
  RunJob& job = *shared_job;
  if (options.resume) {
    bad_input("--resume of a run to rest", "it keeps no checkpoints: it ends where it ends", "Run it anew");
  }
  StageTimes times = job.times();
  Results results;
  const std::optional<Error> failure = failure_of([&] { results = job.relax(times); });
  if (failure && failure->kind() == ErrorKind::bad_input) throw *failure;
  const StopsHeldBack held_back(failure);
  if (failure) results = job.scene("");
  results.set("complete", true);
  deliver_run(options, "at_rest", std::move(results), std::move(times), shared_job, std::make_shared<const RunResult>(),
              failure);
}

void run_to_accuracy(RunVerb options, double accuracy) {
  CaseSearch search(options, [&] {
    const BondedRun given(read_case(options));
    check_outputs(options, given);
    return searched_step(given, accuracy);
  }());
  const auto lock = lock_out(options);
  for (;;) {
    const auto job = std::make_shared<BondedRun>(search.propose());
    if (step_through(options, job, &search)) return;
    options.overwrite = true;  // files of the step that was too long
  }
}

void check_options(const RunVerb& options, bool collide) {
  if (options.resume) expect_folder_of(options, "the checkpoint");
  if (options.accuracy && collide) {
    bad_input("--accuracy does not act on bodies that collide",
              "their motions do not converge by one order with the step: impacts begin and end within it, and many of "
              "them make the motion chaotic",
              "Halve time_step and compare what is measured; 'equidem study collision_laws' shows the error of each "
              "law against the step");
  }
  if (options.accuracy && options.resume)
    bad_input("--resume and --accuracy exclude each other", "the step is that of the checkpoint",
              "Leave one of them out");
  if (options.begin_from && options.resume)
    bad_input("--begin-from and --resume exclude each other", "a run begins once", "Leave one of them out");
  if (options.begin_from && !collide)
    bad_input("--begin-from of bonded discs", "only runs of grains are in stages, with a checkpoint at the end of each",
              "Leave it out; --resume goes on with a longer duration");
  if (options.seed && collide) bad_input("--seed", "nothing in a case of grains is random", "Leave it out");
}

void run(const RunVerb& options) {
  const bool collide = describes_grains(casefile::read_document(options.case_file, options.set));
  check_options(options, collide);
  if (options.accuracy && !options.dry_run) return run_to_accuracy(options, *options.accuracy);
  const std::shared_ptr<RunJob> job = make_run_job(options, options.resume, options.begin_from);
  check_outputs(options, *job);
  const auto lock = lock_out(options);
  if (options.dry_run) {
    Results results = dry_run_results(*job, options.out.has_value());
    if (options.accuracy) results.append(accuracy_plan(*options.accuracy, plan_of_steps));
    deliver(options, "dry_run", results, job->times());
  } else if (job->goes_to_rest()) {
    relax_to_rest(options, job);
  } else {
    step_through(options, job);
  }
}

}  // namespace

std::vector<std::string> files_of_steps(const OutputCase& output) {
  std::vector<std::string> files{"run.checkpoint.h5"};
  if (output.probe_interval) files.emplace_back("history.csv");
  if (output.frame_interval) files.emplace_back("frames.pvd");
  return files;
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

std::unique_ptr<RunJob> make_run_job(const CommonOptions& options, bool resume,
                                     const std::optional<std::filesystem::path>& begin_from) {
  prepare(options);
  if (describes_grains(casefile::read_document(options.case_file, options.set))) {
    GrainCase resolved = read_grain_case(options.case_file, options.set);
    if (resume) {
      const std::string text = case_of_checkpoint(*options.out / "run.checkpoint.h5");
      const std::optional<double> step = kept_grain_step(text, resolved);
      auto job = std::make_unique<GrainRun>(std::move(resolved), step);
      job->go_on_from(text);
      return job;
    }
    if (!begin_from) return std::make_unique<GrainRun>(std::move(resolved));
    auto job = std::make_unique<GrainRun>(std::move(resolved), step_of_stages(*begin_from));
    job->begin_from(*begin_from);
    return job;
  }
  Case resolved = read_case(options);
  const bool continues = resume && resolved.run && resolved.run->duration;
  return std::make_unique<BondedRun>(
      std::move(resolved), continues ? std::optional(kept_step(*options.out / "run.checkpoint.h5")) : std::nullopt);
}

Run declare_run(CLI::App& command) {
  const auto options = std::make_shared<RunVerb>();
  add_common_options(command, *options);
  command.add_flag("--resume", options->resume, "go on from the checkpoint in --out");
  command
      .add_option("--begin-from", options->begin_from,
                  "grains in stages: begin with the state in a checkpoint of another run, run.STAGE.checkpoint.h5, "
                  "with which the case agrees until the end of that stage")
      ->type_name("FILE");
  add_accuracy_option(command, options->accuracy,
                      "bonded discs: the step that tells the displacements at the end to X");
  return [options] { return run(*options); };
}

}  // namespace equidem
