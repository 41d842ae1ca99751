// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Many random cells of several sizes, one seed after another.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"

namespace equidem {

/// The cells to sample: `samples` of each size, with the seeds first_seed, first_seed + 1, ...
struct EnsemblePlan {
  std::vector<std::int64_t> discs = {100, 400, 1600};  ///< wanted in a cell, ascending
  int samples = 10;                                    ///< of each size
  std::uint64_t first_seed = 1;
};

/// Result of homogenizing one cell.
struct HomogenizedCell {
  std::int64_t discs = 0;  ///< that the cell has: some point processes only come near the number wanted
  EffectiveModuli moduli;
};

/// \throws Error as effective_stiffness; (computation_failed) where the cell is unstable, or that is not known
HomogenizedCell homogenize_cell(const Assembly& cell, const ContactSprings& springs, const HomogenizeOptions& options);

/// One cell of an ensemble.
struct EnsembleSample {
  std::int64_t discs = 0;  ///< wanted
  std::uint64_t seed = 0;
  HomogenizedCell cell;
  std::string refusal;  ///< why the cell has no moduli; empty: it has

  [[nodiscard]] bool refused() const { return !refusal.empty(); }
};

/// Builds and homogenizes the cell of a size and seed; called from several threads at once.
/// \throws Error where the cell has no moduli
using CellSampler = std::function<HomogenizedCell(std::int64_t discs, std::uint64_t seed)>;

struct EnsembleSamples {
  std::vector<EnsembleSample> samples;  ///< size by size, seed by seed
  bool stopped = false;                 ///< by the user, before the last one
};

/// Number of cells of a size that are sampled at the same time, each by one thread; 1: by all threads.
int cells_at_once(std::int64_t discs);

/// Sample the cells of a plan. Small cells are done several at a time, each by one thread; large ones one by one: the
/// bits are the same. A cell that the sampler refuses is kept with its reason; an interruption ends the
/// sampling and keeps the cells that are done.
/// \param kept samples of an earlier run, which are not computed again; those outside the plan are left out
/// \param save called now and then, and at the end, with the samples done so far; may be empty
EnsembleSamples sample_ensemble(const EnsemblePlan& plan, const CellSampler& sampler,
                                const std::vector<EnsembleSample>& kept = {},
                                const std::function<void(const std::vector<EnsembleSample>& done)>& save = {});

}  // namespace equidem
