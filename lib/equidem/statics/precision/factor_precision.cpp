// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/precision/factor_precision.hpp"

#include <algorithm>
#include <limits>

#include "equidem/core/text.hpp"
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"

namespace equidem {
namespace {

/// Largest over smallest diagonal entry of K over the components that are not held.
double diagonal_spread(const System& system) {
  const auto b = static_cast<std::size_t>(system.unknowns.per_disc);
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (std::size_t k = 0; k < system.unknowns.held.size(); ++k) {
    if (system.unknowns.held[k] != 0) continue;
    const double entry = system.k.matrix.diagonal_block(k / b)[k % b * (b + 1)];
    least = std::min(least, entry);
    most = std::max(most, entry);
  }
  return most > 0 ? most / least : 1;
}

}  // namespace

bool tries_single_precision(const SolverOptions& options, const ContactSprings& springs,
                            const SymbolicFactor& symbolic) {
  constexpr double large = 4e6;  // entries, from where it is faster: measured with 1e4 and 1e5 discs
  if (options.method != SolverMethod::automatic && options.method != SolverMethod::multifrontal) return false;
  if (springs.may_be_indefinite() || options.max_refinements == 0) return false;
  switch (options.precision) {
    case FactorPrecision::automatic:
      return symbolic.panel_entries() >= large;
    case FactorPrecision::single_precision:
      return true;
    case FactorPrecision::double_precision:
      break;
  }
  return false;
}

std::unique_ptr<Factorization> factorize_in_single_precision(const System& system, std::string& reason) {
  constexpr double alike = 1e6;
  const double spread = diagonal_spread(system);
  if (!(spread <= alike)) {
    reason = fmt::format("stiffnesses differ by a factor of {:.0e}", spread);
    return nullptr;
  }
  constexpr double share_of_round_off = 1e-4;  // in pivots of well-supported samples 1e-2 is left at 1e6 discs
  FactorReport report;
  auto factor = multifrontal_cholesky<float>(system.symbolic, system.k, &report);
  if (factor && report.smallest_pivot >= share_of_round_off) return factor;
  reason = report.smallest_pivot > 0 ? fmt::format("a pivot fell to {:.0e} of its stiffness", report.smallest_pivot)
                                     : "a pivot fell below the round-off of a float";
  return nullptr;
}

}  // namespace equidem
