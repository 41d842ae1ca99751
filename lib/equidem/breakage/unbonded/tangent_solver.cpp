// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/tangent_solver.hpp"

#include <Eigen/LU>
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

}  // namespace

/// I + C dA, 2 rows a contact.
struct TangentSolver::Capacity {
  Eigen::PartialPivLU<Eigen::MatrixXd> lu;
};

TangentSolver::TangentSolver(const ContactOperator& contacts, double ground) : contacts_(contacts), ground_(ground) {}

TangentSolver::~TangentSolver() = default;

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
  EQUIDEM_PASS(n, base, now, solved, factorizations, updates);
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
  const auto n = static_cast<Eigen::Index>(2 * changed_.size());
  if (n == 0) return true;
  Eigen::MatrixXd capacity = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index q = 0; q < n; q += 2) {
    const std::size_t contact = changed_[static_cast<std::size_t>(q / 2)];
    const Columns& z = columns_of(contact);
    const ContactForce by_n = beyond(now_[contact], base_[contact], {1, 0});
    const ContactForce by_t = beyond(now_[contact], base_[contact], {0, 1});
    for (Eigen::Index p = 0; p < n; p += 2) {
      const std::size_t other = changed_[static_cast<std::size_t>(p / 2)];
      const ContactDeformation n_of = contacts_.deformation(other, z.normal);
      const ContactDeformation t_of = contacts_.deformation(other, z.tangential);
      capacity(p, q) += n_of.normal * by_n.normal + t_of.normal * by_n.tangential;
      capacity(p, q + 1) += n_of.normal * by_t.normal + t_of.normal * by_t.tangential;
      capacity(p + 1, q) += n_of.tangential * by_n.normal + t_of.tangential * by_n.tangential;
      capacity(p + 1, q + 1) += n_of.tangential * by_t.normal + t_of.tangential * by_t.tangential;
    }
  }
  capacity_ = std::make_unique<Capacity>(Capacity{capacity.partialPivLu()});
  return capacity_->lu.matrixLU().diagonal().cwiseAbs().minCoeff() > least_pivot * capacity.cwiseAbs().maxCoeff();
}

void TangentSolver::solve(std::span<double> x) const {
  factor_->solve(x, 1);
  if (changed_.empty()) return;
  Eigen::VectorXd w(static_cast<Eigen::Index>(2 * changed_.size()));
  for (Eigen::Index p = 0; p < w.size(); p += 2) {
    const ContactDeformation d = contacts_.deformation(changed_[static_cast<std::size_t>(p / 2)], x);
    w[p] = d.normal;
    w[p + 1] = d.tangential;
  }
  w = capacity_->lu.solve(w).eval();
  for (Eigen::Index p = 0; p < w.size(); p += 2) {
    const std::size_t contact = changed_[static_cast<std::size_t>(p / 2)];
    const ContactForce f = beyond(now_[contact], base_[contact], {w[p], w[p + 1]});
    const Columns& z = columns_.at(contact);
    for (std::size_t k = 0; k < x.size(); ++k) x[k] -= z.normal[k] * f.normal + z.tangential[k] * f.tangential;
  }
}

}  // namespace equidem
