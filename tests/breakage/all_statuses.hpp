// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rate problems of contacts on their limits by all combinations of statuses of the whole network.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "breakage/dense_network.hpp"
#include "breakage/limit_network.hpp"

namespace equidem::test {

/// All combinations of the statuses of contacts on limits, by elimination with full pivots.
class AllStatuses {
 public:
  explicit AllStatuses(const LimitNetwork& network) : network_(network), rows_(network.contacts()) {
    for (std::size_t c = 0; c < rows_.size(); ++c)
      contact_rows(network.assembly(), network.unknowns(), c, rows_[c].first, rows_[c].second);
  }

  struct Count {
    std::int64_t tried = 0, answers = 0;
    bool carried = false;  ///< by the network in which all contacts on limits stick
  };
  [[nodiscard]] Count under(const std::vector<double>& force) const {
    Count count;
    std::vector<ContactStatus> status = network_.status();
    const auto& limits = network_.limits();
    for (const LimitContact& at : limits) status[at.contact] = ContactStatus::stuck;
    count.carried = solve(status, force).has_value();
    std::vector<std::size_t> digit(limits.size(), 0);
    while (true) {
      ++count.tried;
      for (std::size_t k = 0; k < digit.size(); ++k) status[limits[k].contact] = choice(limits[k], digit[k]);
      if (const auto solution = solve(status, force)) count.answers += agrees(status, *solution) ? 1 : 0;
      std::size_t k = 0;
      while (k < digit.size() && ++digit[k] == (limits[k].limit == OnLimit::apex ? 4 : 2)) digit[k++] = 0;
      if (k == digit.size()) return count;
    }
  }

 private:
  static ContactStatus choice(const LimitContact& at, std::size_t digit) {
    using enum ContactStatus;
    if (at.limit == OnLimit::friction) return digit == 0 ? stuck : slipping(at.direction);
    return std::array{stuck, open, slips_forward, slips_backward}[digit];
  }

  /// The least u with K u = f.
  [[nodiscard]] std::optional<std::vector<double>> solve(const std::vector<ContactStatus>& status,
                                                         const std::vector<double>& force) const {
    const auto& held = network_.unknowns().held;
    const std::size_t n = held.size();
    std::vector<double> k(n * n, 0.0), b(n);
    for (std::size_t c = 0; c < rows_.size(); ++c) {
      const ContactTangent a = network_.laws()[c].tangent(status[c]);
      const auto& [g, h] = rows_[c];
      for (std::size_t p = 0; p < n; ++p) {
        for (std::size_t q = 0; q < n && held[p] == 0; ++q)
          k[p * n + q] += held[q] == 0 ? g[p] * a.nn * g[q] + h[p] * (a.tn * g[q] + a.tt * h[q]) : 0;
      }
    }
    for (std::size_t p = 0; p < n; ++p) b[p] = held[p] == 0 ? force[p] : 0;
    // Elimination: row r has its pivot in column order[r].
    constexpr double none = 1e-9;
    std::vector<std::size_t> order(n);
    for (std::size_t p = 0; p < n; ++p) order[p] = p;
    std::size_t rank = 0;
    for (; rank < n; ++rank) {
      std::size_t row = rank, column = rank;
      for (std::size_t r = rank; r < n; ++r) {
        for (std::size_t c = rank; c < n; ++c)
          if (std::abs(k[r * n + order[c]]) > std::abs(k[row * n + order[column]])) row = r, column = c;
      }
      if (std::abs(k[row * n + order[column]]) < none) break;
      std::swap(order[rank], order[column]);
      for (std::size_t c = 0; c < n; ++c) std::swap(k[rank * n + c], k[row * n + c]);
      std::swap(b[rank], b[row]);
      for (std::size_t r = 0; r < n; ++r) {
        const double factor = k[r * n + order[rank]] / k[rank * n + order[rank]];
        if (r == rank || factor == 0) continue;
        for (std::size_t c = 0; c < n; ++c) k[r * n + c] -= factor * k[rank * n + c];
        b[r] -= factor * b[rank];
      }
    }
    for (std::size_t r = rank; r < n; ++r)
      if (std::abs(b[r]) > 1e-7) return {};
    std::vector<double> u(n, 0.0);
    std::vector<std::vector<double>> free;  // orthonormal motions that nothing resists
    for (std::size_t r = 0; r < rank; ++r) u[order[r]] = b[r] / k[r * n + order[r]];
    // Less its part along motions that nothing resists.
    for (std::size_t c = rank; c < n; ++c) {
      if (held[order[c]] != 0) continue;
      std::vector<double> motion(n, 0.0);
      motion[order[c]] = 1;
      for (std::size_t r = 0; r < rank; ++r) motion[order[r]] = -k[r * n + order[c]] / k[r * n + order[r]];
      for (const auto& other : free) add(motion, -product(motion, other), other);
      const double size = std::sqrt(product(motion, motion));
      for (double& x : motion) x /= size;
      free.push_back(std::move(motion));
    }
    for (const auto& motion : free) add(u, -product(u, motion), motion);
    return u;
  }
  static double product(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
    return sum;
  }
  static void add(std::vector<double>& a, double by, const std::vector<double>& b) {
    for (std::size_t k = 0; k < a.size(); ++k) a[k] += by * b[k];
  }

  [[nodiscard]] bool agrees(const std::vector<ContactStatus>& status, const std::vector<double>& u) const {
    double largest = 0;
    for (const double x : u) largest = std::max(largest, std::abs(x));
    for (const LimitContact& at : network_.limits()) {
      const UnbondedLaw& law = network_.laws()[at.contact];
      const double n = law.k.kN * product(rows_[at.contact].first, u),
                   t = law.k.kT * product(rows_[at.contact].second, u), none = 1e-9 * largest;
      const ContactStatus now = status[at.contact];
      if (at.limit == OnLimit::friction) {
        const double beyond = at.direction * t + law.friction * n;
        if (now == ContactStatus::stuck ? beyond > none : beyond < -none) return false;
        continue;
      }
      if (now == ContactStatus::open ? n < -none : n > none) return false;
      if (now == ContactStatus::stuck && std::abs(t) + law.friction * n > none) return false;
      if (is_slipping(now) && direction_of(now) * t + law.friction * n < -none) return false;
    }
    return true;
  }

  const LimitNetwork& network_;
  std::vector<std::pair<std::vector<double>, std::vector<double>>> rows_;
};

}  // namespace equidem::test
