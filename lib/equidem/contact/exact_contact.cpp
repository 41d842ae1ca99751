// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/exact_contact.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "equidem/core/error.hpp"

namespace equidem {

namespace {

/// g' from g' + 2 zeta g + g[1] = 1.
double slope_of(double zeta, const Response& r) {
  return 1 - r.g[1] - 2 * zeta * r.g[0];
}

/// For x (1 + 2 zeta) <= 1: power series of g[4] and g[5]; the others by g[k] = x^(k+1)/(k+1)! - 2 zeta g[k+1] -
/// g[k+2], in which the first term is the large one.
Response response_by_series(double zeta, double x) {
  double power[6];  // x^(k+1)/(k+1)!
  power[0] = x;
  for (int k = 1; k < 6; ++k) power[k] = power[k - 1] * x / (k + 1);
  double fourth = 0, fifth = 0, before = 0, now = power[4];  // now = g^(n+1)(0) x^(n+5)/(n+5)!
  for (int n = 0; n < 20; ++n) {
    fourth += now;
    fifth += now * x / (n + 6);
    // the derivatives follow the equation itself: c_(n+1) = -2 zeta c_n - c_(n-1)
    const double next = -x / (n + 6) * (2 * zeta * now + x / (n + 5) * before);
    before = now;
    now = next;
  }
  Response r;
  r.g[4] = fourth;
  r.g[3] = power[3] - 2 * zeta * fourth - fifth;
  for (int k = 2; k >= 0; --k) r.g[k] = power[k] - 2 * zeta * r.g[k + 1] - r.g[k + 2];
  r.slope = slope_of(zeta, r);
  return r;
}

/// From x to 2x: g[k] is the divided difference of exp at (0, ..., 0, l1, l2), l the roots of l² + 2 zeta l + 1, and
/// products of such make those of twice the time (Leibniz). For zeta >= 1 every term is positive.
Response twice(double zeta, double x, const Response& r) {
  const double* g = r.g;
  const double p = 1 - g[1];  // g' + 2 zeta g
  Response s;
  s.g[0] = g[0] * (2 * p - 2 * zeta * g[0]);
  s.g[1] = g[1] * (1 + p) + g[0] * g[0];
  s.g[2] = g[2] * (1 + p) + g[1] * (x + g[0]);
  s.g[3] = g[3] * (1 + p) + g[2] * (x + g[0]) + g[1] * x * x / 2;
  s.g[4] = g[4] * (1 + p) + g[3] * (x + g[0]) + g[2] * x * x / 2 + g[1] * x * x * x / 6;
  s.slope = slope_of(zeta, s);
  return s;
}

/// The halvings of x that bring x (1 + 2 zeta) below the bound.
int halvings(double zeta, double x, double bound) {
  const double size = x * (1 + 2 * zeta) / bound;
  return size <= 1 ? 0 : std::ilogb(size) + 1;
}

}  // namespace

Response response(double zeta, double x) {
  if (zeta < 1 && x > 2) {
    const double beta = std::sqrt((1 - zeta) * (1 + zeta));
    const double decay = std::exp(-zeta * x);
    Response r;
    r.g[0] = decay * std::sin(beta * x) / beta;
    r.slope = decay * std::cos(beta * x) - zeta * r.g[0];
    r.g[1] = 1 - r.slope - 2 * zeta * r.g[0];
    r.g[2] = x - r.g[0] - 2 * zeta * r.g[1];
    r.g[3] = x * x / 2 - r.g[1] - 2 * zeta * r.g[2];
    r.g[4] = x * x * x / 6 - r.g[2] - 2 * zeta * r.g[3];
    return r;
  }
  int left = halvings(zeta, x, 1);
  Response r = response_by_series(zeta, std::ldexp(x, -left));
  for (; left > 0; --left) r = twice(zeta, std::ldexp(x, -left), r);
  if (zeta >= 1) {  // g' + s g = exp(-f x), f + s = 2 zeta, f s = 1, where the sum above leaves nothing of g'
    const double fast = zeta + std::sqrt((zeta - 1) * (zeta + 1));
    r.slope = std::exp(-fast * x) - r.g[0] / fast;
  }
  return r;
}

/// Gauss's rule where the functions are smooth, then from x to 2x: the second half is the first one, begun with the
/// state at x. Sums of squares throughout.
ResponseProducts products_of_response(double zeta, double x) {
  int left = halvings(zeta, x, 0.125);
  const double start = std::ldexp(x, -left);
  ResponseProducts sum;
  const double root = 2 * std::sqrt(10.0 / 7), edge = 13 * std::sqrt(70.0);
  const double node[3] = {0, std::sqrt(5 - root) / 3, std::sqrt(5 + root) / 3};
  const double weight[3] = {128.0 / 225, (322 + edge) / 900, (322 - edge) / 900};
  for (int i = -2; i <= 2; ++i) {
    const double place = std::copysign(node[std::abs(i)], i);
    const Response r = response_by_series(zeta, start * (1 + place) / 2);
    const double w = weight[std::abs(i)] * start / 2;
    const double a = r.slope, b = r.g[0], c = r.g[1];
    const double terms[6] = {a * a, b * b, c * c, 2 * a * b, 2 * a * c, 2 * b * c};
    for (int k = 0; k < 6; ++k) sum.of[k] += w * terms[k];
  }
  Response r = response_by_series(zeta, start);
  for (; left > 0; --left) {
    const double now = std::ldexp(x, -left);
    // [v, b, h1] at x of those at 0: v' = (g', g, g1), b' = (-g, 1 - g1, x - g2), h1
    const double va = r.slope, vb = r.g[0], vc = r.g[1];
    const double ba = -r.g[0], bb = 1 - r.g[1], bc = now - r.g[2];
    const double aa = sum.of[0], dd = sum.of[1], cc = sum.of[2], ab = sum.of[3], ac = sum.of[4], bd = sum.of[5];
    sum.of[0] += aa * va * va + dd * ba * ba + ab * va * ba;
    sum.of[1] += aa * vb * vb + dd * bb * bb + ab * vb * bb;
    sum.of[2] += aa * vc * vc + dd * bc * bc + cc + ab * vc * bc + ac * vc + bd * bc;
    sum.of[3] += 2 * aa * va * vb + 2 * dd * ba * bb + ab * (va * bb + vb * ba);
    sum.of[4] += 2 * aa * va * vc + 2 * dd * ba * bc + ab * (va * bc + vc * ba) + ac * va + bd * ba;
    sum.of[5] += 2 * aa * vb * vc + 2 * dd * bb * bc + ab * (vb * bc + vc * bb) + ac * vb + bd * bb;
    r = twice(zeta, now, r);
  }
  return sum;
}

namespace {

constexpr double never = std::numeric_limits<double>::infinity();
constexpr int most_events = 1000;

/// State of the two bodies, and the outside force from then on.
struct Motion {
  double u, v, h0, h1;
};

double applied(const double (&row)[4], const Motion& m) {
  return row[0] * m.u + row[1] * m.v + row[2] * m.h0 + row[3] * m.h1;
}

double applied(const double (&form)[6], double v, double b, double h1) {
  return std::max(
      0.0, (form[0] * v + form[3] * b + form[4] * h1) * v + (form[1] * b + form[5] * h1) * b + form[2] * h1 * h1);
}

/// Without a dashpot both ends are one.
bool ends_at_zero_force(const ExactPair& p) {
  return p.end == ContactEnd::at_zero_force && p.damping_ratio > 0;
}

/// f, which is positive while the contact lasts, with derivatives, and bounds of |f''| and |f'''| over a given time.
struct Course {
  double f, slope, bend, most_bend, most_jolt;
};

/// The deviation of the contact from the linear course that it tends to, and all derivatives of it, are free
/// oscillations; their energies never grow: not f''² + w² (f' - its limit)², nor f'''² + w² f''².
Course course(const ExactPair& p, const Motion& m, double horizon) {
  const double w = p.frequency, c = 2 * p.damping_ratio * w, cu = p.hold[0], cv = p.hold[1];
  const double a = m.h0 - c * m.v - w * w * m.u;
  const double jerk = m.h1 - c * a - w * w * m.v;
  const double slope = cu * m.v + cv * a;
  const double bend = cu * a + cv * jerk;
  const double jolt = cu * jerk - cv * (c * jerk + w * w * a);
  const double swing = w * slope - cu * m.h1 / w;
  const double most_jolt = std::abs(jolt) + w * std::abs(bend);
  const double most_bend = std::min(std::sqrt(bend * bend + swing * swing), std::abs(bend) + horizon * most_jolt);
  return {cu * m.u + cv * m.v, slope, bend, most_bend, most_jolt};
}

/// In contact, at time t.
Motion in_contact(const ExactPair& p, const Response& r, double t, const Motion& m) {
  const double w = p.frequency, kept = r.slope + 2 * p.damping_ratio * r.g[0];
  return {m.u * kept + (m.v * r.g[0] + (m.h0 * r.g[1] + m.h1 / w * r.g[2]) / w) / w,
          m.v * r.slope - m.u * w * r.g[0] + (m.h0 * r.g[0] + m.h1 / w * r.g[1]) / w, m.h0 + m.h1 * t, m.h1};
}

/// Apart, at time t.
Motion in_flight(double t, const Motion& m) {
  return {m.u + t * (m.v + t * (m.h0 / 2 + t * m.h1 / 6)), m.v + t * (m.h0 + t * m.h1 / 2), m.h0 + m.h1 * t, m.h1};
}

/// Impulse and moment over the reduced mass as rows for [u, v, h0, h1]: sums of positive terms, no differences.
void impulse_rows(double w, double zeta, const Response& r, double (&impulse)[4], double (&moment)[4]) {
  const double z = 2 * zeta;
  const double* g = r.g;
  impulse[0] = w * g[0];
  impulse[1] = z * g[0] + g[1];
  impulse[2] = (z * g[1] + g[2]) / w;
  impulse[3] = (z * g[2] + g[3]) / (w * w);
  moment[0] = g[1];
  moment[1] = (z * g[1] + g[2]) / w;
  moment[2] = (z * g[2] + g[3]) / (w * w);
  moment[3] = (z * g[3] + g[4]) / (w * w * w);
}

/// c v² dt with v(t) = v g' + b/w g + h1/w² g[1].
void loss_form(double w, double zeta, double x, double (&form)[6]) {
  const ResponseProducts sum = products_of_response(zeta, x);
  const double scale[6] = {1, 1 / (w * w), 1 / (w * w * w * w), 1 / w, 1 / (w * w), 1 / (w * w * w)};
  for (int k = 0; k < 6; ++k) form[k] = 2 * zeta * scale[k] * sum.of[k];
}

struct ValueAndSlope {
  double value, slope;
};

/// The zero between f(low) >= 0 and f(high) < 0, not the one at which f begins to rise. \param f gives value and slope.
template <class Function>
double zero_between(double low, double high, Function f) {
  double x = low;
  for (int i = 0; i < 200; ++i) {
    const auto [value, slope] = f(x);
    if (value == 0 && slope < 0) return x;
    (value >= 0 ? low : high) = x;
    double next = x - value / slope;
    if (!(next > low && next < high)) next = low + (high - low) / 2;
    if (next == x || next == low || next == high) break;
    if (std::abs(next - x) <= 1e-16 * std::abs(x)) return next;
    x = next;
  }
  return x;
}

/// The first time in [0, within] at which the cubic c0 + c1 t + c2 t²/2 + c3 t³/6 comes up to zero, from at or below;
/// or never; searched for between the extremes.
double first_rise(double c0, double c1, double c2, double c3, double within) {
  const auto cubic = [&](double t) {
    return ValueAndSlope{c0 + t * (c1 + t * (c2 / 2 + t * c3 / 6)), c1 + t * (c2 + t * c3 / 2)};
  };
  const double q = -(c2 + std::copysign(std::sqrt(std::max(0.0, c2 * c2 - 2 * c3 * c1)), c2));
  double extremes[2] = {q / c3, 2 * c1 / q};
  if (!(extremes[0] <= extremes[1])) std::swap(extremes[0], extremes[1]);
  double before = 0, value_before = c0;
  for (const double t : {extremes[0], extremes[1], within}) {
    if (!(t > before && t <= within)) continue;
    const double value = cubic(t).value;
    if (value_before <= 0 && value > 0) {
      if (value_before == 0) return before;
      return zero_between(before, t, [&](double s) {
        const ValueAndSlope at = cubic(s);
        return ValueAndSlope{-at.value, -at.slope};
      });
    }
    before = t;
    value_before = value;
  }
  return never;
}

/// The first time in [0, within] at which a contact ends, or never. Goes on by steps that hold no end for certain, as
/// the curvature is bounded (the third derivative, where f begins without slope); close to the end they are Newton's.
/// They are no shorter than 1e-3 of the contact's own time: a shorter dip of f below zero, by less than 1e-6 of its
/// swing, is no end.
double contact_end(const ExactPair& p, const Motion& start, double within) {
  const double least = std::min(1e-4 * within, 1e-3 / (p.frequency * (1 + 2 * p.damping_ratio)));
  const auto at = [&](double t) {
    return course(p, in_contact(p, response(p.damping_ratio, p.frequency * t), t, start), within - t);
  };
  Course now = course(p, start, within);
  for (double t = 0; t < within;) {
    const double f = std::max(0.0, now.f);
    const double root = std::sqrt(now.slope * now.slope + 2 * now.most_bend * f);
    // 0/0: permanently at rest
    double sure = now.slope < 0 ? 2 * f / (root - now.slope) : (now.slope + root) / now.most_bend;
    if (now.slope >= 0 && now.bend > 0) sure = std::max(sure, 3 * now.bend / now.most_jolt);
    if (!(sure < within - t)) return never;
    const double next = std::min(within, t + (f > 0 || sure == 0 ? std::max(sure, least) : sure));
    const Course then = at(next);
    if (then.f < 0) {
      return zero_between(t, next, [&](double s) {
        const Course there = at(s);
        return ValueAndSlope{there.f, there.slope};
      });
    }
    t = next;
    now = then;
  }
  return never;
}

/// A step in which contacts begin or end.
class EventfulStep {
 public:
  EventfulStep(const ExactPair& pair, const Motion& start, bool touching)
      : p_(pair), m_(start), left_(pair.step), contact_(touching) {}

