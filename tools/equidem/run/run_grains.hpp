// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// `equidem run` of bodies that collide.
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
#include "equidem/output/run/sample_test.hpp"

#include "case_text.hpp"
#include "command.hpp"
#include "run/run_job.hpp"

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
  /// The names of all files of measures.
  static std::vector<std::string> files(const GrainCase& resolved);
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

/// The step of the run in stages that a checkpoint is of, s.
/// \throws Error (bad_input) as case_of_checkpoint; a checkpoint of another run
double step_of_stages(const std::filesystem::path& checkpoint);

/// The step of a run that goes on, s, from the case text of its checkpoint: a run that has begun from another one has
/// the step of that one, which may be shorter than its own. None where this case needs a shorter one.
std::optional<double> kept_grain_step(const std::string& text, const GrainCase& resolved);

class GrainRun final : public RunJob {
 public:
  /// \param kept_step s, of a checkpoint: an automatic step is that one
  /// \throws Error (bad_input) as GrainSimulation does, with its place in the case; a kept step that is too long
  explicit GrainRun(GrainCase resolved, const std::optional<double>& kept_step = {});
  GrainRun(const GrainRun&) = delete;  // measures refer to case and simulation
  GrainRun& operator=(const GrainRun&) = delete;

  /// Begin with the state of a checkpoint of another run, with which this case agrees until then.
  /// \throws Error (bad_input) as read_checkpoint; a run that is not in stages, a case that is another one until
  ///         then, or has nothing to follow
  void begin_from(const std::filesystem::path& path);
  /// Go on with a run whose checkpoint is of that case text: how it began is known from there.
  void go_on_from(const std::string& text) { beginning_ = beginning_in(text); }

  [[nodiscard]] AnySimulation& simulation() override { return simulation_; }
  [[nodiscard]] RunPlan plan() override;
  [[nodiscard]] const char* body_name() const override { return "grain"; }
  [[nodiscard]] bool needs_history() const override { return SampleTest::loads(loaded_sample()); }
  [[nodiscard]] Results scene(const std::string& history) const override;
  [[nodiscard]] std::vector<std::pair<std::string, std::vector<double>>> curves(
      const std::string& history) const override;
  [[nodiscard]] Results step() const override;
  [[nodiscard]] Results events() const override;
  [[nodiscard]] Results advice(const Balance& balance) const override;
  [[nodiscard]] std::vector<OutputPart> parts(const RunResult& result) const override;
  [[nodiscard]] double bytes_of_drawing() const override {
    constexpr double of_body = 300;  // measured: its row in the tables and in the picture
    return of_body * static_cast<double>(simulation_.motions().size());
  }

 private:
  struct Snapshot {
    std::vector<Grain> grains;
    std::vector<Wall> walls;
    StagedSimulation::HoldingBonds bonds;   ///< of the grains, which they number as they are here
    std::vector<std::string> groups = {};   ///< of each grain
    std::vector<int> colours = {};          ///< likewise
    std::vector<std::size_t> numbers = {};  ///< likewise, in the run
    std::vector<std::size_t> places = {};   ///< here of each number in the run
  };
  /// The bodies that are there now.
  [[nodiscard]] Snapshot snapshot() const;
  void write_tables(const CommonOptions& into) const;
  void write_breaks(const CommonOptions& into) const;
  void draw(const CommonOptions& into, const RunResult& result) const;
  /// The sample and its stages.
  [[nodiscard]] LoadedSample loaded_sample() const;
  /// Bonds that broke.
  [[nodiscard]] Results breaks() const;
  /// Contacts as the present stage has them.
  [[nodiscard]] const ContactTable& present_contacts() const;
  [[nodiscard]] int colour_of(const std::string& group) const;

  GrainCase case_;
  GrainTimeStep step_;
  std::int64_t steps_;       ///< number of steps of the whole duration
  std::vector<Wall> walls_;  ///< of all stages, one of each name
  StagedSimulation simulation_;
  std::optional<GrainMeasures> measures_;
  FrameOptions frames_;
  Assembly frame_discs_;
  std::optional<Beginning> beginning_;
};

}  // namespace equidem
