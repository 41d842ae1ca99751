// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Files of `equidem quasistatic`: the curve, the crack picture, frames.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "equidem/breakage/breakage_run.hpp"
#include "equidem/breakage/unbonded/unbonded_run.hpp"
#include "equidem/output/files/frames.hpp"

#include "command.hpp"

namespace equidem {

inline constexpr const char* event_table_name = "events.csv";

/// \throws Error (bad_input) where a file could not be written
void expect_quasistatic(const OutputPlan& plan, const OutputCase& wanted);

/// The curve of load against motion with its envelopes, and the picture of the cracks.
void write_figures(const CommonOptions& options, const OutputCase& wanted, const BreakageScene& scene,
                   const EventPath& run, std::span<const std::size_t> cut, const std::string& title);

/// A frame for every n-th event: the network behind the event, at its lambda; the event stands for the time.
class EventFrames {
 public:
  EventFrames(const CommonOptions& options, const BreakageScene& scene, const Effects& effects,
              std::span<const std::size_t> cut, std::int64_t every);
  void add(const BreakageRun& run, const BreakableSystem& system);
  /// Closed contacts and bonds.
  void add(const UnbondedRun& run);
  void finish() const { writer_.finish(); }

 private:
  void append(std::int64_t event, std::span<const double> motion, const std::vector<BodyContact>& contacts);

  const BreakageScene scene_;
  std::vector<std::uint8_t> broken_;
  std::int64_t every_, written_ = 0;  // events between frames, and frames written where contacts rub
  std::size_t per_disc_;
  FrameWriter writer_;
};

}  // namespace equidem
