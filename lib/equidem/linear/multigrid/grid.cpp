// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/grid.hpp"

#include <algorithm>
#include <cmath>

namespace equidem::multigrid {
namespace {

/// Cell and coordinate along one axis, in spacings.
struct Coordinate {
  int cell;
  double inside;
};

Coordinate locate(const GridAxis& axis, double x) {
  double u = (x - axis.low) / axis.spacing;
  if (axis.periodic) u -= axis.cells * std::floor(u / axis.cells);
  const int cell = std::clamp(static_cast<int>(std::floor(u)), 0, axis.cells - 1);
  return {cell, u - cell};
}

/// The cell `step` cells on, or -1 beyond a free side.
int neighbour(const GridAxis& axis, int cell, int step) {
  const int other = cell + step;
  if (axis.periodic) return (other + axis.cells) % axis.cells;
  return other < axis.cells ? other : -1;
}

GridAxis halved(GridAxis axis) {
  axis.cells /= 2;
  axis.spacing *= 2;
  return axis;
}

double distance_from_cell(double s) {
  return std::max({0.0, -s, s - 1});
}

}  // namespace

GridAxis divide(double low, double extent, double spacing, bool periodic) {
  constexpr double least = 0.25;  // of a spacing: less is one line of discs
  if (!periodic && extent < least * spacing) return {low, spacing, 1, false};
  const double wanted = extent / spacing;
  const int halvings = wanted < 16 ? 0 : static_cast<int>(std::floor(std::log2(wanted / 8)));
  const double coarsest = std::max(1.0, std::round(std::ldexp(wanted, -halvings)));
  const int cells = static_cast<int>(coarsest) << halvings;
  return {low, extent / cells, cells, periodic};
}

Grid::Grid(GridAxis x, GridAxis y)
    : x_(x),
      y_(y),
      kept_(static_cast<std::size_t>(x.nodes()) * static_cast<std::size_t>(y.nodes()), 0),
      full_(cells(), 0) {}

Grid Grid::coarser() const {
  return {halved(x_), halved(y_)};
}

bool Grid::divisible() const {
  const auto axis_is = [](const GridAxis& axis) { return axis.cells % 2 == 0 && axis.cells >= 16; };
  return axis_is(x_) && axis_is(y_);
}

void Grid::keep_nodes(std::span<const double> mass) {
  constexpr double enough = 0.15;  // of the median; a node at the corner of a rectangle has a quarter
  std::vector<double> positive;
  for (const double m : mass) {
    if (m > 0) positive.push_back(m);
  }
  if (positive.empty()) return;
  const auto middle = positive.begin() + static_cast<std::ptrdiff_t>(positive.size() / 2);
  std::nth_element(positive.begin(), middle, positive.end());
  for (std::size_t node = 0; node < kept_.size(); ++node) kept_[node] = mass[node] > enough * *middle ? 1 : 0;
  for (std::size_t cell = 0; cell < full_.size(); ++cell) {
    const auto nodes = nodes_of(cell);
    full_[cell] = std::all_of(nodes.begin(), nodes.end(), [&](std::size_t node) { return kept(node); }) ? 1 : 0;
  }
}

std::vector<std::int32_t> Grid::cell_order() const {
  const GridAxis& along = wide() ? x_ : y_;
  const int width = wide() ? y_.cells : x_.cells;
  std::vector<std::int32_t> order;
  order.reserve(cells());
  for (int k = 0; k < along.cells; ++k) {
    const int from_end = along.cells - 1 - k / 2;
    const int line = !along.periodic ? k : k % 2 == 0 ? k / 2 : from_end;
    for (int across = 0; across < width; ++across) {
      order.push_back(wide() ? line + x_.cells * across : across + x_.cells * line);
    }
  }
  return order;
}

std::array<std::size_t, 4> Grid::nodes_of(std::size_t cell) const {
  const std::size_t columns = x_.nodes(), rows = y_.nodes();
  const std::size_t x = cell % x_.cells, y = cell / x_.cells;
  const std::size_t right = (x + 1) % columns, above = (y + 1) % rows;
  return {y * columns + x, y * columns + right, above * columns + x, above * columns + right};
}

Vec2 Grid::position(std::size_t node) const {
  const std::size_t columns = x_.nodes();
  return {x_.low + x_.spacing * static_cast<double>(node % columns),
          y_.low + y_.spacing * static_cast<double>(node / columns)};
}

Place Grid::place(Vec2 point) const {
  const Coordinate x = locate(x_, point.x), y = locate(y_, point.y);
  return {x.cell + x_.cells * y.cell, x.inside, y.inside};
}

Place Grid::place_in(std::int32_t cell, Vec2 point) const {
  const auto inside = [](const GridAxis& axis, double x, int position) {
    const double s = (x - axis.low) / axis.spacing - position;
    return axis.periodic ? s - axis.cells * std::round((s - 0.5) / axis.cells) : s;
  };
  return {cell, inside(x_, point.x, cell % x_.cells), inside(y_, point.y, cell / x_.cells)};
}

Place Grid::host(const Place& place) const {
  if (full(place.cell)) return place;
  constexpr double farthest = 1;  // spacings by which functions are continued
  Place best = place;
  double least = 2 * farthest;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int x = neighbour(x_, place.cell % x_.cells, dx), y = neighbour(y_, place.cell / x_.cells, dy);
      if (x < 0 || y < 0) continue;
      const Place other{x + x_.cells * y, place.s - dx, place.t - dy};
      const double s = distance_from_cell(other.s), t = distance_from_cell(other.t);
      if (std::max(s, t) > farthest || !(s + t < least) || !full(other.cell)) continue;
      least = s + t;
      best = other;
    }
  }
  return best;
}

