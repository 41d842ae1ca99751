// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/unique_rates.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/breakage/unbonded/dense_lu.hpp"

namespace equidem {
namespace {

constexpr double least_share = 1e-8;  // of a spring: entries of S and pivots below are round-off

/// The network as the contacts on limits feel it, C = G K^-1 G^T: their deformations, row by row, by unit pairs of
/// forces at them, 2 rows and columns a contact: stretch and slip. Where the driving prescribes a motion it is kept.
std::vector<double> limit_compliance(const RateProblem& problem, const TangentSolver& solver) {
  const ContactOperator& contacts = problem.contacts;
  const auto& held = contacts.unknowns().held;
  const std::vector<double>& load = problem.driving.pattern->force;
  const std::size_t m = problem.limits.size(), n = 2 * m;
  std::vector<double> c(n * n), along;
  const auto dot = [&](std::span<const double> x) {
    double sum = 0;
    for (std::size_t k = 0; k < x.size(); ++k) sum += load[k] * x[k];
    return sum;
  };
  const auto solve = [&](std::vector<double>& x) {
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = held[k] != 0 ? 0 : x[k];
    solver.solve(x);
  };
  if (problem.driving.by_motion) solve(along = load);
  for (std::size_t q = 0; q < n; ++q) {
    std::vector<double> z(contacts.components(), 0.0);
    contacts.add_internal(problem.limits[q / 2].contact, q % 2 == 0 ? ContactForce{1, 0} : ContactForce{0, 1}, z);
    solve(z);
    if (problem.driving.by_motion) {
      const double by = dot(z) / dot(along);
      for (std::size_t k = 0; k < z.size(); ++k) z[k] -= by * along[k];
    }
    for (std::size_t p = 0; p < m; ++p) {
      const ContactDeformation d = contacts.deformation(problem.limits[p].contact, z);
      c[2 * p * n + q] = d.normal;
      c[(2 * p + 1) * n + q] = d.tangential;
    }
  }
  return c;
}

/// The tangent of a contact that sticks.
ContactTangent sticking(const RateProblem& problem, std::size_t place) {
  return problem.laws[problem.limits[place].contact].tangent(ContactStatus::stuck);
}

/// S, 2 rows and columns a contact; empty where it is not determined.
std::vector<double> schur_complement(const RateProblem& problem, std::span<const double> c,
                                     std::span<const ContactStatus> status) {
  const std::size_t m = problem.limits.size(), n = 2 * m;
  // C_s = (I + C (B - A))^-1 C
  std::vector<double> system(n * n, 0.0), column(n);
  for (std::size_t r = 0; r < n; ++r) {
    system[r * n + r] = 1;
    for (std::size_t k = 0; k < m; ++k) {
      const std::size_t contact = problem.limits[k].contact, q = 2 * k;
      const ContactTangent now = problem.laws[contact].tangent(status[contact]), b = sticking(problem, k);
      system[r * n + q] += c[r * n + q] * (b.nn - now.nn) - c[r * n + q + 1] * now.tn;
      system[r * n + q + 1] += c[r * n + q + 1] * (b.tt - now.tt);
    }
  }
  std::vector<std::size_t> pivots;
  if (factorize_dense(system, pivots) < least_share) return {};
  const auto spring = [&](std::size_t row) {
    const ContactTangent b = sticking(problem, row / 2);
    return row % 2 == 0 ? b.nn : b.tt;
  };
  std::vector<double> s(n * n, 0.0);
  for (std::size_t q = 0; q < n; ++q) {
    for (std::size_t r = 0; r < n; ++r) column[r] = c[r * n + q];
    solve_dense(system, pivots, column);
    for (std::size_t r = 0; r < n; ++r) s[r * n + q] = (r == q ? spring(r) : 0) - spring(r) * column[r] * spring(q);
  }
  return s;
}

/// Whether all pivots of a symmetric n x n matrix, its lower half given, are above a limit.
bool is_positive_definite(std::vector<double>& a, std::size_t n, double least) {
  for (std::size_t k = 0; k < n; ++k) {
    double* const row = &a[k * n];
    for (std::size_t c = 0; c < k; ++c) {
      double sum = row[c];
      for (std::size_t p = 0; p < c; ++p) sum -= row[p] * a[c * n + p];
      row[c] = sum / a[c * n + c];
      row[k] -= row[c] * row[c];
    }
    if (!(row[k] > least)) return false;
    row[k] = std::sqrt(row[k]);
  }
  return true;
}

}  // namespace

bool proved_unique(const RateProblem& problem, const TangentSolver& solver, std::span<const ContactStatus> status) {
  const std::size_t m = problem.limits.size(), n = 2 * m;
  if (m == 0) return true;
  const std::vector<double> s = schur_complement(problem, limit_compliance(problem, solver), status);
  if (s.empty()) return false;
  struct Unknown {
    std::size_t row;  // of S
    double along;     // mu theta of a slip, 0 of an opening
    double alpha;     // of a slip whose theta is not known, else 0
  };
  std::vector<Unknown> unknowns;
  // Loose parts are held by a share of the stiffest spring of the network (tangent_solver.hpp).
  double stiffest = 0;
  for (const UnbondedLaw& law : problem.laws) stiffest = std::max({stiffest, law.k.kN, law.k.kT});
  const double least = least_share * stiffest;
  bool coupled = false;  // a row without resistance of its own is part of others
  const auto add = [&](std::size_t row, double along, double alpha) {
    if (s[row * n + row] > least) {
      unknowns.push_back({row, along, alpha});
      return;
    }
    for (std::size_t q = 0; q < n; ++q)
      coupled = coupled || std::abs(s[row * n + q]) > least || std::abs(s[q * n + row]) > least;
  };
  for (std::size_t k = 0; k < m; ++k) {
    const LimitContact& at = problem.limits[k];
    const UnbondedLaw& law = problem.laws[at.contact];
    const std::size_t normal = 2 * k, tangential = normal + 1;
    if (at.limit == OnLimit::apex) add(normal, 0, 0);
    if (!law.rough()) continue;
    const double s_nn = s[normal * n + normal], s_tt = s[tangential * n + tangential];
    if (at.limit == OnLimit::apex) {
      add(tangential, 0, std::sqrt(std::max(s_nn * s_tt, 0.0)));
    } else {
      add(tangential, law.friction * at.direction, 0);
    }
  }
  if (coupled) return false;
  const std::size_t u = unknowns.size();
  const auto product = [&](const Unknown& p, const Unknown& q) {
    return s[p.row * n + q.row] + (p.along != 0 ? p.along * s[(p.row - 1) * n + q.row] : 0);
  };
  std::vector<double> a(u * u, 0.0), r(u);
  for (std::size_t p = 0; p < u; ++p) {
    for (std::size_t q = 0; q <= p; ++q)
      a[p * u + q] = 0.5 * (product(unknowns[p], unknowns[q]) + product(unknowns[q], unknowns[p]));
  }
  for (std::size_t k = 0; k < u; ++k) {
    const double alpha = unknowns[k].alpha;
    if (alpha == 0) continue;
    const double mu = problem.laws[problem.limits[unknowns[k].row / 2].contact].friction;
    for (std::size_t q = 0; q < u; ++q) r[q] = s[(unknowns[k].row - 1) * n + unknowns[q].row];
    a[k * u + k] -= 0.5 * mu * alpha;
    for (std::size_t p = 0; p < u; ++p) {
      for (std::size_t q = 0; q <= p; ++q) a[p * u + q] -= 0.5 * mu / alpha * r[p] * r[q];
    }
  }
  return is_positive_definite(a, u, least);
}

}  // namespace equidem
