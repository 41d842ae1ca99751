// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rows of results as CSV columns, JSON objects and curves.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "equidem/output/files/csv.hpp"
#include "equidem/output/plots/plot.hpp"
#include "equidem/output/results.hpp"

#include "text_table.hpp"

namespace equidem {

/// The rows of a table as JSON objects. \param renamed columns whose keys differ: {column, key}
std::vector<Results> rows_of(const Table& table, const std::map<std::string, std::string>& renamed = {});

/// The series with one point per row. \param x, y members or functions of a row
template <class Rows, class X, class Y>
Series with_points(Series series, const Rows& rows, X x, Y y) {
  for (const auto& row : rows) {
    series.x.push_back(static_cast<double>(std::invoke(x, row)));
    series.y.push_back(static_cast<double>(std::invoke(y, row)));
  }
  return series;
}

/// A curve of 100 pieces. \param formula y(x)
template <class Formula>
Series curve(Series series, double from, double to, Formula formula) {
  for (int k = 0; k <= 100; ++k) {
    series.x.push_back(from + (to - from) * k / 100);
    series.y.push_back(formula(series.x.back()));
  }
  return series;
}

}  // namespace equidem
