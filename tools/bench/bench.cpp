// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <fstream>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

#include "command.hpp"

namespace equidem::bench {

void Report::begin(const char* title) {
  add(fmt::format("# {}\n\n    {}\n\n{}.\n", title, command_, machine_text()));
}

void Report::add(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
  text_ += text;
}

void TextTable::add_row(std::string_view cells) {
  constexpr std::string_view separator = " & ";
  std::vector<std::string>& row = rows_.emplace_back();
  for (std::size_t end; (end = cells.find(separator)) != std::string_view::npos;) {
    row.emplace_back(cells.substr(0, end));
    cells.remove_prefix(end + separator.size());
  }
  row.emplace_back(cells);
}

std::string TextTable::markdown() const {
  std::vector<std::size_t> widths;
  for (const auto& row : rows_) {
    widths.resize(std::max(widths.size(), row.size()), 3);
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], columns_of(row[k]));
  }
  std::string text;
  for (const auto& row : rows_) {
    for (std::size_t k = 0; k < widths.size(); ++k) {
      const std::string cell = k < row.size() ? row[k] : "";
      text += "| " + cell + std::string(widths[k] - columns_of(cell), ' ') + " ";
    }
    text += "|\n";
    if (&row != &rows_.front()) continue;
    for (const std::size_t width : widths) text += "|" + std::string(width + 2, '-');
    text += "|\n";
  }
  return text;
}

/// The command without --markdown and its value: where a page is written does not change it.
static std::string command_line(const char* name, int argc, char** argv) {
  std::string text = name;
  for (int k = 1; k < argc; ++k) {
    if (std::string_view(argv[k]) == "--markdown")
      ++k;
    else
      text += fmt::format(" {}", argv[k]);
  }
  return text;
}

int run_benchmark(const char* name, const char* purpose, int argc, char** argv,
                  const std::function<void(CLI::App&)>& declare, const std::function<void(Report&)>& run) {
  CLI::App app(purpose, name);
  std::string file;
  declare(app);
  app.add_option("--markdown", file, "file for the report");
  CLI11_PARSE(app, argc, argv);
  try {
    Report report(command_line(name, argc, argv));
    run(report);
    if (file.empty()) return 0;
    std::ofstream page(file);
    page << report.text();
    if (!page.flush()) bad_input(fmt::format("'{}' cannot be written", file), "", "Choose another path");
    return 0;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return error.exit_code();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 1;
  }
}

double processor_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::vector<Seconds> take_turns(std::span<const Entry> entries, std::int64_t steps, int rounds) {
  std::vector<Seconds> seconds(entries.size());
  for (int round = -1; round < rounds; ++round) {
    for (std::size_t k = 0; k < entries.size(); ++k) {
      set_thread_count(entries[k].threads);
      const Stopwatch watch;
      const double begin = processor_time();
      entries[k].advance(steps);
      const double taken = entries[k].threads == 1 ? processor_time() - begin : watch.seconds();
      if (round >= 0) seconds[k].push_back(taken);
    }
  }
  set_thread_count(1);
  return seconds;
}

std::string Range::text(const char* format) const {
  const auto one = [&](double value) { return fmt::format(fmt::runtime(format), value); };
  return fmt::format("{} ({} .. {})", one(median), one(smallest), one(largest));
}

Range range_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values.front(), values.back()};
}

Range ratio_of(const Seconds& a, const Seconds& b) {
  std::vector<double> ratios(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) ratios[k] = a[k] / b[k];
  return range_of(std::move(ratios));
}

std::vector<std::string> assembly_kinds() {
  return {"hexagonal", "delaunay"};
}

void Sizes::declare(CLI::App& app) {
  app.add_option("--discs", discs, "numbers of discs")->delimiter(',')->check(CLI::PositiveNumber);
  app.add_option("--kinds", kinds, "assemblies")->delimiter(',')->check(CLI::IsMember(assembly_kinds()));
  app.add_option("--threads", threads, "numbers of threads")->delimiter(',')->check(CLI::PositiveNumber);
  declare_rounds(app, rounds);
}

void Sizes::for_each(const std::function<void(const std::string&, double, int)>& work) const {
  for (const std::string& kind : kinds)
    for (const double count : discs)
      for (const int each : threads) work(kind, count, each);
}

void declare_rounds(CLI::App& app, int& rounds) {
  app.add_option("--rounds", rounds, "in which all take turns; medians are reported")->check(CLI::PositiveNumber);
}

Assembly build_assembly(const std::string& kind, std::int64_t discs, double radius) {
  if (kind == "delaunay") return delaunay_assembly({.discs = discs, .radii = {radius, radius}});
  const auto rows = static_cast<int>(std::lround(std::sqrt(static_cast<double>(discs))));
  // every other row is one disc short
  const auto columns = static_cast<int>(std::lround(static_cast<double>(discs) / rows + 0.5));
  return hexagonal_lattice({.columns = columns, .rows = rows, .radius = radius});
}

std::vector<Wall> box_walls(double width, double height) {
  std::vector<Wall> walls{{.name = "floor", .point = {0, 0}, .normal = {0, 1}},
                          {.name = "left", .point = {0, 0}, .normal = {1, 0}},
                          {.name = "right", .point = {width, 0}, .normal = {-1, 0}}};
  if (height > 0) walls.push_back({.name = "lid", .point = {0, height}, .normal = {0, -1}});
  return walls;
}

}  // namespace equidem::bench
