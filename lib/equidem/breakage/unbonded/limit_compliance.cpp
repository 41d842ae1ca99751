// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/limit_compliance.hpp"

namespace equidem {

std::vector<double> limit_compliance(const RateProblem& problem, const TangentSolver& solver) {
  const ContactOperator& contacts = problem.contacts;
  const auto& held = contacts.unknowns().held;
  const std::vector<double>& load = problem.driving.pattern->force;
  const std::size_t m = problem.limits.size(), n = 2 * m;
  std::vector<double> c(n * n), along;
  const auto dot = [&](std::span<const double> x) {
    double sum = 0;
    for (std::size_t k = 0; k < x.size(); ++k) sum += load[k] * x[k];
    return sum;
  };
  const auto solve = [&](std::vector<double>& x) {
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = held[k] != 0 ? 0 : x[k];
    solver.solve(x);
  };
  if (problem.driving.by_motion) solve(along = load);
  for (std::size_t q = 0; q < n; ++q) {
    std::vector<double> z(contacts.components(), 0.0);
    contacts.add_internal(problem.limits[q / 2].contact, q % 2 == 0 ? ContactForce{1, 0} : ContactForce{0, 1}, z);
    solve(z);
    if (problem.driving.by_motion) {
      const double by = dot(z) / dot(along);
      for (std::size_t k = 0; k < z.size(); ++k) z[k] -= by * along[k];
    }
    for (std::size_t p = 0; p < m; ++p) {
      const ContactDeformation d = contacts.deformation(problem.limits[p].contact, z);
      c[2 * p * n + q] = d.normal;
      c[(2 * p + 1) * n + q] = d.tangential;
    }
  }
  return c;
}

}  // namespace equidem
