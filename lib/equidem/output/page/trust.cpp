// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/page/trust.hpp"

#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

using enum TrustCheck::Verdict;

std::optional<double> number(const Results& results, const char* path) {
  const Result* found = find_result(results, path);
  const auto* value = found != nullptr ? std::get_if<double>(&found->value.value) : nullptr;
  return value != nullptr && std::isfinite(*value) ? std::optional(*value) : std::nullopt;
}

/// Good up to the first limit, doubtful up to the second.
TrustCheck graded(std::string name, double value, std::pair<double, double> limits, std::string found,
                  std::string advice) {
  const auto verdict = value <= limits.first ? good : value <= limits.second ? doubtful : bad;
  return {verdict, std::move(name), std::move(found), verdict == good ? "" : std::move(advice)};
}

std::optional<TrustCheck> check_step(const Results& results, const TrustLimits& limits) {
  const auto step = number(results, "time_step");
  if (!step) return std::nullopt;
  if (const auto ratio = number(results, "time_step_ratio")) {
    const auto* exact = find_result(results, "critical_time_step_exact");
    const bool critical =
        exact != nullptr && std::get_if<bool>(&exact->value.value) != nullptr && std::get<bool>(exact->value.value);
    return graded("time step", *ratio, {1, 1},
                  fmt::format("{:.3g} of the {} step", *ratio, critical ? "critical" : "guaranteed"),
                  "Leave run.time_step out, or give a shorter one: beyond the critical step the motion grows");
  }
  if (const auto critical = number(results, "critical_time_step")) {
    return graded("time step", *step / *critical, {limits.safe_step_of_contact, 1},
                  fmt::format("{:.3g} of the critical step of one contact", *step / *critical),
                  "Compare with a run.time_step a third as long: several contacts at a body lower the critical step");
  }
  if (const auto contact = number(results, "steps_in_contact"))
    return TrustCheck{good, "time step",
                      fmt::format("{:.3g} steps in the shortest contact, exact at any step", *contact)};
  if (find_result(results, "time_step_ratio") != nullptr)
    return TrustCheck{good, "time step", "nothing vibrates, any step is stable"};
  return TrustCheck{doubtful, "time step", "the duration of a contact is not known",
                    "Give collisions.closing_speed, or compare with a run.time_step half as long"};
}

std::optional<TrustCheck> check_overlap(const Results& results, const TrustLimits& limits) {
  const std::pair graded_by{limits.small_overlap, limits.large_overlap};
  if (const auto change = number(results, "largest_deformation")) {
    return graded("overlap", *change, graded_by,
                  fmt::format("contacts change by at most {:.2g} of the sum of their radii", *change),
                  "Take stiffer springs or smaller loads: the contact law is that of small overlaps");
  }
  if (find_result(results, "grains") == nullptr) return std::nullopt;
  const auto overlap = number(results, "largest_overlap");
  if (!overlap) return TrustCheck{good, "overlap", "no bodies touch at the end"};
  return graded("overlap", *overlap, graded_by,
                fmt::format("at most {:.2g} of the smaller radius at the end", *overlap),
                "Take a shorter collisions.contact_duration or a larger stiffness: bodies overlap visibly");
}

std::optional<TrustCheck> check_balance(const Results& results, const TrustLimits& limits) {
  if (const auto force = number(results, "relative_unbalanced_force")) {
    return graded("balance of forces", *force, {limits.small_unbalanced_force, limits.large_unbalanced_force},
                  fmt::format("unbalanced by {:.1e} of the contact forces", *force), "Give a smaller run.until_rest");
  }
  const auto error = number(results, "energy/relative_error");
  if (!error) return std::nullopt;
  return graded("balance of energies", std::abs(*error), {limits.small_imbalance, limits.large_imbalance},
                fmt::format("closed to {:.1e} of the largest energy", std::abs(*error)),
                "Compare with a shorter run.time_step before trusting the motion");
}

/// The mean field of bonded discs, nu = (1 - kT/kN)/4 in plane strain (Abe 1996, eq. 35), is at most 1/4 without
/// negative springs, 1/3 in plane stress.
std::optional<TrustCheck> check_poisson_ratio(const Results& results) {
  const auto ratio = number(results, "springs/ratio");
  if (!ratio || find_result(results, "grains") != nullptr) return std::nullopt;
  if (*ratio >= 0)
    return TrustCheck{good, "Poisson's ratio", fmt::format("feasible: no spring is negative (kT/kN = {:.4g})", *ratio)};
  return TrustCheck{bad, "Poisson's ratio", fmt::format("not feasible in motion: kT/kN = {:.4g} is negative", *ratio),
                    "Ask for at most 1/4 in plane strain, 1/3 in plane stress: 'equidem calibrate' tells the range of "
                    "an assembly"};
}

}  // namespace

std::vector<TrustCheck> trust_checks(const Results& results, const TrustLimits& limits) {
  std::vector<TrustCheck> checks;
  for (auto& check : {check_step(results, limits), check_overlap(results, limits), check_balance(results, limits),
                      check_poisson_ratio(results)})
    if (check) checks.push_back(*check);
  return checks;
}

}  // namespace equidem
