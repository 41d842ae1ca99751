// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rate problems of contacts on their limits: as the library solves them, and by all combinations of statuses.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/breakage/unbonded/limit_compliance.hpp"
#include "equidem/breakage/unbonded/rate_branches.hpp"
#include "equidem/breakage/unbonded/rate_search.hpp"
#include "equidem/breakage/unbonded/unique_rates.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/core/random.hpp"
#include "equidem/statics/number_unknowns.hpp"

#include "breakage/dense_network.hpp"

namespace equidem::test {

/// A network with contacts on limits, to be loaded at will.
class LimitNetwork {
 public:
  LimitNetwork(Assembly assembly, ContactSprings springs, std::vector<Support> supports, double friction)
      : assembly_(std::move(assembly)),
        springs_(std::move(springs)),
        unknowns_(
            number_unknowns(assembly_, springs_, derive_effects(assembly_, springs_, Rotation::from_scene), supports)),
        contacts_(assembly_, unknowns_),
        solver_(contacts_, 1e-9 * springs_.largest()),
        status_(assembly_.contacts.size(), ContactStatus::stuck) {
    for (std::size_t c = 0; c < assembly_.contacts.size(); ++c) laws_.push_back({springs_[c], friction, {}});
  }

  LimitNetwork(const LimitNetwork&) = delete;
  LimitNetwork& operator=(const LimitNetwork&) = delete;

  void open(std::size_t contact) { status_[contact] = ContactStatus::open; }
  void bond(std::size_t contact) { status_[contact] = ContactStatus::bonded; }
  void limit(LimitContact at) { limits_.push_back(at); }
  [[nodiscard]] const Assembly& assembly() const { return assembly_; }
  [[nodiscard]] const DegreesOfFreedom& unknowns() const { return unknowns_; }
  [[nodiscard]] const std::vector<UnbondedLaw>& laws() const { return laws_; }
  [[nodiscard]] const std::vector<LimitContact>& limits() const { return limits_; }
  [[nodiscard]] const std::vector<ContactStatus>& status() const { return status_; }
  [[nodiscard]] std::size_t contacts() const { return laws_.size(); }
  [[nodiscard]] std::size_t components() const { return contacts_.components(); }

  struct Answers {
    bool found = false, proved = false;
    Branches branches{};
    std::int64_t tried = 0;  ///< RateSearch::tried
  };
  Answers load(std::vector<double> force) {
    const RightHandSide pattern{.force = std::move(force), .prescribed = std::vector<double>(components(), 0.0)};
    const RateProblem problem{contacts_, laws_, limits_, {.pattern = &pattern, .rate = 1}};
    const RateSearch search = search_rates(problem, solver_, status_);
    if (!search.found) return {.tried = search.tried};
    const RateAnswer& answer = search.answer;
    const std::vector<double> compliance = limit_compliance(problem, solver_);
    return {true, proved_unique(problem, compliance, answer.status), find_branches(problem, compliance, answer, {})};
  }

 private:
  Assembly assembly_;
  ContactSprings springs_;
  DegreesOfFreedom unknowns_;
  ContactOperator contacts_;
  TangentSolver solver_;
  std::vector<UnbondedLaw> laws_;
  std::vector<LimitContact> limits_;
  std::vector<ContactStatus> status_;
};

/// Nine discs of which the lowest are held, with up to `most` contacts on limits, `apex` of them without a force.
/// \param kinds shares of open contacts and of bonds, and of contacts off their limits or either
inline std::unique_ptr<LimitNetwork> random_limit_network(std::uint64_t seed, Random& random, double friction,
                                                          std::size_t most = 5, double apex = 0.3,
                                                          std::array<double, 3> kinds = {0.12, 0.3, 0.7}) {
  const Assembly assembly = delaunay_assembly({.discs = 9,
                                               .points = PointProcess::perturbed_hexagonal,
                                               .disorder = 0.25,
                                               .seed = seed,
                                               .radii = {.smallest = 0.5, .largest = 0.5}});
  std::vector<SpringConstants> springs;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c)
    springs.push_back({random.uniform(0.5, 2), random.uniform(0.1, 1)});
  auto made = std::make_unique<LimitNetwork>(assembly, ContactSprings(std::move(springs)),
                                             std::vector<Support>{{"bottom", 0, 0, {}}}, friction);
  LimitNetwork& network = *made;
  for (std::size_t c = 0; c < network.contacts(); ++c) {
    const double kind = random.uniform(0, 1);
    if (kind < kinds[0]) network.open(c);
    if (kind > kinds[0] && kind < kinds[1]) network.bond(c);
    if (kind < kinds[2] || network.limits().size() == most) continue;
    const bool at_apex = random.uniform(0, 1) < apex;
    network.limit({c, at_apex ? OnLimit::apex : OnLimit::friction, random.uniform(-1, 1) < 0 ? -1.0 : 1.0});
  }
  return made;
}

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
    std::vector<double> u;
    count.carried = solve(status, force, u);
    std::vector<std::size_t> digit(limits.size(), 0);
    while (true) {
      ++count.tried;
      for (std::size_t k = 0; k < digit.size(); ++k) status[limits[k].contact] = choice(limits[k], digit[k]);
      if (solve(status, force, u) && agrees(status, u)) ++count.answers;
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

  /// The least motion u with K u = f. \return false where there is none
  bool solve(const std::vector<ContactStatus>& status, const std::vector<double>& force, std::vector<double>& u) const {
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
      if (std::abs(b[r]) > 1e-7) return false;
    u.assign(n, 0.0);
    for (std::size_t r = 0; r < rank; ++r) u[order[r]] = b[r] / k[r * n + order[r]];
    // Less its part along motions that nothing resists.
    std::vector<std::vector<double>> free;
    for (std::size_t c = rank; c < n; ++c) {
      std::vector<double> motion(n, 0.0);
      motion[order[c]] = 1;
      for (std::size_t r = 0; r < rank; ++r) motion[order[r]] = -k[r * n + order[c]] / k[r * n + order[r]];
      for (const auto& other : free) add(motion, -product(motion, other), other);
      const double size = std::sqrt(product(motion, motion));
      for (double& x : motion) x /= size;
      free.push_back(std::move(motion));
    }
    for (const auto& motion : free) add(u, -product(u, motion), motion);
    return true;
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
