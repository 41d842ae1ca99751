// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/geometry/shape_contact.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <limits>
#include <vector>

namespace equidem {

namespace {

/// The affine map that makes `outer` the unit circle turns the inner ellipse into {c + A w, |w| <= 1}. It lies in the
/// circle when max |c + A w|² <= 1; by duality the maximum is the minimum over l >= mu_1 of |c|² + l + sum (A^T
/// c)_k²/(l - mu_k), in the eigenbasis of A^T A, mu_1 >= mu_2 its eigenvalues: a convex function of l.
bool lies_in(const Ellipse& inner, const Ellipse& outer, Vec2 branch) {
  const auto mapped = [&](Vec2 x) { return Vec2{dot(outer.axis, x) / outer.a, cross(outer.axis, x) / outer.b}; };
  const Vec2 c = mapped(branch);
  const double offset = dot(c, c);
  if (!(offset <= 1)) return false;
  const Vec2 first = inner.a * mapped(inner.axis), second = inner.b * mapped(perpendicular(inner.axis));
  const double xx = dot(first, first), yy = dot(second, second), xy = dot(first, second);
  const double middle = (xx + yy) / 2, half = std::hypot((xx - yy) / 2, xy);
  const double mu_1 = middle + half, mu_2 = middle - half;
  if (mu_1 > 1) return false;
  const double turn = std::atan2(xy, (xx - yy) / 2) / 2, b_x = dot(first, c), b_y = dot(second, c);
  const double b_1 = std::cos(turn) * b_x + std::sin(turn) * b_y, b_2 = std::cos(turn) * b_y - std::sin(turn) * b_x;
  double low = mu_1 + std::abs(b_1), high = mu_1 + std::hypot(b_1, b_2);  // the derivative changes sign between them
  const auto share = [](double b, double gap) { return gap > 0 ? b / gap : 0.0; };
  for (int k = 0; k < 60; ++k) {
    const double l = (low + high) / 2, s_1 = share(b_1, l - mu_1), s_2 = share(b_2, l - mu_2);
    (s_1 * s_1 + s_2 * s_2 > 1 ? low : high) = l;
  }
  return offset + high + b_1 * share(b_1, high - mu_1) + b_2 * share(b_2, high - mu_2) <= 1;
}

}  // namespace

bool nested(const Ellipse& i, const Ellipse& j, Vec2 branch) {
  return lies_in(i, j, -branch) || lies_in(j, i, branch);
}

namespace {

/// f with its derivative and the support functions in one direction.
struct Sample {
  Vec2 n;
  EllipseSupport i, j;
  double gap = 0;    ///< f
  double slope = 0;  ///< f'

  [[nodiscard]] double bend() const { return gap + (i.radius + j.radius); }  ///< -f''
  /// The gradient of branch . x - h_i(x) - h_j(x) at n. That function of the plane is concave and homogeneous: gradient
  /// . x bounds it.
  [[nodiscard]] Vec2 gradient() const { return gap * n + slope * perpendicular(n); }
  /// Newton's step for f' = 0, its tangent: towards the centre of the circle of curvature of the Minkowski sum.
  [[nodiscard]] Vec2 newton() const {
    const double turn = slope / bend(), square = turn * turn;
    if (bend() > 0 && square < 1e-6) return (1 - square * (0.5 - 0.375 * square)) * (n + turn * perpendicular(n));
    const Vec2 towards = bend() * n + slope * perpendicular(n);
    return towards / norm(towards);
  }
};

struct Pair {
  const Ellipse& i;
  const Ellipse& j;
  Vec2 branch;
  double near;  ///< angle_of_arrival

  Pair(const Ellipse& first, const Ellipse& second, Vec2 between)
      : i(first), j(second), branch(between), near(angle_of_arrival(first, second)) {}

