// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// `equidem run` of bodies that collide.
#pragma once

#include <optional>

#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/grains/stages/staged_simulation.hpp"

#include "run/run_grains_measures.hpp"
#include "run/run_job.hpp"

namespace equidem {

class GrainRun final : public RunJob {
 public:
  /// \throws Error (bad_input) as GrainSimulation does, with its place in the case
  explicit GrainRun(GrainCase resolved);
  GrainRun(const GrainRun&) = delete;  // measures refer to case and simulation
  GrainRun& operator=(const GrainRun&) = delete;

  [[nodiscard]] AnySimulation& simulation() override { return simulation_; }
  [[nodiscard]] RunPlan plan() override;
  [[nodiscard]] const char* body_name() const override { return "grain"; }
  [[nodiscard]] std::vector<std::string> files() const override;
  [[nodiscard]] Results scene() const override;
  [[nodiscard]] Results step() const override;
  [[nodiscard]] Results events() const override;
  [[nodiscard]] Results advice(const Balance& balance) const override;
  void write_files(const std::filesystem::path& folder, const RunResult& result, bool overwrite) const override;

 private:
  /// The case text in a checkpoint: all data that affect the motion, including files that it names, without how long it
  /// lasts and what is written.
  [[nodiscard]] std::string fingerprint() const;
  /// Of the present stage.
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
};

}  // namespace equidem
