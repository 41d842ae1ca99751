// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/ensemble/ensemble_accuracy.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

#include "accuracy.hpp"
#include "homogenize/ensemble.hpp"
#include "homogenize/ensemble_report.hpp"

namespace equidem {
namespace {

/// Fewer bodies jam earlier, so that many of their cells could not be packed.
constexpr std::int64_t smallest_packing = 128;

AccuracySetting setting_of(const EnsembleSetting& setting) {
  return {{"ensemble.discs", static_cast<double>(setting.discs)},
          {"ensemble.samples", static_cast<double>(setting.samples)}};
}

double work_of(const AccurateEnsemble& sampled) {
  double work = 0;
  for (const EnsembleSample& sample : sampled.samples) work += EnsembleSetting{sample.discs, 1}.work();
  return work;
}

ReachedAccuracy reached_by(const AccurateEnsemble& sampled, const EnsembleAccuracy& wanted, double seconds) {
  ReachedAccuracy reached{
      .requested = wanted.accuracy,
      .estimated = sampled.estimated,
      .of = fmt::format(
          "K and G relative, nu (plane strain) as it is, mean of {} cells of {} discs against infinite cells, with "
          "{:.4g} % confidence, scatter and drift together",
          sampled.chosen.samples, sampled.chosen.discs, 100 * wanted.confidence),
      .knob = "size and number of cells",
      .value = setting_of(sampled.chosen),
      .pilots = {},
      .ten_times_more = {}};
  std::vector<std::string> pilots;
  for (const std::int64_t discs : sampled.plan.discs) {
    if (discs == sampled.chosen.discs) continue;
    const auto cells = std::ranges::count(sampled.samples, discs, &EnsembleSample::discs);
    pilots.push_back(fmt::format("{} cells of {} discs", cells, discs));
  }
  reached.pilots = joined(pilots);
  reached.pilots_factor = work_of(sampled) / sampled.chosen.work() - 1;
  auto& more = reached.ten_times_more;
  more.time_factor = sampled.ten_times_more.work() / sampled.chosen.work();
  more.seconds = seconds * sampled.ten_times_more.work() / work_of(sampled);
  more.value = setting_of(sampled.ten_times_more);
  if (sampled.estimated <= wanted.accuracy / 10) more.note = has_it_already;
  if (sampled.ten_times_more.samples == 0) more.note = "cannot be had: cells of any size are off by more";
  if (sampled.ten_times_more.all_discs() > wanted.most_discs)
    more.note = fmt::format("cannot be had: it takes {:.2g} discs in all", sampled.ten_times_more.all_discs());
  return reached;
}

}  // namespace

int homogenize_to_accuracy(const CommonOptions& options, const Case& resolved, double accuracy) {
  if (!resolved.assembly.periodic()) {
    bad_input_at(resolved.where("assembly"), "--accuracy cannot be kept by samples with free boundaries",
                 "their moduli depend on the boundary far more than on the number of samples",
                 fmt::format("Set {}", joins_sides(resolved.assembly)));
  }
  OutputPlan(options).expect_json();
  if (!options.dry_run) check_ensemble_outputs(options);
  const auto lock = lock_out(options);
  EnsembleAccuracy wanted{.accuracy = accuracy, .first_seed = resolved.assembly.seed()};
  if (resolved.assembly.packing) wanted.smallest = smallest_packing;
  Results results = cell_results(resolved, wanted.smallest, wanted.first_seed);
  if (options.dry_run) {
    std::vector<std::string> pilots;
    for (const EnsembleSetting& pilot : accuracy_pilots(wanted))
      pilots.push_back(fmt::format("{} cells of {} discs", pilot.samples, pilot.discs));
    results.append(accuracy_plan(accuracy, fmt::format("first {}; the size and number of cells that reach it follow "
                                                       "from them, with at most {:.0e} discs in all",
                                                       joined(pilots, " and "), wanted.most_discs)));
    deliver(options, "dry_run", results.block("nothing was solved (--dry-run)\n"), {});
    return 0;
  }
  const auto& folder = options.out;
  const auto save = [&](const std::vector<EnsembleSample>& done) {
    if (folder) write_samples(*folder / "samples.csv", samples_table(done));
  };
  StageTimes times;
  Stopwatch watch;
  SavedOnTheWay saved(options);
  AccurateEnsemble sampled =
      sample_to_accuracy([&](std::int64_t discs, std::uint64_t seed) { return homogenize_cell(resolved, discs, seed); },
                         wanted, [&](const std::vector<EnsembleSample>& done) { saved([&] { save(done); }); });
  times.add("sampling", watch.lap());
  std::optional<Error> failure = sampled.failure;
  if (sampled.stopped)
    failure = Error(
        ErrorKind::interrupted, "stopped as asked",
        fmt::format("{} cells are done, too few for an accuracy of {:.3g}", sampled.samples.size(), accuracy), "");
  const ReachedAccuracy reached = reached_by(sampled, wanted, times.total());
  EnsembleResult result{.title = resolved.title,
                        .plan = sampled.plan,
                        .accuracy = accuracy,
                        .samples = std::move(sampled.samples),
                        .statistics = std::move(sampled.statistics)};
  if (folder) {
    CommonOptions chosen = options;
    chosen.set.push_back(fmt::format("ensemble={{discs = [{}], samples = {}, accuracy = {}}}", sampled.chosen.discs,
                                     sampled.chosen.samples, accuracy));
    write_case(options, read_case(chosen));
  }
  results.append(ensemble_results(result));
  if (sampled.estimated > 0 || !failure) results.append(accuracy_results(reached));
  deliver_ensemble(
      options, result, std::move(results), std::move(times), [&] { save(result.samples); }, failure);
  return 0;
}

}  // namespace equidem