  /// Inlined, or the numbers would go through memory: a third of the time.
  [[nodiscard, gnu::always_inline]] Sample at(Vec2 n) const {
    Sample s{n, support(i, n), support(j, n)};
    s.gap = dot(branch, n) - (s.i.reach + s.j.reach);
    s.slope = dot(branch, perpendicular(n)) - (s.i.slope + s.j.slope);
    return s;
  }
  [[nodiscard]] bool arrived(const Sample& s) const { return std::abs(s.slope) < near * s.bend(); }
  /// The maximum of f where the sample has arrived at one, else f.
  [[nodiscard]] double top(const Sample& s) const {
    return arrived(s) ? s.gap + s.slope * s.slope / (2 * s.bend()) : s.gap;
  }
  /// A maximum above minus the sum of the sharpest radii is the highest.
  [[nodiscard]] bool is_highest(double maximum) const {
    return maximum > 0 || -maximum < roundness(i) * i.b + roundness(j) * j.b;
  }
};

/// Direction of a vector; along x for the zero vector.
Vec2 direction(Vec2 v) {
  const double length = norm(v);
  return length > 0 ? v / length : Vec2{1, 0};
}

/// Normal, at the place where the branch leaves it, of an ellipse much like the Minkowski sum.
Vec2 first_guess(const Ellipse& i, const Ellipse& j, Vec2 branch) {
  const auto across = [branch](const Ellipse& e) {  // det P P^-1 branch, P = a^2 u u + b^2 v v
    const double p = dot(e.axis, branch), q = cross(e.axis, branch);
    return e.b * e.b * p * e.axis + e.a * e.a * q * perpendicular(e.axis);
  };
  return direction(across(i) + across(j));
}

/// Directions from left counter-clockwise to right, at most a quarter of a turn.
struct Arc {
  Sample left, right;
  Vec2 chord;           ///< the direction in which both gradients give the same bound
  double bound = 0;     ///< f is not above it
  bool climbs = false;  ///< f is concave with its maximum within
};

/// Both support functions are convex and homogeneous: within an arc of width w they are at most their larger value at
/// the ends over cos(w/2), radii of curvature at least the smaller times cos³, and f at least the lower over cos where
/// that is negative.
bool is_concave(const Sample& left, const Sample& right) {
  const double cosine = std::sqrt((1 + dot(left.n, right.n)) / 2);
  const double least_radius = std::min(left.i.radius, right.i.radius) + std::min(left.j.radius, right.j.radius);
  return std::min({left.gap, right.gap, 0.0}) + least_radius * cosine * cosine * cosine * cosine > 0;
}

Arc arc_between(const Pair& pair, const Sample& left, const Sample& right) {
  Arc arc{left, right, {}};
  const Vec2 middle = left.n + right.n, from_left = left.gradient(), from_right = right.gradient();
  arc.chord = perpendicular(from_right - from_left);
  const double length = norm(arc.chord), side = dot(arc.chord, middle);
  arc.chord = length > 0 && side != 0 ? arc.chord / std::copysign(length, side) : middle / norm(middle);
  const bool rises = left.slope > 0 && !pair.arrived(left), falls = right.slope < 0 && !pair.arrived(right);
  const bool concave = is_concave(left, right);
  if (concave && !(rises && falls)) {
    arc.bound = std::max(pair.top(left), pair.top(right));
  } else {
    const double bound = dot(from_left, arc.chord);
    arc.bound = bound > 0 ? std::min(norm(from_left), norm(from_right)) : std::max({left.gap, right.gap, bound});
    arc.climbs = concave;
  }
  return arc;
}

/// Whether n lies strictly between the ends.
bool within(const Arc& arc, Vec2 n) {
  return cross(arc.left.n, n) > 0 && cross(n, arc.right.n) > 0;
}

/// The highest maximum: arcs are divided where they may still hold something higher. As h is even, it lies within a
/// quarter of a turn from the branch.
[[gnu::noinline]] Sample highest(const Pair& pair, Sample best, WhenApart when_apart) {
  constexpr std::size_t most_arcs = 128;
  const double resolution =
      2 * std::numeric_limits<double>::epsilon() * (best.i.reach + best.j.reach + norm(pair.branch));
  std::vector<Arc> arcs;
  arcs.reserve(16);
  const auto look = [&](Vec2 n) {
    const Sample sample = pair.at(n);
    if (pair.top(sample) > pair.top(best)) best = sample;
    return sample;
  };
  const Vec2 along = direction(pair.branch);
  const Sample first = look(-perpendicular(along)), middle = look(along), last = look(perpendicular(along));
  arcs.push_back(arc_between(pair, first, middle));
  arcs.push_back(arc_between(pair, middle, last));
  while (arcs.size() < most_arcs) {
    if (best.gap > 0 && when_apart == WhenApart::only_that_it_is) break;
    if (pair.arrived(best) && pair.is_highest(best.gap)) break;
    const auto top =
        std::max_element(arcs.begin(), arcs.end(), [](const Arc& x, const Arc& y) { return x.bound < y.bound; });
    const Arc arc = *top;
    if (!(arc.bound > pair.top(best) + resolution)) break;
    Vec2 n = arc.chord;
    if (arc.climbs) {
      const Vec2 newton = (arc.left.gap > arc.right.gap ? arc.left : arc.right).newton();
      if (within(arc, newton)) n = newton;
    }
    if (!within(arc, n)) n = (arc.left.n + arc.right.n) / norm(arc.left.n + arc.right.n);
    if (!within(arc, n)) break;
    const Sample sample = look(n);
    *top = arc_between(pair, arc.left, sample);
    arcs.push_back(arc_between(pair, sample, arc.right));
  }
  for (int step = 0; step < 4 && !pair.arrived(best) && best.bend() > 0; ++step) {
    const Sample next = pair.at(best.newton());
    if (!(std::abs(next.slope) < std::abs(best.slope) && next.gap > best.gap - resolution)) break;
    best = next;
  }
  return best;
}

EllipseState state_of(const Pair& pair, double gap) {
  if (gap > 0) return EllipseState::apart;
  if (pair.branch == Vec2{}) return EllipseState::concentric;
  // One in the other lies deeper than twice its smallest half-axis.
  const bool deep = -gap >= 2 * std::min(pair.i.b, pair.j.b);
  return deep && nested(pair.i, pair.j, pair.branch) ? EllipseState::nested : EllipseState::touching;
}

/// The point that reaches farthest along n turned by an angle, to its second order.
inline Vec2 support_point_beside(const EllipseSupport& s, Vec2 n, double turn) {
  return support_point(s, n) +
         turn * ((s.radius + turn / 2 * s.radius_slope) * perpendicular(n) - turn / 2 * s.radius * n);
}

/// In the maximum that has been arrived at, where f' - bend t - (R_i' + R_j') t^2/2 = 0; in the sample itself where
/// none has.
inline EllipseContact contact_at(const Pair& pair, const Sample& s) {
  double gap = s.gap, turn = 0;
  if (pair.arrived(s)) {
    const double first = s.slope / s.bend();
    gap += first * s.slope / 2;
    turn = first - first * first * (s.i.radius_slope + s.j.radius_slope) / (2 * s.bend());
  }
  return {state_of(pair, gap), gap, (1 - turn * turn / 2) * s.n + turn * perpendicular(s.n),
          support_point_beside(s.i, s.n, turn), -support_point_beside(s.j, s.n, turn)};
}

}  // namespace

double angle_of_arrival(const Ellipse& i, const Ellipse& j) {
  return 2e-5 * roundness(i) * roundness(j);
}

EllipseContact contact_of_ellipses(const Ellipse& i, const Ellipse& j, Vec2 branch, Vec2 last_normal,
                                   WhenApart when_apart) {
  assert(i.a >= i.b && i.b >= 0 && j.a >= j.b && j.b >= 0 && i.a + j.a > 0);
  constexpr int most_steps = 8;
  const Pair pair(i, j, branch);
  // Newton's method where it is certain to converge to the highest maximum in few steps, else a search.
  if (!(dot(last_normal, branch) > 0)) last_normal = first_guess(i, j, branch);
  Sample sample =
      pair.at((1.5 - dot(last_normal, last_normal) / 2) * last_normal);  // or its round-off adds up over the steps
  for (int step = 0;; ++step) {
    if (sample.gap > 0 && when_apart == WhenApart::only_that_it_is) {
      return {EllipseState::apart, sample.gap, sample.n, {}, {}};
    }
    const bool arrived = pair.arrived(sample);
    if (arrived && pair.is_highest(sample.gap)) break;
    if (arrived || step == most_steps || !(sample.bend() > 0)) {
      sample = highest(pair, sample, when_apart);
      break;
    }
    sample = pair.at(sample.newton());
  }
  return contact_at(pair, sample);
}

EllipseContact contact_with_line(const Ellipse& i, Vec2 to_line, Vec2 normal) {
  const Vec2 n = -normal;
  const EllipseSupport s = support(i, n);
  const double gap = dot(to_line, n) - s.reach;
  const Vec2 arm = support_point(s, n);
  return {gap > 0 ? EllipseState::apart : EllipseState::touching, gap, n, arm, arm + gap * n - to_line};
}

EllipseContact contact_with_segment(const Ellipse& i, Vec2 to_start, Vec2 to_end, Vec2 last_normal) {
  const Vec2 middle = (to_start + to_end) / 2, half = (to_end - to_start) / 2;
  const double half_length = norm(half);
  assert(half_length > 0);
  const Ellipse segment{half_length, 0, half / half_length};
  const Vec2 across = perpendicular(segment.axis);
  EllipseContact side = contact_with_line(i, middle, dot(middle, across) > 0 ? -across : across);
  if (std::abs(dot(side.arm_j, segment.axis)) > half_length) {
    return contact_of_ellipses(i, segment, middle, last_normal);
  }
  // A corner of f, and a maximum.
  side.state = state_of(Pair(i, segment, middle), side.gap);
  if (Pair(i, segment, middle).is_highest(side.gap)) return side;
  const EllipseContact other = contact_of_ellipses(i, segment, middle, side.normal);
  return other.gap > side.gap + 1e-14 * (i.a + half_length) ? other : side;
}

MappedEllipse mapped_ellipse(const Ellipse& i, const Ellipse& j, Vec2 branch) {
  assert(i.b > 0 && j.b > 0);
  const double c = dot(i.axis, j.axis), s = cross(j.axis, i.axis);  // of theta_i - theta_j
  const double n_x = j.a * c, n_y = -j.a * s, p_x = j.b * s, p_y = j.b * c;
  const double o_x = dot(i.axis, branch), o_y = cross(i.axis, branch);
  const double x = 1 / (i.a * i.a), y = 1 / (i.b * i.b);
  const double A = n_x * n_x * x + n_y * n_y * y, B = p_x * p_x * x + p_y * p_y * y;
  const double D = 2 * (n_x * p_x * x + n_y * p_y * y), E = 2 * (o_x * n_x * x + o_y * n_y * y);
  const double F = 2 * (p_x * o_x * x + p_y * o_y * y), G = o_x * o_x * x + o_y * o_y * y - 1;

  MappedEllipse image;
  const double determinant = D * D - 4 * A * B;
  image.h = (F * D - 2 * E * B) / determinant;
  image.k = (E * D - 2 * A * F) / determinant;
  const double K =
      A * image.h * image.h + B * image.k * image.k + D * image.h * image.k - E * image.h - F * image.k + G;
  image.theta = std::atan2(D, B - A) / 2;
  const double cosine = std::cos(image.theta), sine = std::sin(image.theta);
  image.a = std::sqrt(-K / (A * cosine * cosine + B * sine * sine - D * sine * cosine));
  image.b = std::sqrt(-K / (A * sine * sine + B * cosine * cosine + D * sine * cosine));
  return image;
}

EnlargedEllipseContact enlarged_ellipse_contact(const Ellipse& i, const Ellipse& j, Vec2 branch) {
  const MappedEllipse image = mapped_ellipse(i, j, branch);
  const Vec2 along = {std::cos(image.theta), -std::sin(image.theta)}, across = perpendicular(along);
  const Vec2 centre = {-image.h, -image.k};
  const double cos_a = -dot(centre, along) / (image.a + 1), sin_b = -dot(centre, across) / (image.b + 1);
  const auto back = [&](Vec2 x) { return x.x * j.a * j.axis + x.y * j.b * perpendicular(j.axis) + branch; };

  EnlargedEllipseContact contact;
  contact.judgement = cos_a * cos_a + sin_b * sin_b - 1;
  contact.point = back(-(cos_a * along + sin_b * across));
  const double phi = std::atan2(sin_b, cos_a);  // (4.44)-(4.45), in every quadrant
  contact.surface_point = back(image.a * std::cos(phi) * along + image.b * std::sin(phi) * across + centre);
  const double p = dot(i.axis, contact.surface_point), q = cross(i.axis, contact.surface_point);
  const Vec2 outward = i.b * i.b * p * i.axis + i.a * i.a * q * perpendicular(i.axis);
  contact.angle = std::atan2(-outward.x, outward.y);  // (4.49), outwards of ellipse i
  contact.normal = {-std::sin(contact.angle), std::cos(contact.angle)};
  return contact;
}

}  // namespace equidem
