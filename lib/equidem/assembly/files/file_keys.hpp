// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Keys and conditions that assembly files of all formats share.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"

namespace equidem {

inline constexpr const char* assembly_schema = "equidem-assembly/1";

/// A text (UTF-8) as JSON has it, between quotation marks.
std::string quoted_json(const std::string& text);

/// \param given the schema of a file as text, or empty
/// \param example what a file has: "\"schema\": \"equidem-assembly/1\""
/// \throws Error (bad_input) where it is another one
void check_schema(const std::string& given, const std::string& example);

/// \throws Error (bad_input) naming the nearest of the known keys where the key is none of them
void check_key(const std::string& key, const std::vector<std::string>& known);

/// Lists of contacts need contacts, contacts off the line of centres need normals, levers and offsets, and a gap
/// tolerance is for files without contacts.
/// \param has whether the file has a key
/// \throws Error (bad_input) naming the key
void check_keys_together(const std::function<bool(const char* key)>& has, double gap_tolerance);

/// \throws Error (bad_input) where two contacts join the same bodies over the same shift at the same place
void refuse_repeated_contacts(const Assembly& assembly);

}  // namespace equidem
