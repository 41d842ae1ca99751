// SPDX-License-Identifier: GPL-3.0-or-later
// Static solves side by side with CHOLMOD: bench_static --help.
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <unistd.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/json.hpp"

#include "comparison.hpp"
#include "matrix_file.hpp"
#include "measurement.hpp"
#include "problem.hpp"

namespace equidem::bench {
namespace {

struct Request {
  std::vector<double> discs = {1e4, 1e5};
  std::vector<std::string> kinds = problem_kinds();
  std::vector<std::string> solvers;
  std::vector<int> threads = {1, 2};
  int repetitions = 0;
  std::string json_file, markdown_file, matrix_file;
};

int default_repetitions(double discs) {
  return discs < 3e4 ? 9 : discs < 3e5 ? 5 : 3;
}

void write(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  if (!file.flush()) bad_input(fmt::format("'{}' cannot be written", path), "", "Choose another path");
}

void run(const Request& request) {
  std::string report = fmt::format("equidem {}, {}\n\n{}", library_version(), describe_machine(), explain_tables());
  std::printf("%s", report.c_str());
  std::vector<Results> comparisons;
  for (const std::string& kind : request.kinds) {
    for (const double discs : request.discs) {
      ComparisonOptions options{
          .kind = kind,
          .discs = std::llround(discs),
          .solvers = request.solvers,
          .threads = request.threads,
          .repetitions = request.repetitions > 0 ? request.repetitions : default_repetitions(discs)};
      const bool watched = isatty(STDERR_FILENO) != 0;
      const Comparison comparison = compare(options, [&](int repetition, const Trial& trial) {
        if (!watched) return;
        std::fprintf(stderr, "\r\033[K%s, %lld discs, round %d of %d: %s, %s", kind.c_str(),
                     static_cast<long long>(trial.discs), repetition + 1, options.repetitions, trial.solver.c_str(),
                     counted(trial.threads, "thread").c_str());
      });
      if (watched) std::fprintf(stderr, "\r\033[K");
      const std::string text = "\n" + tables(comparison);
      std::printf("%s", text.c_str());
      std::fflush(stdout);
      report += text;
      comparisons.push_back(json(comparison));
    }
  }
  if (!request.markdown_file.empty()) write(request.markdown_file, "# Static solves\n" + report);
  if (!request.json_file.empty()) {
    Results object;
    object.set("version", library_version()).set("machine", describe_machine());
    write(request.json_file, object.set("comparisons", comparisons).json());
  }
}

int parse_and_run(int argc, char** argv) {
  CLI::App program("Static solves side by side with CHOLMOD, each in a fresh process.", "bench_static");
  Request request;
  std::vector<std::string> names;
  for (const Solver& solver : solvers()) names.push_back(solver.name);
  request.solvers = names;
  program.add_option("--discs", request.discs, "numbers of discs")->delimiter(',')->check(CLI::PositiveNumber);
  program.add_option("--kinds", request.kinds, "assemblies")->delimiter(',')->check(CLI::IsMember(problem_kinds()));
  program.add_option("--solvers", request.solvers, "who takes part")->delimiter(',')->check(CLI::IsMember(names));
  program.add_option("--threads", request.threads, "numbers of threads")->delimiter(',')->check(CLI::PositiveNumber);
  program.add_option("--repetitions", request.repetitions, "rounds; the default falls with the size");
  program.add_option("--json", request.json_file, "file for all numbers");
  program.add_option("--markdown", request.markdown_file, "file for the tables");
  program.add_option("--write-matrix", request.matrix_file,
                     "no comparison: write the matrix of the first kind and size to this file, see matrix_file.hpp");
  CLI11_PARSE(program, argc, argv);
  if (!request.matrix_file.empty()) {
    write_matrix_file(request.matrix_file, request.kinds.front(), std::llround(request.discs.front()));
    return 0;
  }
  run(request);
  return 0;
}

}  // namespace
}  // namespace equidem::bench

int main(int argc, char** argv) {
  using namespace equidem;
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  try {
    if (!arguments.empty() && arguments[0] == bench::measure_option) {
      return bench::serve_measurement({arguments.begin() + 1, arguments.end()});
    }
    if (arguments.size() == 2 && arguments[0] == bench::warm_up_option) {
      return bench::serve_warm_up(std::stod(arguments[1]));
    }
    return bench::parse_and_run(argc, argv);
  } catch (const Error& error) {
    std::fprintf(stderr, "bench_static: %s\n", error.what());
    return error.exit_code();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_static: %s\n", error.what());
    return 1;
  }
}
