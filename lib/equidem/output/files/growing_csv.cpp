// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/growing_csv.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <span>
#include <string_view>
#include <system_error>
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

}  // namespace

GrowingCsv::GrowingCsv(std::filesystem::path path, std::vector<std::string> columns, const GrowingCsvOptions& options)
    : path_(std::move(path)),
      interval_(options.interval),
      columns_(std::move(columns)),
      header_(CsvText(columns_).text()),
      rows_(columns_) {
  check_writable(path_, options.overwrite || options.continue_after);
  if (options.continue_after) {
    go_on(*options.continue_after);
    return;
  }
  write_file(path_, header_, options.overwrite);
  file_.emplace(path_, OpenFile::Mode::update);
  end_ = header_.size();
}

GrowingCsv::~GrowingCsv() {
  try {
    flush();
  } catch (const Error&) {
  }
}

void GrowingCsv::add(std::int64_t step, const std::vector<double>& cells) {
  assert(step > last_step_ && cells.size() + 1 == columns_.size());
  last_step_ = step;
  rows_.cell(step);
  for (const double cell : cells) rows_.cell(cell);
  rows_.end_row();
  if (rows_.text().size() >= written_at_once || since_flush_.seconds() >= interval_) flush();
}

void GrowingCsv::flush() {
  const auto rows = std::string_view(rows_.text()).substr(header_.size());
  file_->write_at(end_, std::as_bytes(std::span(rows)));
  end_ += rows.size();
  rows_ = CsvText(columns_);
  since_flush_.lap();
}

void GrowingCsv::sync() {
  flush();
  file_->sync();
}

/// Rows are kept up to the first that is later, or that is not whole.
void GrowingCsv::go_on(std::int64_t after) {
  const std::string text = read_file(path_);
  if (!text.starts_with(header_)) {
    cannot_add_rows(path_, fmt::format("its columns are '{}', not '{}'", text.substr(0, text.find('\n')),
                                       header_.substr(0, header_.size() - 1)));
  }
  end_ = header_.size();
  for (std::size_t end = text.find('\n', end_); end != std::string::npos; end = text.find('\n', end_)) {
    std::int64_t step = 0;
    const auto [rest, failed] = std::from_chars(text.data() + end_, text.data() + end, step);
    if (failed != std::errc() || *rest != ',' || step <= last_step_) {
      cannot_add_rows(path_,
                      fmt::format("'{}' is no row of it", text.substr(end_, std::min<std::size_t>(end - end_, 40))));
    }
    if (step > after) break;
    last_step_ = step;
    end_ = end + 1;
  }
  file_.emplace(path_, OpenFile::Mode::update);
  file_->truncate(end_);
}

}  // namespace equidem
