// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Static solves side by side with CHOLMOD: bench_static --help.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <CLI/CLI.hpp>
#include <unistd.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/results.hpp"

#include "bench.hpp"
#include "command.hpp"
#include "measurement.hpp"

namespace equidem::bench {
namespace {

struct Request {
  std::vector<double> discs = {1e4, 1e5};
  std::vector<std::string> kinds = assembly_kinds();
  std::vector<std::string> solvers;
  std::vector<int> threads = {1, 2};
  int repetitions = 0;
  std::string json_file, matrix_file;
  std::vector<std::string> measured;  ///< by this process alone: solver, kind, discs, threads
  double warm_up = 0;                 ///< bytes to touch
};

/// The numbers of a measurement by name.
constexpr std::pair<const char*, double Measurement::*> fields[] = {
    {"discs", &Measurement::discs},
    {"unknowns", &Measurement::unknowns},
    {"assembly", &Measurement::assembly},
    {"convert", &Measurement::convert},
    {"order", &Measurement::order},
    {"analyze", &Measurement::analyze},
    {"factorize", &Measurement::factorize},
    {"solve", &Measurement::solve},
    {"iterations", &Measurement::iterations},
    {"nonzeros", &Measurement::nonzeros},
    {"factor_bytes", &Measurement::factor_bytes},
    {"residual", &Measurement::residual},
    {"peak_bytes", &Measurement::peak_bytes},
    {"cpu", &Measurement::cpu},
};

bool is_ours(const std::string& solver) {
  return solver.starts_with("equidem");
}

/// Runs this program again. \param settings environment variables of the shell \return its output
std::string run_again(const std::string& settings, const std::string& arguments) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  std::FILE* output = popen(fmt::format("{} exec '{}' {}", settings, program, arguments).c_str(), "r");
  if (output == nullptr) computation_failed("a fresh process could not be started", "", "");
  std::string text;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), output))
    text.append(buffer.data(), count);
  if (pclose(output) != 0) computation_failed(fmt::format("'bench_static {}' failed", arguments), "", "");
  return text;
}

