// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/conjugate_gradients.hpp"

#include "equidem/core/ordered_sums.hpp"
#include "equidem/linear/large_buffer.hpp"

namespace equidem::multigrid {
namespace {

constexpr std::size_t numbers_at_once = 1 << 14;

class PlainVectors {
 public:
  PlainVectors(const Product& k, const Product& m, std::span<double> x)
      : k_(k), m_(m), x_(x), r_(x.begin(), x.end()), p_(x.size(), 0.0), q_(x.size(), 0.0), z_(x.size()) {
    std::fill(x.begin(), x.end(), 0.0);
  }

  [[nodiscard]] double size() const { return std::sqrt(dot(r_, r_)); }
  Dots precondition() {
    m_(r_, z_);
    return {dot(r_, z_), dot(q_, z_)};
  }
  void turn(double factor) {
    parallel_ranges(p_.size(), numbers_at_once, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) p_[k] = z_[k] + factor * p_[k];
    });
  }
  double multiply() {
    k_(p_, q_);
    return dot(p_, q_);
  }
  double advance(double factor) {
    return std::sqrt(sums_over<1>(x_.size(), numbers_at_once, [&](std::size_t begin, std::size_t end) {
      double square = 0;
      for (std::size_t k = begin; k < end; ++k) {
        x_[k] += factor * p_[k];
        r_[k] -= factor * q_[k];
        square += r_[k] * r_[k];
      }
      return std::array{square};
    })[0]);
  }

 private:
  static double dot(std::span<const double> x, std::span<const double> y) {
    return sums_over<1>(x.size(), numbers_at_once, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t k = begin; k < end; ++k) sum += x[k] * y[k];
      return std::array{sum};
    })[0];
  }

  const Product &k_, &m_;
  std::span<double> x_;
  LargeVector<double> r_, p_, q_, z_;
};

}  // namespace

IterationReport conjugate_gradients(const Product& multiply_by_k, const Product& multiply_by_m, std::span<double> x,
                                    const IterationOptions& options) {
  PlainVectors vectors(multiply_by_k, multiply_by_m, x);
  return iterate(vectors, options);
}

}  // namespace equidem::multigrid
