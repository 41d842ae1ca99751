// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A run, or a run in stages, saved at its steps goes on with the same bits.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "equidem/grains/stages/staged_simulation.hpp"

#include "grains/scenes.hpp"
#include "support/catch.hpp"

namespace equidem::test {

/// Saved at about forty steps, and at those at which bodies are taken back into a cell (every 256th); steps that were
/// made one at a time are then made together, by a new simulation and by the one that has made them.
inline void check_resuming(const GrainScene& scene, const GrainOptions& options, std::int64_t last) {
  GrainSimulation whole(scene, options);
  std::vector<SavedState> states;
  std::vector<Bits> seen;
  for (std::int64_t k = 0; k <= last; ++k) {
    if (k > 0) whole.advance(1);
    if (k % std::max<std::int64_t>(1, last / 40) != 0 && (k + 1) % 256 > 2 && k != last) continue;
    states.push_back(whole.save());
    seen.push_back(bits_and_loads_of(whole));
  }
  REQUIRE(whole.counters().contacts > 10);
  for (std::size_t s = 0; s < states.size(); ++s) {
    CAPTURE(states[s].step, states[s]["contacts"].size());
    GrainSimulation resumed(scene, options);
    resumed.restore(states[s]);
    REQUIRE(bits_and_loads_of(resumed) == seen[s]);
    resumed.advance(last - states[s].step);
    REQUIRE(bits_and_loads_of(resumed) == seen.back());
    CHECK(resumed.counters().contacts == whole.counters().contacts);
    REQUIRE(resumed.breaks().size() == whole.breaks().size());
    for (std::size_t b = 0; b < whole.breaks().size(); ++b) {
      CHECK(resumed.breaks()[b].step == whole.breaks()[b].step);
      CHECK(resumed.breaks()[b].bond == whole.breaks()[b].bond);
      CHECK(resumed.breaks()[b].energy == whole.breaks()[b].energy);
    }
  }
  for (const std::size_t s : {std::size_t{0}, states.size() / 2}) {
    whole.restore(states[s]);
    CHECK(bits_and_loads_of(whole) == seen[s]);
    whole.advance(last - states[s].step);
    CHECK(bits_and_loads_of(whole) == seen.back());
  }
}

/// A stage that differs from another one by its name.
inline GrainStage named(GrainStage stage, std::string name) {
  stage.name = std::move(name);
  return stage;
}

/// Over ends of stages.
inline void run_to(StagedSimulation& simulation, std::int64_t step) {
  while (simulation.step() < step && !simulation.over()) simulation.advance(step - simulation.step());
}

/// Saved at every `stride`-th step and at the ends of stages. \return the run at its end
inline StagedSimulation check_resuming(const std::vector<GrainStage>& stages, const GrainOptions& options,
                                       std::int64_t stride) {
  StagedSimulation whole(stages, options);
  std::vector<SavedState> states;
  std::vector<Bits> seen;
  const auto keep = [&] {
    states.push_back(whole.save());
    seen.push_back(bits_and_loads_of(whole.present()));
  };
  while (!whole.over()) {
    if (whole.step() % stride == 0 || whole.milestone() >= 0) keep();
    whole.advance(1);
  }
  keep();
  for (std::size_t s = 0; s < states.size(); ++s) {
    CAPTURE(states[s].step);
    StagedSimulation resumed(stages, options);
    resumed.restore(states[s]);
    REQUIRE(resumed.step() == states[s].step);
    CHECK(bits_and_loads_of(resumed.present()) == seen[s]);
    run_to(resumed, whole.step());
    CHECK(bits_and_loads_of(resumed.present()) == seen.back());
    CHECK(resumed.energy().error() == whole.energy().error());
    CHECK(resumed.save()["stage_bodies"] == whole.save()["stage_bodies"]);
    REQUIRE(resumed.reports().size() == whole.reports().size());
    for (std::size_t k = 0; k < whole.reports().size(); ++k) {
      CHECK(resumed.reports()[k].removed == whole.reports()[k].removed);
      CHECK(resumed.reports()[k].bonds_made == whole.reports()[k].bonds_made);
      CHECK(resumed.reports()[k].effects == whole.reports()[k].effects);
    }
    REQUIRE((resumed.strengths() == nullptr) == (whole.strengths() == nullptr));
    if (whole.strengths() != nullptr) CHECK(resumed.strengths()->tension == whole.strengths()->tension);
    REQUIRE(resumed.breaks().size() == whole.breaks().size());
    for (std::size_t b = 0; b < whole.breaks().size(); ++b) CHECK(resumed.breaks()[b].bond == whole.breaks()[b].bond);
  }
  return whole;
}

}  // namespace equidem::test
