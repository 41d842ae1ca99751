// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts that are given twice.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>

#include "equidem/assembly/assembly.hpp"

namespace equidem {

/// Two contacts, ascending, of the same bodies across the same period in the same place, whichever body each names
/// first.
std::optional<std::pair<std::size_t, std::size_t>> find_repeated_contact(const Assembly& assembly);

}  // namespace equidem