  ExactStep make() {
    decide_state();
    for (int event = 0; left_ > 0; ++event) {
      if (event == most_events) {
        rest();
      } else if (contact_) {
        touch();
      } else {
        fly();
      }
    }
    const double m = p_.reduced_mass;
    return {m * impulse_, m * moment_, m * loss_, m * released_, contact_, beginnings_};
  }

 private:
  [[nodiscard]] double spring_energy() const { return p_.frequency * p_.frequency * m_.u * m_.u / 2; }

  /// Where round-off leaves the state undecided, the previous one decides: within 1e-9 of the step of an end, and 1e-6
  /// of it before a beginning, the contact is as it was.
  void decide_state() {
    const bool touched = contact_;
    if (touched && m_.u < 0 && m_.v > 0 && -m_.u < 1e-6 * m_.v * p_.step) m_.u = 0;
    const Course now = course(p_, m_, 0);
    contact_ = m_.u > 0 ? now.f >= 0 : touched && m_.u == 0 && m_.v >= 0;
    if (contact_ && !touched) {
      if (now.slope < 0 && now.f < -1e-9 * p_.step * now.slope) {
        contact_ = false;
        if (!ends_at_zero_force(p_)) m_.u = 0;
      } else {
        begin();
      }
    } else if (touched && !contact_ && m_.u > 0) {
      released_ += spring_energy();
    }
  }

