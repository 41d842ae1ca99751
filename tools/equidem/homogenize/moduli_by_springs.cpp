// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>

#include "homogenize/homogenize.hpp"
#include "state_files.hpp"

namespace equidem {
namespace {

struct ModulusOfSprings {
  const char *symbol, *key, *heading, *unit;
  double ModuliChange::*change;
  double EffectiveModuli::*whole;  ///< null: the change itself is shown
  bool drawn;                      ///< in a picture
};

constexpr std::array moduli_of_springs{
    ModulusOfSprings{"K", "bulk_modulus_2d", "dK/K", "Pa", &ModuliChange::bulk_modulus_2d,
                     &EffectiveModuli::bulk_modulus_2d, false},
    ModulusOfSprings{"G", "shear_modulus", "dG/G", "Pa", &ModuliChange::shear_modulus, &EffectiveModuli::shear_modulus,
                     true},
    ModulusOfSprings{"E", "young_modulus", "dE/E", "Pa", &ModuliChange::young_modulus, &EffectiveModuli::young_stress,
                     true},
    ModulusOfSprings{"nu", "poisson_ratio", "dnu", "", &ModuliChange::poisson_ratio, nullptr, true}};

double whole_of(const ModulusOfSprings& modulus, const EffectiveModuli& moduli) {
  return modulus.whole == nullptr ? 1 : moduli.*modulus.whole;
}

}  // namespace

std::optional<SpringSensitivities> sensitivities_of(const Problem& problem, const EffectiveStiffness& result,
                                                    std::optional<Error>& failure) {
  std::optional<SpringSensitivities> found;
  const std::optional<Error> refused =
      failure_of([&] { found = spring_sensitivities(problem.assembly, problem.springs.springs, result); });
  if (!failure) failure = refused;
  return found;
}

std::optional<MeanShift> mean_shift_of(const Problem& problem, const EffectiveStiffness& result,
                                       const SpringSensitivities& sensitivities, int probes,
                                       std::optional<Error>& failure) {
  std::optional<MeanShift> found;
  const Case& as = problem.resolved;
  const std::optional<Error> refused = failure_of([&] {
    found = mean_shift_of_moduli(problem.assembly, problem.springs.springs, result, sensitivities,
                                 {.rotation = as.rotation, .solver = as.solver, .probes = probes});
  });
  if (!failure) failure = refused;
  return found;
}

Results shift_results(const EffectiveStiffness& result, const MeanShift& found) {
  const EffectiveModuli m = effective_moduli(result.stiffness);
  Results out;
  out.line("mean of scatter", "over the square of the coefficient of variation of the springs of each contact:");
  constexpr Shown shown{Shown::decimals, 4};
  for (const ModulusOfSprings& modulus : moduli_of_springs) {
    const double whole = whole_of(modulus, m);
    out.line("").add(fmt::format("sensitivities/mean_shift/{}", modulus.key), modulus.heading,
                     found.shift.*modulus.change / whole, "", shown);
    out.add(fmt::format("sensitivities/mean_shift_error/{}", modulus.key), "+-",
            found.standard_error.*modulus.change / whole, "", shown);
  }
  return out;
}

std::vector<std::string> pictures_of_sensitivities() {
  std::vector<std::string> symbols;
  for (const ModulusOfSprings& modulus : moduli_of_springs)
    if (modulus.drawn) symbols.emplace_back(modulus.symbol);
  return symbols;
}

std::vector<SpringDependent> moduli_by_springs(const Matrix3& stiffness, const SpringSensitivities& found) {
  const EffectiveModuli moduli = effective_moduli(stiffness);
  std::vector<SpringDependent> numbers;
  for (const ModulusOfSprings& modulus : moduli_of_springs)
    numbers.push_back({modulus_by_springs(stiffness, found, modulus.change), modulus.symbol, modulus.key,
                       modulus.heading, modulus.unit, whole_of(modulus, moduli), false, modulus.drawn});
  return numbers;
}

std::vector<ResultArray> sensitivity_arrays(const std::shared_ptr<const SpringSensitivities>& found) {
  std::vector<ResultArray> arrays;
  const auto add = [&](const char* name, const char* unit, const std::vector<Matrix3>& derivatives) {
    if (derivatives.empty()) return;
    arrays.push_back(array_of(name, unit, std::shared_ptr<const std::vector<Matrix3>>(found, &derivatives), 9));
    arrays.back().matrix_columns = 3;
  };
  add("dC_dkN", "", found->by_kN);
  add("dC_dkT", "", found->by_kT);
  add("dC_dkM", "1/m2", found->by_kM);
  return arrays;
}

std::vector<ResultArray> shape_arrays(const ShapeSensitivities& found) {
  std::vector<Matrix3> by_x, by_y;
  for (const auto& [x, y] : found.by_position) by_x.push_back(x), by_y.push_back(y);
  std::vector<ResultArray> arrays;
  const auto add = [&](const char* name, std::vector<Matrix3> derivatives) {
    if (derivatives.empty()) return;
    arrays.push_back(array_of(name, "Pa/m", std::move(derivatives), 9));
    arrays.back().matrix_columns = 3;
  };
  add("dC_dx", std::move(by_x));
  add("dC_dy", std::move(by_y));
  add("dC_dradius", found.by_radius);
  return arrays;
}

}  // namespace equidem
