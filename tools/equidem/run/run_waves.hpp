// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Standing waves of a bonded run: period and speed, from the velocities of probes that have a wavelength.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "equidem/core/matrix.hpp"
#include "equidem/motion/saved_state.hpp"
#include "equidem/output/results.hpp"
#include "equidem/output/run/run_loop.hpp"

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

}  // namespace equidem