Shape Grid::shape(const Place& place) const {
  const bool complete = full(place.cell);
  constexpr double margin = 0.02;  // leaves every kept node of the cell a part
  const double s = complete ? place.s : std::clamp(place.s, margin, 1 - margin);
  const double t = complete ? place.t : std::clamp(place.t, margin, 1 - margin);
  Shape shape;
  shape.weight = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
  const double factor = complete ? 0.5 : 1;
  for (int k = 0; k < 4; ++k) {
    shape.arm[k] = factor * Vec2{x_.spacing * (place.s - k % 2), y_.spacing * (place.t - k / 2)};
  }
  if (complete) return shape;
  const auto nodes = nodes_of(place.cell);
  double sum = 0;
  for (int k = 0; k < 4; ++k) sum += shape.weight[k] *= kept(nodes[k]) ? 1 : 0;
  for (int k = 0; sum > 0 && k < 4; ++k) shape.weight[k] /= sum;
  return shape;
}

Grid grid_over(const GridRegion& region, double spacing) {
  const Vec2 low = (1 / region.unit) * region.low, extent = (1 / region.unit) * (region.high - region.low);
  const double h =
      std::max({spacing * region.distance / region.unit, std::sqrt(extent.x) * std::sqrt(extent.y / region.discs),
                extent.x / region.discs, extent.y / region.discs});
  return {divide(low.x, extent.x, h, region.periodic), divide(low.y, extent.y, h, region.periodic)};
}

Buckets sort_into_buckets(std::span<const std::int32_t> bucket_of_item, std::size_t buckets) {
  Buckets result{std::vector<std::int32_t>(buckets + 1, 0), std::vector<std::int32_t>(bucket_of_item.size())};
  for (const std::int32_t bucket : bucket_of_item) ++result.first[bucket + 1];
  for (std::size_t k = 0; k < buckets; ++k) result.first[k + 1] += result.first[k];
  std::vector<std::int32_t> next(result.first.begin(), result.first.end() - 1);
  for (std::size_t item = 0; item < bucket_of_item.size(); ++item) {
    result.items[next[bucket_of_item[item]]++] = static_cast<std::int32_t>(item);
  }
  return result;
}

}  // namespace equidem::multigrid
