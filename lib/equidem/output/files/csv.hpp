// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Tables as comma-separated values (RFC 4180): one header line, units in the names of columns (x_m, stress_xx_Pa),
/// numbers in the shortest form that reads back to the same bits.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "equidem/output/files/state.hpp"

namespace equidem {

/// The text of a table, row by row. Every row must have as many cells as there are columns.
class CsvText {
 public:
  explicit CsvText(const std::vector<std::string>& columns, std::size_t expected_rows = 0);

  void cell(double value);  ///< "nan", "inf" and "-inf" where not finite
  void cell(std::int64_t value);
  void cell(std::string_view value);  ///< quoted where it holds a comma, a quote or a line break
  void empty_cell() { separate(); }
  void end_row();
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void separate();

  std::string text_;
  std::size_t columns_;
  std::size_t cells_ = 0;  ///< in the current row
};

/// Named columns of equal length, for results of any kind: a sweep, a study, a curve.
class Table {
 public:
  using Values = std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::string>>;
  struct Column {
    std::string name;
    Values values;
  };

  /// Add a column to the right of the others.
  /// \throws Error (bad_input) where the name is empty or taken or the length differs
  Table& add(std::string name, Values values);

  [[nodiscard]] std::size_t rows() const;
  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  /// The column of that name.
  /// \throws Error (bad_input) where there is none
  [[nodiscard]] const Column& column(const std::string& name) const;
  [[nodiscard]] std::string csv() const;

 private:
  std::vector<Column> columns_;
};

/// \throws Error (bad_input) as write_file does
void write_csv(const std::filesystem::path& path, const Table& table, bool overwrite);

/// One row per disc: disc, x_m, y_m, radius_m, [ux_m, uy_m, rotation_rad,] [stress_xx_Pa, stress_yy_Pa, stress_xy_Pa,
/// stress_yx_Pa,] [cell_area_m2]; columns in brackets where known.
/// \throws Error (bad_input) as write_file does
void write_disc_csv(const std::filesystem::path& path, const AssemblyState& state, bool overwrite);

/// One row per contact: i, j, shift_x, shift_y, branch_x_m, branch_y_m, lever_i_m, lever_j_m, [normal_x, normal_y,
/// offset_i_m, offset_j_m,] [normal_force_N_per_m (tension positive), tangential_force_N_per_m, force_x_N_per_m,
/// force_y_N_per_m (on disc i)].
/// \throws Error (bad_input) as write_file does
void write_contact_csv(const std::filesystem::path& path, const AssemblyState& state, bool overwrite);

/// Cells of a CSV text (RFC 4180), row by row.
std::vector<std::vector<std::string>> csv_cells(const std::string& text);

/// The number of a whole cell; NaN where it is empty, nothing where it is no number.
std::optional<double> csv_number(const std::string& cell);
/// The integer of a whole cell; nothing where it is none.
std::optional<std::int64_t> csv_integer(const std::string& cell);

}  // namespace equidem