/// Measure in a fresh process, with peak memory and thread settings of its own. Another process first touches as much
/// memory as the solution needs, because memory that the system hands out for the first time is slow.
Measurement measure_in_fresh_process(const Trial& trial) {
  const double free = static_cast<double>(sysconf(_SC_AVPHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  run_again("", fmt::format("--warm-up {}", std::min(2e8 + 8e3 * static_cast<double>(trial.discs), 0.5 * free)));
  const std::string output =
      run_again("OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1",
                fmt::format("--measure {} {} {} {}", trial.solver, trial.kind, trial.discs, trial.threads));
  Measurement result;
  std::istringstream numbers(output);
  for (const auto& [name, member] : fields) numbers >> result.*member;
  return result;
}

/// One solver with one number of threads; run r of every solver stems from the same round.
struct Series {
  Trial trial;
  std::vector<Measurement> runs;

  /// \param value member or function of a measurement
  template <class Value>
  [[nodiscard]] std::vector<double> values(Value value) const {
    std::vector<double> all;
    for (const Measurement& run : runs) all.push_back(std::invoke(value, run));
    return all;
  }
  template <class Value>
  [[nodiscard]] double median(Value value) const {
    return range_of(values(value)).median;
  }
  [[nodiscard]] const std::string& label() const {
    return std::ranges::find(solvers(), trial.solver, &Solver::name)->label;
  }
};

/// Every solver runs once in every round, so that a disturbance of the machine affects all of them.
std::vector<Series> compare(const Request& request, const std::string& kind, double discs) {
  std::vector<Series> all;
  for (const std::string& solver : request.solvers)
    for (const int threads : request.threads) all.push_back({{solver, kind, std::llround(discs), threads}, {}});
  const int rounds = request.repetitions > 0 ? request.repetitions : discs < 3e4 ? 9 : discs < 3e5 ? 5 : 3;
  const bool watched = isatty(STDERR_FILENO) != 0;
  for (int round = 0; round < rounds; ++round) {
    for (Series& series : all) {
      if (watched)
        std::fprintf(stderr, "\r\033[K%s, %.0f discs, round %d of %d: %s, %s", kind.c_str(), discs, round + 1, rounds,
                     series.trial.solver.c_str(), counted(series.trial.threads, "thread").c_str());
      series.runs.push_back(measure_in_fresh_process(series.trial));
    }
  }
  if (watched) std::fprintf(stderr, "\r\033[K");
  return all;
}

std::string medians(const std::vector<Series>& all) {
  using M = Measurement;
  TextTable table(
      "solver & threads & order & analyze & factorize & solve & total, s & iterations & K & nnz(L) & stored/nnz(L) & "
      "factor, MB & peak, MB & peak/factor & CPU & residual");
  for (const Series& s : all) {
    const bool factor = s.median(&M::nonzeros) > 0, stored = s.median(&M::factor_bytes) > 0;
    table.add(
        "{} & {} & {:.3g} & {:.3g} & {:.3g} & {:.3g} & {} & {} & {:.3g} & {} & {} & {} & {:.0f} & {} & {:.3g} & {:.1e}",
        s.label(), s.trial.threads, s.median(&M::order), s.median(&M::analyze), s.median(&M::factorize),
        s.median(&M::solve), range_of(s.values(&M::total)).text("{:.3g}"),
        s.median(&M::iterations) > 0 ? fmt::format("{:.0f}", s.median(&M::iterations)) : "-", s.median(&M::assembly),
        factor ? fmt::format("{:.3e}", s.median(&M::nonzeros)) : "-",
        factor ? fmt::format("{:.2f}", s.median(&M::stored_over_nonzeros)) : "-",
        stored ? fmt::format("{:.0f}", 1e-6 * s.median(&M::factor_bytes)) : "-", 1e-6 * s.median(&M::peak_bytes),
        stored ? fmt::format("{:.2f}", s.median(&M::peak_over_factor)) : "-", s.median(&M::cpu),
        s.median(&M::residual));
  }
  return table.markdown();
}

/// equidem over CHOLMOD with its own orderings, and its methods over those before them in the list: medians of the
/// ratios within each round.
std::string ratios(const std::vector<Series>& all) {
  using M = Measurement;
  TextTable table("of & over & threads & total & nnz(L) & peak & K / total of equidem");
  for (const Series& ours : all) {
    for (const Series& theirs : all) {
      const bool peer = theirs.trial.solver == "cholmod-metis" || theirs.trial.solver == "cholmod-amd" ||
                        (is_ours(theirs.trial.solver) && &theirs < &ours);
      if (!is_ours(ours.trial.solver) || !peer || theirs.trial.threads != ours.trial.threads) continue;
      const auto ratio = [&](auto value) { return ratio_of(ours.values(value), theirs.values(value)); };
      const bool factors = ours.median(&M::nonzeros) > 0 && theirs.median(&M::nonzeros) > 0;
      table.add("{} & {} & {} & {} & {} & {:.2f} & {:.1f} %", ours.label(), theirs.label(), ours.trial.threads,
                ratio(&M::total).text("{:.3g}"), factors ? fmt::format("{:.3f}", ratio(&M::nonzeros).median) : "-",
                ratio(&M::peak_bytes).median, 100 * ratio_of(ours.values(&M::assembly), ours.values(&M::total)).median);
    }
  }
  return table.empty() ? "" : "\n" + table.markdown();
}

Results json(const std::string& kind, const std::vector<Series>& all) {
  std::vector<Results> list;
  for (const Series& series : all) {
    Results entry;
    entry.set("solver", series.trial.solver).set("threads", series.trial.threads);
    for (const auto& [name, member] : fields) entry.set(name, series.values(member));
    list.push_back(entry);
  }
  return Results().set("kind", kind).set("series", list);
}

void run(Report& report, const Request& request) {
  const std::string threads = joined(
      solvers(), [](const Solver& solver) { return fmt::format("{}: {}", solver.label, solver.threads); }, "; ");
  report.begin("Static solves");
  report.add(fmt::format(
      "\nkT/kN = 0.5, 3 unknowns per disc, left side fixed, load on the right side. Seconds, "
      "medians (smallest .. largest); total = order + analyze + factorize + solve, one right-hand side, no refinement. "
      "Multigrid: factorize is the set-up of the grids, solve ends at a residual of the "
      "contact "
      "law of 1e-12; K is assembled afterwards, for the residual of the table alone. The residual of the table is "
      "computed by equidem for all. K: assembly "
      "of the stiffness "
      "matrix, not in the total. nnz(L): lower triangle, without explicit zeros. Factor: stored of L; stored/nnz(L) "
      "counts 8 bytes an entry. Peak: of the whole process, the assembly and K included. CPU: seconds of all threads "
      "since the start of the process, the set-up of the problem included; it depends least on other load of the "
      "machine. Every run is a fresh process, solvers take turns.\n"
      "Threads of {}. CHOLMOD runs supernodal, with 32-bit indices and OMP_THREAD_LIMIT=1.\n",
      threads));
  std::vector<Results> comparisons;
  for (const std::string& kind : request.kinds) {
    for (const double discs : request.discs) {
      const std::vector<Series> all = compare(request, kind, discs);
      const Measurement& first = all.at(0).runs.at(0);
      report.add(fmt::format("\n{}, {:.0f} discs, {:.0f} unknowns, {} rounds\n\n{}{}", kind, first.discs,
                             first.unknowns, all[0].runs.size(), medians(all), ratios(all)));
      comparisons.push_back(json(kind, all));
    }
  }
  if (request.json_file.empty()) return;
  write(request.json_file, Results()
                               .set("version", library_version())
                               .set("machine", machine_text())
                               .set("comparisons", comparisons)
                               .json());
}

void touch_memory(double bytes) {
  const auto size = static_cast<std::size_t>(bytes);
  auto* memory = static_cast<volatile char*>(std::malloc(size));
  for (std::size_t at = 0; memory != nullptr && at < size; at += 4096) memory[at] = 1;
}

void measure_here(const std::vector<std::string>& words) {
  const Measurement result =
      measure({.solver = words[0], .kind = words[1], .discs = std::stoll(words[2]), .threads = std::stoi(words[3])});
  for (const auto& [name, member] : fields) std::printf("%.17g\n", result.*member);
}

}  // namespace
}  // namespace equidem::bench

