// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// One solution of a plate of discs by one solver, measured in this process: tools/bench/static.py starts one after the
/// other and compares them.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <span>
#include <utility>

#include <CLI/CLI.hpp>
#include <sys/resource.h>

#include "equidem/contact/effects.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/cholmod_factorization.hpp"
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"
#include "equidem/linear/multigrid/multigrid_solver.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/output/results.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/loads.hpp"
#include "equidem/statics/number_unknowns.hpp"

#include "bench.hpp"
#include "command.hpp"

namespace equidem::bench {
namespace {

struct Trial {
  std::string solver;
  std::string kind;  ///< of the assembly, one of assembly_kinds()
  double discs = 0;
  int threads = 1;
};

/// Times in seconds.
struct Measurement {
  double assembly = 0;  ///< K as blocks on the graph of discs; not part of the total
  double order = 0, analyze = 0, factorize = 0, solve = 0;
};

/// A plate of discs, its left side held, its right side pulled: kT/kN = 0.5, three unknowns per disc.
struct Problem {
  Assembly assembly;
  ContactSprings springs;
  DegreesOfFreedom unknowns;
  std::vector<double> load;  ///< N/m, discs x 3 components: (1, -1/4, 0) on each disc of the right side
};

Problem build_problem(const std::string& kind, std::int64_t discs) {
  Problem problem{build_assembly(kind, discs, 0.005), ContactSprings(SpringConstants{.kN = 1e9, .kT = 0.5e9}), {}, {}};
  const Support left{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = 0.0};
  const Effects effects = derive_effects(problem.springs, Rotation::free);
  problem.unknowns = number_unknowns(problem.assembly, problem.springs, effects, {&left, 1});
  problem.load.assign(problem.unknowns.held.size(), 0.0);
  for (const std::int32_t disc : group(problem.assembly, "right").discs) {
    const std::size_t component = 3 * static_cast<std::size_t>(disc);
    if (problem.unknowns.held[component] == 0) problem.load[component] = 1;
    if (problem.unknowns.held[component + 1] == 0) problem.load[component + 1] = -0.25;
  }
  return problem;
}

std::unique_ptr<Factorization> factorize(const std::string& solver, const Problem& problem,
                                         const StiffnessMatrix& matrix, Measurement& result) {
  const ContactGraph graph(problem.assembly);
  const MatrixOnGraph given{matrix, problem.assembly, graph};
  Stopwatch watch;
  std::unique_ptr<Factorization> factor;
  if (solver == "equidem") {
    DissectionTree tree = dissect(problem.assembly, graph);
    result.order = watch.lap();
    auto symbolic = std::make_shared<const SymbolicFactor>(analyze(std::move(tree), graph, matrix.block));
    result.analyze = watch.lap();
    factor = multifrontal_cholesky(std::move(symbolic), given);
  } else {
    const auto ordering = enum_from<CholmodOrdering>(solver.substr(8));  // behind "cholmod-"
    std::vector<std::int32_t> order;
    if (ordering == CholmodOrdering::equidem) order = dissect(problem.assembly, graph).order;
    result.order = watch.lap();
    factor = cholmod_cholesky(given, problem.unknowns, ordering, order);  // with CHOLMOD's ordering and analysis
  }
  result.factorize = watch.lap();
  return factor;
}

/// As equidem solves: passes until the residual of the contact law is small enough.
void solve_by_multigrid(const Problem& problem, const ContactGraph& graph, Factorization& factor,
                        std::vector<double>& x) {
  constexpr double tolerance = 1e-12;
  const SpringNetwork network{problem.assembly, graph, problem.springs, problem.unknowns};
  const auto norm_of = [](const std::vector<double>& v) {
    return std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0));
  };
  PreciseMotion motion(x.size());
  const double size = norm_of(x);
  for (double left = size; left > tolerance * size; left = norm_of(x)) {
    factor.solve(x, 1);
    motion.add(x);
    residual_force(network, motion, {}, problem.load, x);
  }
  x = motion.high;
}

double relative_residual(const Problem& problem, const StiffnessMatrix& matrix, const std::vector<double>& x) {
  std::vector<double> y(x.size());
  multiply(matrix, problem.assembly, ContactGraph(problem.assembly), x, y);
  double difference = 0, size = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    difference += (problem.load[k] - y[k]) * (problem.load[k] - y[k]);
    size += problem.load[k] * problem.load[k];
  }
  return std::sqrt(difference / size);
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// \throws Error (computation_failed) where the matrix is not positive definite
Results measure(const Trial& trial) {
  return_freed_memory();  // as the program does
  set_thread_count(trial.threads);
  const Problem problem = build_problem(trial.kind, std::llround(trial.discs));
  Measurement result;
  const bool iterates = trial.solver == "equidem-multigrid";
  const ContactGraph graph(problem.assembly);
  StiffnessMatrix matrix;
  const auto assemble = [&] {
    const Stopwatch watch;
    matrix = assemble_stiffness(problem.assembly, graph, problem.springs, problem.unknowns);
    result.assembly = watch.seconds();
  };
  std::unique_ptr<Factorization> factor;
  if (iterates) {
    const Stopwatch watch;
    factor = multigrid_solver({problem.assembly, graph, problem.springs, problem.unknowns});
    result.factorize = watch.seconds();
  } else {
    assemble();
    factor = factorize(trial.solver, problem, matrix, result);
  }
  if (!factor) computation_failed("the stiffness matrix is not positive definite", "", "");
  std::vector<double> x = problem.load;
  const Stopwatch watch;
  if (iterates) {
    solve_by_multigrid(problem, graph, *factor, x);
  } else {
    factor->solve(x, 1);
  }
  result.solve = watch.seconds();
  const FactorReport report = factor->report();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  if (iterates) assemble();  // for the residual alone
  return Results()
      .set("machine", machine_text())
      .set("discs", problem.assembly.size())
      .set("unknowns", problem.unknowns.unknowns)
      .set("assembly", result.assembly)
      .set("order", result.order)
      .set("analyze", result.analyze)
      .set("factorize", result.factorize)
      .set("solve", result.solve)
      .set("iterations", report.iterations)
      .set("nonzeros", report.nonzeros)
      .set("factor_bytes", report.bytes)
      .set("residual", relative_residual(problem, matrix, x))
      .set("peak_bytes", 1024.0 * static_cast<double>(usage.ru_maxrss))
      .set("cpu", seconds(usage.ru_utime) + seconds(usage.ru_stime));
}

}  // namespace
}  // namespace equidem::bench

int main(int argc, char** argv) {
  using namespace equidem::bench;
  Trial trial;
  return run_benchmark(
      "bench_static", "One static solution, measured: JSON on stdout. tools/bench/static.py compares", argc, argv,
      [&](CLI::App& app) {
        app.add_option("solver", trial.solver)
            ->required()
            ->check(CLI::IsMember({"equidem", "equidem-multigrid", "cholmod-metis", "cholmod-amd", "cholmod-equidem"}));
        app.add_option("kind", trial.kind, "assembly")->required()->check(CLI::IsMember(assembly_kinds()));
        app.add_option("discs", trial.discs)->required()->check(CLI::PositiveNumber);
        app.add_option("threads", trial.threads)->required()->check(CLI::PositiveNumber);
      },
      [&](Report& report) { report.add(measure(trial).json()); });
}
