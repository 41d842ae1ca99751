// SPDX-License-Identifier: GPL-3.0-or-later
#include "comparison.hpp"

#include <algorithm>
#include <fstream>
#include <thread>

#include "equidem/core/text.hpp"

namespace equidem::bench {
namespace {

struct Range {
  double median = 0, smallest = 0, largest = 0;
};

Range range_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values.front(), values.back()};
}

template <typename Value>
Range range_of(const Series& series, Value value) {
  std::vector<double> values;
  for (const Measurement& run : series.runs) values.push_back(value(run));
  return range_of(std::move(values));
}

/// a over b, round by round.
template <typename Value>
Range ratio_of(const Series& a, const Series& b, Value value) {
  std::vector<double> ratios;
  for (std::size_t r = 0; r < a.runs.size(); ++r) ratios.push_back(value(a.runs[r]) / value(b.runs[r]));
  return range_of(std::move(ratios));
}

const Solver& solver_of(const Trial& trial) {
  return *std::find_if(solvers().begin(), solvers().end(),
                       [&](const Solver& solver) { return solver.name == trial.solver; });
}

std::string with_range(const Range& range) {
  return fmt::format("{:.3g} ({:.3g}..{:.3g})", range.median, range.smallest, range.largest);
}

using Row = std::vector<std::string>;

std::string markdown(const std::vector<Row>& rows) {
  std::vector<std::size_t> width(rows[0].size(), 3);
  for (const Row& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], row[c].size());
  }
  std::string text;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < width.size(); ++c) text += fmt::format("| {:<{}} ", rows[r][c], width[c]);
    text += "|\n";
    if (r > 0) continue;
    for (const std::size_t w : width) text += "|" + std::string(w + 2, '-');
    text += "|\n";
  }
  return text;
}

std::string medians_table(const Comparison& comparison) {
  std::vector<Row> rows = {{"solver", "threads", "order", "analyze", "factorize", "solve", "total (min..max), s", "K",
                            "nnz(L)", "stored/nnz(L)", "factor, MB", "peak, MB", "peak/factor", "CPU", "residual"}};
  for (const Series& s : comparison.series) {
    const auto median = [&](double Measurement::*value) {
      return range_of(s, [value](const Measurement& run) { return run.*value; }).median;
    };
    const auto stage = [&](double Measurement::*value) { return fmt::format("{:.3g}", median(value)); };
    rows.push_back(
        {solver_of(s.trial).label, fmt::format("{}", s.trial.threads), stage(&Measurement::order),
         stage(&Measurement::analyze), stage(&Measurement::factorize), stage(&Measurement::solve),
         with_range(range_of(s, [](const Measurement& run) { return run.total(); })), stage(&Measurement::assembly),
         fmt::format("{:.3e}", median(&Measurement::nonzeros)),
         fmt::format("{:.2f}", median(&Measurement::factor_bytes) / sizeof(double) / median(&Measurement::nonzeros)),
         fmt::format("{:.0f}", median(&Measurement::factor_bytes) * 1e-6),
         fmt::format("{:.0f}", median(&Measurement::peak_bytes) * 1e-6),
         fmt::format("{:.2f}", median(&Measurement::peak_bytes) / median(&Measurement::factor_bytes)),
         stage(&Measurement::cpu), fmt::format("{:.1e}", median(&Measurement::residual))});
  }
  return markdown(rows);
}

std::string ratios_table(const Comparison& comparison) {
  std::vector<Row> rows = {{"equidem over", "threads", "total (min..max)", "nnz(L)", "peak", "K / total of equidem"}};
  for (const Series& ours : comparison.series) {
    if (ours.trial.solver != "equidem") continue;
    for (const Series& theirs : comparison.series) {
      const bool peer = theirs.trial.solver == "cholmod-metis" || theirs.trial.solver == "cholmod-amd";
      if (!peer || theirs.trial.threads != ours.trial.threads) continue;
      const auto share = range_of(ours, [](const Measurement& run) { return run.assembly / run.total(); });
      rows.push_back(
          {solver_of(theirs.trial).label, fmt::format("{}", ours.trial.threads),
           with_range(ratio_of(ours, theirs, [](const Measurement& run) { return run.total(); })),
           fmt::format("{:.3f}", ratio_of(ours, theirs, [](const Measurement& run) { return run.nonzeros; }).median),
           fmt::format("{:.2f}", ratio_of(ours, theirs, [](const Measurement& run) { return run.peak_bytes; }).median),
           fmt::format("{:.1f} %", 100 * share.median)});
    }
  }
  return rows.size() == 1 ? "" : markdown(rows);
}

}  // namespace

Comparison compare(const ComparisonOptions& options,
                   const std::function<void(int repetition, const Trial&)>& progress) {
  Comparison comparison{options.kind, options.discs, {}};
  for (const std::string& solver : options.solvers) {
    for (const int threads : options.threads) {
      comparison.series.push_back({{solver, options.kind, options.discs, threads}, {}});
    }
  }
  for (int repetition = 0; repetition < options.repetitions; ++repetition) {
    for (Series& series : comparison.series) {
      progress(repetition, series.trial);
      series.runs.push_back(measure_in_fresh_process(series.trial));
    }
  }
  return comparison;
}

std::string explain_tables() {
  std::string text =
      "kT/kN = 0.5, 3 unknowns per disc, left side fixed, load on the right side. Seconds, medians; total = "
      "order + analyze + factorize + solve, one right-hand side, no refinement. K: assembly of the stiffness "
      "matrix, not in the total. nnz(L): lower triangle, without explicit zeros. Factor: what is stored of "
      "L. Peak: of the whole "
      "process, the assembly and K included. CPU: seconds of all threads from the start of the process to "
      "its end, setting up the problem included; a busy machine disturbs it least. Every run is a fresh "
      "process, solvers take turns.\n"
      "Threads of ";
  for (const Solver& solver : solvers()) {
    text += fmt::format("{}{}: {}", &solver == &solvers().front() ? "" : "; ", solver.label, solver.threads);
  }
  return text + ". CHOLMOD runs supernodal, with 32-bit indices and OMP_THREAD_LIMIT=1.\n";
}

std::string tables(const Comparison& comparison) {
  const Measurement& first = comparison.series.at(0).runs.at(0);
  return fmt::format("{}, {:.0f} discs, {:.0f} unknowns, {} rounds\n\n{}\n{}", comparison.kind, first.discs,
                     first.unknowns, comparison.series[0].runs.size(), medians_table(comparison),
                     ratios_table(comparison));
}

Results json(const Comparison& comparison) {
  std::vector<Results> list;
  for (const Series& series : comparison.series) {
    Results entry;
    entry.set("solver", series.trial.solver).set("threads", series.trial.threads);
    for (const Field& field : fields) {
      std::vector<double> values;
      for (const Measurement& run : series.runs) values.push_back(run.*field.value);
      entry.set(field.name, values);
    }
    list.push_back(entry);
  }
  Results object;
  object.set("kind", comparison.kind).set("series", list);
  return object;
}

std::string describe_machine() {
  std::string processor = "unknown processor", line;
  for (std::ifstream file("/proc/cpuinfo"); std::getline(file, line);) {
    if (!line.starts_with("model name")) continue;
    processor = line.substr(std::min(line.find(':') + 2, line.size()));
    break;
  }
  return fmt::format("{}, {}, compiler {}", processor, counted(std::thread::hardware_concurrency(), "core"),
                     __VERSION__);
}

}  // namespace equidem::bench
