// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/strips.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

/// Width and margin of a strip in mean spacings. Twice the radius of the largest empty circle between 10⁷ independent
/// points is 5; a margin of 6 on either side costs 8 % of a strip.
constexpr double strip_width = 150, strip_margin = 6;

/// Name an edge from the end that a contact starts at: the lower disc, between images of one disc that with the
/// positive shift to the other.
void orient(TriangulationEdge& edge, const Sites& sites) {
  const Image a = sites.image(edge.a);
  const Image b = sites.image(edge.b);
  const bool forward = a.disc != b.disc         ? a.disc < b.disc
                       : a.shift_x != b.shift_x ? a.shift_x < b.shift_x
                                                : a.shift_y < b.shift_y;
  if (forward) return;
  std::swap(edge.a, edge.b);
  std::swap(edge.left, edge.right);
}

/// The edges of all strips by a, then the disc of b, then its shift. All edges of one a are in one strip.
std::vector<TriangulationEdge> sorted(std::vector<std::vector<TriangulationEdge>> strips, const Sites& sites) {
  const std::size_t count = sites.positions().size();
  std::vector<std::uint32_t> place(count + 1, 0);
  parallel_tasks(strips.size(), [&](std::size_t strip, int) {
    for (const TriangulationEdge& edge : strips[strip]) ++place[static_cast<std::size_t>(edge.a) + 1];
  });
  for (std::size_t a = 0; a < count; ++a) place[a + 1] += place[a];
  std::vector<TriangulationEdge> result(place[count]);
  parallel_tasks(strips.size(), [&](std::size_t strip, int) {
    for (const TriangulationEdge& edge : strips[strip]) result[place[static_cast<std::size_t>(edge.a)]++] = edge;
    strips[strip] = {};
  });
  // Now place[a] is the end of the edges of a.
  parallel_ranges(count, 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t a = begin; a < end; ++a) {
      const std::size_t first = a == 0 ? 0 : place[a - 1];
      const std::span<TriangulationEdge> of_a = std::span(result).subspan(first, place[a] - first);
      std::sort(of_a.begin(), of_a.end(), [&](const auto& p, const auto& q) {
        const Image x = sites.image(p.b);
        const Image y = sites.image(q.b);
        return std::tie(x.disc, x.shift_x, x.shift_y) < std::tie(y.disc, y.shift_x, y.shift_y);
      });
    }
  });
  return result;
}

}  // namespace

Strips::Strips(const Sites& sites) : sites_(sites) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec2 low = {infinity, infinity}, high = {-infinity, -infinity};
  for (const Vec2 x : sites.positions()) {
    low = {std::min(low.x, x.x), std::min(low.y, x.y)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y)};
  }
  const Vec2 extent = high - low;
  upright_ = extent.y > extent.x;
  low_ = along(low);
  const double longer = std::max(extent.x, extent.y), shorter = std::min(extent.x, extent.y);
  const double spacing = std::sqrt(longer * shorter / static_cast<double>(sites.positions().size()));
  margin_ = strip_margin * spacing;
  // No thinner than a strip of a square: a narrow sample is cut as seldom as a wide one of as many discs.
  const double count = std::sqrt(static_cast<double>(sites.positions().size())) / strip_width;
  if (spacing > 0 && std::isfinite(spacing)) count_ = static_cast<std::size_t>(std::max(count, 1.0));
  width_ = longer / static_cast<double>(count_);
}

void Strips::choose(std::size_t strip, std::size_t count, const Rectangle& region) {
  chosen_ = strip;
  count_ = count;
  const Vec2 extent = region.high - region.low;
  upright_ = extent.y > extent.x;
  low_ = along(region.low);
  width_ = std::max(extent.x, extent.y) / static_cast<double>(count);
}

std::size_t Strips::cut_of(Vec2 place) const {
  if (count_ == 1) return 0;
  return static_cast<std::size_t>(
      std::clamp(std::floor((along(place) - low_) / width_), 0.0, static_cast<double>(count_ - 1)));
}

double Strips::known(std::int32_t a, Vec2 place) const {
  double clear = std::numeric_limits<double>::infinity();
  if (count() == 1) return clear;
  const std::size_t strip = chosen_ ? *chosen_ : strip_of(sites_.position(a));
  if (strip > 0) clear = std::min(clear, along(place) - (cut(strip) - margin_));
  if (strip + 1 < count_) clear = std::min(clear, cut(strip + 1) + margin_ - along(place));
  return clear;
}

std::vector<std::vector<std::int32_t>> Strips::members() const {
  std::vector<std::vector<std::int32_t>> members(count_);
  for (const std::int32_t site : sites_.insertion_order()) {
    const double place = along(sites_.position(site));
    const std::size_t strip = strip_of(sites_.position(site));
    members[strip].push_back(site);
    for (std::size_t k = strip; k > 0 && place <= cut(k) + margin_; --k) members[k - 1].push_back(site);
    for (std::size_t k = strip + 1; k < count_ && place >= cut(k) - margin_; ++k) members[k].push_back(site);
  }
  return members;
}

std::vector<std::int32_t> Strips::members_of(std::size_t strip) const {
  std::vector<std::int32_t> members;
  for (const std::int32_t site : sites_.insertion_order()) {
    const double place = along(sites_.position(site));
    const bool above = strip == 0 || place >= cut(strip) - margin_;
    const bool below = strip + 1 == count_ || place <= cut(strip + 1) + margin_;
    if (above && below) members.push_back(site);
  }
  return members;
}

std::vector<TriangulationEdge> Strips::edges_of(std::size_t strip, std::vector<std::int32_t> members) const {
  std::vector<TriangulationEdge> edges = triangulation_edges(sites_.positions(), sites_.weights(), members);
  for (TriangulationEdge& edge : edges) orient(edge, sites_);
  if (sites_.images() > 0 || count_ > 1) {
    std::erase_if(edges, [&](const TriangulationEdge& edge) {
      if (chosen_) return !holds(edge.a) && !holds(edge.b);
      return (!sites_.in_cell(edge.a) && !sites_.in_cell(edge.b)) || strip_of(sites_.position(edge.a)) != strip;
    });
    edges.shrink_to_fit();
  }
  return edges;
}

std::vector<TriangulationEdge> Strips::edges() const {
  std::vector<std::vector<TriangulationEdge>> edges(chosen_ ? 1 : count());
  if (count() == 1) {
    edges[0] = edges_of(0, {sites_.insertion_order().begin(), sites_.insertion_order().end()});
  } else if (chosen_) {
    edges[0] = edges_of(*chosen_, members_of(*chosen_));
  } else {
    std::vector<std::vector<std::int32_t>> parts = members();
    parallel_tasks(count_, [&](std::size_t strip, int) { edges[strip] = edges_of(strip, std::move(parts[strip])); });
  }
  return sorted(std::move(edges), sites_);
}

}  // namespace equidem
