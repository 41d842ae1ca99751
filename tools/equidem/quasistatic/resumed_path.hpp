// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The part of a case that decides a path, by which a resumed one is told to be the same.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "equidem/casefile/assembly/case.hpp"

namespace equidem {

/// The case without title, [output], quasistatic.max_events and quasistatic.frame_every, as text.
/// \param folder to which paths in it are relative
std::string deciding_keys_of_path(const Case& resolved, const std::filesystem::path& folder);

/// Keys that a resumed path may have otherwise than before.
struct FreeKeysOfPath {
  std::int64_t max_events = 0;
  std::int64_t frame_every = 0;
};

/// \param there case.toml of the path so far
/// \return the keys that it had
/// \throws Error (bad_input) where a key that decides the path differs, which the message names
FreeKeysOfPath check_same_path(const std::filesystem::path& there, const Case& resolved);

/// \param events of the path so far
/// \throws Error (bad_input) where max_events was lowered below them
void check_most_events(const FreeKeysOfPath& before, const Case& resolved, std::int64_t events);

}  // namespace equidem
