// SPDX-License-Identifier: GPL-3.0-or-later
#include "measurement.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>
#include <span>
#include <utility>

#include <sys/resource.h>

#include "equidem/contact/effects.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/cholmod_factorization.hpp"
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"
#include "equidem/linear/multigrid/multigrid_solver.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/number_unknowns.hpp"
#include "equidem/statics/supports.hpp"

#include "bench.hpp"

namespace equidem::bench {
namespace {

/// kT/kN = 0.5, three unknowns per disc.
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

/// Entries of L in its lower triangle over the components that are not held, without the explicit zeros of dense
/// blocks: the row subtrees of the elimination tree (Liu 1990), disc by disc, one step per block of L.
double count_factor_entries(const ContactGraph& graph, const DegreesOfFreedom& unknowns,
                            const std::vector<std::int32_t>& order) {
  const std::size_t discs = order.size(), block = static_cast<std::size_t>(unknowns.per_disc);
  std::vector<std::int32_t> position(discs), parent(discs, -1), visited(discs, -1);
  std::vector<int> free(discs, 0);  // components not held, by position
  for (std::size_t p = 0; p < discs; ++p) {
    const auto disc = static_cast<std::size_t>(order[p]);
    position[disc] = static_cast<std::int32_t>(p);
    for (std::size_t k = 0; k < block; ++k) free[p] += unknowns.held[disc * block + k] == 0 ? 1 : 0;
  }
  double entries = 0;
  for (std::size_t p = 0; p < discs; ++p) {
    if (free[p] == 0) continue;
    const auto row = static_cast<std::int32_t>(p);
    visited[p] = row;
    entries += 0.5 * free[p] * (free[p] + 1);
    for (const auto& edge : graph.of(static_cast<std::size_t>(order[p]))) {
      std::int32_t column = position[edge.other];
      if (column > row || free[column] == 0) continue;
      while (visited[column] != row) {
        visited[column] = row;
        entries += static_cast<double>(free[p]) * free[column];
        if (parent[column] < 0) parent[column] = row;
        column = parent[column];
      }
    }
  }
  return entries;
}

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
  result.nonzeros = count_factor_entries(graph, problem.unknowns, symbolic->tree.order);  // fronts also hold zeros
  return factor;
}

std::unique_ptr<Factorization> cholmod(const Problem& problem, const StiffnessMatrix& matrix, CholmodOrdering ordering,
                                       Measurement& result) {
  const ContactGraph graph(problem.assembly);
  std::vector<std::int32_t> order;
  if (ordering == CholmodOrdering::equidem) {
    const Stopwatch watch;
    order = dissect(problem.assembly, graph).order;
    result.order = watch.seconds();
  }
  const Stopwatch watch;
  auto factor = cholmod_cholesky({matrix, problem.assembly, graph}, problem.unknowns, ordering, order);
  result.factorize = watch.seconds();  // with CHOLMOD's ordering and analysis
  return factor;
}

std::unique_ptr<Factorization> factorize(const std::string& solver, const Problem& problem,
                                         const StiffnessMatrix& matrix, Measurement& result) {
  if (solver == "equidem") return multifrontal(problem, matrix, result);
  const CholmodOrdering ordering = solver == "cholmod-metis" ? CholmodOrdering::metis
                                   : solver == "cholmod-amd" ? CholmodOrdering::amd
                                                             : CholmodOrdering::equidem;
  return cholmod(problem, matrix, ordering, result);
}

/// As equidem solves: passes until the residual of the contact law is small enough.
void solve_by_multigrid(const Problem& problem, const ContactGraph& graph, const Factorization& factor,
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

void write_matrix(const std::filesystem::path& path, const Problem& problem, const CompressedColumns& columns) {
  const auto per_disc = problem.unknowns.per_disc;
  std::vector<double> load, x, y;
  std::vector<std::int32_t> component;
  for (const std::int64_t k : columns.component) {
    load.push_back(problem.load[static_cast<std::size_t>(k)]);
    const Vec2 place =
        problem.assembly.centres[static_cast<std::size_t>(k / per_disc)] / problem.unknowns.rotation_scale;
    x.push_back(place.x);
    y.push_back(place.y);
    component.push_back(static_cast<std::int32_t>(k % per_disc));
  }
  std::ofstream file(path, std::ios::binary);
  const auto put = [&]<class Number>(const std::vector<Number>& numbers) {
    file.write(reinterpret_cast<const char*>(numbers.data()),
               static_cast<std::streamsize>(numbers.size() * sizeof(Number)));
  };
  put(std::vector<std::int64_t>{columns.size, static_cast<std::int64_t>(columns.values.size()), per_disc, 0});
  put(std::vector<std::int32_t>(columns.first.begin(), columns.first.end()));
  put(std::vector<std::int32_t>(columns.rows.begin(), columns.rows.end()));
  for (const auto& numbers : {columns.values, load, x, y}) put(numbers);
  put(component);
  if (!file.flush()) bad_input(fmt::format("'{}' cannot be written", path.string()), "", "Choose another path");
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

const std::vector<Solver>& solvers() {
  static const std::vector<Solver> list = [] {
    std::vector<Solver> all{
        {"equidem", "equidem multifrontal", "threads"},
        {"equidem-multigrid", "equidem multigrid", "threads"},
        {"cholmod-metis", "CHOLMOD, METIS on the unknowns", "one"},
        {"cholmod-amd", "CHOLMOD, AMD on the unknowns", "one"},
        {"cholmod-ours", "CHOLMOD, order of equidem", "one"},
    };
    return all;
  }();
  return list;
}

Measurement measure(const Trial& trial) {
  return_freed_memory();  // as the program does
  set_thread_count(trial.threads);
  const Problem problem = build_problem(trial.kind, trial.discs);
  Measurement result{.discs = static_cast<double>(problem.assembly.size()),
                     .unknowns = static_cast<double>(problem.unknowns.unknowns)};
  const bool iterates = trial.solver == "equidem-multigrid";
  const ContactGraph graph(problem.assembly);
  StiffnessMatrix matrix;
  const auto assemble = [&] {
    const Stopwatch watch;
    matrix = assemble_stiffness(problem.assembly, graph, problem.springs, problem.unknowns);
    result.assembly = watch.seconds();
  };
  if (!iterates) assemble();
  std::unique_ptr<Factorization> factor;
  if (iterates) {
    const Stopwatch watch;
    factor = multigrid_solver({problem.assembly, graph, problem.springs, problem.unknowns});
    result.factorize = watch.seconds();
  } else {
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
  if (result.nonzeros == 0) result.nonzeros = factor->report().nonzeros;
  result.factor_bytes = factor->report().bytes;
  result.iterations = static_cast<double>(factor->report().iterations);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  result.peak_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  result.cpu = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  if (iterates) assemble();  // for the residual alone
  result.residual = relative_residual(problem, matrix, x);
  return result;
}

void write_matrix_file(const std::string& path, const std::string& kind, std::int64_t discs) {
  const Problem problem = build_problem(kind, discs);
  const ContactGraph graph(problem.assembly);
  write_matrix(path, problem,
               compress(assemble_stiffness(problem.assembly, graph, problem.springs, problem.unknowns),
                        problem.assembly, graph, problem.unknowns));
}

}  // namespace equidem::bench
