// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Text inside XML.
#pragma once

#include <string>

namespace equidem {

/// The text with & < > " written as entities, for content and for values in double quotes.
std::string escape_xml(const std::string& text);

}  // namespace equidem
