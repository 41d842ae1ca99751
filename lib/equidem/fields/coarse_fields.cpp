// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/fields/coarse_fields.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

std::optional<std::size_t> cell_at(const CoarseGrid& grid, Vec2 place) {
  const Vec2 size = grid.cell_size(), way = place - grid.region.low;
  const double column = std::floor(way.x / size.x), row = std::floor(way.y / size.y);
  if (!(column >= 0 && row >= 0 && column < static_cast<double>(grid.columns) && row < static_cast<double>(grid.rows)))
    return {};
  return static_cast<std::size_t>(row) * grid.columns + static_cast<std::size_t>(column);
}

/// Shares of a way at which it crosses the lines of the grid along one axis.
void add_crossings(double from, double way, double low, double width, std::size_t lines, std::vector<double>& shares) {
  if (way == 0) return;
  const double a = (std::min(from, from + way) - low) / width, b = (std::max(from, from + way) - low) / width;
  const double first = std::max(0.0, std::ceil(a)), last = std::min(static_cast<double>(lines), b);
  for (std::size_t n = 0; first + static_cast<double>(n) <= last; ++n) {
    const double k = first + static_cast<double>(n);
    const double share = (low + k * width - from) / way;
    if (share > 0 && share < 1) shares.push_back(share);
  }
}

}  // namespace

Rectangle CoarseGrid::cell(std::size_t k) const {
  const Vec2 size = cell_size();
  const std::size_t column = k % columns, row = k / columns;
  const Vec2 low = region.low + Vec2{size.x * static_cast<double>(column), size.y * static_cast<double>(row)};
  return {low, low + size};
}

CoarseGrid grid_over(const Rectangle& region, double width) {
  const Vec2 sides = region.high - region.low;
  if (!(sides.x > 0 && sides.y > 0))
    bad_input(fmt::format("the region of the fields is {} m wide and {} m high", sides.x, sides.y), "it has no area",
              "Give its lower left corner first");
  if (!(width > 0))
    bad_input(fmt::format("the cells of the fields are {} m wide", width), "they need a positive width", "Give one");
  constexpr double most = 1e6;
  if (!(sides.x / width * (sides.y / width) <= most))
    bad_input(fmt::format("cells of {} m in a region of {:.4g} m by {:.4g} m", width, sides.x, sides.y),
              "they would be more than a million", "Give a larger width, a few bodies wide");
  const auto count = [&](double side) { return static_cast<std::size_t>(std::max(1.0, std::round(side / width))); };
  return {region, count(sides.x), count(sides.y)};
}

CoarseFields coarse_fields(std::span<const Grain> grains, std::span<const Clump> clumps,
                           std::span<const BodyContact> contacts, const CoarseGrid& grid) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  CoarseFields fields{.grid = grid,
                      .stress = std::vector<Tensor2>(grid.size()),
                      .solid_fraction = std::vector<double>(grid.size(), 0.0),
                      .coordination = std::vector<double>(grid.size(), unknown),
                      .velocity = std::vector<Vec2>(grid.size(), {unknown, unknown})};
  if (grid.size() == 0) return fields;
  const Vec2 size = grid.cell_size();
  const double area = size.x * size.y;

  std::vector<double> held(grains.size(), 0.0), shares;
  for (const BodyContact& contact : contacts) {
    const auto i = static_cast<std::size_t>(contact.i);
    const Grain& grain = grains[i];
    held[i] += 1;
    Vec2 branch = contact.arm;
    if (contact.j >= 0) {
      const auto j = static_cast<std::size_t>(contact.j);
      held[j] += 1;
      branch = grains[j].position - grain.position;
    }
    shares = {0, 1};
    add_crossings(grain.position.x, branch.x, grid.region.low.x, size.x, grid.columns, shares);
    add_crossings(grain.position.y, branch.y, grid.region.low.y, size.y, grid.rows, shares);
    std::sort(shares.begin(), shares.end());
    for (std::size_t k = 0; k + 1 < shares.size(); ++k) {
      const auto cell = cell_at(grid, grain.position + 0.5 * (shares[k] + shares[k + 1]) * branch);
      if (cell) fields.stress[*cell] += ((shares[k + 1] - shares[k]) / area) * outer(contact.force, branch);
    }
  }

  std::vector<double> bodies(grid.size(), 0.0), masses(grid.size(), 0.0), ends(grid.size(), 0.0);
  std::vector<Vec2> momenta(grid.size());
  for (std::size_t g = 0; g < grains.size(); ++g) {
    const Grain& grain = grains[g];
    if (const auto cell = cell_at(grid, grain.position)) {
      bodies[*cell] += 1;
      ends[*cell] += held[g];
      masses[*cell] += grain.inertia.mass;
      momenta[*cell] += grain.inertia.mass * grain.velocity;
    }
    const auto span_of = [&](double centre, double low, double width, std::size_t count) {
      const auto last = static_cast<double>(count);
      return std::pair(
          static_cast<std::size_t>(std::clamp(std::floor((centre - grain.radius - low) / width), 0.0, last)),
          static_cast<std::size_t>(std::clamp(std::ceil((centre + grain.radius - low) / width), 0.0, last)));
    };
    const auto [left, right] = span_of(grain.position.x, grid.region.low.x, size.x, grid.columns);
    const auto [bottom, top] = span_of(grain.position.y, grid.region.low.y, size.y, grid.rows);
    for (std::size_t row = bottom; row < top; ++row)
      for (std::size_t column = left; column < right; ++column) {
        const std::size_t cell = row * grid.columns + column;
        fields.solid_fraction[cell] += clipped_area(grain, clumps, grid.cell(cell)) / area;
      }
  }
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (bodies[cell] == 0) continue;
    fields.coordination[cell] = ends[cell] / bodies[cell];
    fields.velocity[cell] = momenta[cell] / masses[cell];
  }
  return fields;
}

namespace {

/// The part of the way from a point that lies in a rectangle.
Vec2 part_inside(const Rectangle& region, Vec2 from, Vec2 way) {
  double first = 0, last = 1;
  const auto cut = [&](double start, double along, double low, double high) {
    if (along == 0) {
      if (start < low || start > high) last = first;
      return;
    }
    const double a = (low - start) / along, b = (high - start) / along;
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  };
  cut(from.x, way.x, region.low.x, region.high.x);
  cut(from.y, way.y, region.low.y, region.high.y);
  return std::max(0.0, last - first) * way;
}

}  // namespace

Tensor2 region_stress(const Rectangle& region, std::span<const std::int32_t> bodies, std::span<const DiscMotion> places,
                      std::span<const BodyContact> contacts) {
  std::vector<char> counts(places.size(), 0);
  for (const std::int32_t body : bodies) counts[static_cast<std::size_t>(body)] = 1;
  Tensor2 sum;
  for (const BodyContact& contact : contacts) {
    const Vec2 at_i = places[static_cast<std::size_t>(contact.i)].u;
    if (counts[static_cast<std::size_t>(contact.i)] != 0)
      sum += outer(contact.force, part_inside(region, at_i, contact.arm));
    if (contact.j < 0 || counts[static_cast<std::size_t>(contact.j)] == 0) continue;
    const Vec2 at_j = places[static_cast<std::size_t>(contact.j)].u;
    sum += outer(-contact.force, part_inside(region, at_j, at_i + contact.arm - contact.shift - at_j));
  }
  const Vec2 sides = region.high - region.low;
  return (1 / (sides.x * sides.y)) * sum;
}

}  // namespace equidem