  void begin() {
    contact_ = true;
    ++beginnings_;
    released_ -= spring_energy();
  }

  void touch() {
    const double end = contact_end(p_, m_, left_);
    const double t = std::min(end, left_);
    const double x = p_.frequency * t;
    const Response r = response(p_.damping_ratio, x);
    double impulse[4], moment[4], form[6];
    impulse_rows(p_.frequency, p_.damping_ratio, r, impulse, moment);
    if (p_.damping_ratio > 0) {
      loss_form(p_.frequency, p_.damping_ratio, x, form);
      loss_ += applied(form, m_.v, m_.h0 - p_.frequency * p_.frequency * m_.u, m_.h1);
    }
    left_ -= t;
    impulse_ += applied(impulse, m_);
    moment_ += applied(moment, m_) + applied(impulse, m_) * left_;
    m_ = in_contact(p_, r, t, m_);
    if (end == never) return;
    contact_ = false;
    if (ends_at_zero_force(p_)) {
      released_ += spring_energy();
    } else {
      m_.u = 0;
    }
  }

  void fly() {
    const bool overlapping = m_.u > 0;
    const double cu = p_.hold[0], cv = p_.hold[1];
    const double rise = overlapping ? first_rise(cu * m_.u + cv * m_.v, cu * m_.v + cv * m_.h0, cu * m_.h0 + cv * m_.h1,
                                                 cu * m_.h1, left_)
                                    : first_rise(m_.u, m_.v, m_.h0, m_.h1, left_);
    const double parting = overlapping ? first_rise(-m_.u, -m_.v, -m_.h0, -m_.h1, left_) : never;
    const double t = std::min({rise, parting, left_});
    left_ -= t;
    m_ = in_flight(t, m_);
    if (rise <= parting && rise != never) {
      if (!overlapping) m_.u = 0;
      begin();
    } else if (parting != never) {
      m_.u = 0;
    }
  }

