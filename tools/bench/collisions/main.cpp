// SPDX-License-Identifier: GPL-3.0-or-later
// What collisions cost, law by law: bench_collisions --help.
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/json.hpp"

#include "absent_effects.hpp"
#include "accuracy.hpp"
#include "laws.hpp"

namespace equidem::bench {
namespace {

struct Request {
  int rounds = 9, halvings = 10;
  std::vector<std::string> scenes = {"ball", "stack", "gas"};
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

constexpr const char* introduction = R"(# Collisions

equidem {0}, compiler {1}, `bench_collisions --rounds {2} --halvings {3}`. One thread, processor time; medians
(smallest .. largest) of {2} rounds in which all take turns. Laws: C linear spring and dashpot, T Hertz spring and
dashpot, F and P the maps of Fujioka & Ushijima, X the linear spring and dashpot solved exactly within the step.
Dimensionless stiffness a = k dt²/m = 0.1 (T: 4.62) where nothing else is said.

## An evaluation of each law

The law alone, on all steps of impacts with random speed and phase, in random order; e = 0.7.

)";

void run(const Request& request) {
  Report report;
  report.add(fmt::format(introduction, library_version(), __VERSION__, request.rounds, request.halvings));
  report.add(compare_laws(2000, request.rounds));
  report.add(
      "\nIn the simulation, everything that a step does. 2500 discs that keep colliding in a box, solid fraction 0.6, "
      "e = 1:\n\n");
  report.add(compare_in_simulation("gas", request.rounds));
  report.add("\n2500 discs packed by gravity, e = 0.7, contacts that last:\n\n");
  report.add(compare_in_simulation("bed", request.rounds));
  report.add(
      "\n## Time at equal accuracy\n\nThe dimensionless stiffness is held as the step falls: all laws tend to rigid "
      "bodies, for which the truth is known.\n");
  for (const std::string& scene : request.scenes) report.add("\n" + compare_accuracy(scene, request.halvings, 3));
  report.add(
      "\n## What is not there\n\nFree flight: 10000 discs that fall, drift and touch nothing, beside `v += g dt; x "
      "+= v dt`.\n\n");
  report.add(compare_free_flight(10000, request.rounds));
  report.add(
      "\nFriction: 2500 discs packed in a box, beside a loop for discs without friction, spin, ledger and search "
      "for neighbours.\n\n");
  report.add(compare_friction(50, 50, request.rounds));
  if (request.file.empty()) return;
  std::ofstream out(request.file);
  out << report.text();
  if (!out.flush()) bad_input(fmt::format("'{}' cannot be written", request.file), "", "Choose another path");
}

int parse_and_run(int argc, char** argv) {
  CLI::App program("What collisions cost: laws side by side, at equal accuracy, and what is not there.",
                   "bench_collisions");
  Request request;
  program.add_option("--rounds", request.rounds, "of all contenders in turn")->check(CLI::PositiveNumber);
  program.add_option("--halvings", request.halvings, "of the coarsest step, at equal accuracy")
      ->check(CLI::PositiveNumber);
  program.add_option("--scenes", request.scenes, "at equal accuracy")
      ->delimiter(',')
      ->check(CLI::IsMember({"ball", "stack", "gas"}));
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
    std::fprintf(stderr, "bench_collisions: %s\n", error.what());
    return error.exit_code();
  }
}
