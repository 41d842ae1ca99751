// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/growing_csv.hpp"

#include <cassert>
#include <charconv>
#include <span>
#include <string_view>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
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
    : path_(std::move(path)),
      interval_(options.interval),
      columns_(std::move(columns)),
      header_(CsvText(columns_).text()),
      rows_(columns_) {
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
  if (rows_.text().size() == header_.size()) return;
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
  const auto rows = std::string_view(rows_.text()).substr(header_.size());
  file_->write_at(end_, bytes_of(rows));
  end_ += rows.size();
  file_->truncate(end_);  // what an earlier run left behind
  rows_ = CsvText(columns_);
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
