// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/choice/hold_mechanism.hpp"

#include <utility>

namespace equidem {
namespace {

class WithoutMechanism final : public Factorization {
 public:
  WithoutMechanism(std::unique_ptr<Factorization> rest, std::size_t component, std::vector<double> motion)
      : rest_(std::move(rest)), component_(component), motion_(std::move(motion)), report_(rest_->report()) {
    ++report_.zero_pivots;
  }

  void solve(std::span<double> x, int right_hand_sides) const override {
    for (std::size_t k = component_; k < x.size(); k += motion_.size()) x[k] = 0;
    rest_->solve(x, right_hand_sides);
  }
  [[nodiscard]] std::vector<double> softest_motion() const override { return motion_; }
  [[nodiscard]] std::vector<double> null_motion(std::int64_t k) const override {
    return k < rest_->report().zero_pivots ? rest_->null_motion(k) : motion_;
  }
  [[nodiscard]] const FactorReport& report() const override { return report_; }

 private:
  std::unique_ptr<Factorization> rest_;
  std::size_t component_;
  std::vector<double> motion_;
  FactorReport report_;
};

}  // namespace

std::unique_ptr<Factorization> hold_mechanism(std::unique_ptr<Factorization> rest, std::size_t component,
                                              std::vector<double> motion) {
  return std::make_unique<WithoutMechanism>(std::move(rest), component, std::move(motion));
}

}  // namespace equidem
