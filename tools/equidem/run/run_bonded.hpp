// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// `equidem run` of bonded discs.
#pragma once

#include "equidem/dynamics/relaxation.hpp"
#include "equidem/dynamics/watch.hpp"

#include "command.hpp"
#include "run/run_job.hpp"
#include "run/run_setup.hpp"

namespace equidem {

class BondedRun final : public RunJob {
 public:
  /// \param setup must outlive the job
  explicit BondedRun(const RunSetup& setup);

  [[nodiscard]] AnySimulation& simulation() override { return simulation_; }
  [[nodiscard]] RunPlan plan() override;
  [[nodiscard]] const OutputCase& output() const override { return setup_.problem.resolved.output; }
  [[nodiscard]] const char* body_name() const override { return "disc"; }
  [[nodiscard]] StageTimes times() const override { return setup_.problem.times; }
  [[nodiscard]] std::string describe() const override;
  [[nodiscard]] std::string describe_balance(const Balance& balance) const override;
  void add_step(JsonObject& object) const override;
  void add_results(JsonObject& object) const override;
  void write_files(const std::filesystem::path& folder, const RunResult& result, bool overwrite) const override;

  /// In place of steps: to rest. \return the exit code
  int relax_to_rest(const CommonOptions& common) const;

 private:
  void write_state(const std::filesystem::path& folder, const std::vector<DiscMotion>& motions, bool overwrite) const;

  const RunSetup& setup_;
  Simulation simulation_;
  RunawayWatch watch_;
};

}  // namespace equidem
