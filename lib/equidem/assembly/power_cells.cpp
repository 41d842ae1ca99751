// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/power_cells.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "equidem/assembly/sites.hpp"
#include "equidem/assembly/strips.hpp"
#include "equidem/assembly/triangulation.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Facets shorter than this share of the distance of the centres are round-off.
constexpr double smallest_facet = 1e-9;

/// The line of equal power of two sites a and b, at `lever` from a along the normal n from a to b, and the stretch of
/// it from `low` to `high`, along s = (-n_y, n_x), on which no third site has less power.
struct Facet {
  double distance = 0;
  double lever = 0;
  double low = 0;
  double high = 0;
  bool cut = false;     ///< it ends at the rectangle
  bool certain = true;  ///< no image beyond those present can take part of it

  [[nodiscard]] double length() const { return std::max(0.0, high - low); }
};

class DualGeometry {
 public:
  DualGeometry(const Sites& sites, const Strips& strips, const std::optional<Rectangle>& domain)
      : sites_(sites), strips_(strips), domain_(domain) {}

  [[nodiscard]] Facet facet(const TriangulationEdge& edge) const {
    const Vec2 l = sites_.branch(edge.a, edge.b);
    const double wa = sites_.weight(edge.a);
    const double wb = sites_.weight(edge.b);
    Facet facet;
    facet.distance = norm(l);
    facet.lever = 0.5 * (facet.distance + (wa - wb) / facet.distance);
    facet.high = edge.left < 0 ? infinity : radical_centre(edge, edge.left, l, facet.distance);
    facet.low = edge.right < 0 ? -infinity : radical_centre(edge, edge.right, l, facet.distance);
    if (domain_) clip(facet, edge.a, l);
    if (!domain_ || (strips_.count() > 1 && facet.length() > 0))
      facet.certain = certain(facet, facet.high, edge.a, l) && certain(facet, facet.low, edge.a, l);
    return facet;
  }

 private:
  /// The place on the line of a and b, along s, at which the power of the site c is the same too. With u = b - a, v = c
  /// - a, w = c
  /// - b: t = |u| (v.w + (w_a - w_c) - (w_a - w_b) u.v/|u|²) / (2 u x v), for equal weights |u|/2 times the cotangent
  /// of the angle at c. The product u x v is taken of the two shorter sides, where it loses least.
  [[nodiscard]] double radical_centre(const TriangulationEdge& edge, std::int32_t c, Vec2 u, double length) const {
    const Vec2 v = sites_.branch(edge.a, c);
    const Vec2 w = sites_.branch(edge.b, c);
    const double uu = dot(u, u);
    const double vv = dot(v, v);
    const double ww = dot(w, w);
    const double twice_area = uu >= vv && uu >= ww ? cross(v, w) : vv >= ww ? cross(u, w) : cross(u, v);
    double numerator = dot(v, w);
    if (sites_.weighted()) {
      const double wa = sites_.weight(edge.a);
      numerator += (wa - sites_.weight(c)) - (wa - sites_.weight(edge.b)) * dot(u, v) / uu;
    }
    return length * numerator / (2 * twice_area);
  }

  /// Cut the facet at the sides of the rectangle.
  void clip(Facet& facet, std::int32_t a, Vec2 l) const {
    const Vec2 n = l / facet.distance;
    const Vec2 s = perpendicular(n);
    const Vec2 foot = sites_.position(a) + facet.lever * n;
    const double low = facet.low;
    const double high = facet.high;
    const auto slab = [&](double from, double along, double lowest, double highest) {
      if (along == 0) {
        if (from < lowest || from > highest) facet.high = -infinity;
        return;
      }
      const double t0 = (lowest - from) / along;
      const double t1 = (highest - from) / along;
      facet.low = std::max(facet.low, std::min(t0, t1));
      facet.high = std::min(facet.high, std::max(t0, t1));
    };
    slab(foot.x, s.x, domain_->low.x, domain_->high.x);
    slab(foot.y, s.y, domain_->low.y, domain_->high.y);
    facet.cut = facet.low != low || facet.high != high;
  }

