// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Cost of the effective stiffness of a cell beside one factorization and one solution of the same matrix:
/// bench_homogenize --help.
#include <CLI/CLI.hpp>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/statics/stiffness_solver.hpp"

#include "bench.hpp"

namespace equidem::bench {
namespace {

/// Order, analyze, assemble, factorize, and solve (refined to full accuracy) for one mean strain.
double one_solution(const Assembly& assembly, const ContactSprings& springs) {
  const Stopwatch watch;
  StageTimes times;
  ContactGraph graph(assembly);
  DegreesOfFreedom unknowns = number_unknowns(assembly, springs, derive_effects(springs, Rotation::from_scene), {});
  hold_free_motions(assembly, graph, springs, unknowns);
  const StiffnessSolver solver(assembly, springs, std::move(graph), std::move(unknowns), {}, Mechanisms::hold, times);
  RightHandSide strain;
  strain.gradient = Tensor2{1, 0, 0, 0};
  static_cast<void>(solver.solve({&strain, 1}, times));
  return watch.seconds();
}

double whole_stiffness(const Assembly& assembly, const ContactSprings& springs) {
  const Stopwatch watch;
  static_cast<void>(effective_stiffness(assembly, springs));
  return watch.seconds();
}

void compare(TextTable& table, std::int64_t discs, int threads, int rounds) {
  set_thread_count(threads);
  const Assembly cell = delaunay_assembly({.discs = discs, .periodic = true});
  const ContactSprings springs(SpringConstants{1e9, 0.5e9});
  Seconds one, whole;
  static_cast<void>(one_solution(cell, springs));  // the first use of memory is slow
  for (int round = 0; round < rounds; ++round) {
    one.push_back(one_solution(cell, springs));
    whole.push_back(whole_stiffness(cell, springs));
  }
  table.add("{} & {} & {} & {} & {} & {}", cell.size(), threads, rounds, range_of(one).text("{:.3f}"),
            range_of(whole).text("{:.3f}"), ratio_of(whole, one).text("{:.2f}"));
}

}  // namespace
}  // namespace equidem::bench

int main(int argc, char** argv) {
  using namespace equidem::bench;
  std::vector<double> discs = {1e4, 1e5};
  std::vector<int> threads = {1, 2};
  int rounds = 5;
  return run_benchmark(
      "bench_homogenize", "The effective stiffness of a periodic Delaunay cell beside one solution of the same matrix",
      argc, argv,
      [&](CLI::App& app) {
        app.add_option("--discs", discs, "numbers of discs")->delimiter(',')->check(CLI::PositiveNumber);
        app.add_option("--threads", threads, "numbers of threads")->delimiter(',')->check(CLI::PositiveNumber);
        app.add_option("--rounds", rounds, "of both, one after the other")->check(CLI::PositiveNumber);
      },
      [&](Report& report) {
        report.begin("Effective stiffness");
        equidem::bench::TextTable table("discs & threads & rounds & one solution, s & effective stiffness, s & ratio");
        for (const double count : discs)
          for (const int each : threads) compare(table, static_cast<std::int64_t>(count), each, rounds);
        report.add(
            "\nA periodic Delaunay cell, kT/kN = 0.5. One solution: order, analyze, assemble, factorize, solve and "
            "refine "
            "for one mean strain. Effective stiffness: three mean strains, error bound and rigidity included. Seconds, "
            "medians (smallest .. largest) of rounds in which both take turns.\n\n" +
            table.markdown());
      });
}
