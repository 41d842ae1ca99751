// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Solutions with the tangent of a network whose contacts change their status one after another.
///
/// K = K_0 + sum G_c^T dA_c G_c over the contacts whose tangent has changed since K_0 was factorized. With the
/// deformations w = G x of those contacts (Woodbury's identity)
///
///   x = x_0 - Z dA w,   (I + C dA) w = G x_0,   Z = K_0^-1 G^T,   C = G Z,   K_0 x_0 = b.
///
/// K_0 is not symmetric where contacts slip. Springs of `ground` hold every component, so that motions that nothing
/// resists are no zero pivots; they are left out of what is solved for by refinement (contact_rates.hpp).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "equidem/breakage/unbonded/contact_operator.hpp"
#include "equidem/linear/factorization.hpp"

namespace equidem {

class TangentSolver {
 public:
  /// \param ground Pa, far below the springs of contacts
  TangentSolver(const ContactOperator& contacts, double ground);
  ~TangentSolver();

  /// Makes these the tangents, one for each contact, by updates of the factor or by a new one.
  /// \throws Error (computation_failed) where the matrix has a zero pivot
  void set(std::span<const ContactTangent> tangents);
  /// Factorizes the tangent as it is, if it has changed since.
  void refresh();
  /// x := K^-1 x, held components are not changed by it.
  /// \throws Error (computation_failed) where UMFPACK fails
  void solve(std::span<double> x) const;

  /// The tangents of the factor and those set; the factor itself is made again.
  void pass(PathNumbers& n);

  [[nodiscard]] std::int64_t factorizations() const { return factorizations_; }
  [[nodiscard]] std::int64_t updates() const { return updates_; }

 private:
  struct Capacity;
  struct Columns {
    std::vector<double> normal, tangential;  // K_0^-1 of the rows of stretch and slip
  };
  void factorize();
  [[nodiscard]] bool update();
  const Columns& columns_of(std::size_t contact);

  const ContactOperator& contacts_;
  double ground_;
  std::vector<ContactTangent> base_, now_;
  std::unique_ptr<Factorization> factor_;
  std::vector<std::size_t> changed_;        // contacts with other tangents than those of the factor
  std::map<std::size_t, Columns> columns_;  // of contacts that have changed since
  std::unique_ptr<Capacity> capacity_;      // LU of I + C dA; none, or of no use: nothing has changed
  std::int64_t factorizations_ = 0, updates_ = 0;
};

}  // namespace equidem
