// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts that open, close, slip and stick by dense matrices, without any of the library but the description of the
/// network: rates are found by Lemke's pivots, or else by trying all supports, from the network in which every closed
/// contact sticks, whose stiffness is inverted by its eigenvectors. Lambda itself is controlled.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/breakage/breakage_run.hpp"

#include "breakage/dense_network.hpp"
#include "breakage/lemke.hpp"

namespace equidem::test {

class DenseUnbonded {
 public:
  enum State { bonded, stuck, slips, open };  // slips: in the direction of sign
  struct Contact1 {
    State state = stuck;
    double sign = 1, n = 0, t = 0, gap = 0;  // N, T; kN times the gap
    double kept_n = 0, kept_t = 0;           // of a broken bond
  };
  struct Event {
    double lambda = 0;
    std::int64_t contact = 0;
    BreakMode mode = BreakMode::open;
  };

  DenseUnbonded(const Assembly& assembly, const ContactSprings& springs, const ContactStrengths& strengths,
                const LoadPath& path, const DegreesOfFreedom& unknowns, double friction,
                const std::vector<ContactForce>& rest)
      : assembly_(assembly), springs_(springs), strengths_(strengths), path_(path), unknowns_(unknowns), mu_(friction) {
    for (std::size_t c = 0; c < assembly_.contacts.size(); ++c) {
      Contact1 one;
      const ContactForce at_rest = rest.empty() ? ContactForce{} : rest[c];
      const bool bond = strengths_.tension[c] > 0 || strengths_.shear[c] > 0;
      if (bond) {
        one.state = bonded;
      } else if (at_rest.normal > 0) {
        one.state = open;
        one.gap = at_rest.normal;
      }
      if (one.state != open) one.n = at_rest.normal, one.t = rough(c) || bond ? at_rest.tangential : 0;
      contacts_.push_back(one);
      force_ = std::max({force_, std::abs(one.n), std::abs(one.t)});
    }
  }

  /// A state between two events, or at one: the bonds that broke have let go.
  struct State1 {
    double way = 0;          ///< of lambda, all legs behind one another; below 0: dead loads are not whole yet
    std::size_t events = 0;  ///< so far
    std::vector<ContactForce> forces;  ///< per contact
  };
  std::vector<State1> states;

  /// \return false where rates are not found
  bool go(std::size_t most) {
    if (path_.dead && !stage(*path_.dead, 1, most, false)) return false;
    double from = 0;
    for (const double to : path_.legs) {
      if (!stage(path_.pattern, to - from, most, true)) return false;
      from = to;
      if (events.size() >= most) return true;
    }
    return true;
  }

  std::vector<Event> events;
  double lambda = 0;
  /// Events before the first network with a motion that nothing resists: behind it what is loose may be anywhere.
  std::size_t determined = std::numeric_limits<std::size_t>::max();
  [[nodiscard]] const std::vector<Contact1>& contacts() const { return contacts_; }

 private:
  [[nodiscard]] bool rough(std::size_t c) const { return mu_ > 0 && springs_[c].kT > 0; }

  /// Everything grows by `whole` times the pattern. \param leg whether lambda goes with it
  bool stage(const RightHandSide& pattern, double whole, std::size_t most, bool leg) {
    double done = 0;
    const double from = lambda, way = leg ? way_ : -1;
    std::size_t seen = events.size();
    for (int still = 0; events.size() < most; ++still) {
      if (events.size() > seen) still = 0, seen = events.size();
      if (still > 30) return false;  // it changes to and fro at one lambda
      const bool release = letting_go_;
      if (release && kept() <= 1e-12 * force_) {  // round-off of what bonds had
        for (Contact1& one : contacts_) one.kept_n = one.kept_t = 0;
        letting_go_ = false;
        continue;
      }
      if (!find_rates(pattern, release ? 0 : whole > 0 ? 1 : -1, release)) return false;
      const double end = release ? 1 : std::abs(whole) - done;
      std::size_t breaks = contacts_.size();
      BreakMode mode = BreakMode::tension;
      const double until = next(breaks, mode), t = std::min(end, until);
      if (until > end) breaks = contacts_.size();
      for (std::size_t c = 0; c < contacts_.size(); ++c) {
        Contact1& one = contacts_[c];
        one.n += t * dn_[c], one.t += t * dt_[c], one.gap += t * dg_[c];
        if (release) one.kept_n *= 1 - t, one.kept_t *= 1 - t;
        force_ = std::max({force_, std::abs(one.n), std::abs(one.t)});
        if (one.state == slips) one.t = -one.sign * mu_ * one.n;
      }
      if (!release) done += t;
      if (leg) lambda = from + (whole > 0 ? done : -done), way_ = way + done;
      if (!release || kept() <= 1e-12 * force_) keep_state(way + done);
      if (breaks < contacts_.size()) {
        events.push_back({lambda, static_cast<std::int64_t>(breaks), mode});
        let_go(breaks);
      } else if (!release && done >= std::abs(whole)) {
        return true;
      }
    }
    return true;
  }
  void keep_state(double way) {
    State1 state{way, events.size(), {}};
    for (const Contact1& one : contacts_) state.forces.push_back({one.n, one.t});
    states.push_back(std::move(state));
  }
  /// The largest force that broken bonds have yet to give up.
  [[nodiscard]] double kept() const {
    double most = 0;
    for (const Contact1& one : contacts_) most = std::max({most, std::abs(one.kept_n), std::abs(one.kept_t)});
    return most;
  }
  void let_go(std::size_t c) {
    Contact1& one = contacts_[c];
    one.kept_n = one.n, one.kept_t = one.t;
    if (one.n >= 0) {
      one.state = open;
      one.gap = one.n;
      one.n = one.t = 0;
    } else if (!rough(c)) {
      one.state = stuck;
      one.t = 0;
    } else if (std::abs(one.t) > -mu_ * one.n) {
      one.state = slips;
      one.sign = one.t < 0 ? -1 : 1;
      one.t = -one.sign * mu_ * one.n;
    } else {
      one.state = stuck;
    }
    one.kept_n -= one.n, one.kept_t -= one.t;
    letting_go_ = kept() > 0;
  }

