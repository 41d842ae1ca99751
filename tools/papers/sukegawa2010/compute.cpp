// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cassert>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <span>

#include "equidem/core/checksum.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/output/files/checkpoint.hpp"

#include "sukegawa2010/sukegawa2010.hpp"

namespace equidem::sukegawa2010 {

namespace {

/// All settings that a filling depends on.
std::string settings_of(const Fill& fill) {
  std::string text = fmt::format(
      "{} columns {} rows {} seed {} softness {} damping {} friction {} step {} bonds {} rows {} cap {} ellipses {} "
      "version {}",
      plural_of(fill.shape), fill.grid.columns, fill.grid.rows, fill.seed, fill.softness, fill.damping, fill.friction,
      fill.step ? fmt::format("{} s", *fill.step) : fmt::format("{}", fill.step_share), fill.bond_step, fill.row_share,
      fill.cap == FrictionCap::whole_force ? "whole" : "spring",
      fill.ellipse_law == EllipseLaw::exact ? "exact" : "mended", library_version());
  if (fill.bulk_density != Fill::BulkDensity::unused)
    text += fmt::format(" bulk {}", fill.bulk_density == Fill::BulkDensity::of_springs ? "springs" : "all");
  if (fill.printed) {
    text += fmt::format(" printed {} beta {} c {}",
                        fill.printed->integrator == PrintedOptions::Integrator::printed ? "(3.17)" : "semi-implicit",
                        fill.printed->beta, fill.printed->mass_damping);
  }
  return text;
}
std::string settings_of(const Run& run) {
  std::string text = settings_of(run.fill);
  if (run.shaking)
    text += fmt::format(" {} gal {} Hz {} cycles", run.shaking->gal, run.shaking->frequency, run.shaking->cycles);
  return text;
}

class Store {
 public:
  explicit Store(const CommonOptions& options) : folder_(options.out), overwrite_(options.overwrite) {}

  std::optional<Outcome> find(const std::string& name, const std::string& settings) const {
    const auto path = file(name, ".json");
    if (!folder_ || overwrite_ || !std::filesystem::exists(path)) return {};
    const std::string text = read_file(path);
    if (text.find("\"" + settings + "\"") == std::string::npos) {
      bad_input_at(path.string(), "the run there has other settings", "results of different settings must not be mixed",
                   "Choose another --out, or give --overwrite to start again");
    }
    Outcome outcome;
    for (const OutcomeKey& key : outcome_keys)
      outcome.*key.value = number_in_json(text, key.name).value_or(std::numeric_limits<double>::quiet_NaN());
    if (text.find("\"" + checksum_of(name, outcome) + "\"") == std::string::npos) {
      throw Error(ErrorKind::bad_input, "the run there, or its history in CSV, was altered since it was written",
                  "its checksum is wrong", "Remove the file, and the run is computed again", path.string());
    }
    return outcome;
  }

  void keep(const std::string& name, const std::string& settings, const Outcome& outcome) const {
    if (!folder_) return;
    Results object;
    object.set("settings", settings);
    for (const OutcomeKey& key : outcome_keys) object.set(key.name, outcome.*key.value);
    object.set("checksum", checksum_of(name, outcome));
    write_file(file(name, ".json"), object.json(), true);
  }

  std::optional<SavedState> find_state(const Fill& fill, const std::string& settings) const {
    const auto path = file(fill.name(), ".h5");
    if (!folder_ || overwrite_ || !std::filesystem::exists(path)) return {};
    const std::lock_guard lock(mutex_);
    return read_checkpoint(path, settings).state;
  }
  void keep_state(const Fill& fill, const std::string& settings, const SavedState& state) const {
    if (!folder_) return;
    const std::lock_guard lock(mutex_);
    CheckpointWriter(file(fill.name(), ".h5"), settings, true).write({.state = state});
  }

