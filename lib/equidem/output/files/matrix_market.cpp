// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/matrix_market.hpp"

#include <cstdint>
#include <iterator>
#include <string_view>

#include "equidem/core/memory.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr std::int64_t entries_between_looks = 65536;  // for a signal

/// The first lines, with room for as many numbers.
std::string banner(std::string_view kind, const std::string& comment, std::int64_t numbers, double bytes_per_number) {
  const double bytes = static_cast<double>(numbers) * bytes_per_number;
  require_memory(bytes, fmt::format("a file of {} numbers needs about", grouped(numbers)));
  std::string text;
  text.reserve(static_cast<std::size_t>(bytes));
  text += fmt::format("%%MatrixMarket matrix {}\n", kind);
  for (const std::string_view line : parts_of(comment, '\n')) text += fmt::format("% {}\n", line);
  return text;
}

constexpr double bytes_of_entry = 36;  // two indices and a number

}  // namespace

double bytes_of_text(const CompressedColumns& lower) {
  return bytes_of_entry * static_cast<double>(lower.first.back());
}

std::string matrix_market(const CompressedColumns& lower, const std::string& comment) {
  const std::int64_t entries = lower.first.back();
  std::string text = banner("coordinate real symmetric", comment, entries, bytes_of_entry);
  const auto end = std::back_inserter(text);
  fmt::format_to(end, "{} {} {}\n", lower.size, lower.size, entries);
  for (std::int64_t c = 0; c < lower.size; ++c) {
    if (c % entries_between_looks == 0) stop_if_interrupted();
    for (std::int64_t e = lower.first[c]; e < lower.first[c + 1]; ++e)
      fmt::format_to(end, "{} {} {}\n", lower.rows[e] + 1, c + 1, lower.values[e]);
  }
  return text;
}

std::string matrix_market(std::span<const std::vector<double>> columns, const std::string& comment) {
  constexpr double bytes = 22;
  const std::size_t rows = columns.empty() ? 0 : columns.front().size();
  std::string text = banner("array real general", comment, static_cast<std::int64_t>(rows * columns.size()), bytes);
  const auto end = std::back_inserter(text);
  fmt::format_to(end, "{} {}\n", rows, columns.size());
  for (const std::vector<double>& column : columns) {
    for (std::size_t k = 0; k < column.size(); ++k) {
      if (k % entries_between_looks == 0) stop_if_interrupted();
      fmt::format_to(end, "{}\n", column[k]);
    }
  }
  return text;
}

}  // namespace equidem
