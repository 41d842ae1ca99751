// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/ensemble/ensemble.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

/// Discs from which on a cell keeps all threads busy by itself, and its memory should not be needed several times.
constexpr std::int64_t large_cell = 20000;
constexpr double save_every = 1;  // s

/// Empty where the user asked to stop.
std::optional<EnsembleSample> sample_cell(const CellSampler& sampler, std::int64_t discs, std::uint64_t seed) {
  EnsembleSample sample{.discs = discs, .seed = seed, .cell = {}, .refusal = {}};
  try {
    stop_if_interrupted();
    sample.cell = sampler(discs, seed);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) return {};
    sample.refusal = error.what();
  }
  return sample;
}

}  // namespace

HomogenizedCell homogenize_cell(const Assembly& cell, const ContactSprings& springs, const HomogenizeOptions& options) {
  const EffectiveStiffness effective = effective_stiffness(cell, springs, options);
  if (effective.unstable_modes > 0)
    computation_failed("the cell is unstable",
                       fmt::format("it has {}", counted(*effective.unstable_modes, "unstable mode")),
                       "Use a larger kT");
  if (!effective.unstable_modes)
    computation_failed("the stability of the cell is not known", "this solver does not count negative pivots",
                       "Set solver.method = \"auto\"");
  return {static_cast<std::int64_t>(cell.size()), effective_moduli(effective.stiffness)};
}

int cells_at_once(std::int64_t discs) {
  return discs >= large_cell ? 1 : thread_count();
}

EnsembleSamples sample_ensemble(const EnsemblePlan& plan, const CellSampler& sampler,
                                const std::vector<EnsembleSample>& kept,
                                const std::function<void(const std::vector<EnsembleSample>&)>& save) {
  std::map<std::pair<std::int64_t, std::uint64_t>, const EnsembleSample*> known;
  for (const EnsembleSample& sample : kept) known[{sample.discs, sample.seed}] = &sample;

  EnsembleSamples result;
  Stopwatch since_saved;
  for (const std::int64_t discs : plan.discs) {
    Progress progress(fmt::format("{} of {}:", counted(plan.samples, "cell"), counted(discs, "disc")));
    const int at_once = cells_at_once(discs);
    for (int begin = 0; begin < plan.samples && !result.stopped; begin += at_once) {
      const int count = std::min(at_once, plan.samples - begin);
      std::vector<std::optional<EnsembleSample>> cells(static_cast<std::size_t>(count));
      const auto sample = [&](std::size_t k, int) {
        const std::uint64_t seed = plan.first_seed + static_cast<std::uint64_t>(begin) + k;
        const auto found = known.find({discs, seed});
        cells[k] = found != known.end() ? *found->second : sample_cell(sampler, discs, seed);
      };
      if (count == 1) {
        sample(0, 0);
      } else {
        parallel_tasks(cells.size(), sample);
      }
      for (auto& cell : cells) {
        if (cell) {
          result.samples.push_back(std::move(*cell));
        } else {
          result.stopped = true;
        }
      }
      if (save && since_saved.seconds() >= save_every) {
        save(result.samples);
        since_saved.lap();
      }
      try {
        progress.update(static_cast<double>(begin + count) / plan.samples);
      } catch (const Error&) {  // interrupted: the next cell, if there is one, throws again
      }
    }
    if (result.stopped) break;
  }
  if (save) save(result.samples);
  return result;
}

}  // namespace equidem
