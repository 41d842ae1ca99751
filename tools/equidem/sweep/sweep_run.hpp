// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The points of a sweep as they are computed.
/// Size of a sweep before it is made.
#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "equidem/casefile/engine/toml.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/output/results.hpp"

#include "command.hpp"
#include "sweep/sweep_plan.hpp"
#include "sweep/sweep_table.hpp"
#include "verb_run.hpp"

namespace equidem {

struct SweepOptions {
  CommonOptions common;
  std::string verb = "solve";
  std::vector<KeyOptions> keys;
  std::vector<std::string> seeds;  ///< "1,2,3", "1-5"
  bool side_by_side = false;
  std::optional<std::string> title;  ///< of the curves
  bool resume = false;
};

/// A sweep whose options are checked.
struct Sweep {
  static constexpr const char *table_name = "sweep.csv", *case_name = "case.toml";

  const SweepOptions& options;
  SweepPlan plan;
  CaseDocument base;

  /// The verb with the values of a point and further options.
  [[nodiscard]] VerbRun run_of(const std::vector<std::string>& values, const std::vector<std::string>& further) const;
};

/// Computes points, several at the same time. Each is computed as the verb alone would do it, so that their numbers do
/// not depend on how many.
class SweepRun {
 public:
  /// \param kept points of an earlier run; those that failed are computed again
  SweepRun(const Sweep& sweep, std::vector<SweepPoint> kept);

  /// Computes what is missing: the first point on all threads, the others on one each, as many at a time as there are
  /// threads and as fit into memory. Saves the table after the first one and then about every second.
  /// Errors of points become part of them.
  void operator()();

  [[nodiscard]] bool stopped() const { return stopped_; }  ///< by the user
  [[nodiscard]] std::size_t done() const { return points_.size(); }
  [[nodiscard]] double seconds() const { return watch_.seconds(); }
  /// The points of this run that are done, then those of an earlier one beyond them.
  [[nodiscard]] std::vector<SweepPoint> points() const;
  /// Write the table into --out, if there is one.
  void save() const;

 private:
  bool compute_next();  ///< false where nothing is left to do
  [[nodiscard]] std::size_t points_at_once() const;
  void announce(std::size_t at_once) const;

  const Sweep& sweep_;
  std::vector<SweepPoint> kept_;
  std::map<std::size_t, SweepPoint> points_;  ///< done
  std::vector<std::size_t> missing_;          ///< to be computed at the start of the run
  std::atomic<std::size_t> next_{0};          ///< position in missing_
  std::mutex mutex_;                          ///< of what follows, and of points_
  Progress progress_;
  SavedOnTheWay saved_;
  Stopwatch watch_, since_saved_;
  double save_after_ = 0;  ///< s
  std::size_t computed_ = 0;
  bool stopped_ = false;
};

/// Delivers the number of points and the dry run of the first that can be computed.
/// \param results of the keys, which the others follow
/// \return the exit code
int dry_run_sweep(const Sweep& sweep, Results results);

}  // namespace equidem
