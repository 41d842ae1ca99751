// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/multigrid_solver.hpp"

#include <cassert>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/multigrid/conjugate_gradients.hpp"
#include "equidem/linear/rigid_growth.hpp"

namespace equidem {
namespace {

class MultigridSolver final : public Factorization {
 public:
  MultigridSolver(const MatrixOnGraph& matrix, const ContactSprings& springs, const DegreesOfFreedom& unknowns,
                  const multigrid::CycleOptions& options)
      : matrix_(matrix),
        unknowns_(unknowns),
        cycle_(std::make_unique<multigrid::Cycle>(matrix, springs, unknowns, options)) {
    report_.name = "conjugate gradients with multigrid on " + counted(cycle_->grids(), "grid");
    report_.bytes = cycle_->bytes();
    if (!grows_rigid(matrix.assembly, matrix.graph, springs, unknowns.per_disc)) probe();
  }

  void solve(std::span<double> x, int right_hand_sides) const override {
    const std::size_t n = unknowns_.held.size();
    for (std::size_t k = 0; k < static_cast<std::size_t>(right_hand_sides); ++k) {
      report_.iterations += solve_one(x.subspan(k * n, n), {});
    }
  }
  [[nodiscard]] const FactorReport& report() const override { return report_; }

 private:
  /// A rough load works on every motion without stiffness, which loads of the user need not: such a motion would go
  /// unnoticed.
  void probe() const {
    constexpr double tolerance = 1e-6;  // below the share of one motion in the rough load of 1e12 unknowns
    Random random(1);
    std::vector<double> load(unknowns_.held.size());
    for (double& f : load) f = random.uniform() - 0.5;
    static_cast<void>(solve_one(load, {.tolerance = tolerance}));
  }

  int solve_one(std::span<double> x, const multigrid::IterationOptions& options) const {
    for (std::size_t k = 0; k < x.size(); ++k) {
      if (unknowns_.held[k] != 0) x[k] = 0;
    }
    const auto report = multigrid::conjugate_gradients(
        [&](std::span<const double> v, std::span<double> kv) {
          multiply(matrix_.matrix, matrix_.assembly, matrix_.graph, v, kv);
        },
        [&](std::span<const double> v, std::span<double> mv) { cycle_->apply(v, mv); }, x, options);
    switch (report.outcome) {
      case multigrid::IterationOutcome::converged:
        return report.iterations;
      case multigrid::IterationOutcome::stalled:
        computation_failed(fmt::format("method 'multigrid' leaves a residual of {:.1e} after {}", report.residual,
                                       counted(report.iterations, "iteration")),
                           "springs differ too much, or the network is nearly a mechanism",
                           "Use method = \"multifrontal\"");
      case multigrid::IterationOutcome::singular:
        break;
    }
    computation_failed("method 'multigrid' met a motion that costs no energy", "iterations do not show which",
                       "Use method = \"multifrontal\", which names the motion");
  }

  MatrixOnGraph matrix_;
  const DegreesOfFreedom& unknowns_;
  std::unique_ptr<multigrid::Cycle> cycle_;
  mutable FactorReport report_;
};

}  // namespace

std::unique_ptr<Factorization> multigrid_solver(const MatrixOnGraph& matrix, const ContactSprings& springs,
                                                const DegreesOfFreedom& unknowns,
                                                const multigrid::CycleOptions& options) {
  assert(!springs.any_negative());
  return std::make_unique<MultigridSolver>(matrix, springs, unknowns, options);
}

double bytes_of_multigrid(double discs, double contacts) {
  // Per disc the diagonal of K in double, that of K and its inverse in float, 250 bytes on the grids (whose cells have
  // matrices of their own while they are set up), four vectors in float and twenty in double; per contact K in double,
  // in float with both triangles, and its force.
  return discs * (72 + 72 + 250 + 64 + 480) + contacts * (72 + 80 + 16);
}

}  // namespace equidem
