// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Files that stand in the place of a table of a case: `springs = "FILE"`.
#pragma once

#include <filesystem>
#include <string>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/engine/value.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {

/// The table of that name in a file takes the place of the name of the file.
/// \throws Error (bad_input) with file, line and key: a file that cannot be read, or is of another format
template <class F>
void resolve_table_file(TomlValue& root, const char* table, const File<F>& format,
                        const std::filesystem::path& folder) {
  TomlValue* named = root.find(table);
  if (named == nullptr || named->type != TomlValue::Type::text) return;
  const std::filesystem::path path = opened(named->text, folder);
  TomlValue document = with_place(fmt::format("{}: {}", named->where(), table),
                                  [&] { return parse_toml(read_file(path), path.string()); });
  static_cast<void>(format.read(document, folder));
  *named = *document.find(table);
}

/// Lines for people at the top of a file; without the control characters that a comment of TOML must not have.
std::string comment_lines(const std::string& text);

}  // namespace equidem::casefile
