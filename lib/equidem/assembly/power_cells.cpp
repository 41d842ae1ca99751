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
#include "equidem/assembly/triangulation.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Facets shorter than this share of the distance of the centres are round-off.
constexpr double smallest_facet = 1e-9;

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

/// Edges in an order that does not depend on the triangulation: by a, then the disc of b, then its shift.
std::vector<TriangulationEdge> sorted(std::span<const TriangulationEdge> edges, const Sites& sites) {
  const std::size_t count = sites.positions().size();
  std::vector<std::size_t> first(count + 1, 0);
  for (const TriangulationEdge& edge : edges) ++first[static_cast<std::size_t>(edge.a) + 1];
  for (std::size_t a = 0; a < count; ++a) first[a + 1] += first[a];
  std::vector<TriangulationEdge> result(edges.size());
  std::vector<std::size_t> place(first.begin(), first.end() - 1);
  for (const TriangulationEdge& edge : edges) result[place[edge.a]++] = edge;
  for (std::size_t a = 0; a < count; ++a) {
    std::sort(result.begin() + static_cast<std::ptrdiff_t>(first[a]),
              result.begin() + static_cast<std::ptrdiff_t>(first[a + 1]), [&](const auto& p, const auto& q) {
                const Image x = sites.image(p.b);
                const Image y = sites.image(q.b);
                return std::tie(x.disc, x.shift_x, x.shift_y) < std::tie(y.disc, y.shift_x, y.shift_y);
              });
  }
  return result;
}

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
  DualGeometry(const Sites& sites, const std::optional<Rectangle>& domain) : sites_(sites), domain_(domain) {}

  [[nodiscard]] Facet facet(const TriangulationEdge& edge) const {
    const Vec2 l = sites_.branch(edge.a, edge.b);
    const double wa = sites_.weight(edge.a);
    const double wb = sites_.weight(edge.b);
    Facet facet;
    facet.distance = norm(l);
    facet.lever = 0.5 * (facet.distance + (wa - wb) / facet.distance);
    facet.high = edge.left < 0 ? infinity : radical_centre(edge, edge.left, l, facet.distance);
    facet.low = edge.right < 0 ? -infinity : radical_centre(edge, edge.right, l, facet.distance);
    if (domain_) {
      clip(facet, edge.a, l);
    } else {
      facet.certain = certain(facet, facet.high, edge.a, l) && certain(facet, facet.low, edge.a, l);
    }
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

  /// Whether no site outside the region of images can have less power at the end t of the facet than a has: its
  /// distance from there is at least `clear`, its weight at most the largest.
  [[nodiscard]] bool certain(const Facet& facet, double t, std::int32_t a, Vec2 l) const {
    if (!std::isfinite(t)) return false;
    const Vec2 n = l / facet.distance;
    const Vec2 offset = facet.lever * n + t * perpendicular(n);
    const Vec2 end = sites_.position(a) + offset;
    const Rectangle region = sites_.region();
    const double clear =
        std::min({end.x - region.low.x, region.high.x - end.x, end.y - region.low.y, region.high.y - end.y});
    const double power = dot(offset, offset) - sites_.weight(a);
    return clear > 0 && clear * clear > (1 + 1e-9) * (power + sites_.largest_weight());
  }

  const Sites& sites_;
  const std::optional<Rectangle>& domain_;
};

/// The edges that end at a disc of the cell itself, named as contacts are.
std::vector<TriangulationEdge> edges_of_cell(const Sites& sites) {
  std::vector<TriangulationEdge> edges =
      triangulation_edges(sites.positions(), sites.weights(), sites.insertion_order());
  if (sites.images() > 0) {
    std::erase_if(edges,
                  [&](const TriangulationEdge& edge) { return !sites.in_cell(edge.a) && !sites.in_cell(edge.b); });
  }
  parallel_ranges(edges.size(), 65536, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) orient(edges[k], sites);
  });
  return sorted(edges, sites);
}

std::vector<Facet> facets_of(std::span<const TriangulationEdge> edges, const DualGeometry& geometry) {
  std::vector<Facet> facets(edges.size());
  parallel_ranges(edges.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) facets[k] = geometry.facet(edges[k]);
  });
  return facets;
}

/// Neighbours, facets, and the part of the areas that lies between centres and facets: half of lever times length on
/// either side, the lever negative where the facet lies behind the centre.
PowerCells cells_between(const Sites& sites, std::span<const TriangulationEdge> edges, std::span<const Facet> facets,
                         std::size_t discs) {
  PowerCells cells;
  cells.areas.assign(discs, 0);
  cells.neighbours.reserve(edges.size());
  cells.facet_lengths.reserve(edges.size());
  for (std::size_t k = 0; k < edges.size(); ++k) {
    if (!sites.in_cell(edges[k].a)) continue;
    const Contact contact = sites.contact(edges[k].a, edges[k].b);
    const Facet& facet = facets[k];
    const double length = facet.length();
    cells.areas[contact.i] += 0.5 * facet.lever * length;
    cells.areas[contact.j] += 0.5 * (facet.distance - facet.lever) * length;
    if (length <= smallest_facet * facet.distance) continue;
    cells.neighbours.push_back(contact);
    cells.neighbours.back().lever_i = std::clamp(facet.lever, 0.0, facet.distance);
    cells.neighbours.back().lever_j = std::clamp(facet.distance - facet.lever, 0.0, facet.distance);
    cells.facet_lengths.push_back(length);
  }
  return cells;
}

PowerCells periodic_cells(const Assembly& assembly) {
  Sites sites(assembly);
  for (;;) {
    const std::vector<TriangulationEdge> edges = edges_of_cell(sites);
    const std::vector<Facet> facets = facets_of(edges, DualGeometry(sites, {}));
    const bool certain = std::all_of(facets.begin(), facets.end(), [](const Facet& f) { return f.certain; });
    if (certain && !edges.empty()) return cells_between(sites, edges, facets, assembly.size());
    sites.widen();
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

PowerCells free_cells(const Assembly& assembly, const Rectangle& domain) {
  const Sites sites(assembly);
  const std::vector<TriangulationEdge> edges = edges_of_cell(sites);
  const std::vector<Facet> facets = facets_of(edges, DualGeometry(sites, domain));
  PowerCells cells = cells_between(sites, edges, facets, assembly.size());
  cells.collinear =
      std::all_of(edges.begin(), edges.end(), [](const TriangulationEdge& e) { return e.left < 0 && e.right < 0; });
  // A cell that takes a stretch of a side has a facet that the side cuts, unless it is the only one.
  std::vector<std::int32_t> outermost;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    if (facets[k].cut) outermost.insert(outermost.end(), {edges[k].a, edges[k].b});
  }
  std::sort(outermost.begin(), outermost.end());
  outermost.erase(std::unique(outermost.begin(), outermost.end()), outermost.end());
  if (outermost.empty()) {
    for (std::size_t disc = 0; disc < assembly.size(); ++disc) outermost.push_back(static_cast<std::int32_t>(disc));
  }
  cells.sides = side_cells(assembly, outermost, domain, cells.areas);
  return cells;
}

}  // namespace

namespace {

/// The smallest that holds all discs.
Rectangle bounding_rectangle(const Assembly& assembly) {
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
                     : domain            ? free_cells(assembly, *domain)
                              : free_cells(assembly, assembly.box ? *assembly.box : bounding_rectangle(assembly));
  // Rounding may make the area of an empty cell slightly negative.
  for (double& area : cells.areas) area = std::max(area, 0.0);
  return cells;
}

}  // namespace equidem
