// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/power_cells.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "equidem/assembly/dual_cells.hpp"
#include "equidem/assembly/least_rectangle.hpp"
#include "equidem/assembly/sites.hpp"
#include "equidem/assembly/strips.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

PowerCells periodic_cells(const Assembly& assembly) {
  Sites sites(assembly);
  Strips strips(sites);
  for (;;) {
    const std::vector<TriangulationEdge> edges = strips.edges();
    if (!edges.empty()) {
      if (auto dual = cells_between(sites, edges, strips, {}, assembly.size())) {
        dual->cells.collinear = false;
        return std::move(dual->cells);
      }
    }
    if (strips.count() == 1) sites.widen();
    strips.join();
  }
}

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

/// The cells at the sides of a rectangle, counter-clockwise from its lower side; each runs along x or y of the
/// rectangle. Along each side, the power diagram of the plane is that of the points of the side, which is found afresh
/// from the candidates. Adds the part of each area that lies between centre and side, half of distance times length.
/// \param candidates discs of which cells may reach a side, ascending
std::array<SideCells, 4> side_cells(const Assembly& assembly, std::span<const std::int32_t> candidates,
                                    const TurnedRectangle& domain, std::vector<double>& areas) {
  const auto side = [&](double length, const auto& along, const auto& distance) {
    std::vector<Parabola> parabolas;
    parabolas.reserve(candidates.size());
    for (const std::int32_t disc : candidates) {
      const Vec2 from_low = domain.seen(assembly.centres[disc] - domain.low);
      const Vec2 to_high = domain.seen(domain.high - assembly.centres[disc]);
      const double r = assembly.radii[disc], d = distance(from_low, to_high);
      parabolas.push_back({.disc = disc, .along = along(from_low), .distance = d, .excess = d * d - r * r});
    }
    return cells_along(std::move(parabolas), 0, length, areas);
  };
  const auto x = [](Vec2 from_low) { return from_low.x; };
  const auto y = [](Vec2 from_low) { return from_low.y; };
  const Vec2 size = domain.size();
  return {side(size.x, x, [](Vec2 from_low, Vec2) { return from_low.y; }),
          side(size.y, y, [](Vec2, Vec2 to_high) { return to_high.x; }),
          side(size.x, x, [](Vec2, Vec2 to_high) { return to_high.y; }),
          side(size.y, y, [](Vec2 from_low, Vec2) { return from_low.x; })};
}

/// The groups left, right, bottom, top and bottom_left, ...
std::map<std::string, DiscGroup> groups_of(std::array<SideCells, 4> cells) {
  auto& [bottom, right, top, left] = cells;
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

/// The discs of which cells may reach a side, ascending: the power of a place of the side is at least the excess of a
/// disc, and in a stretch of the side at most that of any disc above it plus the length of the stretch squared.
std::vector<std::int32_t> discs_near_sides(const Assembly& assembly, const TurnedRectangle& domain) {
  const std::size_t count = assembly.size();
  const auto stretches = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  std::vector<std::uint8_t> near(count, 0);
  const auto look = [&](double side, const auto& along, const auto& distance) {
    const double length = side / static_cast<double>(stretches);
    const auto excess = [&](std::size_t disc) {
      const double d = distance(assembly.centres[disc]), r = assembly.radii[disc];
      return d * d - r * r;
    };
    std::vector<double> least(stretches, infinity);
    for (std::size_t disc = 0; disc < count; ++disc) {
      const double stretch = std::floor(along(assembly.centres[disc]) / length);
      double& lowest = least[static_cast<std::size_t>(std::clamp(stretch, 0.0, static_cast<double>(stretches - 1)))];
      lowest = std::min(lowest, excess(disc));
    }
    const double most = *std::max_element(least.begin(), least.end()) + 2 * length * length;
    for (std::size_t disc = 0; disc < count; ++disc) near[disc] |= excess(disc) <= most ? 1 : 0;
  };
  const auto x = [&](Vec2 p) { return domain.seen(p - domain.low).x; };
  const auto y = [&](Vec2 p) { return domain.seen(p - domain.low).y; };
  const Vec2 size = domain.size();
  look(size.x, x, y);
  look(size.x, x, [&](Vec2 p) { return domain.seen(domain.high - p).y; });
  look(size.y, y, x);
  look(size.y, y, [&](Vec2 p) { return domain.seen(domain.high - p).x; });
  std::vector<std::int32_t> discs;
  for (std::size_t disc = 0; disc < count; ++disc) {
    if (near[disc] != 0) discs.push_back(static_cast<std::int32_t>(disc));
  }
  return discs;
}

std::array<SideCells, 4> sides_alone(const Assembly& assembly, const TurnedRectangle& domain) {
  std::vector<double> areas(assembly.size(), 0.0);  // unused: their parts at the sides alone
  return side_cells(assembly, discs_near_sides(assembly, domain), domain, areas);
}

/// The rectangle of which the sides are the groups left, right, bottom and top.
Rectangle upright_region(const Assembly& assembly) {
  if (assembly.box && assembly.box->upright()) return *assembly.box;
  return upright_rectangle(assembly.centres, assembly.radii);
}

/// Adds the sides. A cell that takes a stretch of a side has a facet that the side cuts, unless it is the only one.
/// \param outermost discs with such a facet
void add_sides(const Assembly& assembly, const TurnedRectangle& domain, std::vector<std::int32_t> outermost,
               PowerCells& cells) {
  std::sort(outermost.begin(), outermost.end());
  outermost.erase(std::unique(outermost.begin(), outermost.end()), outermost.end());
  if (outermost.empty()) {
    for (std::size_t disc = 0; disc < assembly.size(); ++disc) outermost.push_back(static_cast<std::int32_t>(disc));
  }
  std::array<SideCells, 4> sides = side_cells(assembly, outermost, domain, cells.areas);
  cells.sides = groups_of(domain.upright() ? std::move(sides) : sides_alone(assembly, upright_region(assembly)));
}

PowerCells free_cells(const Assembly& assembly, const TurnedRectangle& domain) {
  stop_if_interrupted();
  check_inside(assembly, domain);
  const Sites sites(assembly);
  Strips strips(sites);
  std::optional<DualCells> dual;
  while (!dual) {
    dual = cells_between(sites, strips.edges(), strips, domain, assembly.size());
    strips.join();
  }
  PowerCells cells = std::move(dual->cells);
  add_sides(assembly, domain, std::move(dual->cut), cells);
  const double filled = std::accumulate(cells.areas.begin(), cells.areas.end(), 0.0), area = domain.area();
  constexpr double close = 1e-9;
  if (!(std::abs(filled - area) <= close * area)) {
    computation_failed(
        fmt::format("the cells of the discs have {:.6g} m² of the {:.6g} m² of their region", filled, area),
        "centres that nearly coincide, or lie far from each other, leave no digits for the corners of their cells",
        "Look for discs in one place, or far from the others");
  }
  return cells;
}

}  // namespace

