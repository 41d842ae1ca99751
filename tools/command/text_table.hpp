// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Tables of reports and of Markdown pages.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "equidem/core/text.hpp"

namespace equidem {

/// Rows of text, columns as wide as their widest cell. Cells are separated by " & ".
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

  /// The first column aligned to the left, the others to the right.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] std::string markdown() const;

 private:
  [[nodiscard]] std::vector<std::size_t> widths(std::size_t least) const;

  std::vector<std::vector<std::string>> rows_;
};

}  // namespace equidem
