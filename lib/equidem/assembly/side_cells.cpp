// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/side_cells.hpp"

#include <algorithm>
#include <utility>

namespace equidem {
namespace {

/// A disc seen from a side: the power of the place u of the side is (u - along)² + excess.
struct Parabola {
  std::int32_t disc = 0;
  double along = 0;     ///< m
  double distance = 0;  ///< m, of the centre from the side
  double excess = 0;    ///< m², distance² - radius²
};

/// Abscissa at which two parabolas cross; before it the one with the lesser `along` is the lower.
double crossing(const Parabola& p, const Parabola& q) {
  return 0.5 * (p.along + q.along) + (q.excess - p.excess) / (2 * (q.along - p.along));
}

/// The parabolas that are the lowest somewhere, from left to right.
std::vector<Parabola> lower_envelope(std::vector<Parabola> parabolas) {
  std::sort(parabolas.begin(), parabolas.end(), [](const Parabola& p, const Parabola& q) {
    if (p.along != q.along) return p.along < q.along;
    return p.excess != q.excess ? p.excess < q.excess : p.disc < q.disc;
  });
  std::vector<Parabola> envelope;
  for (const Parabola& p : parabolas) {
    if (!envelope.empty() && envelope.back().along == p.along) continue;
    while (envelope.size() > 1 &&
           crossing(envelope[envelope.size() - 2], envelope.back()) >= crossing(envelope.back(), p)) {
      envelope.pop_back();
    }
    envelope.push_back(p);
  }
  return envelope;
}

struct SideCells {
  DiscGroup group;
  std::int32_t first = 0;  ///< disc at the lower end of the side
  std::int32_t last = 0;
};

SideCells cells_along(std::vector<Parabola> parabolas, double low, double high, std::vector<double>& areas) {
  /// Stretches below this share of the distance from a centre to its mirror image are rounding.
  constexpr double smallest_stretch = 1e-9;
  const std::vector<Parabola> envelope = lower_envelope(std::move(parabolas));
  std::vector<std::pair<std::int32_t, double>> stretches;
  double begin = low;
  for (std::size_t k = 0; k < envelope.size(); ++k) {
    const double end = k + 1 < envelope.size() ? std::clamp(crossing(envelope[k], envelope[k + 1]), low, high) : high;
    const double length = end - begin;
    begin = end;
    areas[envelope[k].disc] += 0.5 * envelope[k].distance * length;
    if (length > 2 * smallest_stretch * envelope[k].distance) stretches.emplace_back(envelope[k].disc, length);
  }
  SideCells side;
  if (stretches.empty()) return side;
  side.first = stretches.front().first;
  side.last = stretches.back().first;
  std::sort(stretches.begin(), stretches.end());
  for (const auto& [disc, length] : stretches) {
    side.group.discs.push_back(disc);
    side.group.tributary_lengths.push_back(length);
  }
  return side;
}

}  // namespace

std::map<std::string, DiscGroup> side_cells(const Assembly& assembly, std::span<const std::int32_t> candidates,
                                            const Rectangle& domain, std::vector<double>& areas) {
  const auto seen = [&](const auto& along, const auto& distance) {
    std::vector<Parabola> parabolas;
    parabolas.reserve(candidates.size());
    for (const std::int32_t disc : candidates) {
      const Vec2 x = assembly.centres[disc];
      const double r = assembly.radii[disc];
      const double d = distance(x);
      parabolas.push_back({.disc = disc, .along = along(x), .distance = d, .excess = d * d - r * r});
    }
    return parabolas;
  };
  const auto x = [](Vec2 p) { return p.x; };
  const auto y = [](Vec2 p) { return p.y; };
  const Vec2 low = domain.low;
  const Vec2 high = domain.high;
  SideCells bottom = cells_along(seen(x, [&](Vec2 p) { return p.y - low.y; }), low.x, high.x, areas);
  SideCells top = cells_along(seen(x, [&](Vec2 p) { return high.y - p.y; }), low.x, high.x, areas);
  SideCells left = cells_along(seen(y, [&](Vec2 p) { return p.x - low.x; }), low.y, high.y, areas);
  SideCells right = cells_along(seen(y, [&](Vec2 p) { return high.x - p.x; }), low.y, high.y, areas);
  std::map<std::string, DiscGroup> sides;
  sides["bottom_left"].discs = {bottom.first};
  sides["bottom_right"].discs = {bottom.last};
  sides["top_left"].discs = {top.first};
  sides["top_right"].discs = {top.last};
  sides["bottom"] = std::move(bottom.group);
  sides["top"] = std::move(top.group);
  sides["left"] = std::move(left.group);
  sides["right"] = std::move(right.group);
  return sides;
}

}  // namespace equidem
