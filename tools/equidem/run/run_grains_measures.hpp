// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Tables, results and plots of the measures of a box (fields/box_measures.hpp) that `equidem run` writes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/fields/box_measures.hpp"
#include "equidem/grains/stages/staged_simulation.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/results.hpp"
#include "equidem/output/run/run_loop.hpp"

#include "command.hpp"

namespace equidem {

class GrainMeasures final : public RunRecorder {
 public:
  /// \param resolved with measures
  /// \param simulation that is measured; must stay where it is
  GrainMeasures(const GrainCase& resolved, const StagedSimulation& simulation);

  /// Write measures.csv and surface.csv into a folder.
  /// \throws Error (bad_input) as GrowingCsv
  void open(const std::filesystem::path& folder, bool overwrite, const Checkpoint* from) override;
  [[nodiscard]] std::int64_t last_step() const override {
    return measures_.moments().empty() ? -1 : measures_.moments().back().step;
  }
  void record(std::int64_t step, double time, bool regular) override;
  void save(Checkpoint& checkpoint) override;

  /// measures: before and after, after the last step.
  [[nodiscard]] Results results() const;
  /// surface_plot: the surface before and at the end; void_ratio_plot; fields where asked for.
  void write_files(const CommonOptions& into) const;

 private:
  void go_on(const Checkpoint& from);
  [[nodiscard]] std::pair<CoarseGrid, std::string> grid_of_fields() const;

  const GrainCase& resolved_;
  const StagedSimulation& simulation_;
  BoxMeasures measures_;
  std::filesystem::path folder_;
  std::optional<GrowingCsv> table_, profiles_;
};

/// paths_plot: where the probes of positions went, from history.csv of the folder; nothing where there are none.
void write_probe_paths(const CommonOptions& into, const GrainCase& resolved);

}  // namespace equidem
