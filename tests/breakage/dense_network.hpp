// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Breakage by dense matrices, without any of the library but the description of the network: deformations are written
/// out from Abe (1996), eqs. (1)-(3), every network is solved by its eigenvectors, motions without energy left out.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "equidem/breakage/breakage_run.hpp"

namespace equidem::test {

/// Eigenvalues and eigenvectors (columns) of a symmetric matrix by Jacobi's rotations.
inline std::vector<double> jacobi(std::vector<double>& a, std::vector<double>& v, std::size_t n) {
  v.assign(n * n, 0.0);
  for (std::size_t k = 0; k < n; ++k) v[k * n + k] = 1;
  double size = 0;
  for (const double x : a) size = std::max(size, std::abs(x));
  for (int sweep = 0; sweep < 60; ++sweep) {
    double off = 0;
    for (std::size_t p = 0; p < n; ++p) {
      for (std::size_t q = p + 1; q < n; ++q) {
        const double apq = a[p * n + q];
        off = std::max(off, std::abs(apq));
        if (std::abs(apq) <= 1e-18 * size) continue;
        const double theta = (a[q * n + q] - a[p * n + p]) / (2 * apq);
        const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (std::size_t k = 0; k < n; ++k) {
          const double x = a[k * n + p], y = a[k * n + q];
          a[k * n + p] = c * x - s * y;
          a[k * n + q] = s * x + c * y;
        }
        for (std::size_t k = 0; k < n; ++k) {
          const double x = a[p * n + k], y = a[q * n + k];
          a[p * n + k] = c * x - s * y;
          a[q * n + k] = s * x + c * y;
          const double w = v[k * n + p], z = v[k * n + q];
          v[k * n + p] = c * w - s * z;
          v[k * n + q] = s * w + c * z;
        }
      }
    }
    if (off <= 1e-17 * size) break;
  }
  std::vector<double> values(n);
  for (std::size_t k = 0; k < n; ++k) values[k] = a[k * n + k];
  return values;
}

/// Derivatives of stretch and slip of a contact by the components.
inline void contact_rows(const Assembly& assembly, const DegreesOfFreedom& unknowns, std::size_t c,
                         std::vector<double>& normal, std::vector<double>& slip) {
  const Contact& contact = assembly.contacts[c];
  const Vec2 l = assembly.branch(contact), n = l / norm(l);
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  normal.assign(unknowns.held.size(), 0.0);
  slip.assign(unknowns.held.size(), 0.0);
  const auto i = static_cast<std::size_t>(contact.i) * b, j = static_cast<std::size_t>(contact.j) * b;
  normal[j] += n.x, normal[j + 1] += n.y, normal[i] -= n.x, normal[i + 1] -= n.y;
  slip[j] -= n.y, slip[j + 1] += n.x, slip[i] += n.y, slip[i + 1] -= n.x;
  if (b == 3) {
    slip[i + 2] -= contact.lever_i / unknowns.rotation_scale;
    slip[j + 2] -= contact.lever_j / unknowns.rotation_scale;
  }
}

class DenseNetwork {
 public:
  struct State {
    std::vector<double> normal, tangential, motion;  ///< forces per contact; motion per component
    bool carried = true;
  };
  struct Event {
    double lambda = std::numeric_limits<double>::infinity(), gap = 0;
    std::int64_t contact = -1;
    bool shear = false;
  };

  DenseNetwork(const Assembly& assembly, const ContactSprings& springs, const ContactStrengths& strengths,
               const LoadPath& path, const DegreesOfFreedom& unknowns)
      : assembly_(assembly),
        springs_(springs),
        strengths_(strengths),
        path_(path),
        unknowns_(unknowns),
        broken_(assembly.contacts.size(), false) {
    solve();
  }

