// SPDX-License-Identifier: GPL-3.0-or-later
#include "measurement.hpp"

#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/cholmod_factorization.hpp"
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"
#include "equidem/statics/assemble_stiffness.hpp"

#include "fill.hpp"
#include "problem.hpp"

namespace equidem::bench {
namespace {

void check_factor(const std::unique_ptr<Factorization>& factor) {
  if (!factor) computation_failed("the stiffness matrix is not positive definite", "", "");
}

/// Order, analyze and factorize; the entries of L are counted, as fronts hold zeros besides.
std::unique_ptr<Factorization> multifrontal(const Problem& problem, const StiffnessMatrix& matrix,
                                            Measurement& result) {
  Stopwatch watch;
  const ContactGraph graph(problem.assembly);
  DissectionTree tree = dissect(problem.assembly, graph);
  result.order = watch.lap();
  auto symbolic = std::make_shared<const SymbolicFactor>(analyze(std::move(tree), graph, matrix.block));
  result.analyze = watch.lap();
  auto factor = multifrontal_cholesky(symbolic, {matrix, problem.assembly, graph});
  result.factorize = watch.lap();
  result.nonzeros = count_factor_entries(graph, problem.unknowns, symbolic->tree.order);
  return factor;
}

std::unique_ptr<Factorization> cholmod(const Problem& problem, const StiffnessMatrix& matrix, CholmodOrdering ordering,
                                       Measurement& result) {
  Stopwatch watch;
  const ContactGraph graph(problem.assembly);
  std::vector<std::int32_t> order;
  if (ordering == CholmodOrdering::ours) {
    watch.lap();
    order = dissect(problem.assembly, graph).order;
    result.order = watch.lap();
  }
  CholmodTrial trial{.keep_thread_settings = true, .times = {}};
  auto factor = cholmod_cholesky({matrix, problem.assembly, graph}, problem.unknowns, ordering, order, nullptr, &trial);
  result.convert = trial.times.of("compression");
  result.order += trial.times.of("ordering");
  result.analyze = trial.times.of("analysis");
  result.factorize = trial.times.of("factorization");
  return factor;
}

double relative_residual(const Problem& problem, const StiffnessMatrix& matrix, const ContactGraph& graph,
                         const std::vector<double>& x) {
  std::vector<double> y(x.size());
  multiply(matrix, problem.assembly, graph, x, y);
  double difference = 0, size = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    difference += (problem.load[k] - y[k]) * (problem.load[k] - y[k]);
    size += problem.load[k] * problem.load[k];
  }
  return std::sqrt(difference / size);
}

}  // namespace

const std::vector<Solver>& solvers() {
  static const std::vector<Solver> list = {
      {"equidem", "equidem multifrontal", "threads"},
      {"cholmod-metis", "CHOLMOD, METIS on the unknowns", "BLAS threads"},
      {"cholmod-amd", "CHOLMOD, AMD on the unknowns", "BLAS threads"},
      {"cholmod-ours", "CHOLMOD, order of equidem", "BLAS threads"},
  };
  return list;
}

Measurement measure(const Trial& trial) {
  set_thread_count(trial.threads);
  const Problem problem = build_problem(trial.kind, trial.discs);
  Measurement result;
  result.discs = static_cast<double>(problem.assembly.size());
  result.unknowns = static_cast<double>(problem.unknowns.unknowns);
  StiffnessMatrix matrix;
  {
    const ContactGraph graph(problem.assembly);
    Stopwatch watch;
    matrix = assemble_stiffness(problem.assembly, graph, problem.springs, problem.unknowns);
    result.assembly = watch.lap();
  }
  std::unique_ptr<Factorization> factor;
  if (trial.solver == "equidem") {
    factor = multifrontal(problem, matrix, result);
  } else if (trial.solver == "cholmod-metis") {
    factor = cholmod(problem, matrix, CholmodOrdering::metis, result);
  } else if (trial.solver == "cholmod-amd") {
    factor = cholmod(problem, matrix, CholmodOrdering::amd, result);
  } else if (trial.solver == "cholmod-ours") {
    factor = cholmod(problem, matrix, CholmodOrdering::ours, result);
  } else {
    bad_input(fmt::format("there is no solver '{}'", trial.solver), "", "--help lists them");
  }
  check_factor(factor);
  std::vector<double> x = problem.load;
  Stopwatch watch;
  factor->solve(x, 1);
  result.solve = watch.lap();
  if (result.nonzeros == 0) result.nonzeros = factor->report().nonzeros;
  result.factor_bytes = factor->report().bytes;
  result.residual = relative_residual(problem, matrix, ContactGraph(problem.assembly), x);
  return result;
}

}  // namespace equidem::bench