int main(int argc, char** argv) {
  using namespace equidem::bench;
  Request request;
  std::vector<std::string> names;
  for (const Solver& solver : solvers()) names.push_back(solver.name);
  request.solvers = names;
  return run_benchmark(
      "bench_static", "Static solves side by side with CHOLMOD, each in a fresh process", argc, argv,
      [&](CLI::App& app) {
        app.add_option("--discs", request.discs, "numbers of discs")->delimiter(',')->check(CLI::PositiveNumber);
        app.add_option("--kinds", request.kinds, "assemblies")->delimiter(',')->check(CLI::IsMember(assembly_kinds()));
        app.add_option("--solvers", request.solvers, "solvers to compare")->delimiter(',')->check(CLI::IsMember(names));
        app.add_option("--threads", request.threads, "numbers of threads")->delimiter(',')->check(CLI::PositiveNumber);
        app.add_option("--repetitions", request.repetitions, "rounds; the default falls with the size");
        app.add_option("--json", request.json_file, "file for all numbers");
        app.add_option("--write-matrix", request.matrix_file,
                       "no comparison: write the matrix of the first kind and size to this file (measurement.hpp)");
        app.add_option("--measure", request.measured)->expected(4)->group("");  // not in the help
        app.add_option("--warm-up", request.warm_up)->group("");
      },
      [&](Report& report) {
        if (!request.measured.empty())
          measure_here(request.measured);
        else if (request.warm_up > 0)
          touch_memory(request.warm_up);
        else if (!request.matrix_file.empty())
          write_matrix_file(request.matrix_file, request.kinds.front(), std::llround(request.discs.front()));
        else
          run(report, request);
      });
}
