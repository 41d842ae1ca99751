// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Options and report of a benchmark, rounds in which all contenders take turns, medians, scenes.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/text.hpp"
#include "equidem/motion/wall.hpp"

namespace CLI {
class App;
}

namespace equidem::bench {

/// Text that is printed at once and written to the file of --markdown in the end.
class Report {
 public:
  explicit Report(std::string command) : command_(std::move(command)) {}

  /// The title of the page, the command that makes it, and the machine.
  void begin(const char* title);
  void add(const std::string& text);
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string command_, text_;
};

/// A table of Markdown, columns as wide as their widest cell. Cells are separated by " & ".
class TextTable {
 public:
  explicit TextTable(std::string_view head) { add_row(head); }

  /// A row from the format of its cells, "{} & {:.2f}".
  template <class... Values>
  void add(fmt::format_string<Values...> cells, Values&&... values) {
    add_row(fmt::format(cells, std::forward<Values>(values)...));
  }
  /// A row of cells that are formatted already.
  void add_row(std::string_view cells);
  [[nodiscard]] bool empty() const { return rows_.size() < 2; }
  [[nodiscard]] std::string markdown() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// The main function of a benchmark: options, --markdown, errors on stderr.
/// \param declare adds the options of this benchmark
/// \return exit code
int run_benchmark(const char* name, const char* purpose, int argc, char** argv,
                  const std::function<void(CLI::App&)>& declare, const std::function<void(Report&)>& run);

/// Processor time of this thread, s: time in which other processes have the processor is not counted.
double processor_time();

struct Entry {
  std::string label;
  std::function<void(std::int64_t steps)> advance;
  int threads = 1;
};

/// Of a loop or simulation that outlives the entry.
template <typename Advanced>
Entry entry_of(std::string label, Advanced& advanced, int threads = 1) {
  return {std::move(label), [&advanced](std::int64_t steps) { advanced.advance(steps); }, threads};
}

/// Seconds per round: processor time with one thread, wall time with more.
using Seconds = std::vector<double>;

/// In every round each entry in turn makes that many steps, so that a disturbance of the machine affects all of them;
/// one round before the first is not counted.
std::vector<Seconds> take_turns(std::span<const Entry> entries, std::int64_t steps, int rounds);

struct Range {
  double median = 0, smallest = 0, largest = 0;

  [[nodiscard]] Range operator*(double factor) const { return {median * factor, smallest * factor, largest * factor}; }
  /// "median (smallest .. largest)". \param format of a number, "{:.2f}"
  [[nodiscard]] std::string text(const char* format) const;
};
Range range_of(std::vector<double> values);
/// a over b, round by round.
Range ratio_of(const Seconds& a, const Seconds& b);

/// hexagonal, delaunay.
std::vector<std::string> assembly_kinds();
/// Options of a benchmark of assemblies of discs.
struct Sizes {
  std::vector<double> discs;
  std::vector<std::string> kinds = assembly_kinds();
  std::vector<int> threads = {1, 2};
  int rounds = 1;

  void declare(CLI::App& app);
  void for_each(const std::function<void(const std::string& kind, double discs, int threads)>& work) const;
};
void declare_rounds(CLI::App& app, int& rounds);
/// A free assembly about as wide as high. \param kind one of assembly_kinds()
Assembly build_assembly(const std::string& kind, std::int64_t discs, double radius);

/// Floor at y = 0, left wall at x = 0, right wall; a lid where `height` > 0.
std::vector<Wall> box_walls(double width, double height = 0);

}  // namespace equidem::bench
