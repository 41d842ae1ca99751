// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/csv.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr std::size_t typical_cell_length = 16;  // characters, to reserve room

template <class Number>
void append_number(std::string& text, Number value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  text.append(digits, end);
}

}  // namespace

CsvText::CsvText(const std::vector<std::string>& columns, std::size_t expected_rows) : columns_(columns.size()) {
  text_.reserve((expected_rows + 1) * columns_ * typical_cell_length);
  for (const std::string& name : columns) cell(std::string_view(name));
  end_row();
}

void CsvText::separate() {
  if (cells_++ > 0) text_ += ',';
}

void CsvText::cell(double value) {
  separate();
  append_number(text_, value);
}

void CsvText::cell(std::int64_t value) {
  separate();
  append_number(text_, value);
}

void CsvText::cell(std::string_view value) {
  separate();
  if (value.find_first_of(",\"\r\n") == std::string_view::npos) {
    text_ += value;
    return;
  }
  text_ += '"';
  for (const char c : value) {
    if (c == '"') text_ += '"';
    text_ += c;
  }
  text_ += '"';
}

void CsvText::end_row() {
  assert(cells_ == columns_);
  text_ += '\n';
  cells_ = 0;
}

Table& Table::add(std::string name, Values values) {
  if (name.empty()) {
    bad_input("a column of a table has no name", "columns are found by their names", "Name it");
  }
  for (const Column& column : columns_) {
    if (column.name == name) {
      bad_input(fmt::format("two columns of a table are called '{}'", name), "columns are found by their names",
                "Rename one of them");
    }
  }
  const std::size_t length = std::visit([](const auto& v) { return v.size(); }, values);
  if (!columns_.empty() && length != rows()) {
    bad_input(
        fmt::format("column '{}' has {} but the table has {}", name, counted(length, "value"), counted(rows(), "row")),
        "columns of a table are equally long", "Give one value per row");
  }
  columns_.push_back({std::move(name), std::move(values)});
  return *this;
}

std::size_t Table::rows() const {
  if (columns_.empty()) return 0;
  return std::visit([](const auto& v) { return v.size(); }, columns_.front().values);
}

const Table::Column& Table::column(const std::string& name) const {
  const auto found = std::find_if(columns_.begin(), columns_.end(), [&](const Column& c) { return c.name == name; });
  if (found == columns_.end()) {
    const std::string names = joined(columns_, [](const Column& c) { return c.name; });
    bad_input(fmt::format("the table has no column '{}'", name), fmt::format("its columns are: {}", names),
              "Choose one of them");
  }
  return *found;
}

std::string Table::csv() const {
  std::vector<std::string> names;
  for (const Column& column : columns_) names.push_back(column.name);
  CsvText text(names, rows());
  for (std::size_t row = 0; row < rows(); ++row) {
    for (const Column& column : columns_) {
      std::visit([&](const auto& values) { text.cell(values[row]); }, column.values);
    }
    text.end_row();
  }
  return text.text();
}

void write_csv(const std::filesystem::path& path, const Table& table, bool overwrite) {
  check_writable(path, overwrite);
  write_file(path, table.csv(), overwrite);
}

void write_disc_csv(const std::filesystem::path& path, const AssemblyState& state, bool overwrite) {
  assert_consistent(state);
  check_writable(path, overwrite);
  const Assembly& assembly = state.assembly;
  const bool areas = !assembly.cell_areas.empty();
  std::vector<std::string> columns{"disc", "x_m", "y_m", "radius_m"};
  if (!state.motions.empty()) columns.insert(columns.end(), {"ux_m", "uy_m", "rotation_rad"});
  if (!state.stresses.empty()) {
    columns.insert(columns.end(), {"stress_xx_Pa", "stress_yy_Pa", "stress_xy_Pa", "stress_yx_Pa"});
  }
  if (areas) columns.emplace_back("cell_area_m2");

  CsvText text(columns, assembly.size());
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    text.cell(static_cast<std::int64_t>(disc));
    for (const double v : {assembly.centres[disc].x, assembly.centres[disc].y, assembly.radii[disc]}) {
      text.cell(v);
    }
    if (!state.motions.empty()) {
      const DiscMotion& motion = state.motions[disc];
      for (const double v : {motion.u.x, motion.u.y, motion.theta}) text.cell(v);
    }
    if (!state.stresses.empty()) {
      const Tensor2& s = state.stresses[disc];
      for (const double v : {s.xx, s.yy, s.xy, s.yx}) text.cell(v);
    }
    if (areas) text.cell(assembly.cell_areas[disc]);
    text.end_row();
  }
  write_file(path, text.text(), overwrite);
}

void write_contact_csv(const std::filesystem::path& path, const AssemblyState& state, bool overwrite) {
  assert_consistent(state);
  check_writable(path, overwrite);
  const Assembly& assembly = state.assembly;
  std::vector<std::string> columns{"i",          "j",          "shift_x",   "shift_y",
                                   "branch_x_m", "branch_y_m", "lever_i_m", "lever_j_m"};
  const auto& arms = assembly.contact_arms;
  if (!arms.empty()) columns.insert(columns.end(), {"normal_x", "normal_y", "offset_i_m", "offset_j_m"});
  if (!state.contact_forces.empty()) {
    columns.insert(columns.end(),
                   {"normal_force_N_per_m", "tangential_force_N_per_m", "force_x_N_per_m", "force_y_N_per_m"});
  }

  CsvText text(columns, assembly.contacts.size());
  for (std::size_t index = 0; index < assembly.contacts.size(); ++index) {
    const Contact& contact = assembly.contacts[index];
    for (const std::int32_t v : {contact.i, contact.j, contact.shift_x, contact.shift_y}) {
      text.cell(static_cast<std::int64_t>(v));
    }
    const Vec2 branch = assembly.branch(contact);
    for (const double v : {branch.x, branch.y, contact.lever_i, contact.lever_j}) text.cell(v);
    if (!arms.empty()) {
      const ContactArms& a = arms[index];
      for (const double v : {a.normal.x, a.normal.y, a.offset_i, a.offset_j}) text.cell(v);
    }
    if (!state.contact_forces.empty()) {
      const ContactForce& force = state.contact_forces[index];
      const Vec2 on_i = force_on_i(frame_of(assembly, index), force);
      for (const double v : {force.normal, force.tangential, on_i.x, on_i.y}) text.cell(v);
    }
    text.end_row();
  }
  write_file(path, text.text(), overwrite);
}

namespace {

template <typename Number>
std::optional<Number> whole_cell(const std::string& cell) {
  Number value = 0;
  const auto [end, problem] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (problem != std::errc() || end != cell.data() + cell.size()) return {};
  return value;
}

}  // namespace

std::vector<std::vector<std::string>> csv_cells(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row(1);
  bool quoted = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (quoted) {
      if (c == '"' && k + 1 < text.size() && text[k + 1] == '"') {
        row.back() += '"';
        ++k;
      } else if (c == '"') {
        quoted = false;
      } else {
        row.back() += c;
      }
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',') {
      row.emplace_back();
    } else if (c == '\n') {
      rows.push_back(std::move(row));
      row.assign(1, {});
    } else if (c != '\r') {
      row.back() += c;
    }
  }
  if (row.size() > 1 || !row.front().empty()) rows.push_back(std::move(row));
  return rows;
}

std::optional<double> csv_number(const std::string& cell) {
  return cell.empty() ? std::numeric_limits<double>::quiet_NaN() : whole_cell<double>(cell);
}

std::optional<std::int64_t> csv_integer(const std::string& cell) {
  return whole_cell<std::int64_t>(cell);
}

}  // namespace equidem
