// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/multigrid_solver.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/multigrid/conjugate_gradients.hpp"
#include "equidem/linear/rigid_growth.hpp"

namespace equidem {
namespace {

constexpr std::size_t rows_at_once = 1 << 12;

/// The vectors of conjugate gradients by rows of three, and the cycle, which takes r over its size.
class CycleVectors {
 public:
  /// \param x the load over discs x block components; the solution by rows from then on
  CycleVectors(multigrid::Cycle& cycle, const DegreesOfFreedom& unknowns, std::span<double> x)
      : cycle_(cycle), unknowns_(unknowns), x_(x) {
    const std::size_t n = 3 * cycle.order().size();
    for (LargeVector<double>* vector : {&r_, &p_, &q_}) {
      vector->resize(n + 1);
      vector->back() = 0;
    }
    const auto b = static_cast<std::size_t>(unknowns.per_disc);
    size_ = std::sqrt(sum_over_rows([&](std::size_t row) {
      double square = 0;
      for (std::size_t e = 0; e < 3; ++e) {
        const std::size_t k = 3 * row + e, component = static_cast<std::size_t>(cycle_.order()[row]) * b + e;
        p_[k] = q_[k] = 0;
        r_[k] = e < b && unknowns_.held[component] == 0 ? x[component] / cycle_.unit() : 0;
        square += r_[k] * r_[k];
      }
      return square;
    }));
    const double over = size_ > 0 ? 1 / size_ : 0;
    parallel_ranges(rows(), rows_at_once, [&](std::size_t begin, std::size_t end) {
      std::fill(x.begin() + static_cast<std::ptrdiff_t>(begin * b), x.begin() + static_cast<std::ptrdiff_t>(end * b),
                0.0);
      for (std::size_t row = begin; row < end; ++row) give_to_cycle(row, over);
    });
    scale_ = size_;
  }

  [[nodiscard]] double size() const { return size_; }

  multigrid::Dots precondition() {
    z_ = cycle_.solve();
    const auto sums = sums_over<2>(rows(), rows_at_once, [&](std::size_t begin, std::size_t end) {
      double rz = 0, qz = 0;
      for (std::size_t row = begin; row < end; ++row) {
        for (std::size_t e = 0; e < 3; ++e) {
          const double z = z_[row][e];
          rz += r_[3 * row + e] * z;
          qz += q_[3 * row + e] * z;
        }
      }
      return std::array{rz, qz};
    });
    return {scale_ * sums[0], scale_ * sums[1]};
  }

  void turn(double factor) {
    parallel_ranges(rows(), rows_at_once, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        for (std::size_t e = 0; e < 3; ++e) p_[3 * row + e] = scale_ * z_[row][e] + factor * p_[3 * row + e];
      }
    });
  }

  double multiply() { return cycle_.multiply(p_.data(), q_.data()); }

  double advance(double factor) {
    const double over = 1 / size_;  // the size before does as well
    scale_ = size_;
    const auto b = static_cast<std::size_t>(unknowns_.per_disc);
    size_ = std::sqrt(sum_over_rows([&](std::size_t row) {
      double square = 0;
      for (std::size_t e = 0; e < b; ++e) x_[b * row + e] += factor * p_[3 * row + e];
      for (std::size_t e = 0; e < 3; ++e) {
        const std::size_t k = 3 * row + e;
        r_[k] -= factor * q_[k];
        square += r_[k] * r_[k];
      }
      give_to_cycle(row, over);
      return square;
    }));
    return size_;
  }

  /// The solution over discs x block components.
  void sort_by_discs() {
    const auto b = static_cast<std::size_t>(unknowns_.per_disc);
    const auto component = [b](std::size_t row) { return static_cast<std::ptrdiff_t>(row * b); };
    parallel_ranges(rows(), rows_at_once, [&](std::size_t begin, std::size_t end) {
      std::copy(x_.begin() + component(begin), x_.begin() + component(end), q_.begin() + component(begin));
    });
    parallel_ranges(rows(), rows_at_once, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        std::copy_n(q_.begin() + component(row), b,
                    x_.begin() + component(static_cast<std::size_t>(cycle_.order()[row])));
      }
    });
  }

 private:
  [[nodiscard]] std::size_t rows() const { return cycle_.order().size(); }
  void give_to_cycle(std::size_t row, double factor) {
    const auto number = [&](std::size_t e) { return static_cast<float>(factor * r_[3 * row + e]); };
    cycle_.right_hand_side()[row] = multigrid::Quad{number(0), number(1), number(2), 0};
  }
  template <typename Function>
  [[nodiscard]] double sum_over_rows(const Function& f) const {
    return sums_over<1>(rows(), rows_at_once, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t row = begin; row < end; ++row) sum += f(row);
      return std::array{sum};
    })[0];
  }

  multigrid::Cycle& cycle_;
  const DegreesOfFreedom& unknowns_;
  std::span<double> x_;            // rows x block components
  LargeVector<double> r_, p_, q_;  // rows x 3, and one number for loads of vectors behind the last row
  const multigrid::Quad* z_ = nullptr;
  double size_ = 0;   // |r|
  double scale_ = 1;  // of z
};

