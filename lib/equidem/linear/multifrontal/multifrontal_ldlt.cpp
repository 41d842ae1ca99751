// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multifrontal/multifrontal_ldlt.hpp"

#include <utility>

namespace equidem {
namespace {

class Ldlt final : public Factorization {
 public:
  Ldlt(std::shared_ptr<const SymbolicFactor> symbolic, const MatrixOnGraph& k, const IndefiniteOptions& options)
      : factor_(std::move(symbolic), k, options) {}

  void solve(std::span<double> x, int right_hand_sides) const override { factor_.solve(x, right_hand_sides); }
  [[nodiscard]] std::vector<double> softest_motion() const override { return factor_.softest_motion(); }
  [[nodiscard]] std::vector<double> null_motion(std::int64_t k) const override { return factor_.null_motion(k); }
  [[nodiscard]] std::vector<std::size_t> null_components() const override { return factor_.null_components(); }
  [[nodiscard]] const FactorReport& report() const override { return factor_.report(); }

 private:
  LdltFactor<double> factor_;
};

}  // namespace

std::unique_ptr<Factorization> multifrontal_ldlt(std::shared_ptr<const SymbolicFactor> symbolic,
                                                 const MatrixOnGraph& matrix, const IndefiniteOptions& options) {
  return std::make_unique<Ldlt>(std::move(symbolic), matrix, options);
}

}  // namespace equidem
