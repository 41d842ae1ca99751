// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// `equidem run` of bodies that collide.
#pragma once

#include <optional>

#include "run/run_grains_measures.hpp"
#include "run/run_grains_setup.hpp"
#include "run/run_job.hpp"

namespace equidem {

class GrainRun final : public RunJob {
 public:
  /// \param setup must outlive the job
  explicit GrainRun(const GrainSetup& setup);
  GrainRun(const GrainRun&) = delete;  // measures refer to the simulation
  GrainRun& operator=(const GrainRun&) = delete;

  [[nodiscard]] AnySimulation& simulation() override { return simulation_; }
  [[nodiscard]] RunPlan plan() override;
  [[nodiscard]] const OutputCase& output() const override { return setup_.resolved.output; }
  [[nodiscard]] const char* body_name() const override { return "grain"; }
  [[nodiscard]] std::string describe() const override;
  [[nodiscard]] std::string describe_events() const override;
  [[nodiscard]] std::string describe_balance(const Balance& balance) const override;
  void add_step(JsonObject& object) const override;
  void add_results(JsonObject& object) const override;
  void write_files(const std::filesystem::path& folder, const RunResult& result, bool overwrite) const override;

 private:
  const GrainSetup& setup_;
  GrainSimulation simulation_;
  std::optional<GrainMeasures> measures_;
  FrameOptions frames_;
  Assembly frame_discs_;
};

}  // namespace equidem
