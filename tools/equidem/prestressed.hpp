// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The forces at rest of the contacts of a problem.
#pragma once

#include <string_view>

#include "equidem/output/results.hpp"

#include "problem.hpp"

namespace equidem {

/// The problem with the decision whether the forces at rest count, as the case asks; where they do, its springs have
/// their geometric stiffness.
/// \throws Error (bad_input) as choose_prestress
Problem prestressed(Problem problem);

/// Whether the forces at rest of the assembly, if it carries some, count.
/// \throws Error (bad_input) as choose_prestress
bool prestress_counts(const Problem& problem);

/// Forces of the contacts with those at rest, where these count. \param changes by the loads
std::vector<ContactForce> forces_in_total(const Problem& problem, std::vector<ContactForce> changes);

/// \param taker of the springs alone
/// \throws Error (bad_input) where the forces at rest count
void refuse_prestress(const Problem& problem, std::string_view taker);

/// Tells what was decided, or that the verb takes no such forces.
void add_forces_at_rest(Results& results, const Problem& problem);

}  // namespace equidem