  double next(std::size_t& breaks, BreakMode& mode) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
      const Contact1& one = contacts_[c];
      const double none = 1e-9 * rate_;
      const auto reach = [&](double a, double b, int kind, BreakMode how) {
        if (!(b > none)) return;
        const double t = std::max(0.0, -a / b);
        if (t >= least * (1 - 1e-10) || (least == 0 && t == 0)) return;
        least = t;
        breaks = kind != 0 ? c : contacts_.size();
        mode = how;
      };
      const double mu = strengths_.friction, fs = strengths_.shear[c];
      if (one.state == bonded) {
        reach(one.n - strengths_.tension[c], dn_[c], 1, BreakMode::tension);
        reach(one.t + mu * one.n - fs, dt_[c] + mu * dn_[c], 1, BreakMode::shear);
        reach(-one.t + mu * one.n - fs, -dt_[c] + mu * dn_[c], 1, BreakMode::shear);
      } else if (one.state == open) {
        reach(-one.gap, -dg_[c], 0, mode);
      } else if (one.state == stuck && rough(c)) {
        reach(one.t + mu_ * one.n, dt_[c] + mu_ * dn_[c], 0, mode);
        reach(-one.t + mu_ * one.n, -dt_[c] + mu_ * dn_[c], 0, mode);
      } else {
        reach(one.n, dn_[c], 0, mode);
      }
    }
    return least;
  }

  /// The rates of all contacts by the complementarity problem of those on a limit.
  bool find_rates(const RightHandSide& pattern, double way, bool release) {
    const std::size_t n = unknowns_.held.size(), count = contacts_.size(), events_before = events.size();
    std::vector<std::vector<double>> g(count), h(count);
    for (std::size_t c = 0; c < count; ++c) contact_rows(assembly_, unknowns_, c, g[c], h[c]);
    // Contacts on a limit are closed and stick in the base.
    const double none = 1e-11 * force_;
    struct Multiplier {
      std::size_t contact;
      int kind;  // 0: opening, 1: slip in the direction of sign
      double sign;
    };
    std::vector<Multiplier> multipliers;
    std::vector<bool> closed(count);
    std::vector<int> limit(count, 0);
    for (std::size_t c = 0; c < count; ++c) {
      const Contact1& one = contacts_[c];
      closed[c] = one.state != open || one.gap <= none;
      if (one.state == bonded || !closed[c]) continue;
      if (one.state == open || -one.n <= none) {
        limit[c] = 2;
        multipliers.push_back({c, 0, 1});
        if (rough(c)) multipliers.push_back({c, 1, 1}), multipliers.push_back({c, 1, -1});
      } else if (rough(c) && std::abs(one.t) + mu_ * one.n >= -none) {
        limit[c] = 1;
        multipliers.push_back({c, 1, one.t < 0 ? -1.0 : 1.0});
      }
    }
    const auto kt = [&](std::size_t c) { return contacts_[c].state == bonded || rough(c) ? springs_[c].kT : 0; };
    const auto modes_of = [&](const std::vector<bool>& resists, std::vector<double>& vectors) {
      std::vector<double> k(n * n, 0.0);
      for (std::size_t c = 0; c < count; ++c) {
        if (!resists[c]) continue;
        for (std::size_t p = 0; p < n; ++p) {
          for (std::size_t q = 0; q < n; ++q)
            k[p * n + q] += springs_[c].kN * g[c][p] * g[c][q] + kt(c) * h[c][p] * h[c][q];
        }
      }
      for (std::size_t p = 0; p < n; ++p) {
        if (unknowns_.held[p] == 0) continue;
        for (std::size_t q = 0; q < n; ++q) k[p * n + q] = k[q * n + p] = 0;
      }
      return jacobi(k, vectors, n);
    };
    std::vector<double> vectors;
    const std::vector<double> values = modes_of(closed, vectors);
    double largest = 0;
    for (const double value : values) largest = std::max(largest, std::abs(value));
    const auto solve = [&](const std::vector<double>& f, bool& carried) {
      std::vector<double> u(n, 0.0);
      double size = 0;
      for (std::size_t p = 0; p < n; ++p) size += unknowns_.held[p] == 0 ? f[p] * f[p] : 0;
      for (std::size_t m = 0; m < n; ++m) {
        double part = 0;
        for (std::size_t p = 0; p < n; ++p) part += unknowns_.held[p] == 0 ? vectors[p * n + m] * f[p] : 0;
        if (std::abs(values[m]) <= 1e-10 * largest) {
          carried = carried && std::abs(part) <= 1e-8 * std::sqrt(size);
          continue;
        }
        for (std::size_t p = 0; p < n; ++p) u[p] += part / values[m] * vectors[p * n + m];
      }
      return u;
    };
    // The rates without multipliers.
    std::vector<double> f(n, 0.0), u0(n, 0.0);
    std::vector<double> an(count, 0.0), at(count, 0.0);
    for (std::size_t c = 0; c < count && pattern.gradient; ++c) {
      const Vec2 l = assembly_.branch(assembly_.contacts[c]), e = l / norm(l), du = *pattern.gradient * l;
      an[c] = way * (du.x * e.x + du.y * e.y);
      at[c] = way * (du.y * e.x - du.x * e.y);
    }
    for (std::size_t p = 0; p < n; ++p) {
      if (!pattern.force.empty()) f[p] += way * pattern.force[p];
      if (unknowns_.held[p] != 0 && !pattern.prescribed.empty()) u0[p] = way * pattern.prescribed[p];
    }
    const auto along = [&](const std::vector<double>& row, const std::vector<double>& u) {
      double sum = 0;
      for (std::size_t p = 0; p < n; ++p) sum += row[p] * u[p];
      return sum;
    };
    for (std::size_t c = 0; c < count; ++c) {
      const double dn = along(g[c], u0) + an[c], ds = along(h[c], u0) + at[c];
      for (std::size_t p = 0; p < n; ++p) {
        if (closed[c]) f[p] -= springs_[c].kN * dn * g[c][p] + kt(c) * ds * h[c][p];
        if (release) f[p] += contacts_[c].kept_n * g[c][p] + contacts_[c].kept_t * h[c][p];
      }
    }
    bool carried = true;
    std::vector<double> u = solve(f, carried);
    for (std::size_t p = 0; p < n; ++p) u[p] = unknowns_.held[p] != 0 ? u0[p] : u[p];
    // Motions by the multipliers: eigenstrains of their contacts.
    const std::size_t m = multipliers.size();
    std::vector<std::vector<double>> by(m);
    for (std::size_t a = 0; a < m; ++a) {
      const Multiplier& x = multipliers[a];
      std::vector<double> eigen(n, 0.0);
      for (std::size_t p = 0; p < n; ++p)
        eigen[p] = x.kind == 0 ? springs_[x.contact].kN * g[x.contact][p] : kt(x.contact) * x.sign * h[x.contact][p];
      bool ignored = true;
      by[a] = solve(eigen, ignored);
    }
    const auto force = [&](std::size_t c, const std::vector<double>& motion, bool tangential) {
      return tangential ? kt(c) * along(h[c], motion) : springs_[c].kN * along(g[c], motion);
    };
    // w of each multiplier, from rates of force (dN, dT).
    const auto slack = [&](const Multiplier& x, double n1, double t1) {
      return x.kind == 0 ? -n1 : -(x.sign * t1 + mu_ * n1);
    };
    const auto own = [&](std::size_t a, std::size_t c, bool tangential) {
      const Multiplier& x = multipliers[a];
      if (x.contact != c || (x.kind == 1) != tangential) return 0.0;
      return x.kind == 0 ? -springs_[c].kN : -kt(c) * x.sign;
    };
    std::vector<double> matrix(m * m), q(m), z;
    double unit = 0;
    for (std::size_t a = 0; a < m; ++a) {
      const std::size_t c = multipliers[a].contact;
      q[a] = slack(multipliers[a], force(c, u, false) + springs_[c].kN * an[c], force(c, u, true) + kt(c) * at[c]);
      unit = std::max(unit, std::abs(q[a]));
      for (std::size_t b = 0; b < m; ++b) {
        matrix[a * m + b] =
            slack(multipliers[a], force(c, by[b], false) + own(b, c, false), force(c, by[b], true) + own(b, c, true)) /
            largest;
      }
    }
    for (double& x : q) x = unit > 0 && std::abs(x) > 1e-10 * unit ? x / unit : 0;
    if (!lemke(matrix, q, z) && !complementary_by_supports(matrix, q, z)) return false;
    for (std::size_t a = 0; a < m; ++a) {
      z[a] *= unit / largest;
      for (std::size_t p = 0; p < n; ++p) u[p] += z[a] * by[a][p];
    }
    if (!carried) return false;
    dn_.assign(count, 0.0), dt_.assign(count, 0.0), dg_.assign(count, 0.0);
    std::vector<double> opening(count, 0.0), slip(count, 0.0);
    for (std::size_t a = 0; a < m; ++a)
      (multipliers[a].kind == 0 ? opening : slip)[multipliers[a].contact] += multipliers[a].sign * z[a];
    rate_ = 0;
    double moved = 0;
    for (std::size_t c = 0; c < count; ++c) {
      const double dn = along(g[c], u) + an[c], ds = along(h[c], u) + at[c];
      if (closed[c]) {
        dn_[c] = springs_[c].kN * (dn - opening[c]);
        dt_[c] = kt(c) * (ds - slip[c]);
        rate_ = std::max({rate_, std::abs(dn_[c]), std::abs(dt_[c])});
      } else {
        dg_[c] = springs_[c].kN * dn;
      }
      moved = std::max(moved, springs_[c].kN * std::abs(dn));
    }
    // Where the discs move and nothing carries a force, round-off alone would say which contacts are open.
    if (rate_ < 1e-9 * moved) determined = std::min(determined, events_before);
    for (std::size_t c = 0; c < count; ++c) {
      if (limit[c] == 0) continue;
      Contact1& one = contacts_[c];
      const double opens = springs_[c].kN * opening[c], slides = kt(c) * slip[c];
      State now = stuck;
      double sign = one.sign;
      if (limit[c] == 2 && opens > 1e-8 * rate_) {
        now = open;
        dg_[c] = opens;
        dn_[c] = dt_[c] = 0;
      } else if (std::abs(slides) > 1e-8 * rate_) {
        now = slips;
        sign = slides < 0 ? -1 : 1;
      } else if (limit[c] == 1 && one.state == slips && dt_[c] * one.sign + mu_ * dn_[c] > -1e-8 * rate_) {
        now = slips;
      }
      change(c, now, sign);
      // A contact that touches without a force holds nothing: its status is but a name.
      closed[c] = now != open && (limit[c] == 1 || std::abs(dn_[c]) > 1e-8 * rate_);
    }
    const std::vector<double> left = modes_of(closed, vectors);
    int loose = assembly_.periodic() ? -2 : 0;
    for (std::size_t mode = 0; mode < n; ++mode) {
      bool moves = false;
      for (std::size_t p = 0; p < n; ++p) {
        const bool turns = unknowns_.per_disc == 3 && p % 3 == 2;
        moves = moves || (!turns && unknowns_.held[p] == 0 && std::abs(vectors[p * n + mode]) > 1e-6);
      }
      loose += moves && std::abs(left[mode]) <= 1e-10 * largest ? 1 : 0;
    }
    if (loose > 0) determined = std::min(determined, events_before);
    return true;
  }

  void change(std::size_t c, State now, double sign) {
    Contact1& one = contacts_[c];
    const State before = one.state;
    if (before != now || (now == slips && sign != one.sign && before == slips)) {
      const BreakMode mode = now == open      ? BreakMode::open
                             : before == open ? BreakMode::close
                             : now == stuck   ? BreakMode::stick
                                              : BreakMode::slip;
      events.push_back({lambda, static_cast<std::int64_t>(c), mode});
    }
    if (now == open || before == open) one.n = one.t = one.gap = 0;
    one.state = now;
    one.sign = sign;
  }

  const Assembly& assembly_;
  const ContactSprings& springs_;
  const ContactStrengths& strengths_;
  const LoadPath& path_;
  const DegreesOfFreedom& unknowns_;
  double mu_;
  std::vector<Contact1> contacts_;
  std::vector<double> dn_, dt_, dg_;  // rates of N, T and kN times the gap
  double force_ = 0, rate_ = 0, way_ = 0;
  bool letting_go_ = false;
};

}  // namespace equidem::test