class MultigridSolver final : public Factorization {
 public:
  MultigridSolver(const SpringNetwork& network, const multigrid::CycleOptions& options, int max_iterations)
      : unknowns_(network.unknowns),
        max_iterations_(max_iterations),
        cycle_(std::make_unique<multigrid::Cycle>(network, options)) {
    report_.name = "conjugate gradients with multigrid on " + counted(cycle_->grids(), "grid");
    report_.bytes = cycle_->bytes();
    stop_if_interrupted();
    if (!grows_rigid(network.assembly, network.graph, network.springs, network.unknowns.per_disc)) probe();
  }

  void solve(std::span<double> x, int right_hand_sides) override {
    const std::size_t n = unknowns_.held.size();
    for (std::size_t k = 0; k < static_cast<std::size_t>(right_hand_sides); ++k) {
      report_.iterations += solve_one(x.subspan(k * n, n), {}).iterations;
    }
  }
  Energies solve_to(double accuracy, double energy, std::span<double> x) override {
    const double unit = cycle_->unit();
    const auto report = solve_one(x, {.accuracy = accuracy, .energy = energy / unit});
    report_.iterations += report.iterations;
    return {unit * report.energy, unit * report.energy_error};
  }
  void solve_roughly(std::span<double> x) override { static_cast<void>(solve_one(x, {.tolerance = 0.03})); }
  [[nodiscard]] const FactorReport& report() const override { return report_; }

 private:
  /// A random load excites every null vector, which the user's load may not: that mode would go unnoticed.
  void probe() {
    constexpr double tolerance = 1e-6;  // below the share of one motion in the rough load of 1e12 unknowns
    Random random(1);
    std::vector<double> load(unknowns_.held.size());
    for (double& f : load) f = random.uniform() - 0.5;
    static_cast<void>(solve_one(load, {.tolerance = tolerance}));
  }

  multigrid::IterationReport solve_one(std::span<double> x, multigrid::IterationOptions options) {
    options.max_iterations = max_iterations_;
    CycleVectors vectors(*cycle_, unknowns_, x);
    const auto report = multigrid::iterate(vectors, options);
    switch (report.outcome) {
      case multigrid::IterationOutcome::converged:
        vectors.sort_by_discs();
        return report;
      case multigrid::IterationOutcome::stalled:
        computation_failed(fmt::format("method 'multigrid' leaves a residual of {:.1e} after {}", report.residual,
                                       counted(report.iterations, "iteration")),
                           "springs differ too much, or the network is nearly a mechanism",
                           "Use method = \"multifrontal\"");
      case multigrid::IterationOutcome::singular:
        break;
    }
    computation_failed("method 'multigrid' found a zero-energy mode", "iterations do not show which",
                       "Use method = \"multifrontal\", which names the motion");
  }

  const DegreesOfFreedom& unknowns_;
  int max_iterations_;
  std::unique_ptr<multigrid::Cycle> cycle_;
  FactorReport report_;
};

}  // namespace

std::unique_ptr<Factorization> multigrid_solver(const SpringNetwork& network, const multigrid::CycleOptions& options,
                                                int max_iterations) {
  assert(!network.springs.may_be_indefinite());
  return std::make_unique<MultigridSolver>(network, options, max_iterations);
}

double bytes_of_multigrid(double discs, double contacts) {
  // Per disc the inverse of its block, 75 bytes on the grids, three vectors in float, nine in double (five of a
  // solution and four of the two others that homogenization keeps, or of loads); per contact both its slots, of which
  // random assemblies fill four in five, and its force.
  return discs * (24 + 75 + 48 + 216) + contacts * (2 * 1.25 * 20 + 16);
}

}  // namespace equidem
