// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/wave_survey.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "equidem/core/stopwatch.hpp"
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
  if (cell.size() > 25) search.refine = 1;
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

/// Share of the zone: nearer to q = 0 round-off dominates modes of stiffness q², and the exact limit is used instead.
constexpr double nearest_to_gamma = 1e-3;

double critical_ratio_away_from_gamma(const BlochWaves& waves, const BrillouinZone& zone, Vec2 q) {
  const double distance = norm(zone.folded(q)) / norm(zone.reciprocal[0]);
  if (distance > 0 && distance < nearest_to_gamma) return std::numeric_limits<double>::quiet_NaN();
  return waves.critical_ratio(q);
}

/// Long waves are named where they are lost first, and where the climb came to them with nothing gained on the way.
void add_long_waves(const BlochWaves& waves, const BrillouinZone& zone, ZoneMaximum& critical) {
  const LongWaveLoss loss = waves.long_wave_loss();
  const double margin = 1e-9 * std::abs(critical.value) + 1e-12;
  const bool climbed_there =
      critical.at.name.empty() && norm(zone.folded(critical.at.q)) < 30 * nearest_to_gamma * norm(zone.reciprocal[0]);
  if (!(loss.ratio > critical.value + (climbed_there ? -margin : margin))) return;
  critical.value = loss.ratio;
  critical.points.clear();
  critical.at = {long_waves_name,
                 nearest_to_gamma * norm(zone.reciprocal[0]) * Vec2{std::cos(loss.angle), std::sin(loss.angle)}};
}

/// The cell with equal springs: its zero-energy modes follow from geometry alone.
PrimitiveCell with_unit_springs(PrimitiveCell cell) {
  for (CellContact& contact : cell.contacts) {
    contact.springs = {1, contact.springs.kT != 0 ? 1.0 : 0.0};
    if (contact.kM > 0) contact.kM = cell.rotation_scale * cell.rotation_scale;
  }
  return cell;
}

/// Wave vectors of the grid and the points of symmetry, less q = 0, of waves that stretch and slip nothing.
std::vector<Vec2> find_free_waves(const BlochWaves& waves, const BrillouinZone& zone, int grid) {
  std::vector<Vec2> all = zone_grid(zone, grid);
  for (const ZonePoint& point : zone.points) {
    if (std::none_of(all.begin(), all.end(), [&](Vec2 q) { return zone.equivalent(q, point.q); }))
      all.push_back(point.q);
  }
  std::vector<char> free(all.size(), 0);
  parallel_tasks(all.size(), [&](std::size_t k, int) {
    stop_if_interrupted();
    if (zone.equivalent(all[k], {})) return;
    const std::vector<double> energies = eigenvalues(waves.stiffness(all[k]));
    free[k] = !energies.empty() && energies.front() < 1e-12 * energies.back() ? 1 : 0;
  });
  std::vector<Vec2> found;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (free[k] != 0) found.push_back(zone.folded(all[k]));
  return found;
}

}  // namespace

std::size_t survey_size(const PrimitiveCell& cell) {
  const ZoneSearch search = search_of(cell);
  const BrillouinZone zone = brillouin_zone(cell.period);
  const auto n = static_cast<std::size_t>(search.grid);
  return 4 * (n * (n / 2 + 1) + zone.points.size() + 10 * search.refine) +
         2 * (zone.path.size() - 1) * static_cast<std::size_t>(steps_of_segment(cell));
}

WaveSurvey survey_waves(const PrimitiveCell& cell, const std::vector<Inertia>& inertia, Rotation rotation) {
  const bool turns = rotation != Rotation::restrained;
  const bool any_tangential =
      std::any_of(cell.contacts.begin(), cell.contacts.end(), [](const CellContact& c) { return c.springs.kT != 0; });
  const bool any_negative =
      std::any_of(cell.contacts.begin(), cell.contacts.end(), [](const CellContact& c) { return c.springs.kT < 0; });
  WaveSurvey survey;
  const bool on_lines = cell.on_lines_of_centres();
  const bool prestressed = cell.prestressed();
  survey.ratio_sought = on_lines && !cell.bends() && !prestressed;
  const bool turned_by_forces = std::any_of(cell.contacts.begin(), cell.contacts.end(), [](const CellContact& c) {
    return c.prestress && (turns_i(*c.prestress, c.frame) || turns_j(*c.prestress, c.frame));
  });
  const bool turned = turns && (any_tangential || !on_lines || turned_by_forces);
  const BlochWaves in_motion(cell, inertia, turned), at_rest(cell, inertia, turns);
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
  if (survey.ratio_sought) {
    survey.critical = over_zone([&](Vec2 q) { return critical_ratio_away_from_gamma(at_rest, survey.zone, q); }, 0.5);
    add_long_waves(at_rest, survey.zone, survey.critical);
  }
  survey.highest = over_zone([&](Vec2 q) { return in_motion.squared_frequencies(q).back(); }, 0.7);
  if (any_negative || prestressed)
    survey.growing = over_zone([&](Vec2 q) { return -in_motion.squared_frequencies(q).front(); }, 0.9);
  if (!prestressed)
    survey.free_waves = find_free_waves({with_unit_springs(cell), inertia, turned}, survey.zone, survey.grid);

  survey.path = path_of(survey.zone, steps_of_segment(cell));
  parallel_tasks(survey.path.size(), [&](std::size_t k, int) {
    stop_if_interrupted();
    PathPoint& point = survey.path[k];
    point.squared_frequencies = in_motion.squared_frequencies(point.at.q);
    point.critical_ratio =
        survey.ratio_sought ? at_rest.critical_ratio(point.at.q) : std::numeric_limits<double>::quiet_NaN();
  });
  for (int k = 0; k < directions; ++k)
    survey.sound.push_back({k * std::numbers::pi / directions, in_motion.sound_speeds(direction(k))});
  survey.squared_rotational_gap = in_motion.squared_rotational_gap();
  progress.update(1);
  return survey;
}

PlaneWaves plane_waves(const Matrix4& gradient_stiffness, double mass_per_area, Vec2 direction) {
  constexpr int row[2][2] = {{0, 2}, {3, 1}};  // of the component ij
  const Vec2 unit = direction / norm(direction);
  const double n[2] = {unit.x, unit.y};
  double a[2][2] = {};
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j < 2; ++j)
        for (int l = 0; l < 2; ++l) a[i][k] += n[j] * n[l] * gradient_stiffness[row[i][j]][row[k][l]] / mass_per_area;
  const double coupling = 0.5 * (a[0][1] + a[1][0]), middle = 0.5 * (a[0][0] + a[1][1]);
  const double half_difference = 0.5 * (a[0][0] - a[1][1]), radius = std::hypot(half_difference, coupling);
  // n . A n lies above the middle where the larger eigenvalue belongs to the wave along n.
  const Vec2 an{a[0][0] * unit.x + coupling * unit.y, coupling * unit.x + a[1][1] * unit.y};
  const double sign = dot(unit, an) >= middle ? 1 : -1;
  const double turned = 0.5 * std::atan2(coupling, half_difference) + (sign < 0 ? 0.5 * std::numbers::pi : 0);
  return {middle + sign * radius, middle - sign * radius, {std::cos(turned), std::sin(turned)}};
}

}  // namespace equidem