  void remove(std::size_t contact) {
    broken_[contact] = true;
    solve();
  }
  /// The least lambda > 0 at which a contact breaks, as the definition says: of criteria that are met at 0 it is 0.
  [[nodiscard]] Event next() const {
    Event least;
    double second = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < broken_.size(); ++c) {
      if (broken_[c]) continue;
      const auto seen = [](double f, double largest) { return std::abs(f) > 1e-11 * largest ? f : 0; };
      const double n1 = seen(pattern_.normal[c], force_), t1 = seen(pattern_.tangential[c], force_);
      const double n0 = seen(dead_.normal[c], dead_force_), t0 = seen(dead_.tangential[c], dead_force_);
      if (n1 == 0 && t1 == 0 && n0 == 0 && t0 == 0) continue;
      const double mu = strengths_.friction, ft = strengths_.tension[c], fs = strengths_.shear[c];
      const double tension = first(n0 - ft, n1);
      const double shear = std::min(first(t0 + mu * n0 - fs, t1 + mu * n1), first(mu * n0 - t0 - fs, mu * n1 - t1));
      const double lambda = std::min(tension, shear);
      if (lambda < least.lambda) {
        second = least.lambda;
        least = {lambda, 0, static_cast<std::int64_t>(c), shear < tension};
      } else {
        second = std::min(second, lambda);
      }
    }
    least.gap = least.lambda > 0 ? second / least.lambda - 1 : second;
    return least;
  }
  [[nodiscard]] const State& pattern() const { return pattern_; }
  [[nodiscard]] const State& dead() const { return dead_; }
  [[nodiscard]] bool carried() const { return pattern_.carried && dead_.carried; }
  [[nodiscard]] int negative() const { return negative_; }
  [[nodiscard]] int null_motions() const { return null_; }
  /// Least eigenvalue that is not zero over the largest.
  [[nodiscard]] double softest() const { return softest_; }
  [[nodiscard]] double energy(double lambda) const {
    double sum = 0;
    for (std::size_t c = 0; c < broken_.size(); ++c) {
      if (broken_[c]) continue;
      const double n = dead_.normal[c] + lambda * pattern_.normal[c];
      const double t = dead_.tangential[c] + lambda * pattern_.tangential[c];
      sum += 0.5 * n * n / springs_[c].kN + (springs_[c].kT != 0 ? 0.5 * t * t / springs_[c].kT : 0);
    }
    return sum;
  }
  /// Stretch and slip of a contact, broken or not, under lambda.
  [[nodiscard]] ContactDeformation opening(std::size_t c, double lambda) const {
    ContactDeformation d;
    const auto add = [&](const State& state, const RightHandSide& given, double by) {
      const auto [n, t] = stretch(c, state.motion, given);
      d.normal += by * n;
      d.tangential += by * t;
    };
    add(pattern_, path_.pattern, lambda);
    if (path_.dead) add(dead_, *path_.dead, 1);
    return d;
  }

