// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/dual_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
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
    facet.high = edge.left < 0 ? unbounded : radical_centre(edge, edge.left, l, facet.distance);
    facet.low = edge.right < 0 ? -unbounded : radical_centre(edge, edge.right, l, facet.distance);
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
        if (from < lowest || from > highest) facet.high = -unbounded;
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

}  // namespace

std::optional<DualCells> cells_between(const Sites& sites, std::span<const TriangulationEdge> edges,
                                       const Strips& strips, const std::optional<Rectangle>& domain,
                                       std::size_t discs) {
  const DualGeometry geometry(sites, strips, domain);
  constexpr std::size_t at_once = 1 << 18, grain = 8192;
  DualCells dual;
  PowerCells& cells = dual.cells;
  cells.areas.assign(discs, 0);
  if (strips.chosen()) dual.contacts.assign(discs, 0);
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
      const double length = facet.length();
      const double area_a = 0.5 * facet.lever * length, area_b = 0.5 * (facet.distance - facet.lever) * length;
      const bool wide = length > smallest_facet * facet.distance;
      if (strips.chosen()) {
        if (strips.holds(some[k].b)) cells.areas[some[k].b] += area_b, dual.contacts[some[k].b] += wide ? 1 : 0;
        if (!strips.holds(some[k].a)) continue;
        cells.areas[some[k].a] += area_a, dual.contacts[some[k].a] += wide ? 1 : 0;
      } else if (!sites.in_cell(some[k].a)) {
        continue;
      }
      const Contact contact = sites.contact(some[k].a, some[k].b);
      if (!strips.chosen()) cells.areas[contact.i] += area_a, cells.areas[contact.j] += area_b;
      if (!wide) continue;
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

}  // namespace equidem
