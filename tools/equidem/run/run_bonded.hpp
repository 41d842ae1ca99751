// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// `equidem run` of bonded discs, and the time step that an accuracy needs (--accuracy).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "equidem/dynamics/relaxation.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/dynamics/time_step.hpp"
#include "equidem/dynamics/watch.hpp"
#include "equidem/output/pictures/picture.hpp"

#include "accuracy.hpp"
#include "problem.hpp"
#include "run/run_job.hpp"
#include "run/run_waves.hpp"

namespace equidem {

/// The step of a resumed run.
struct KeptStep {
  double step = 0;   ///< s
  std::string rule;  ///< by which it was chosen
};

/// The step that a checkpoint was made with.
/// \throws Error (bad_input) where there is no such file, or it is damaged
KeptStep kept_step(const std::filesystem::path& checkpoint);

class BondedRun final : public RunJob {
 public:
  /// \param kept takes the place of an automatic step
  /// \throws Error (bad_input) without [run]; as Simulation, with its place in the case
  explicit BondedRun(Case resolved, const std::optional<KeptStep>& kept = {});
  BondedRun(const BondedRun&) = delete;  // the scene refers to the problem
  BondedRun& operator=(const BondedRun&) = delete;

  [[nodiscard]] const RunCase& run() const { return *problem_.resolved.run; }
  [[nodiscard]] const TimeStep& time_step() const { return step_; }
  /// Place of a key in the case.
  [[nodiscard]] std::string where(const char* key) const { return problem_.resolved.where(key); }
  /// The order in the time step of the error of the motions.
  [[nodiscard]] int order() const;
  /// Steps of the whole duration; 0 where the run goes to rest.
  /// \throws Error (bad_input) where they are too many to be counted
  [[nodiscard]] std::int64_t steps() const;

  [[nodiscard]] Simulation& simulation() override { return simulation_; }
  [[nodiscard]] RunPlan plan() override;
  [[nodiscard]] const char* body_name() const override { return "disc"; }
  [[nodiscard]] std::vector<std::string> files() const override;
  [[nodiscard]] StageTimes times() const override { return problem_.times; }
  [[nodiscard]] Results scene() const override;
  [[nodiscard]] Results step() const override;
  [[nodiscard]] Results events() const override;
  [[nodiscard]] Results advice(const Balance& balance) const override;
  [[nodiscard]] std::vector<OutputPart> parts(const RunResult& result) const override;
  [[nodiscard]] double bytes_of_drawing() const override {
    return problem_.resolved.output.picture ? bytes_of_picture(problem_.assembly) : 0;
  }
  [[nodiscard]] bool goes_to_rest() const override { return run().until_rest.has_value(); }
  Results relax(StageTimes& times) override;

 private:
  /// The case text in a checkpoint: all data that affect the motion, including files that it names, without how long it
  /// lasts and what is written.
  [[nodiscard]] std::string fingerprint() const;
  [[nodiscard]] RelaxationOptions relaxation_options() const;
  /// None without waves, and where the cell has no stiffness or is too large to be homogenized beside a run.
  [[nodiscard]] std::optional<WaveStiffness> stiffness_of_waves() const;
  [[nodiscard]] LargestDeformation deformation_at(const std::vector<DiscMotion>& motions) const;

  Problem problem_;
  Scene scene_;
  TimeStep step_;
  SimulationOptions options_;
  Simulation simulation_;
  std::vector<Probe> probes_;
  StandingWaves waves_;
  RunawayWatch watch_;
  std::vector<DiscMotion> at_rest_;  ///< after relax()
};

/// The longest step for which the displacements at the end are within the accuracy, relative to the largest one. Pilots
/// are runs with the step of the case, that over root 2, and its half (and finer ones, until the motions at the end
/// converge by the order of the integrator); they write nothing.
/// \param given the run with the step of the case
/// \throws Error (bad_input) where the run goes to rest
SearchedSetting searched_step(const BondedRun& given, double accuracy);
inline constexpr const char* plan_of_steps =
    "first runs with the step of the case, that over root 2 and its half; the longest step that reaches it follows "
    "from them; above is the run with the step of the case";
std::vector<double> searched_values(const std::vector<DiscMotion>& motions);
/// \param search that has ended
ReachedAccuracy reached_by_step(const CaseSearch& search);

}  // namespace equidem
