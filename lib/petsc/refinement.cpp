// SPDX-License-Identifier: GPL-3.0-or-later
#include "petsc/refinement.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem::petsc {

Refined refine(const Network& network, PetscSolver& solver, std::span<const double> f,
               const std::optional<Tensor2>& gradient) {
  constexpr int most_passes = 12;
  constexpr double small_enough = 1e-12, rounding = 4e-16;  // of the motion
  Refined result;
  result.motion = PreciseMotion(network.size());
  result.motion.high = network.unknowns().prescribed;
  std::vector<double> residual(network.size()), change(network.size());
  const auto evaluate = [&](const PreciseMotion& motion) {
    network.residual(motion, gradient, f, residual);
    return network.norm(residual);
  };
  result.scale = result.residual = evaluate(result.motion);
  if (!std::isfinite(result.scale)) {
    bad_input("the forces overflow a double", "the largest is 1.8e308", "Check the units of sizes, springs and loads");
  }
  double before = 0;
  // Lattices are at rest under a mean strain but for rounding.
  const double at_rest = gradient ? 1e-13 * network.stiffest() * network.whole().mean_branch *
                                        std::sqrt(static_cast<double>(network.whole().discs))
                                  : 0;
  // A first pass may reach the rest at once; only a second one shows how far the motion is from it.
  for (int pass = 0; pass < most_passes && (pass == 1 || result.residual > at_rest); ++pass) {
    result.iterations += solver.solve(residual, change);
    result.motion.add(change);
    const double last = result.residual;
    result.residual = evaluate(result.motion);
    result.refinements = pass;
    const double size = network.norm(result.motion.high), moved = network.norm(change);
    const double now = size > 0 ? moved / size : 0;
    result.error = pass == 0 ? now : now * std::min(1.0, before > 0 ? now / before : 0.0);
    before = now;
    if (pass > 0 && (result.error <= small_enough || now <= rounding)) break;
    if (pass > 0 && result.residual > 0.5 * last && result.residual > 1e-12 * result.scale) {
      computation_failed(
          fmt::format("the residual stays at {:.1e} of the forces", result.residual / result.scale),
          network.any_negative()
              ? "kT < 0: an iteration or preconditioner needs a positive definite matrix; MUMPS meets one "
                "that is singular or nearly so"
              : "the stiffness matrix is singular or nearly so: the assembly may have a mechanism",
          "'equidem solve' names a mechanism; --set solver.method=multifrontal, without -equidem_ksp_type "
          "and -equidem_pc_type, takes MUMPS");
    }
  }
  result.error = std::max(result.error, rounding);
  PreciseMotion rounded(0);
  rounded.high = result.motion.high;
  result.rounded_residual = evaluate(rounded);
  return result;
}

}  // namespace equidem::petsc