 private:
  static double first(double a, double b) {
    if (a > 0 || (a == 0 && b >= 0)) return 0;
    return b > 0 ? -a / b : std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] std::pair<double, double> stretch(std::size_t c, const std::vector<double>& u,
                                                  const RightHandSide& given) const {
    std::vector<double> normal, slip;
    contact_rows(assembly_, unknowns_, c, normal, slip);
    double n = 0, t = 0;
    for (std::size_t k = 0; k < u.size(); ++k) n += normal[k] * u[k], t += slip[k] * u[k];
    if (given.gradient) {
      const Vec2 l = assembly_.branch(assembly_.contacts[c]), e = l / norm(l), du = *given.gradient * l;
      n += du.x * e.x + du.y * e.y;
      t += du.y * e.x - du.x * e.y;
    }
    return {n, t};
  }
  void solve() {
    const std::size_t n = unknowns_.held.size();
    std::vector<double> k(n * n, 0.0), normal, slip;
    for (std::size_t c = 0; c < broken_.size(); ++c) {
      if (broken_[c]) continue;
      contact_rows(assembly_, unknowns_, c, normal, slip);
      for (std::size_t p = 0; p < n; ++p) {
        for (std::size_t q = 0; q < n; ++q)
          k[p * n + q] += springs_[c].kN * normal[p] * normal[q] + springs_[c].kT * slip[p] * slip[q];
      }
    }
    for (std::size_t p = 0; p < n; ++p) {
      if (unknowns_.held[p] == 0) continue;
      for (std::size_t q = 0; q < n; ++q) k[p * n + q] = k[q * n + p] = 0;
    }
    values_ = jacobi(k, vectors_, n);
    double largest = 0;
    for (const double value : values_) largest = std::max(largest, std::abs(value));
    least_ = 1e-11 * largest;
    negative_ = null_ = 0;
    softest_ = 1;
    for (const double value : values_) {
      negative_ += value < -least_ ? 1 : 0;
      null_ += std::abs(value) <= least_ ? 1 : 0;
      if (std::abs(value) > least_) softest_ = std::min(softest_, std::abs(value) / largest);
    }
    pattern_ = solved(path_.pattern);
    if (path_.dead) {
      dead_ = solved(*path_.dead);
    } else {
      dead_.normal.assign(broken_.size(), 0.0);
      dead_.tangential.assign(broken_.size(), 0.0);
    }
    if (force_ > 0) return;
    for (std::size_t c = 0; c < broken_.size(); ++c) {
      force_ = std::max({force_, std::abs(pattern_.normal[c]), std::abs(pattern_.tangential[c])});
      dead_force_ = std::max({dead_force_, std::abs(dead_.normal[c]), std::abs(dead_.tangential[c])});
    }
  }
  State solved(const RightHandSide& given) const {
    const std::size_t n = unknowns_.held.size();
    State state;
    state.motion.assign(n, 0.0);
    for (std::size_t p = 0; p < n; ++p) {
      if (unknowns_.held[p] != 0 && !given.prescribed.empty()) state.motion[p] = given.prescribed[p];
    }
    std::vector<double> f(n, 0.0), normal, slip;
    double load = 0;
    for (std::size_t c = 0; c < broken_.size(); ++c) {
      if (broken_[c]) continue;
      contact_rows(assembly_, unknowns_, c, normal, slip);
      const auto [dn, ds] = stretch(c, state.motion, given);
      for (std::size_t p = 0; p < n; ++p) f[p] -= springs_[c].kN * dn * normal[p] + springs_[c].kT * ds * slip[p];
    }
    for (std::size_t p = 0; p < n; ++p) {
      if (unknowns_.held[p] != 0) {
        f[p] = 0;
      } else if (!given.force.empty()) {
        f[p] += given.force[p];
        load += given.force[p] * given.force[p];
      }
    }
    for (std::size_t m = 0; m < n; ++m) {
      double part = 0;
      for (std::size_t p = 0; p < n; ++p) part += vectors_[p * n + m] * f[p];
      if (std::abs(values_[m]) <= least_) {
        if (std::abs(part) > 1e-8 * std::sqrt(load) && load > 0) state.carried = false;
        continue;
      }
      for (std::size_t p = 0; p < n; ++p) state.motion[p] += part / values_[m] * vectors_[p * n + m];
    }
    state.normal.assign(broken_.size(), 0.0);
    state.tangential.assign(broken_.size(), 0.0);
    for (std::size_t c = 0; c < broken_.size(); ++c) {
      if (broken_[c]) continue;
      const auto [dn, ds] = stretch(c, state.motion, given);
      state.normal[c] = springs_[c].kN * dn;
      state.tangential[c] = springs_[c].kT * ds;
    }
    return state;
  }

  const Assembly& assembly_;
  const ContactSprings& springs_;
  const ContactStrengths& strengths_;
  const LoadPath& path_;
  const DegreesOfFreedom& unknowns_;
  std::vector<bool> broken_;
  std::vector<double> values_, vectors_;
  double least_ = 0, softest_ = 1, force_ = 0, dead_force_ = 0;
  int negative_ = 0, null_ = 0;
  State pattern_, dead_;
};

}  // namespace equidem::test
