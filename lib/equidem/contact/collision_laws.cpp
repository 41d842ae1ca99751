// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/collision_laws.hpp"

#include <array>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

struct NamedLaw {
  NormalLaw law;
  const char* name;
  const char* letter;
};
constexpr std::array<NamedLaw, 5> laws{{{NormalLaw::linear_dashpot, "linear_dashpot", "C"},
                                        {NormalLaw::hertz_dashpot, "hertz_dashpot", "T"},
                                        {NormalLaw::five_case_map, "five_case_map", "F"},
                                        {NormalLaw::energy_map, "energy_map", "P"},
                                        {NormalLaw::exact_flow, "exact_flow", "X"}}};

const NamedLaw& entry(NormalLaw law) {
  for (const NamedLaw& named : laws) {
    if (named.law == law) return named;
  }
  assert(false);
  return laws[0];
}

}  // namespace

NormalLaw normal_law_from(const std::string& name) {
  std::string choices;
  for (const NamedLaw& named : laws) {
    if (name == named.name) return named.law;
    choices += (choices.empty() ? "" : ", ") + std::string(named.name);
  }
  bad_input(fmt::format("\"{}\" is not a law of normal contact", name), "", "Choose one of " + choices);
}

std::string to_string(NormalLaw law) {
  return entry(law).name;
}

std::string letter_of(NormalLaw law) {
  return entry(law).letter;
}

void check_five_case_range(double a, double restitution) {
  if (restitution * restitution * (1 + a) >= a) return;
  bad_input(fmt::format("the law five_case_map is asked for restitution {:.6g} at dimensionless stiffness a = {:.6g}",
                        restitution, a),
            fmt::format("its first step has an answer only where e² >= a/(1 + a), that is e >= {:.6g}",
                        std::sqrt(a / (1 + a))),
            fmt::format("Choose energy_map, which takes any restitution, or an a of at most {:.6g}",
                        restitution * restitution / ((1 - restitution) * (1 + restitution))));
}

}  // namespace equidem
