// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Table, JSON and command line.
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

#include "papers.hpp"
#include "sukegawa2010/sukegawa2010.hpp"
#include "tables.hpp"

namespace equidem::sukegawa2010 {
namespace {

Table table_of(const Reproduction& result) {
  const auto& runs = result.runs;
  Table table;
  table.add("run", runs, [](const Done& d) { return d.run.name(); });
  table.add("shape", runs, [](const Done& d) { return plural_of(d.run.fill.shape); });
  table.add("variant", runs, [](const Done& d) { return d.run.fill.variant; });
  table.add("seed", runs, [](const Done& d) { return static_cast<std::int64_t>(d.run.fill.seed); });
  table.add("acceleration_gal", runs, [](const Done& d) { return d.run.shaking->gal; });
  table.add("frequency_Hz", runs, [](const Done& d) { return d.run.shaking->frequency; });
  table.add("cycles", runs, [](const Done& d) { return d.run.shaking->cycles; });
  for (const OutcomeKey& key : outcome_keys)
    table.add(key.name, runs, [&](const Done& d) { return d.outcome.*key.value; });
  return table;
}

int reproduce(const CommonOptions& options, bool quick) {
  CommonOptions without_folder = options;
  without_folder.out.reset();  // its files may be there: check_kept() sees that they belong to the same runs
  static_cast<void>(start_paper(without_folder, {}, {}));
  const auto lock = lock_out(options);
  check_kept(options, quick);
  Reproduction result;
  result.quick = quick;
  result.planned = plan(quick).size();
  Stopwatch watch;
  std::optional<Error> stopped;
  try {
    result.packings = pack_every_way(quick);
    result.times.add("packings", watch.lap());
    result.fallen_ellipses = drop_ellipses(quick);
    result.times.add("contact tests of ellipses", watch.lap());
    compute(options, result);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::interrupted) throw;
    stopped = error;
  }
  result.times.add("runs", watch.lap());
  if (!stopped || (options.out && !result.runs.empty())) {
    CommonOptions common = options;
    common.overwrite = true;
    const Fill fill = result.runs.empty() ? plan(quick).front().fill : result.runs.front().run.fill;
    const GrainScene scene = start_of(fill);
    const bool any = !result.runs.empty();
    const Table table = table_of(result);
    finish_paper(common, {.paper = "sukegawa2010",
                          .report = report(result),
                          .times = result.times,
                          .effects = GrainSimulation(scene, options_of(scene, fill)).effects(),
                          .add_numbers =
                              [&](Results& object) {
                                object.set("quick", quick).set("planned", static_cast<std::int64_t>(result.planned));
                                object.set("runs", rows_of(table, {{"run", "name"}}));
                              },
                          .tables = any ? Named<Table>{{"runs", table}} : Named<Table>{},
                          .plots = any ? plots(result, options.out) : Named<Plot>{},
                          .status = result.complete() ? "done" : "incomplete"});
  }
  if (!stopped) return 0;
  throw Error(
      ErrorKind::interrupted, "stopped as asked",
      fmt::format("{} of {} runs are done", result.runs.size(), result.planned),
      options.out ? "Give the same command again to do the rest" : "With --out DIR the runs done would be kept");
}

}  // namespace

equidem::Run declare(CLI::App& command) {
  return declare_with_quick(
      command,
      "Chapter 8: a box of 3000 discs, ellipses or bonded pairs filled and shaken; void ratios over seeds beside the\n"
      "printed ones, surface, grains thrown, pictures, an animation; which shaking compacts best, and whether the box\n"
      "resonates. An interrupted computation is continued when the same command is given again.",
      reproduce);
}

}  // namespace equidem::sukegawa2010
