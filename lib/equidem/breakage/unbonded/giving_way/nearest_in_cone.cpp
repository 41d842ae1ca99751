// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/giving_way/nearest_in_cone.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace equidem {
namespace {

constexpr double dependent = 1e-8;  // of a vector: what is left of it beside others is round-off

double scalar_product(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

double norm_of(std::span<const double> a) {
  return std::sqrt(scalar_product(a, a));
}

/// Vectors one after another as Q R, by the Gram-Schmidt process, twice.
class Orthogonal {
 public:
  /// \return false where the vector depends on those that are in
  bool add(std::span<const double> a) {
    const double whole = norm_of(a);
    std::vector<double> rest(a.begin(), a.end()), column(q_.size() + 1, 0.0);
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t k = 0; k < q_.size(); ++k) {
        const double along = scalar_product(q_[k], rest);
        column[k] += along;
        for (std::size_t m = 0; m < rest.size(); ++m) rest[m] -= along * q_[k][m];
      }
    }
    const double left = norm_of(rest);
    if (!(left > dependent * whole)) return false;
    for (double& x : rest) x /= left;
    column.back() = left;
    q_.push_back(std::move(rest));
    r_.push_back(std::move(column));
    return true;
  }
  void keep(std::size_t count) {
    q_.resize(count);
    r_.resize(count);
  }
  /// x less its part along the vectors.
  void leave_rest(std::vector<double>& x) const {
    for (int pass = 0; pass < 2; ++pass) {
      for (const std::vector<double>& q : q_) {
        const double along = scalar_product(q, x);
        for (std::size_t m = 0; m < x.size(); ++m) x[m] -= along * q[m];
      }
    }
  }
  /// The factors of the vectors whose sum is nearest to f.
  [[nodiscard]] std::vector<double> factors(std::span<const double> f) const {
    std::vector<double> x(q_.size());
    for (std::size_t k = x.size(); k-- > 0;) {
      double sum = scalar_product(q_[k], f);
      for (std::size_t j = k + 1; j < x.size(); ++j) sum -= r_[j][k] * x[j];
      x[k] = sum / r_[k][k];
    }
    return x;
  }

 private:
  std::vector<std::vector<double>> q_, r_;  // by columns
};

/// The edges with x > 0, and their x.
class ActiveEdges {
 public:
  ActiveEdges(std::span<const std::vector<double>> edges, std::span<const double> f)
      : edges_(edges), f_(f), in_(edges.size(), 0) {}

  /// Takes the edge in, and others out until all x are positive.
  /// \return false where it depends on those that are in
  bool enter(std::size_t edge) {
    if (!basis_.add(edges_[edge])) return false;
    active_.push_back(edge);
    x_.push_back(0);
    in_[edge] = 1;
    for (;;) {
      const std::vector<double> wanted = basis_.factors(f_);
      double way = 1;
      for (std::size_t k = 0; k < x_.size(); ++k)
        if (wanted[k] <= 0) way = std::min(way, x_[k] / (x_[k] - wanted[k]));
      if (std::ranges::all_of(wanted, [](double x) { return x > 0; })) {
        x_ = wanted;
        return true;
      }
      std::size_t first = x_.size(), kept = 0;
      const std::vector<std::size_t> before = active_;
      for (std::size_t k = 0; k < before.size(); ++k) {
        const double x = x_[k] + way * (wanted[k] - x_[k]);
        const bool leaves = wanted[k] <= 0 && x_[k] <= way * (x_[k] - wanted[k]) * (1 + 1e-12);
        if (leaves) {
          in_[before[k]] = 0;
          first = std::min(first, k);
          continue;
        }
        active_[kept] = before[k];
        x_[kept++] = std::max(x, 0.0);
      }
      if (kept == before.size()) return false;
      active_.resize(kept);
      x_.resize(kept);
      basis_.keep(first);
      for (std::size_t k = first; k < active_.size(); ++k) basis_.add(edges_[active_[k]]);
    }
  }
  [[nodiscard]] bool holds(std::size_t edge) const { return in_[edge] != 0; }
  [[nodiscard]] std::vector<double> remainder() const {
    std::vector<double> r(f_.begin(), f_.end());
    basis_.leave_rest(r);
    return r;
  }

 private:
  std::span<const std::vector<double>> edges_;
  std::span<const double> f_;
  Orthogonal basis_;
  std::vector<std::size_t> active_;
  std::vector<double> x_;
  std::vector<char> in_;
};

void scale_to_one(std::vector<double>& x) {
  const double whole = norm_of(x);
  for (double& a : x) a = whole > 0 ? a / whole : 0;
}

}  // namespace

ConeRemainder remainder_outside(Cone cone, std::span<const double> f) {
  for (std::vector<double>& line : cone.lines) scale_to_one(line);
  for (std::vector<double>& edge : cone.edges) scale_to_one(edge);
  Orthogonal lines;
  for (const std::vector<double>& line : cone.lines) lines.add(line);
  std::vector<double> beside(f.begin(), f.end());
  lines.leave_rest(beside);
  // Edges beside the lines.
  std::vector<std::vector<double>> edges;
  for (const std::vector<double>& edge : cone.edges) {
    std::vector<double> rest = edge;
    lines.leave_rest(rest);
    if (norm_of(rest) > dependent) edges.push_back(std::move(rest));
  }
  const double whole = norm_of(f);
  ActiveEdges active(edges, beside);
  ConeRemainder result{beside};
  std::vector<char> refused(edges.size(), 0);
  for (std::size_t k = 0; k < 100 + 10 * edges.size(); ++k) {
    std::size_t best = edges.size();
    double most = 1e-12 * whole;
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (active.holds(e) || refused[e] != 0) continue;
      const double along = scalar_product(edges[e], result.remainder) / norm_of(edges[e]);
      if (along > most) most = along, best = e;
    }
    if (best == edges.size()) break;
    if (active.enter(best)) std::ranges::fill(refused, 0);
    refused[best] = active.holds(best) ? 0 : 1;
    result.remainder = active.remainder();
  }
  const double left = norm_of(result.remainder);
  result.share = whole > 0 ? left / whole : 0;
  for (const std::vector<double>& edge : cone.edges)
    result.beyond = std::max(result.beyond, left > 0 ? scalar_product(edge, result.remainder) / left : 0);
  for (const std::vector<double>& line : cone.lines)
    result.beyond = std::max(result.beyond, left > 0 ? std::abs(scalar_product(line, result.remainder)) / left : 0);
  return result;
}

}  // namespace equidem
