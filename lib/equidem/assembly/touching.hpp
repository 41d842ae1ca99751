// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts of discs that touch, or are bonded across a gap.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"

namespace equidem {

/// The pairs of discs, and of discs and images across the period, whose gap is at most `gap_tolerance` times the sum of
/// their radii; 0: those that overlap, or whose gap is at most 1e-9 of the smaller radius. Each once, ascending by i,
/// then j (i <= j), then shift. The contact point divides the branch as the radii do.
/// \param gap_tolerance from 0 to 1
/// \throws Error (bad_input) where a disc is many times wider than the period or lies too many periods away
std::vector<Contact> touching_discs(const Assembly& assembly, double gap_tolerance = 0);

/// Contacts that a gap tolerance finds.
struct BondCount {
  double gap_tolerance = 0;
  std::int64_t contacts = 0;
  double coordination = 0;  ///< contacts of each body
};
/// The largest tolerance that bond_counts looks at.
inline constexpr double largest_counted_gap = 0.5;
/// For tolerances of 0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5.
/// \param gaps of all pairs up to largest_counted_gap, over the sums of the radii; what touches has 0 or less
std::vector<BondCount> bond_counts(std::span<const double> gaps, std::size_t bodies);
std::vector<BondCount> bond_counts(const Assembly& discs);
/// "gap_tolerance = 0.05 would find 4,312 contacts (z = 4.31)": the first tolerance above `tolerance` with four
/// contacts of each body or more, else the last; empty where that finds no more.
std::string suggested_tolerance(std::span<const BondCount> counts, double tolerance);
/// " by a gap_tolerance above 0.05": how to add contacts where a tolerance found them, for advice in errors; else
/// empty.
std::string by_larger_tolerance(const Assembly& assembly);
/// Contacts that were found by a gap tolerance join bodies, and do not cross.
/// \throws Error (bad_input): none, or more than six of each body, with a tolerance to use instead
void check_found_contacts(const Assembly& assembly);

}  // namespace equidem
