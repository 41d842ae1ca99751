// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Interface of all factorizations of a stiffness matrix.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace equidem {

/// Properties of the matrix that a factorization found.
struct FactorReport {
  std::string name;     ///< "multifrontal Cholesky", ...
  double nonzeros = 0;  ///< entries of L
  double bytes = 0;
  std::optional<std::int64_t> negative_pivots;  ///< negative eigenvalues (Sylvester); none: the method does not know
  double growth = 0;                            ///< largest |L_ij|; 0 where not watched
  /// Smallest ratio of a pivot to its diagonal entry of K. Near round-off the matrix is singular.
  double smallest_pivot = 1;
  std::optional<std::size_t> smallest_component;  ///< the component (disc * block + k) it belongs to
  std::int64_t delayed_pivots = 0;                ///< eliminated later than planned, for stability
  std::int64_t zero_pivots = 0;                   ///< unknowns that nothing holds: dimension of the null space found
  std::int64_t iterations = 0;                    ///< done by all solves; 0 where the method is direct
};

/// A factorized matrix. Vectors hold discs x block components, in the order of discs, held components included. Threads
/// may share one for its constant functions; a solve may use workspace of the object and has it alone.
class Factorization {
 public:
  Factorization() = default;
  virtual ~Factorization() = default;
  Factorization(const Factorization&) = delete;
  Factorization& operator=(const Factorization&) = delete;

  /// x := K^-1 x for right-hand sides stored one after another.
  virtual void solve(std::span<double> x, int right_hand_sides) = 0;
  /// Energies of a solution x, Pa m².
  struct Energies {
    double solution = 0;  ///< x.K x
    double error = 0;     ///< e.K e of the error e, estimated; 0 where the solution is exact
  };
  /// x := K^-1 x where that is cheaper only until e.K e <= accuracy² max(x.K x, energy); accuracy 0: as solve does.
  virtual Energies solve_to(double accuracy, double energy, std::span<double> x) {
    static_cast<void>(accuracy), static_cast<void>(energy);
    solve(x, 1);
    return {};
  }
  /// x := K^-1 x to a few per cent, where that is cheaper.
  virtual void solve_roughly(std::span<double> x) { solve(x, 1); }
  /// Approximate null vector, not normalized: L^-T e for the unit vector e of the smallest pivot. Where K is singular
  /// it is a mechanism. None where the method does not determine it, or nothing is free.
  [[nodiscard]] virtual std::optional<std::vector<double>> softest_motion() const { return {}; }
  /// The k-th of FactorReport::zero_pivots zero-energy modes, not normalized; they are independent. Solving
  /// holds one unknown for each of them.
  [[nodiscard]] virtual std::vector<double> null_motion(std::int64_t) const {
    assert(!"a factorization without zero pivots has no zero-energy modes");
    return {};
  }
  /// The unknowns (disc * block + k) that are held for them.
  [[nodiscard]] virtual std::vector<std::size_t> null_components() const { return {}; }
  [[nodiscard]] virtual const FactorReport& report() const = 0;
};

}  // namespace equidem
