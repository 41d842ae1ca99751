// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// One measured solution of the problem by one solver.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace equidem::bench {

/// A solver in the comparison.
struct Solver {
  std::string name;     ///< on the command line
  std::string label;    ///< in tables
  std::string threads;  ///< what a number of threads means to it
};
const std::vector<Solver>& solvers();

/// What is measured, on what.
struct Trial {
  std::string solver;
  std::string kind;  ///< of the assembly
  std::int64_t discs = 0;
  int threads = 1;
};

/// Times in seconds.
struct Measurement {
  double discs = 0;
  double unknowns = 0;
  double assembly = 0;  ///< K as blocks on the graph of discs; not part of the total
  double convert = 0;   ///< K into the columns that the solver takes; not part of the total
  double order = 0;
  double analyze = 0;
  double factorize = 0;
  double solve = 0;
  double nonzeros = 0;      ///< entries of L, lower triangle, without explicit zeros
  double factor_bytes = 0;  ///< what is stored of it
  double residual = 0;      ///< |f - K u| / |f|, 2-norms, without refinement
  double peak_bytes = 0;    ///< of the process
  double cpu = 0;           ///< of all threads of the process, from its start to its end

  [[nodiscard]] double total() const { return order + analyze + factorize + solve; }
};

/// A number of a measurement, by name.
struct Field {
  const char* name;
  double Measurement::*value;
};
inline constexpr Field fields[] = {
    {"discs", &Measurement::discs},
    {"unknowns", &Measurement::unknowns},
    {"assembly", &Measurement::assembly},
    {"convert", &Measurement::convert},
    {"order", &Measurement::order},
    {"analyze", &Measurement::analyze},
    {"factorize", &Measurement::factorize},
    {"solve", &Measurement::solve},
    {"nonzeros", &Measurement::nonzeros},
    {"factor_bytes", &Measurement::factor_bytes},
    {"residual", &Measurement::residual},
    {"peak_bytes", &Measurement::peak_bytes},
    {"cpu", &Measurement::cpu},
};

/// Solve the problem once, in this process; all but peak_bytes and cpu.
Measurement measure(const Trial& trial);

/// Measure in a fresh process, whose peak memory and thread settings are its own. Before it another process
/// touches as much memory as the solution will need: memory that the system hands out for the first time is
/// slow.
/// \throws Error (computation_failed) where the process fails
Measurement measure_in_fresh_process(const Trial& trial);

/// What such a process does: `arguments` are what follows the hidden option that starts it.
int serve_measurement(const std::vector<std::string>& arguments);
inline constexpr const char* measure_option = "--measure";
inline constexpr const char* warm_up_option = "--warm-up";
int serve_warm_up(double bytes);

}  // namespace equidem::bench
