// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/wall_loads.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/text.hpp"
#include "equidem/output/files/energies.hpp"

namespace equidem {
namespace {

struct WallColumn {
  const char* name;
  bool per_depth;  ///< of discs
  bool summed;     ///< since the start, of colliding bodies alone
  double (*value)(const WallState&);
};

constexpr WallColumn wall_quantities[] = {
    {"x_m", false, false, [](const WallState& w) { return w.place.x; }},
    {"y_m", false, false, [](const WallState& w) { return w.place.y; }},
    {"vx_m_per_s", false, false, [](const WallState& w) { return w.velocity.x; }},
    {"vy_m_per_s", false, false, [](const WallState& w) { return w.velocity.y; }},
    {"force_x_N", true, false, [](const WallState& w) { return w.force.x; }},
    {"force_y_N", true, false, [](const WallState& w) { return w.force.y; }},
    {"moment_N_m", true, false, [](const WallState& w) { return w.moment; }},
    {"impulse_x_N_s", true, true, [](const WallState& w) { return w.impulse.x; }},
    {"impulse_y_N_s", true, true, [](const WallState& w) { return w.impulse.y; }},
    {"work_J", true, true, [](const WallState& w) { return w.work; }},
};

bool is_written(const WallColumn& column, BodyFamily family) {
  return family == BodyFamily::colliding || !column.summed;
}

}  // namespace

std::vector<std::string> wall_columns(std::span<const std::string> names, BodyFamily family, Body body) {
  std::vector<std::string> columns;
  for (const std::string& name : names)
    for (const WallColumn& column : wall_quantities)
      if (is_written(column, family))
        columns.push_back(fmt::format("wall_{}_{}{}", name, column.name, column.per_depth ? per_depth(body) : ""));
  return columns;
}

std::vector<double> wall_cells(std::span<const std::string> names, BodyFamily family,
                               std::span<const WallState> walls) {
  std::vector<double> cells;
  for (const std::string& name : names) {
    const auto found = std::ranges::find(walls, name, &WallState::name);
    for (const WallColumn& column : wall_quantities)
      if (is_written(column, family)) cells.push_back(found == walls.end() ? NAN : column.value(*found));
  }
  return cells;
}

Results wall_results(std::span<const WallState> walls, BodyFamily family, Body body) {
  const bool disc = body == Body::disc, summed = family == BodyFamily::colliding;
  const char *force = disc ? "N/m" : "N", *moment = disc ? "N" : "N m", *impulse = disc ? "N s/m" : "N s",
             *work = disc ? "J/m" : "J";
  std::vector<Results> rows;
  for (const WallState& wall : walls) {
    Results& row = rows.emplace_back();
    row.add("name", "wall", wall.name)
        .set("place", wall.place, "m", "place of a wall")
        .set("force", wall.force, force, "force of the bodies on a wall, mean over the last step")
        .set("moment", wall.moment, moment, "moment of this force about the place of the wall");
    row.add("", fmt::format("force x, {}", force), wall.force.x).add("", "force y", wall.force.y);
    row.add("", fmt::format("moment, {}", moment), wall.moment);
    row.add("", "at x, m", wall.place.x).add("", "at y", wall.place.y);
    if (!summed) continue;
    row.set("impulse", wall.impulse, impulse, "impulse of the bodies on a wall since the start")
        .set("work", wall.work, work, "work of a wall since the start")
        .add("", fmt::format("work, {}", work), wall.work);
  }
  Results out;
  if (rows.empty()) return out.set("forces_on_walls", std::move(rows));
  out.line("walls", fmt::format("forces on them in the last step, moments about their places{}:",
                                summed ? ", works since the start" : ""));
  return out.table("forces_on_walls", std::move(rows));
}

}  // namespace equidem
