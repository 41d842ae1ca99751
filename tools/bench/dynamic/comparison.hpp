// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The tables of the benchmark.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace equidem::bench {

struct Limits {
  double bandwidth = 0;   ///< bytes/s
  double arithmetic = 0;  ///< operations/s
};

/// Simulation beside plain loops, on one assembly.
/// \throws Error (computation_failed) where contenders do not move alike
std::string compare_loops(const std::string& kind, std::int64_t discs, const std::vector<int>& threads, int rounds,
                          const Limits& limits);
std::string loops_header();

/// What assembly and simulation hold, counted by the allocator.
std::string count_memory(const std::string& kind, std::int64_t discs);

/// Every variant beside the plain one, on one assembly.
std::string compare_effects(const std::string& kind, std::int64_t discs, int rounds);

/// Simulation beside loops written by hand for what it simulates and nothing else, step by step.
std::string compare_absent_effects(const std::string& kind, std::int64_t discs, int rounds);

}  // namespace equidem::bench
