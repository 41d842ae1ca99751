// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/pencil/matrix_pencil.hpp"

#include <cmath>
#include <cstddef>
#include <limits>

#include "equidem/core/error.hpp"
#include "equidem/core/ordered_sums.hpp"
#include "equidem/core/random.hpp"

namespace equidem {
namespace {

void clear_held(const DegreesOfFreedom& unknowns, std::vector<double>& x) {
  for (std::size_t k = 0; k < x.size(); ++k)
    if (unknowns.held[k] != 0) x[k] = 0;
}

}  // namespace

std::vector<double> random_motion(const DegreesOfFreedom& unknowns) {
  Random random(1);
  std::vector<double> x(unknowns.held.size());
  for (double& value : x) value = random.uniform(-1, 1);
  clear_held(unknowns, x);
  return x;
}

double rayleigh_quotient(const Assembly& assembly, const ContactGraph& graph, const DegreesOfFreedom& unknowns,
                         const StiffnessMatrix& a, const StiffnessMatrix& b, const std::vector<double>& x) {
  std::vector<double> a_x(x.size()), b_x(x.size());
  multiply(a, assembly, graph, x, a_x);
  clear_held(unknowns, a_x);
  multiply(b, assembly, graph, x, b_x);
  clear_held(unknowns, b_x);
  return -dot(x, a_x) / dot(x, b_x);
}

double InverseIteration::run(std::vector<double>& x) const {
  std::vector<double> b_x(x.size());
  double before = std::numeric_limits<double>::quiet_NaN();
  constexpr int most = 60;
  for (int k = 0; k < most; ++k) {
    multiply(b, assembly, graph, x, b_x);
    clear_held(unknowns, b_x);
    shifted.solve(b_x, 1);
    clear_held(unknowns, b_x);
    const double size = std::sqrt(dot(b_x, b_x));
    if (!is_positive(size)) break;
    for (std::size_t c = 0; c < x.size(); ++c) x[c] = b_x[c] / size;
    const double value = quotient(x);
    if (settled(value, before)) return value;
    before = value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace equidem
