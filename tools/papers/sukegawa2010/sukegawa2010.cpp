// SPDX-License-Identifier: GPL-3.0-or-later
#include "sukegawa2010/sukegawa2010.hpp"

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

namespace equidem::sukegawa2010 {
namespace {

JsonObject json_of(const Done& done) {
  JsonObject object;
  object.set("name", done.run.name()).set("shape", plural_of(done.run.fill.shape));
  object.set("variant", done.run.fill.variant).set("seed", static_cast<std::int64_t>(done.run.fill.seed));
  if (done.run.shaking) {
    object.set("acceleration_gal", done.run.shaking->gal).set("frequency_Hz", done.run.shaking->frequency);
    object.set("cycles", done.run.shaking->cycles);
  }
  for (const OutcomeKey& key : outcome_keys()) object.set(key.name, done.outcome.*key.value);
  return object;
}

JsonObject as_json(const Reproduction& result, const std::string& text) {
  JsonObject object;
  const Fill fill = result.runs.empty() ? plan(result.quick).front().fill : result.runs.front().run.fill;
  const GrainScene scene = start_of(fill);
  add_common(object, result.complete() ? "done" : "incomplete", text, result.times,
             GrainSimulation(scene, options_of(scene, fill)).effects());
  object.set("paper", "sukegawa2010").set("quick", result.quick);
  object.set("planned", static_cast<std::int64_t>(result.planned));
  std::vector<JsonObject> runs;
  for (const Done& done : result.runs) runs.push_back(json_of(done));
  object.set("runs", runs);
  return object;
}

}  // namespace

int reproduce(const CommonOptions& options, bool quick) {
  if (options.threads > 0) set_thread_count(options.threads);
  set_progress_shown(!options.quiet);
  OutputPlan(options).expect_json();
  Reproduction result;
  result.quick = quick;
  Stopwatch watch;
  std::optional<Error> stopped;
  try {
    compute(options, result);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::interrupted) throw;
    stopped = error;
  }
  result.times.add("runs", watch.lap());
  // What is there is of the same settings (compute checks it), or to be replaced.
  CommonOptions common = options;
  common.overwrite = true;
  std::string text = report(result);
  if (options.out && !result.runs.empty()) {
    for (const auto& [name, table] : tables(result)) write_csv(*options.out / (name + ".csv"), table, true);
    std::string drawn;
    std::size_t number = 0;
    for (const auto& [name, plot] : plots(result, options.out)) {
      const PlotResult written = write_plot(*options.out, name, plot, true);
      ++number;
      if (!written.drawn) drawn = written.message + "\n";
    }
    if (drawn.empty())
      drawn = fmt::format("{} are in '{}'\n", counted(static_cast<long long>(number), "plot"), options.out->string());
    write_file(*options.out / "report.txt", text, true);
    if (!stopped) text += "\n" + drawn;
  }
  if (!stopped || options.out) deliver(common, text, as_json(result, text));
  if (options.out) say(options, fmt::format("written to {}", options.out->string()));
  if (stopped) {
    throw Error(
        ErrorKind::interrupted, "stopped as asked",
        fmt::format("{} of {} runs are done", result.runs.size(), result.planned),
        options.out ? "Give the same command again to do the rest" : "With --out DIR the runs done would be kept");
  }
  return 0;
}

}  // namespace equidem::sukegawa2010
