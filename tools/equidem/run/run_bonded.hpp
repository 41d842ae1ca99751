// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// `equidem run` of bonded discs, and the time step that an accuracy needs (--accuracy).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "equidem/core/matrix.hpp"
#include "equidem/dynamics/relaxation.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/dynamics/time_step.hpp"
#include "equidem/dynamics/watch.hpp"
#include "equidem/motion/saved_state.hpp"
#include "equidem/output/pictures/picture.hpp"
#include "equidem/output/results.hpp"
#include "equidem/output/run/run_loop.hpp"

#include "problem.hpp"
#include "run/run_job.hpp"

namespace equidem {

/// The continuum that a periodic cell stands for.
struct WaveStiffness {
  Matrix3 stiffness{};  ///< Pa, Voigt
  double density = 0;   ///< kg/m³, of the continuum
};

class StandingWaves final : public RunRecorder {
 public:
  /// \param probes those without a wavelength are left out
  StandingWaves(const AnySimulation& simulation, const std::vector<Probe>& probes);

  [[nodiscard]] bool empty() const { return waves_.empty(); }
  /// For each wave the period and the speed, wavelength over period; why not, where it did not oscillate.
  /// \param stiffness of the cell, for the speeds of theory beside the measured ones; may be none
  [[nodiscard]] Results results(const std::optional<WaveStiffness>& stiffness) const;

  void open(const std::filesystem::path& folder, bool overwrite, const Checkpoint* from) override;
  [[nodiscard]] std::int64_t last_step() const override { return last_step_; }
  void record(std::int64_t step, double time, bool regular) override;
  void save(Checkpoint& checkpoint) override;

 private:
  enum class Component { none, x, y };  ///< of the velocity; none while it is 0
  struct Wave {
    Probe probe;
    Component component = Component::none;
    Oscillation oscillation = {};
  };

  struct SavedWave {
    std::int64_t last_step = -1;
    Component component = Component::none;
    Oscillation oscillation = {};

    static constexpr auto numbers = [](auto& wave, const auto& visit) {
      visit(wave.last_step), visit(wave.component);
      Oscillation::numbers(wave.oscillation, visit);
    };
  };

  const AnySimulation& simulation_;
  std::vector<Wave> waves_;
  std::int64_t last_step_ = -1;
};

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
  [[nodiscard]] StageTimes times() const override { return problem_.times; }
  [[nodiscard]] Results scene(const std::string& history) const override;
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

}  // namespace equidem
