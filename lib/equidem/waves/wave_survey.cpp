// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/wave_survey.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/progress.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

int fineness(const PrimitiveCell& cell, int of_one_disc, int at_least) {
  const double n = of_one_disc / std::sqrt(static_cast<double>(cell.size()));
  return std::max(at_least, 2 * static_cast<int>(std::lround(n / 2)));
}

ZoneSearch search_of(const PrimitiveCell& cell) {
  ZoneSearch search{.grid = fineness(cell, 48, 4)};
  if (cell.size() > 4) search.refine = 2, search.steps = 12;
  if (cell.size() > 25) search.refine = 1, search.steps = 4;
  return search;
}

int steps_of_segment(const PrimitiveCell& cell) {
  return fineness(cell, 60, 6);
}

std::vector<PathPoint> path_of(const BrillouinZone& zone, int steps) {
  std::vector<PathPoint> path;
  double along = 0;
  for (std::size_t k = 0; k + 1 < zone.path.size(); ++k) {
    const ZonePoint &from = zone.path[k], &to = zone.path[k + 1];
    const Vec2 step = (to.q - from.q) / steps;
    for (int s = 0; s < steps; ++s, along += norm(step))
      path.push_back({along, {s == 0 ? from.name : "", from.q + static_cast<double>(s) * step}, {}, 0});
  }
  path.push_back({along, zone.path.back(), {}, 0});
  return path;
}

constexpr int directions = 12;

Vec2 direction(int k) {
  const double angle = k * std::numbers::pi / directions;
  return {std::cos(angle), std::sin(angle)};
}

/// The limit q -> 0 is another one along every direction, and none of them is what q = 0 has: there the mean strain is held, in a
/// long wave it follows. One thousandth of the zone is near enough to 0 for six digits, and far enough for the round-off of
/// motions that cost q².
void add_long_waves(const BlochWaves& waves, const BrillouinZone& zone, ZoneMaximum& critical) {
  const double length = 1e-3 * norm(zone.reciprocal[0]);
  std::vector<double> ratios(directions);
  parallel_tasks(ratios.size(), [&](std::size_t k, int) {
    ratios[k] = waves.critical_ratio(length * direction(static_cast<int>(k)));
  });
  const auto best = std::max_element(ratios.begin(), ratios.end());
  const bool climbed_there = critical.at.name.empty() && norm(critical.at.q) < 30 * length;
  if (*best > critical.value + 1e-9 * std::abs(critical.value) + 1e-12) {
    critical.value = *best;
    critical.at.q = length * direction(static_cast<int>(best - ratios.begin()));
    critical.points.clear();
  } else if (!climbed_there) {
    return;
  }
  critical.at.name = long_waves_name;
}

}  // namespace

std::size_t survey_size(const PrimitiveCell& cell) {
  const ZoneSearch search = search_of(cell);
  const BrillouinZone zone = brillouin_zone(cell.period);
  const auto n = static_cast<std::size_t>(search.grid);
  return 3 * (n * (n / 2 + 1) + zone.points.size() + 10 * search.refine) +
         2 * (zone.path.size() - 1) * static_cast<std::size_t>(steps_of_segment(cell));
}

WaveSurvey survey_waves(const PrimitiveCell& cell, const std::vector<Inertia>& inertia, Rotation rotation) {
  const bool turns = rotation != Rotation::restrained;
  const bool any_tangential =
      std::any_of(cell.contacts.begin(), cell.contacts.end(), [](const CellContact& c) { return c.springs.kT != 0; });
  const bool any_negative =
      std::any_of(cell.contacts.begin(), cell.contacts.end(), [](const CellContact& c) { return c.springs.kT < 0; });
  const BlochWaves in_motion(cell, inertia, turns && any_tangential), at_rest(cell, inertia, turns);
  WaveSurvey survey;
  survey.cell = cell;
  survey.zone = brillouin_zone(cell.period);
  survey.mass_per_area = in_motion.mass_per_area();
  const ZoneSearch search = search_of(cell);
  survey.grid = search.grid;
  Progress progress("waves");
  const auto over_zone = [&](auto of_q, double done) {
    ZoneMaximum found = maximize_over_zone(
        survey.zone,
        [&](Vec2 q) {
          stop_if_interrupted();
          return of_q(q);
        },
        search);
    progress.update(done);
    return found;
  };
  survey.critical = over_zone([&](Vec2 q) { return at_rest.critical_ratio(q); }, 0.5);
  add_long_waves(at_rest, survey.zone, survey.critical);
  survey.highest = over_zone([&](Vec2 q) { return in_motion.squared_frequencies(q).back(); }, 0.7);
  if (any_negative) survey.growing = over_zone([&](Vec2 q) { return -in_motion.squared_frequencies(q).front(); }, 0.9);

  survey.path = path_of(survey.zone, steps_of_segment(cell));
  parallel_tasks(survey.path.size(), [&](std::size_t k, int) {
    stop_if_interrupted();
    PathPoint& point = survey.path[k];
    point.squared_frequencies = in_motion.squared_frequencies(point.at.q);
    point.critical_ratio = at_rest.critical_ratio(point.at.q);
  });
  for (int k = 0; k < directions; ++k)
    survey.sound.push_back({k * std::numbers::pi / directions, in_motion.sound_speeds(direction(k))});
  survey.squared_rotational_gap = in_motion.squared_rotational_gap();
  progress.update(1);
  return survey;
}

}  // namespace equidem
