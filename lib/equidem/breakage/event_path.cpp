// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/event_path.hpp"

#include <limits>

#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

BreakableNetwork breakable_network(const BreakageScene& scene, const Effects& effects, std::vector<Support> supports,
                                   const SolverOptions& solver) {
  BreakableNetwork network{scene.assembly, scene.springs, effects, std::move(supports), {scene.path.pattern}, solver};
  if (scene.path.dead) network.cases.push_back(*scene.path.dead);
  return network;
}

bool EventPath::advance() {
  const std::size_t before = events_.size();
  const std::int64_t most = scene_.path.max_events;
  pauses_ = false;
  while (end_ == PathEnd::none && events_.size() == before && !pauses_) {
    stop_if_interrupted();
    if (most == 0 || std::ssize(events_) < most) {
      step();
    } else {
      end(PathEnd::most_events, fmt::format("{} are done (max_events = {}){}", counted(std::ssize(events_), "event"),
                                            most, releasing() ? ", while a broken bond gives up its force" : ""));
    }
  }
  return events_.size() > before || end_ == PathEnd::none;
}

double EventPath::direction(std::int64_t leg) const {
  const std::vector<double>& legs = scene_.path.legs;
  const auto k = static_cast<std::size_t>(leg);
  if (k >= legs.size()) return 1;
  const double from = k == 0 || scene_.path.control == LoadControl::path ? 0 : legs[k - 1];
  return legs[k] < from ? -1 : 1;
}

BreakEvent EventPath::event_of(std::size_t contact, BreakMode mode) const {
  const LegPoint at = point();
  const PathLedger energies = ledger();
  return {.leg = leg_,
          .lambda = at.lambda,
          .contact = static_cast<std::int64_t>(contact),
          .mode = mode,
          .gap = std::numeric_limits<double>::infinity(),
          .load = at.load,
          .motion = at.motion,
          .stress = at.stress.value_or(Tensor2{}),
          .energy_before = energies.elastic,
          .energy_after = energies.elastic,
          .work = energies.work,
          .load_rate = at.load_rate,
          .motion_rate = at.motion_rate,
          .friction = energies.friction};
}

void EventPath::end(PathEnd why, std::string sentence) {
  end_ = why;
  why_ = std::move(sentence);
}

std::optional<double> EventPath::end_of_leg() const {
  const auto k = static_cast<std::size_t>(leg_);
  return k < scene_.path.legs.size() ? std::optional(scene_.path.legs[k]) : std::nullopt;
}

}  // namespace equidem