TurnedRectangle region_of_cells(const Assembly& assembly) {
  return assembly.box ? *assembly.box : least_rectangle(assembly.centres, assembly.radii);
}

void check_inside(const Assembly& assembly, const TurnedRectangle& region) {
  constexpr double epsilon = 8 * std::numeric_limits<double>::epsilon();
  const auto& [low, high] = static_cast<const Rectangle&>(region);
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    const Vec2 x = assembly.centres[d], from_low = region.seen(x - low), to_high = region.seen(high - x);
    const double rounding = region.upright() ? 0 : epsilon * (norm(x) + norm(low) + norm(high));
    if (std::min({from_low.x, from_low.y, to_high.x, to_high.y}) >= -rounding) continue;
    const std::string turned =
        region.upright() ? "" : fmt::format(" with a side along ({:g}, {:g})", region.along.x, region.along.y);
    bad_input(
        fmt::format("the centre of disc {}, ({:g}, {:g}) m, lies outside the box from ({:g}, {:g}) to ({:g}, {:g}) m{}",
                    d, x.x, x.y, low.x, low.y, high.x, high.y, turned),
        "the cells of all discs fill the box", "Correct the box, or remove it");
  }
}

PowerCells power_cells(const Assembly& assembly, const std::optional<TurnedRectangle>& domain) {
  assert(assembly.size() > 0 && assembly.radii.size() == assembly.size());
  PowerCells cells = assembly.periodic() ? periodic_cells(assembly)
                                         : free_cells(assembly, domain ? *domain : region_of_cells(assembly));
  // Rounding may make the area of an empty cell slightly negative.
  for (double& area : cells.areas) area = std::max(area, 0.0);
  return cells;
}

StripCells strip_cells(const Assembly& assembly, const Rectangle& domain, const StripShare& share) {
  Sites sites(assembly);
  Strips strips(sites);
  strips.choose(share.strip, share.count, domain);
  std::optional<TurnedRectangle> clipped;
  if (!assembly.periodic()) clipped = domain;
  std::optional<DualCells> dual;
  for (;;) {
    const std::vector<TriangulationEdge> edges = strips.edges();
    dual = cells_between(sites, edges, strips, clipped, assembly.size());
    const bool nothing_found = assembly.periodic() && edges.empty();
    if (!share.any(!dual || nothing_found)) break;
    if (strips.count() == 1 && assembly.periodic()) sites.widen();
    strips.join();
  }
  StripCells result{.cells = std::move(dual->cells), .strips = {}, .contacts = std::move(dual->contacts)};
  for (std::size_t disc = 0; disc < assembly.size(); ++disc)
    result.strips.push_back(static_cast<std::int32_t>(strips.strip_of_disc(static_cast<std::int32_t>(disc))));
  result.cells.collinear = !share.any(!result.cells.collinear) && !assembly.periodic();
  if (!assembly.periodic()) add_sides(assembly, domain, share.joined(dual->cut), result.cells);
  for (double& area : result.cells.areas) area = std::max(area, 0.0);
  return result;
}

std::map<std::string, DiscGroup> measured_sides(const Assembly& assembly) {
  assert(!assembly.periodic() && assembly.size() > 0);
  return groups_of(sides_alone(assembly, upright_region(assembly)));
}

std::array<RegionSide, 4> region_sides(const Assembly& assembly) {
  assert(!assembly.periodic() && assembly.size() > 0);
  const TurnedRectangle region = region_of_cells(assembly);
  auto [bottom, right, top, left] = sides_alone(assembly, region);
  const Vec2 along = region.along, across = perpendicular(along);
  return {{{-across, std::move(bottom.group)},
           {along, std::move(right.group)},
           {across, std::move(top.group)},
           {-along, std::move(left.group)}}};
}

}  // namespace equidem
