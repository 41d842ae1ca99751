// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace equidem {

/// Whether a text in UTF-8 has control characters but for tabs and line breaks: terminals obey them, XML forbids them.
bool has_controls(std::string_view text);

/// "a, b, ..., 300 000 in all": the first ten words, for lists that may be long.
std::string first_words(std::vector<std::string> words);

}  // namespace equidem
