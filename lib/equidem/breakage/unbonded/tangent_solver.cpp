// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/tangent_solver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/linear/umfpack_factorization.hpp"

namespace equidem {
namespace {

constexpr std::size_t most_changed = 32;  // contacts, after which a new factorization is cheaper
constexpr double least_pivot = 1e-7;      // of the capacity matrix: below, too few digits are left

/// The rate of force beyond that of the base.
ContactForce beyond(const ContactTangent& a, const ContactTangent& base, const ContactDeformation& d) {
  return ContactTangent{a.nn - base.nn, a.tn - base.tn, a.tt - base.tt}.rate(d);
}

/// L U of a square matrix, row-major, in its place.
/// \return the least pivot over the largest entry of the matrix; 0: it is singular
double factorize_dense(std::span<double> a, std::vector<std::size_t>& pivots) {
  const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(a.size()))));
  pivots.resize(n);
  double largest = 0, least = 1;
  for (const double x : a) largest = std::max(largest, std::abs(x));
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t p = k;
    for (std::size_t r = k + 1; r < n; ++r) {
      if (std::abs(a[r * n + k]) > std::abs(a[p * n + k])) p = r;
    }
    pivots[k] = p;
    const double pivot = a[p * n + k];
    if (!(std::abs(pivot) > 0)) return 0;
    least = std::min(least, std::abs(pivot) / largest);
    for (std::size_t c = 0; c < n && p != k; ++c) std::swap(a[k * n + c], a[p * n + c]);
    for (std::size_t r = k + 1; r < n; ++r) {
      const double factor = a[r * n + k] /= pivot;
      for (std::size_t c = k + 1; c < n && factor != 0; ++c) a[r * n + c] -= factor * a[k * n + c];
    }
  }
  return least;
}

void solve_dense(std::span<const double> lu, std::span<const std::size_t> pivots, std::span<double> x) {
  const std::size_t n = pivots.size();
  for (std::size_t k = 0; k < n; ++k) std::swap(x[k], x[pivots[k]]);
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t c = 0; c < r; ++c) x[r] -= lu[r * n + c] * x[c];
  }
  for (std::size_t r = n; r-- > 0;) {
    for (std::size_t c = r + 1; c < n; ++c) x[r] -= lu[r * n + c] * x[c];
    x[r] /= lu[r * n + r];
  }
}

}  // namespace

TangentSolver::TangentSolver(const ContactOperator& contacts, double ground) : contacts_(contacts), ground_(ground) {}

void TangentSolver::factorize() {
  base_ = now_;
  changed_.clear();
  columns_.clear();
  factor_ = umfpack_lu(contacts_.matrix(base_, ground_), 1);
  ++factorizations_;
  if (factor_ != nullptr) return;
  computation_failed("the tangent of the contacts has a zero pivot", "springs that slip have lost all stiffness",
                     "Check the friction and the springs");
}

void TangentSolver::refresh() {
  if (!changed_.empty()) factorize();
}

void TangentSolver::set(std::span<const ContactTangent> tangents) {
  now_.assign(tangents.begin(), tangents.end());
  changed_.clear();
  if (factor_ != nullptr) {
    for (std::size_t c = 0; c < now_.size(); ++c) {
      if (!(now_[c] == base_[c])) changed_.push_back(c);
    }
  }
  if (factor_ == nullptr || changed_.size() > most_changed || !update()) factorize();
}

const TangentSolver::Columns& TangentSolver::columns_of(std::size_t contact) {
  const auto known = columns_.find(contact);
  if (known != columns_.end()) return known->second;
  Columns columns{std::vector<double>(contacts_.components(), 0.0), std::vector<double>(contacts_.components(), 0.0)};
  contacts_.add_internal(contact, {1, 0}, columns.normal);
  contacts_.add_internal(contact, {0, 1}, columns.tangential);
  factor_->solve(columns.normal, 1);
  factor_->solve(columns.tangential, 1);
  const auto& held = contacts_.unknowns().held;
  for (std::size_t k = 0; k < held.size(); ++k) {
    if (held[k] != 0) columns.normal[k] = columns.tangential[k] = 0;
  }
  ++updates_;
  return columns_.emplace(contact, std::move(columns)).first->second;
}

void TangentSolver::pass(PathNumbers& n) {
  std::vector<ContactTangent> base = base_, now = now_;
  std::int64_t factorizations = factorizations_, updates = updates_;
  std::vector<std::size_t> solved;
  for (const auto& [contact, columns] : columns_) solved.push_back(contact);
  n.pass(base, now, solved, factorizations, updates);
  if (!n.restores()) return;
  if (!base.empty() && base_ != base) {
    now_ = base;
    factorize();
  }
  if (!base.empty()) set(now);
  for (const std::size_t contact : solved) columns_of(contact);
  factorizations_ = factorizations;
  updates_ = updates;
}

bool TangentSolver::update() {
  const std::size_t n = 2 * changed_.size();
  capacity_.assign(n * n, 0.0);
  for (std::size_t q = 0; q < changed_.size(); ++q) {
    const std::size_t contact = changed_[q];
    const Columns& z = columns_of(contact);
    const ContactForce by_n = beyond(now_[contact], base_[contact], {1, 0});
    const ContactForce by_t = beyond(now_[contact], base_[contact], {0, 1});
    for (std::size_t p = 0; p < changed_.size(); ++p) {
      const ContactDeformation n_of = contacts_.deformation(changed_[p], z.normal);
      const ContactDeformation t_of = contacts_.deformation(changed_[p], z.tangential);
      double* row = &capacity_[2 * p * n + 2 * q];
      row[0] = n_of.normal * by_n.normal + t_of.normal * by_n.tangential;
      row[1] = n_of.normal * by_t.normal + t_of.normal * by_t.tangential;
      row[n] = n_of.tangential * by_n.normal + t_of.tangential * by_n.tangential;
      row[n + 1] = n_of.tangential * by_t.normal + t_of.tangential * by_t.tangential;
    }
  }
  for (std::size_t k = 0; k < n; ++k) capacity_[k * n + k] += 1;
  return factorize_dense(capacity_, pivots_) > least_pivot || n == 0;
}

void TangentSolver::solve(std::span<double> x) const {
  factor_->solve(x, 1);
  if (changed_.empty()) return;
  std::vector<double> w(2 * changed_.size());
  for (std::size_t p = 0; p < changed_.size(); ++p) {
    const ContactDeformation d = contacts_.deformation(changed_[p], x);
    w[2 * p] = d.normal;
    w[2 * p + 1] = d.tangential;
  }
  solve_dense(capacity_, pivots_, w);
  for (std::size_t p = 0; p < changed_.size(); ++p) {
    const std::size_t contact = changed_[p];
    const ContactForce f = beyond(now_[contact], base_[contact], {w[2 * p], w[2 * p + 1]});
    const Columns& z = columns_.at(contact);
    for (std::size_t k = 0; k < x.size(); ++k) x[k] -= z.normal[k] * f.normal + z.tangential[k] * f.tangential;
  }
}

}  // namespace equidem