  /// Whether no site that was left out can have less power at the end t of the facet than a has, beyond the images or
  /// beyond the strip of a: its distance from there is at least `clear`, its weight at most the largest.
  [[nodiscard]] bool certain(const Facet& facet, double t, std::int32_t a, Vec2 l) const {
    if (!std::isfinite(t)) return false;
    const Vec2 n = l / facet.distance;
    const Vec2 offset = facet.lever * n + t * perpendicular(n);
    const Vec2 end = sites_.position(a) + offset;
    double clear = strips_.known(a, end);
    if (!domain_) {
      const Rectangle region = sites_.region();
      clear =
          std::min({clear, end.x - region.low.x, region.high.x - end.x, end.y - region.low.y, region.high.y - end.y});
    }
    const double power = dot(offset, offset) - sites_.weight(a);
    return clear > 0 && clear * clear > (1 + 1e-9) * (power + sites_.largest_weight());
  }

  const Sites& sites_;
  const Strips& strips_;
  const std::optional<Rectangle>& domain_;
};

/// Cells of the edges of a triangulation, without sides.
struct DualCells {
  PowerCells cells;
  std::vector<std::int32_t> cut;  ///< discs with a facet that the rectangle cuts, some of them repeated
};

/// Neighbours, facets, and the part of the areas that lies between centres and facets: half of lever times length on
/// either side, the lever negative where the facet lies behind the centre. None where a facet is not certain.
std::optional<DualCells> cells_between(const Sites& sites, std::span<const TriangulationEdge> edges,
                                       const DualGeometry& geometry, std::size_t discs) {
  constexpr std::size_t at_once = 1 << 18, grain = 8192;
  DualCells dual;
  PowerCells& cells = dual.cells;
  cells.areas.assign(discs, 0);
  cells.neighbours.reserve(edges.size());
  cells.facet_lengths.reserve(edges.size());
  std::vector<Facet> facets(std::min(edges.size(), at_once));
  for (std::size_t first = 0; first < edges.size(); first += at_once) {
    const std::span<const TriangulationEdge> some = edges.subspan(first, std::min(at_once, edges.size() - first));
    parallel_ranges(some.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) facets[k] = geometry.facet(some[k]);
    });
    for (std::size_t k = 0; k < some.size(); ++k) {
      const Facet& facet = facets[k];
      if (!facet.certain) return {};
      if (facet.cut) dual.cut.insert(dual.cut.end(), {some[k].a, some[k].b});
      if (!sites.in_cell(some[k].a)) continue;
      const Contact contact = sites.contact(some[k].a, some[k].b);
      const double length = facet.length();
      cells.areas[contact.i] += 0.5 * facet.lever * length;
      cells.areas[contact.j] += 0.5 * (facet.distance - facet.lever) * length;
      if (length <= smallest_facet * facet.distance) continue;
      cells.neighbours.push_back(contact);
      cells.neighbours.back().lever_i = std::clamp(facet.lever, 0.0, facet.distance);
      cells.neighbours.back().lever_j = std::clamp(facet.distance - facet.lever, 0.0, facet.distance);
      cells.facet_lengths.push_back(length);
    }
  }
  cells.collinear =
      std::all_of(edges.begin(), edges.end(), [](const TriangulationEdge& e) { return e.left < 0 && e.right < 0; });
  return dual;
}

