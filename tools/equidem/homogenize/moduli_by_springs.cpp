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
  const char* picture;             ///< legend; empty: none
};

constexpr std::array moduli_of_springs{
    ModulusOfSprings{"K", "bulk_modulus_2d", "dK/K", "Pa", &ModuliChange::bulk_modulus_2d,
                     &EffectiveModuli::bulk_modulus_2d, ""},
    ModulusOfSprings{"G", "shear_modulus", "dG/G", "Pa", &ModuliChange::shear_modulus, &EffectiveModuli::shear_modulus,
                     "dG/G by the springs of a contact; widest line "},
    ModulusOfSprings{"E", "young_modulus", "dE/E", "Pa", &ModuliChange::young_modulus, &EffectiveModuli::young_stress,
                     "dE/E by the springs of a contact; widest line "},
    ModulusOfSprings{"nu", "poisson_ratio", "dnu", "", &ModuliChange::poisson_ratio, nullptr,
                     "dnu by the springs of a contact, red: up, blue: down; widest line "}};

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
  const auto add = [&](const char* name, const char* label, double ModuliChange::*modulus, double whole) {
    const std::string key = std::string("sensitivities/mean_shift/") + name;
    constexpr Shown shown{Shown::decimals, 4};
    out.line("").add(key, label, found.shift.*modulus / whole, "", shown);
    out.add("sensitivities/mean_shift_error/" + std::string(name), "+-", found.standard_error.*modulus / whole, "",
            shown);
  };
  add("bulk_modulus_2d", "dK/K", &ModuliChange::bulk_modulus_2d, m.bulk_modulus_2d);
  add("shear_modulus", "dG/G", &ModuliChange::shear_modulus, m.shear_modulus);
  add("young_modulus", "dE/E", &ModuliChange::young_modulus, m.young_stress);
  add("poisson_ratio", "dnu", &ModuliChange::poisson_ratio, 1);
  return out;
}

std::vector<std::string> pictures_of_sensitivities() {
  std::vector<std::string> symbols;
  for (const ModulusOfSprings& modulus : moduli_of_springs)
    if (*modulus.picture != 0) symbols.emplace_back(modulus.symbol);
  return symbols;
}

std::vector<SpringDependent> moduli_by_springs(const Matrix3& stiffness, const SpringSensitivities& found) {
  const EffectiveModuli moduli = effective_moduli(stiffness);
  std::vector<SpringDependent> numbers;
  for (const auto& [symbol, key, heading, unit, change, whole, picture] : moduli_of_springs) {
    numbers.push_back({modulus_by_springs(stiffness, found, change), symbol, key, heading, unit,
                       whole == nullptr ? 1 : moduli.*whole, false, picture});
  }
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
