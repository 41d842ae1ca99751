// SPDX-License-Identifier: GPL-3.0-or-later
// What the effective stiffness of a cell costs beside one factorization and one solve of the same matrix:
// bench_homogenize --help.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/homogenize/affine.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/output/files/json.hpp"
#include "equidem/statics/hold_free_motions.hpp"
#include "equidem/statics/stiffness_solver.hpp"

namespace equidem::bench {
namespace {

/// Order, analyze, assemble, factorize, and solve (refined to full accuracy) for one mean strain.
double one_solve(const Assembly& assembly, const ContactSprings& springs) {
  const Stopwatch watch;
  StageTimes times;
  ContactGraph graph(assembly);
  DegreesOfFreedom unknowns = number_unknowns(assembly, springs, derive_effects(springs, Rotation::from_scene), {});
  hold_free_motions(assembly, graph, springs, unknowns);
  const StiffnessSolver solver(assembly, springs, std::move(graph), std::move(unknowns), {}, Mechanisms::hold, times);
  RightHandSide strain;
  strain.imposed = affine_deformations(assembly, {1, 0, 0, 0}, 0);
  static_cast<void>(solver.solve({&strain, 1}, times));
  return watch.seconds();
}

double whole_stiffness(const Assembly& assembly, const ContactSprings& springs) {
  const Stopwatch watch;
  static_cast<void>(effective_stiffness(assembly, springs));
  return watch.seconds();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

std::string compare(std::int64_t discs, int threads, int rounds) {
  set_thread_count(threads);
  const Assembly cell = delaunay_assembly({.discs = discs, .periodic = true});
  const ContactSprings springs(SpringConstants{1e9, 0.5e9});
  std::vector<double> one, whole, ratio;
  static_cast<void>(one_solve(cell, springs));  // touch the memory once
  for (int round = 0; round < rounds; ++round) {
    one.push_back(one_solve(cell, springs));
    whole.push_back(whole_stiffness(cell, springs));
    ratio.push_back(whole.back() / one.back());
  }
  const auto [least, most] = std::minmax_element(ratio.begin(), ratio.end());
  return fmt::format("| {} | {} | {} | {:.3f} | {:.3f} | {:.2f} ({:.2f} .. {:.2f}) |\n", cell.size(), threads, rounds,
                     median(one), median(whole), median(ratio), *least, *most);
}

int run(int argc, char** argv) {
  CLI::App program("The effective stiffness of a periodic Delaunay cell beside one solve of the same matrix.",
                   "bench_homogenize");
  std::vector<double> discs = {1e4, 1e5};
  std::vector<int> threads = {1, 2};
  int rounds = 5;
  std::string file;
  program.add_option("--discs", discs, "numbers of discs")->delimiter(',')->check(CLI::PositiveNumber);
  program.add_option("--threads", threads, "numbers of threads")->delimiter(',')->check(CLI::PositiveNumber);
  program.add_option("--rounds", rounds, "of both, one after the other")->check(CLI::PositiveNumber);
  program.add_option("--markdown", file, "file for the table");
  CLI11_PARSE(program, argc, argv);
  std::string report = fmt::format(
      "equidem {}: three load cases, error bound and rigidity included, over one solve; medians of rounds, s\n\n",
      library_version());
  report += "| discs | threads | rounds | one solve | effective stiffness | ratio |\n|---|---|---|---|---|---|\n";
  std::printf("%s", report.c_str());
  for (const double count : discs) {
    for (const int each : threads) {
      const std::string row = compare(static_cast<std::int64_t>(count), each, rounds);
      std::printf("%s", row.c_str());
      std::fflush(stdout);
      report += row;
    }
  }
  if (!file.empty()) {
    std::ofstream out(file);
    out << "# Effective stiffness\n\n" << report;
    if (!out.flush()) bad_input(fmt::format("'{}' cannot be written", file), "", "Choose another path");
  }
  return 0;
}

}  // namespace
}  // namespace equidem::bench

int main(int argc, char** argv) {
  try {
    return equidem::bench::run(argc, argv);
  } catch (const equidem::Error& error) {
    std::fprintf(stderr, "bench_homogenize: %s\n", error.what());
    return error.exit_code();
  }
}
