// SPDX-License-Identifier: GPL-3.0-or-later
#include "prestressed.hpp"

#include <optional>

#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

namespace {

std::optional<PrestressedSprings> choice_for(const Problem& problem) {
  try {
    return choose_prestress(problem.assembly, problem.springs.springs, problem.resolved.prestress);
  } catch (const Error& error) {
    throw error.at(problem.resolved.where("effects.prestress"));
  }
}

}  // namespace

bool prestress_counts(const Problem& problem) {
  if (!carries_forces(problem.assembly)) return false;
  const auto choice = choice_for(problem);
  return choice && choice->springs.prestressed();
}

std::vector<ContactForce> forces_in_total(const Problem& problem, std::vector<ContactForce> changes) {
  for (std::size_t c = 0; problem.springs.springs.prestressed() && c < changes.size(); ++c) {
    const ContactForce at_rest = force_at_rest(problem.assembly, c);
    changes[c].normal += at_rest.normal;
    changes[c].tangential += at_rest.tangential;
  }
  return changes;
}

void refuse_prestress(const Problem& problem, std::string_view taker) {
  if (!prestress_counts(problem)) return;
  bad_input(fmt::format("the forces at rest of the assembly count, and {} takes none", taker),
            "its stiffness would be that of the springs alone",
            "Set effects.prestress = \"off\", or use solve, homogenize or stability");
}

Problem prestressed(Problem problem) {
  problem.prestress = choice_for(problem);
  if (problem.prestress) problem.springs.springs = problem.prestress->springs;
  return problem;
}

void add_forces_at_rest(Results& results, const Problem& problem) {
  if (!problem.prestress) {
    if (carries_forces(problem.assembly))
      results.line("not used",
                   "forces at rest: solve, homogenize, stability, and quasistatic where contacts rub, take them");
    return;
  }
  results.line("forces at rest", problem.prestress->sentence);
  results.set("prestress/counts", problem.prestress->springs.prestressed())
      .set("prestress/largest", problem.prestress->largest)
      .set("prestress/imbalance", problem.prestress->balance.relative);
}

}  // namespace equidem