PowerCells periodic_cells(const Assembly& assembly) {
  Sites sites(assembly);
  Strips strips(sites);
  for (;;) {
    const std::vector<TriangulationEdge> edges = strips.edges();
    if (!edges.empty()) {
      if (auto dual = cells_between(sites, edges, DualGeometry(sites, strips, {}), assembly.size())) {
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

/// The groups left, right, bottom, top and bottom_left, ... of a free assembly in `domain`: along each side, the
/// power diagram of the plane is that of the points of the side, which is found afresh from the candidates. Adds the
/// part of each area that lies between centre and side, half of distance times length.
/// \param candidates discs of which cells may reach a side, ascending
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

/// The discs of which cells may reach a side, ascending: the power of a place of the side is at least the excess of a
/// disc, and in a stretch of the side at most that of any disc above it plus the length of the stretch squared.
std::vector<std::int32_t> discs_near_sides(const Assembly& assembly, const Rectangle& domain) {
  const std::size_t count = assembly.size();
  const auto stretches = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  std::vector<std::uint8_t> near(count, 0);
  const auto look = [&](double low, double high, const auto& along, const auto& distance) {
    const double length = (high - low) / static_cast<double>(stretches);
    const auto excess = [&](std::size_t disc) {
      const double d = distance(assembly.centres[disc]), r = assembly.radii[disc];
      return d * d - r * r;
    };
    std::vector<double> least(stretches, infinity);
    for (std::size_t disc = 0; disc < count; ++disc) {
      const double stretch = std::floor((along(assembly.centres[disc]) - low) / length);
      double& lowest = least[static_cast<std::size_t>(std::clamp(stretch, 0.0, static_cast<double>(stretches - 1)))];
      lowest = std::min(lowest, excess(disc));
    }
    const double most = *std::max_element(least.begin(), least.end()) + 2 * length * length;
    for (std::size_t disc = 0; disc < count; ++disc) near[disc] |= excess(disc) <= most ? 1 : 0;
  };
  const Vec2 low = domain.low, high = domain.high;
  const auto x = [](Vec2 p) { return p.x; };
  const auto y = [](Vec2 p) { return p.y; };
  look(low.x, high.x, x, [&](Vec2 p) { return p.y - low.y; });
  look(low.x, high.x, x, [&](Vec2 p) { return high.y - p.y; });
  look(low.y, high.y, y, [&](Vec2 p) { return p.x - low.x; });
  look(low.y, high.y, y, [&](Vec2 p) { return high.x - p.x; });
  std::vector<std::int32_t> discs;
  for (std::size_t disc = 0; disc < count; ++disc) {
    if (near[disc] != 0) discs.push_back(static_cast<std::int32_t>(disc));
  }
  return discs;
}

PowerCells free_cells(const Assembly& assembly, const Rectangle& domain) {
  const Sites sites(assembly);
  Strips strips(sites);
  std::optional<DualCells> dual;
  while (!dual) {
    dual = cells_between(sites, strips.edges(), DualGeometry(sites, strips, domain), assembly.size());
    strips.join();
  }
  PowerCells cells = std::move(dual->cells);
  // A cell that takes a stretch of a side has a facet that the side cuts, unless it is the only one.
  std::vector<std::int32_t>& outermost = dual->cut;
  std::sort(outermost.begin(), outermost.end());
  outermost.erase(std::unique(outermost.begin(), outermost.end()), outermost.end());
  if (outermost.empty()) {
    for (std::size_t disc = 0; disc < assembly.size(); ++disc) outermost.push_back(static_cast<std::int32_t>(disc));
  }
  cells.sides = side_cells(assembly, outermost, domain, cells.areas);
  return cells;
}

/// The box of the assembly, else the smallest rectangle that holds all discs.
Rectangle region_of_cells(const Assembly& assembly) {
  if (assembly.box) return *assembly.box;
  Rectangle box{.low = {infinity, infinity}, .high = {-infinity, -infinity}};
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    const Vec2 x = assembly.centres[disc];
    const double r = assembly.radii[disc];
    box.low = {std::min(box.low.x, x.x - r), std::min(box.low.y, x.y - r)};
    box.high = {std::max(box.high.x, x.x + r), std::max(box.high.y, x.y + r)};
  }
  return box;
}

}  // namespace

PowerCells power_cells(const Assembly& assembly, const std::optional<Rectangle>& domain) {
  assert(assembly.size() > 0 && assembly.radii.size() == assembly.size());
  PowerCells cells = assembly.periodic() ? periodic_cells(assembly)
                                         : free_cells(assembly, domain ? *domain : region_of_cells(assembly));
  // Rounding may make the area of an empty cell slightly negative.
  for (double& area : cells.areas) area = std::max(area, 0.0);
  return cells;
}

std::map<std::string, DiscGroup> measured_sides(const Assembly& assembly) {
  assert(!assembly.periodic() && assembly.size() > 0);
  const Rectangle domain = region_of_cells(assembly);
  std::vector<double> areas(assembly.size(), 0.0);  // unused: their parts at the sides alone
  return side_cells(assembly, discs_near_sides(assembly, domain), domain, areas);
}

}  // namespace equidem