 private:
  /// Checksum of an outcome and of the history beside it.
  [[nodiscard]] std::string checksum_of(const std::string& name, const Outcome& outcome) const {
    const auto history = file(name, ".csv");
    std::string text = std::filesystem::exists(history) ? read_file(history) : "";
    for (const OutcomeKey& key : outcome_keys) {
      const double value = outcome.*key.value;
      text += std::isfinite(value) ? fmt::format(" {}", value) : " null";
    }
    Checksum sum;
    sum.add(std::as_bytes(std::span(text)));
    return sum.text();
  }
  [[nodiscard]] std::filesystem::path file(const std::string& name, const char* end) const {
    return folder_ ? *folder_ / "runs" / (name + end) : std::filesystem::path();
  }
  std::optional<std::filesystem::path> folder_;
  bool overwrite_;
  mutable std::mutex mutex_;  // HDF5 is not safe for several threads
};

/// Progress over all threads.
class Work {
 public:
  explicit Work(double total) : total_(total) {}
  /// \param now work done by the calling thread \param counted part of it that is already in the total
  void add(double& counted, double now) {
    const std::lock_guard lock(mutex_);
    done_ += now - counted;
    counted = now;
    progress_.update(std::min(1.0, done_ / total_));
  }

 private:
  std::mutex mutex_;
  double total_, done_ = 0;
  Progress progress_{"reproducing Sukegawa 2010"};
};

struct SharedFill {
  std::mutex mutex;
  std::optional<FilledBox> box;
};

}  // namespace

void check_kept(const CommonOptions& options, bool quick) {
  const Store store(options);
  for (const Run& run : plan(quick)) {
    static_cast<void>(store.find(run.fill.name(), settings_of(run.fill)));
    static_cast<void>(store.find(run.name(), settings_of(run)));
  }
}

void compute(const CommonOptions& options, Reproduction& result) {
  const std::vector<Run> runs = plan(result.quick);
  const Store store(options);
  std::vector<std::optional<Outcome>> outcomes;
  std::map<std::string, std::unique_ptr<SharedFill>> fills;
  std::map<std::string, bool> shown;
  std::map<std::string, std::string> names;
  std::map<std::string, Outcome> fillings;
  std::mutex filling;
  double total = 0;
  for (const Run& run : runs) {
    const auto [known, is_new] = names.emplace(run.fill.name(), settings_of(run.fill));
    assert((is_new || known->second == settings_of(run.fill)) && "one filling per name");
    if (is_new) {
      if (const auto outcome = store.find(known->first, known->second)) fillings[known->first] = *outcome;
    }
    outcomes.push_back(store.find(run.name(), settings_of(run)));
    if (outcomes.back()) continue;
    total += cost_of(run);
    auto& fill = fills[run.fill.name()];
    if (!fill) {
      fill = std::make_unique<SharedFill>();
      total += cost_of({.fill = run.fill});
    }
    shown[run.fill.name()] |= run.shown;
  }
  Work work(std::max(total, 1e-300));
  const auto one = [&](std::size_t k, int) {
    if (outcomes[k]) return;
    const Run& run = runs[k];
    double counted = 0, base = 0;
    const auto tick = [&](double cost) {
      return [&work, &counted, &base, cost](double share) { work.add(counted, base + share * cost); };
    };
    SharedFill& fill = *fills.at(run.fill.name());
    {
      const std::lock_guard lock(fill.mutex);
      if (!fill.box) {
        const double cost = cost_of({.fill = run.fill});
        const std::string settings = settings_of(run.fill);
        const auto outcome = store.find(run.fill.name(), settings);
        auto state = outcome ? store.find_state(run.fill, settings) : std::nullopt;
        if (state) {
          fill.box = FilledBox{std::move(*state), *outcome};
        } else {
          fill.box = fill_box(run.fill, shown.at(run.fill.name()), options.out, tick(cost));
          store.keep_state(run.fill, settings, fill.box->state);
          store.keep(run.fill.name(), settings, fill.box->outcome);
        }
        const std::lock_guard adding(filling);
        fillings[run.fill.name()] = fill.box->outcome;
        work.add(counted, base = cost);
      }
    }
    outcomes[k] = shake_box(run, *fill.box, options.out, tick(cost_of(run)));
    work.add(counted, base + cost_of(run));
    store.keep(run.name(), settings_of(run), *outcomes[k]);
  };
  std::exception_ptr interruption;
  try {
    parallel_tasks(runs.size(), one);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::interrupted) throw;
    interruption = std::current_exception();
  }
  for (std::size_t k = 0; k < runs.size(); ++k)
    if (outcomes[k]) result.runs.push_back({runs[k], *outcomes[k]});
  for (const Run& run : runs) {
    const auto found = fillings.extract(run.fill.name());
    if (found) result.fills.push_back({{.fill = run.fill}, found.mapped()});
  }
  if (interruption) std::rethrow_exception(interruption);
}

}  // namespace equidem::sukegawa2010
