// SPDX-License-Identifier: GPL-3.0-or-later
// Speed of the loop over time: bench_dynamic --help.
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/json.hpp"

#include "comparison.hpp"
#include "machine_limits.hpp"
#include "scene.hpp"

namespace equidem::bench {
namespace {

struct Request {
  std::vector<double> discs = {1e4, 1e6};
  std::vector<std::string> kinds = assembly_kinds();
  std::vector<int> threads = {1, 2};
  double effects_discs = 1e4;
  int rounds = 9;
  std::string file;
};

class Report {
 public:
  void add(const std::string& text) {
    std::printf("%s", text.c_str());
    std::fflush(stdout);
    text_ += text;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void run(const Request& request) {
  const Limits limits{.bandwidth = triad_bandwidth(), .arithmetic = peak_arithmetic()};
  const auto effects_discs = static_cast<std::int64_t>(request.effects_discs);
  Report report;
  report.add(fmt::format(
      "# Steps in time\n\nequidem {}, compiler {}. One core of this machine: triad {:.1f} GB/s, multiply-adds on four "
      "numbers {:.1f} Gflop/s.\nMedians (smallest .. largest) of {} rounds in which all take turns; one thread: "
      "processor time, more: the clock.\n",
      library_version(), __VERSION__, 1e-9 * limits.bandwidth, 1e-9 * limits.arithmetic, request.rounds));
  report.add(
      "\n## Beside plain loops\n\nSprings kN and kT, rotation, small motions, leapfrog. Bandwidth counts what a loop "
      "would stream "
      "if nothing stayed in the cache.\n\n" +
      loops_header());
  for (const std::string& kind : request.kinds) {
    for (const double discs : request.discs) {
      report.add(compare_loops(kind, static_cast<std::int64_t>(discs), request.threads, request.rounds, limits));
    }
  }
  report.add("\n## Memory\n\nAll that is allocated and kept, counted by the allocator.\n\n");
  for (const std::string& kind : request.kinds) {
    report.add(count_memory(kind, static_cast<std::int64_t>(request.discs.back())) + "\n");
  }
  for (const std::string& kind : request.kinds) {
    report.add(fmt::format("\n## What effects cost: {}, {} discs\n\n", kind, effects_discs));
    report.add(compare_effects(kind, effects_discs, request.rounds));
    report.add("\nWhat absent effects cost: each scene beside a loop written by hand for it alone.\n\n");
    report.add(compare_absent_effects(kind, effects_discs, 3 * request.rounds));
  }
  if (request.file.empty()) return;
  std::ofstream out(request.file);
  out << report.text();
  if (!out.flush()) bad_input(fmt::format("'{}' cannot be written", request.file), "", "Choose another path");
}

int parse_and_run(int argc, char** argv) {
  CLI::App program("Steps in time, side by side with plain loops, and what each effect costs.", "bench_dynamic");
  Request request;
  program.add_option("--discs", request.discs, "numbers of discs")->delimiter(',')->check(CLI::PositiveNumber);
  program.add_option("--kinds", request.kinds, "assemblies")->delimiter(',')->check(CLI::IsMember(assembly_kinds()));
  program.add_option("--threads", request.threads, "numbers of threads")->delimiter(',')->check(CLI::PositiveNumber);
  program.add_option("--effects-discs", request.effects_discs, "discs for the tables of effects")
      ->check(CLI::PositiveNumber);
  program.add_option("--rounds", request.rounds, "of all contenders in turn")->check(CLI::PositiveNumber);
  program.add_option("--markdown", request.file, "file for the tables");
  CLI11_PARSE(program, argc, argv);
  run(request);
  return 0;
}

}  // namespace
}  // namespace equidem::bench

int main(int argc, char** argv) {
  try {
    return equidem::bench::parse_and_run(argc, argv);
  } catch (const equidem::Error& error) {
    std::fprintf(stderr, "bench_dynamic: %s\n", error.what());
    return error.exit_code();
  }
}
