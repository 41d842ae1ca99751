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

  /// Negative by round-off alone. The sum of all areas needs the sign: ends of facets that meet in a point cancel
  /// there, wherever round-off puts it.
  [[nodiscard]] double stretch() const { return high - low; }
  [[nodiscard]] double length() const { return std::max(0.0, stretch()); }
};

class DualGeometry {
 public:
  DualGeometry(const Sites& sites, const Strips& strips, const std::optional<TurnedRectangle>& domain)
      : sites_(sites), strips_(strips), domain_(domain) {}

  [[nodiscard]] Facet facet(const TriangulationEdge& edge) const {
    const Vec2 l = sites_.branch(edge.a, edge.b);
    const double wa = sites_.weight(edge.a);
    const double wb = sites_.weight(edge.b);
    Facet facet;
    facet.distance = norm(l);
    facet.lever = 0.5 * (facet.distance + (wa - wb) / facet.distance);
    const Vec2 s = perpendicular(l / facet.distance);
    facet.high = edge.left < 0 ? unbounded : dot(radical_centre(edge.a, edge.b, edge.left), s);
    facet.low = edge.right < 0 ? -unbounded : dot(radical_centre(edge.b, edge.a, edge.right), s);
    if (domain_) clip(facet, edge.a, l);
    if (!domain_ || (strips_.count() > 1 && facet.length() > 0))
      facet.certain = certain(facet, facet.high, edge.a, l) && certain(facet, facet.low, edge.a, l);
    return facet;
  }

 private:
  /// The place of equal power of the corners of a counter-clockwise triangle, from its first corner. All three edges
  /// take it from the same corner p, opposite to the longest side, where the product u x v of the sides loses least: x
  /// u = (u² + w_p - w_q)/2 and x v likewise. Corners in a row up to round-off have it beyond all rectangles, on the
  /// side that the triangulation has found by exact arithmetic.
  [[nodiscard]] Vec2 radical_centre(std::int32_t a, std::int32_t b, std::int32_t c) const {
    const Vec2 ab = sites_.branch(a, b), bc = sites_.branch(b, c), ca = sites_.branch(c, a);
    const double at_a = squared(bc), at_b = squared(ca), at_c = squared(ab);  // of the sides opposite to the corners
    const auto before = [](double x, std::int32_t i, double y, std::int32_t j) { return x > y || (x == y && i < j); };
    if (before(at_a, a, at_b, b) && before(at_a, a, at_c, c)) return radical_centre(a, b, c, ab, -ca);
    if (before(at_b, b, at_c, c)) return ab + radical_centre(b, c, a, bc, -ab);
    return radical_centre(c, a, b, ca, -bc) - ca;
  }
  /// Centre of equal power of three discs, from p, with the branches u and v from there to q and r.
  [[nodiscard]] Vec2 radical_centre(std::int32_t p, std::int32_t q, std::int32_t r, Vec2 u, Vec2 v) const {
    const double wp = sites_.weight(p), uu = squared(u), vv = squared(v);
    const double to_q = 0.5 * (uu + (wp - sites_.weight(q))), to_r = 0.5 * (vv + (wp - sites_.weight(r)));
    constexpr double straight = 1e-20;
    return perpendicular(to_r * u - to_q * v) / std::max(cross(u, v), straight * (uu + vv));
  }

  /// Cut the facet at the sides of the rectangle.
  void clip(Facet& facet, std::int32_t a, Vec2 l) const {
    const Vec2 n = l / facet.distance;
    const Vec2 foot = domain_->seen(sites_.position(a) - domain_->low + facet.lever * n);
    const Vec2 along = domain_->seen(perpendicular(n)), size = domain_->size();
    double first = -unbounded, last = unbounded;
    const auto slab = [&](double from, double way, double width) {
      if (way == 0) {
        if (from < 0 || from > width) last = -unbounded;
        return;
      }
      first = std::max(first, std::min(-from / way, (width - from) / way));
      last = std::min(last, std::max(-from / way, (width - from) / way));
    };
    slab(foot.x, along.x, size.x);
    slab(foot.y, along.y, size.y);
    facet.cut = facet.low < first || facet.high > last;
    if (!(first < last)) first = last = 0;
    facet.low = std::clamp(facet.low, first, last);
    facet.high = std::clamp(facet.high, first, last);
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
  const std::optional<TurnedRectangle>& domain_;
};

}  // namespace

std::optional<DualCells> cells_between(const Sites& sites, std::span<const TriangulationEdge> edges,
                                       const Strips& strips, const std::optional<TurnedRectangle>& domain,
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
      const double area_a = 0.5 * facet.lever * facet.stretch();
      const double area_b = 0.5 * (facet.distance - facet.lever) * facet.stretch();
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
