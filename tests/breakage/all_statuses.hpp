// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rate problems of contacts on their limits by all combinations of statuses of the whole network.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
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
    /// Forces of contacts on limits, of answers that differ, motions that nothing resists included; those of
    /// combinations that hold within round-off only are apart.
    std::vector<std::vector<ContactForce>> forces{}, ties{};
    std::int64_t by_free_motions = 0;  ///< answers that the least motion alone is not
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
      if (const auto solution = solve(status, force)) {
        const bool least = agrees(status, solution->u);
        count.answers += least ? 1 : 0;
        add_forces(status, *solution, least, count);
      }
      std::size_t k = 0;
      while (k < digit.size() && ++digit[k] == (limits[k].limit == OnLimit::apex ? 4 : 2)) digit[k++] = 0;
      if (k == digit.size()) return count;
    }
  }

 private:
  struct Motions {
    std::vector<double> u;                  // the least with K u = f
    std::vector<std::vector<double>> free;  // orthonormal motions that nothing resists
  };

  static ContactStatus choice(const LimitContact& at, std::size_t digit) {
    using enum ContactStatus;
    if (at.limit == OnLimit::friction) return digit == 0 ? stuck : slipping(at.direction);
    return std::array{stuck, open, slips_forward, slips_backward}[digit];
  }

  /// Quantities of a contact on a limit that must not be negative in this status, as rows of a motion.
  [[nodiscard]] std::vector<std::vector<double>> rows_to_hold(const LimitContact& at, ContactStatus now) const {
    const UnbondedLaw& law = network_.laws()[at.contact];
    const auto& [g, h] = rows_[at.contact];
    const double mu = law.friction;
    const auto row = [&](double n, double t) {
      std::vector<double> sum(g.size());
      for (std::size_t k = 0; k < g.size(); ++k) sum[k] = n * law.k.kN * g[k] + t * law.k.kT * h[k];
      return sum;
    };
    const bool apex = at.limit == OnLimit::apex;
    if (now == ContactStatus::open) return {row(1, 0)};
    if (is_slipping(now)) {
      std::vector<std::vector<double>> rows{row(mu, direction_of(now))};
      if (apex) rows.push_back(row(-1, 0));
      return rows;
    }
    if (!apex) return {row(-mu, -at.direction)};
    return {row(-1, 0), row(-mu, 1), row(-mu, -1)};
  }

  /// Whether some x has g + h x >= least: then a vertex has, where no x leaves all h x as they are.
  static bool hold(const std::vector<double>& g, const std::vector<std::vector<double>>& h, double least) {
    const std::size_t d = h.empty() ? 0 : h.front().size();
    std::vector<std::size_t> chosen(d);
    const std::function<bool(std::size_t, std::size_t)> choose = [&](std::size_t k, std::size_t from) {
      if (k == d) {
        std::vector<double> x(d, 0.0);
        Dense system(d);
        for (std::size_t r = 0; r < d; ++r) {
          for (std::size_t c = 0; c < d; ++c) system.a[r * d + c] = h[chosen[r]][c];
          system.b[r] = least - g[chosen[r]];
        }
        if (!system.solve(x)) return false;
        for (std::size_t r = 0; r < g.size(); ++r)
          if (g[r] + product(h[r], x) < least - 1e-12) return false;
        return true;
      }
      for (std::size_t r = from; r < g.size(); ++r) {
        chosen[k] = r;
        if (choose(k + 1, r + 1)) return true;
      }
      return false;
    };
    return choose(0, 0);
  }

  void add_forces(const std::vector<ContactStatus>& status, const Motions& solution, bool least, Count& count) const {
    const auto& [u, free] = solution;
    std::vector<ContactForce> forces;
    double largest = 0;
    for (const double x : u) largest = std::max(largest, std::abs(x));
    for (const LimitContact& at : network_.limits()) {
      const auto& [g, h] = rows_[at.contact];
      forces.push_back(network_.laws()[at.contact].tangent(status[at.contact]).rate({product(g, u), product(h, u)}));
    }
    if (is_known(count.forces, forces, largest)) return;
    const double none = 1e-9 * std::max(largest, 1.0);
    std::vector<double> g;
    std::vector<std::vector<double>> h;
    std::size_t place = 0;
    for (const LimitContact& at : network_.limits()) {
      std::vector<double> values;
      std::vector<std::vector<double>> slopes;
      for (const auto& row : rows_to_hold(at, status[at.contact])) {
        values.push_back(product(row, u));
        slopes.emplace_back();
        for (const auto& motion : free) slopes.back().push_back(product(row, motion));
      }
      // A contact without a force that neither opens nor carries holds with every status, however it slips.
      const auto& opens = rows_[at.contact].first;
      const bool rests = std::abs(product(opens, u)) < none && std::abs(forces[place].tangential) < none &&
                         std::ranges::all_of(free, [&](const auto& m) { return std::abs(product(opens, m)) < 1e-9; });
      const bool still = std::ranges::all_of(values, [&](double x) { return std::abs(x) < none; }) &&
                         std::ranges::all_of(slopes, [](const auto& slope) { return size_of(slope) < 1e-9; });
      ++place;
      if (rests && (still || at.limit == OnLimit::apex)) continue;
      g.insert(g.end(), values.begin(), values.end());
      h.insert(h.end(), slopes.begin(), slopes.end());
    }
    const std::vector<std::vector<double>> reduced = without_idle(h);
    if (hold(g, reduced, 10 * none)) {
      count.forces.push_back(std::move(forces));
      count.by_free_motions += least ? 0 : 1;
      std::erase_if(count.ties, [&](const auto& tie) { return is_known({count.forces.back()}, tie, largest); });
    } else if (hold(g, reduced, -10 * none)) {
      count.ties.push_back(std::move(forces));
    }
  }
  static bool is_known(const std::vector<std::vector<ContactForce>>& known, const std::vector<ContactForce>& forces,
                       double largest) {
    return std::ranges::any_of(known, [&](const auto& other) {
      for (std::size_t k = 0; k < forces.size(); ++k) {
        if (std::abs(forces[k].normal - other[k].normal) > 1e-6 * largest) return false;
        if (std::abs(forces[k].tangential - other[k].tangential) > 1e-6 * largest) return false;
      }
      return true;
    });
  }
  static double size_of(const std::vector<double>& x) { return std::sqrt(product(x, x)); }

  /// Columns that span those of h.
  static std::vector<std::vector<double>> without_idle(const std::vector<std::vector<double>>& h) {
    std::vector<std::vector<double>> columns, reduced(h.size());
    for (std::size_t c = 0; !h.empty() && c < h.front().size(); ++c) {
      std::vector<double> column(h.size());
      for (std::size_t r = 0; r < h.size(); ++r) column[r] = h[r][c];
      for (int twice = 0; twice < 2; ++twice)
        for (const auto& other : columns) add(column, -product(column, other), other);
      const double size = size_of(column);
      if (size < 1e-9) continue;
      for (double& x : column) x /= size;
      columns.push_back(std::move(column));
    }
    for (const auto& column : columns)
      for (std::size_t r = 0; r < h.size(); ++r) reduced[r].push_back(column[r]);
    return reduced;
  }

  /// A small system, by elimination with row pivots.
  struct Dense {
    std::vector<double> a, b;
    explicit Dense(std::size_t n) : a(n * n), b(n) {}
    /// \return false where it is singular
    bool solve(std::vector<double>& x) {
      const std::size_t n = b.size();
      for (std::size_t k = 0; k < n; ++k) {
        std::size_t p = k;
        for (std::size_t r = k; r < n; ++r)
          if (std::abs(a[r * n + k]) > std::abs(a[p * n + k])) p = r;
        if (std::abs(a[p * n + k]) < 1e-9) return false;
        for (std::size_t c = 0; c < n; ++c) std::swap(a[k * n + c], a[p * n + c]);
        std::swap(b[k], b[p]);
        for (std::size_t r = 0; r < n; ++r) {
          const double f = a[r * n + k] / a[k * n + k];
          if (r == k) continue;
          for (std::size_t c = 0; c < n; ++c) a[r * n + c] -= f * a[k * n + c];
          b[r] -= f * b[k];
        }
      }
      for (std::size_t k = 0; k < n; ++k) x[k] = b[k] / a[k * n + k];
      return true;
    }
  };

  [[nodiscard]] std::optional<Motions> solve(const std::vector<ContactStatus>& status,
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
    Motions solution{std::vector<double>(n, 0.0), {}};
    auto& [u, free] = solution;
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
    return solution;
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
