// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/csv.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <iterator>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include "equidem/core/checksum.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/results.hpp"

namespace equidem {
namespace {

template <class Number>
void append_number(std::string& text, Number value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  text.append(digits, end);
}

}  // namespace

CsvText::CsvText(const std::vector<std::string>& columns) : columns_(columns.size()) {
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

void CsvText::cell_of(std::int64_t value) {
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

Table& Table::add(std::string name, std::size_t rows, std::function<void(CsvText&, std::size_t row)> cell) {
  if (name.empty()) {
    bad_input("a column of a table has no name", "columns are found by their names", "Name it");
  }
  if (std::ranges::find(columns_, name, &Column::name) != columns_.end()) {
    bad_input(fmt::format("two columns of a table are called '{}'", name), "columns are found by their names",
              "Rename one of them");
  }
  if (!columns_.empty() && rows != rows_) {
    bad_input(
        fmt::format("column '{}' has {} but the table has {}", name, counted(rows, "value"), counted(rows_, "row")),
        "columns of a table are equally long", "Give one value per row");
  }
  rows_ = rows;
  columns_.push_back({std::move(name), std::move(cell)});
  return *this;
}

Table& Table::add(std::string name, Values values) {
  const std::size_t rows = std::visit([](const auto& v) { return v.size(); }, values);
  return add(std::move(name), rows, [values = std::move(values)](CsvText& text, std::size_t row) {
    std::visit([&](const auto& v) { text.cell(v[row]); }, values);
  });
}

void Table::write(const TextSink& to) const {
  CsvText text(names_in(columns_));
  for (std::size_t row = 0; row < rows_; ++row) {
    for (const Column& column : columns_) column.cell(text, row);
    text.end_row();
    text.pass_on(to, false);
  }
  text.pass_on(to, true);
}

std::string Table::csv() const {
  std::string all;
  write([&](std::string_view part) { all += part; });
  return all;
}

void write_csv(const std::filesystem::path& path, const Table& table, bool overwrite) {
  write_file(
      path, [&](const TextSink& to) { table.write(to); }, overwrite);
}

std::vector<std::vector<std::string>> csv_cells(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  TableCells cells;
  for (std::string_view rest = text; !rest.empty();) {
    cells.split(take_record(rest), ',');
    rows.emplace_back(cells.all().begin(), cells.all().end());
  }
  return rows;
}

namespace {

/// Checksum of the first cells of a row and of the names of their columns.
std::string checksum_of(const std::vector<std::string>& names, const std::vector<std::string>& row, std::size_t cells) {
  Checksum sum;
  for (const std::vector<std::string>* texts : {&names, &row}) {
    for (std::size_t k = 0; k < cells; ++k) {
      sum.add(std::as_bytes(std::span((*texts)[k])));
      sum.add(std::uint64_t{(*texts)[k].size()});
    }
  }
  return sum.text();
}

}  // namespace

void write_samples(const std::filesystem::path& path, Table table) {
  const std::vector<std::vector<std::string>> cells = csv_cells(table.csv());
  std::vector<std::string> checksums;
  for (std::size_t row = 1; row < cells.size(); ++row)
    checksums.push_back(checksum_of(cells.front(), cells[row], cells.front().size()));
  write_csv(path, table.add("checksum", std::move(checksums)), true);
}

std::optional<double> csv_number(const std::string& cell) {
  return cell.empty() ? std::numeric_limits<double>::quiet_NaN() : number_from<double>(cell);
}

std::optional<std::int64_t> csv_integer(const std::string& cell) {
  return number_from<std::int64_t>(cell);
}

StoredTable::StoredTable(std::filesystem::path path, const Table& like, const std::string& of, std::string remedy,
                         std::string rows, CutRow cut)
    : path_(std::move(path)), remedy_(std::move(remedy)), rows_(std::move(rows)) {
  const std::string text = read_file(path_);
  cells_ = csv_cells(text);
  std::vector<std::string> columns = names_in(like.columns());
  columns.emplace_back("checksum");
  const std::vector<std::string> found = cells_.empty() ? std::vector<std::string>{} : cells_.front();
  const bool any = columns.size() == 1 && !found.empty();
  if (any ? found.back() != columns.back() : found != columns) {
    const auto differing = std::ranges::mismatch(found, columns);
    const auto name = [](auto at, const auto& names) { return at == names.end() ? "none" : fmt::format("'{}'", *at); };
    refuse(fmt::format(
        "its columns are those of another {}, of another table or of a version other than {}: column {} is {} there "
        "and {} here",
        of, library_version(), differing.in1 - found.begin() + 1, name(differing.in1, found),
        name(differing.in2, columns)));
  }
  columns = found;
  const auto whole = [&](const std::vector<std::string>& cells) {
    return cells.size() == columns.size() && cells.back() == checksum_of(columns, cells, columns.size() - 1);
  };
  // Every row that was written to its end ends its line.
  if (cut == CutRow::left_out && cells_.size() > 1 && text.back() != '\n' && !whole(cells_.back())) {
    cells_.pop_back();
    cut_ = true;
  }
  for (std::size_t row = 1; row < cells_.size(); ++row) {
    if (cells_[row].size() != columns.size())
      refuse(fmt::format("line {} has {}", row + 1, counted(std::ssize(cells_[row]), "cell")));
    if (!whole(cells_[row]))
      refuse(fmt::format("line {} was altered since it was written: its checksum is wrong", row + 1));
  }
}

double StoredTable::number(std::size_t row, std::size_t column) const {
  const std::optional<double> value = csv_number(text(row, column));
  if (!value) refuse(fmt::format("'{}' in line {} is not a number", text(row, column), row + 2));
  return *value;
}

std::int64_t StoredTable::integer(std::size_t row, std::size_t column, std::int64_t least, std::int64_t most) const {
  const std::optional<std::int64_t> value = csv_integer(text(row, column));
  if (!value || *value < least || *value > most)
    refuse(fmt::format("'{}' in line {} is not possible there", text(row, column), row + 2));
  return *value;
}

void StoredTable::refuse(const std::string& why) const {
  bad_input_at(path_.string(), fmt::format("the {} to continue cannot be read", rows_), why, remedy_);
}

namespace {

constexpr std::size_t written_at_once = 1 << 16;  // bytes

[[noreturn]] void cannot_add_rows(const std::filesystem::path& path, const std::string& why) {
  bad_input(fmt::format("cannot add rows to '{}'", path.string()), why,
            "Go on where the files of this very run lie, or start it afresh under another name");
}

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

}  // namespace

std::string read_marked(const std::filesystem::path& path, const FileMark& mark) {
  constexpr const char* remedy = "Put back the file as it was written, or start the run afresh";
  const std::string problem = fmt::format("cannot go on with '{}'", path.string());
  std::string text = read_file(path);
  if (text.size() < mark.length)
    bad_input(problem, fmt::format("it is truncated: {} bytes are left of {}", text.size(), mark.length), remedy);
  text.resize(mark.length);
  Checksum sum;
  sum.add(bytes_of(text));
  if (sum.value() != mark.checksum)
    bad_input(problem, "it was altered since it was written: its checksum is wrong", remedy);
  return text;
}

GrowingCsv::GrowingCsv(std::filesystem::path path, std::vector<std::string> columns, const GrowingCsvOptions& options)
    : path_(std::move(path)), interval_(options.interval), columns_(std::move(columns)), rows_(columns_) {
  rows_.pass_on([&](std::string_view line) { header_ = line; }, true);
  check_writable(path_, options.overwrite || options.continue_from);
  if (options.continue_from) {
    go_on(*options.continue_from);
    return;
  }
  write_file(path_, header_, options.overwrite);
  file_.emplace(path_, OpenFile::Mode::update);
  sum_.add(bytes_of(header_));
  marked_ = end_ = header_.size();
}

GrowingCsv::~GrowingCsv() {
  if (rows_.text().empty()) return;
  try {
    flush();
  } catch (const Error&) {
  }
}

void GrowingCsv::add(std::int64_t step, const std::vector<double>& cells, bool regular) {
  assert(step > last_step_ && cells.size() + 1 == columns_.size());
  last_step_ = step;
  const std::size_t begin = rows_.text().size();
  rows_.cell(step);
  for (const double cell : cells) rows_.cell(cell);
  rows_.end_row();
  if (regular) {
    const auto row = std::string_view(rows_.text()).substr(begin);
    sum_.add(bytes_of(row));
    marked_ += row.size();
  }
  if (rows_.text().size() >= written_at_once || since_flush_.seconds() >= interval_) flush();
}

void GrowingCsv::flush() {
  const auto write = [&](std::string_view rows) {
    file_->write_at(end_, bytes_of(rows));
    end_ += rows.size();
  };
  rows_.pass_on(write, true);
  file_->truncate(end_);  // what an earlier run left behind
  since_flush_.lap();
}

void GrowingCsv::sync() {
  flush();
  file_->sync();
}

FileMark GrowingCsv::mark() const {
  return {path_.filename().string(), marked_, sum_.value()};
}

/// Rows behind the mark stay in the file until rows are written: a run that is refused keeps its result.
void GrowingCsv::go_on(const FileMark& mark) {
  const std::string text = read_marked(path_, mark);
  if (!text.starts_with(header_)) {
    cannot_add_rows(path_, fmt::format("its columns are '{}', not '{}'", text.substr(0, text.find('\n')),
                                       header_.substr(0, header_.size() - 1)));
  }
  sum_.add(bytes_of(text));
  marked_ = end_ = text.size();
  if (end_ > header_.size()) {
    const std::size_t last_row = text.rfind('\n', end_ - 2) + 1;
    std::from_chars(text.data() + last_row, text.data() + end_, last_step_);
  }
  file_.emplace(path_, OpenFile::Mode::update);
}

}  // namespace equidem