  /// All closing stops, the outside force is balanced; parting goes on freely.
  void rest() {
    const Motion free = in_flight(left_, m_);
    const double before = m_.v * m_.v / 2 + (contact_ ? spring_energy() : 0);
    const double mean = (m_.h0 + free.h0) / 2, held = std::max(0.0, free.v), back = std::max(0.0, free.u),
                 v = free.v - held;
    impulse_ += held;
    moment_ += back;
    loss_ += std::max(0.0, before - v * v / 2 + mean * (free.u - back - m_.u));
    contact_ = held > 0;
    left_ = 0;
  }

  const ExactPair& p_;
  Motion m_;
  double left_;
  bool contact_;
  double impulse_ = 0, moment_ = 0, loss_ = 0, released_ = 0;  // over the reduced mass
  int beginnings_ = 0;
};

}  // namespace

ExactPair exact_pair(double reduced_mass, double stiffness, double damping_ratio, ContactEnd end, double step) {
  check_positive(reduced_mass, "reduced mass of a contact", "kg");
  check_positive(stiffness, "stiffness of a contact", "N/m");
  check_range(Range::not_negative(), damping_ratio, "damping ratio of a contact");
  check_positive(step, "time step", "s");
  ExactPair p{reduced_mass, stiffness, damping_ratio, end, step, std::sqrt(stiffness / reduced_mass)};
  const double w = p.frequency, x = w * step;
  const Response r = response(damping_ratio, x);
  impulse_rows(w, damping_ratio, r, p.impulse, p.moment);
  loss_form(w, damping_ratio, x, p.loss);
  p.hold[0] = ends_at_zero_force(p) ? w * w : 1;
  p.hold[1] = ends_at_zero_force(p) ? 2 * damping_ratio * w : 0;
  for (int k = 0; k < 4; ++k) {
    const Motion one = in_contact(p, r, step, {k == 0 ? 1.0 : 0, k == 1 ? 1.0 : 0, k == 2 ? 1.0 : 0, k == 3 ? 1.0 : 0});
    p.hold_after[k] = p.hold[0] * one.u + p.hold[1] * one.v;
  }
  return p;
}

ExactStep exact_step(const ExactPair& p, double overlap, double closing, bool touching, double h0, double h1) {
  const Motion start{overlap, closing, h0, h1};
  const double dt = p.step;
  if (overlap < 0 && !touching) {
    const double speed = std::max(0.0, closing), push = std::max({0.0, h0, h0 + h1 * dt});
    if (overlap + dt * (speed + dt * push / 2) < 0) return {};
  } else if (touching && overlap > 0) {
    // f lies above its chord less most_bend t (dt - t)/2: positive throughout where sqrt f(0) + sqrt f(dt) > dt
    // sqrt(most_bend/2)
    const Course now = course(p, start, dt);
    const double last = applied(p.hold_after, start);
    if (now.f > 0 && last > 0 && now.f + last + 2 * std::sqrt(now.f * last) > now.most_bend * dt * dt / 2) {
      const double m = p.reduced_mass;
      return {m * applied(p.impulse, start),
              m * applied(p.moment, start),
              m * applied(p.loss, closing, h0 - p.frequency * p.frequency * overlap, h1),
              0,
              true,
              0};
    }
  }
  return EventfulStep(p, start, touching).make();
}

}  // namespace equidem
