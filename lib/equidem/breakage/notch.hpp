// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Notches: contacts that are cut before anything is loaded.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"

namespace equidem {

/// A straight cut.
struct Notch {
  Vec2 from, to;  ///< m
};

/// The contacts whose branch a notch crosses, also those across a period, ascending.
/// \throws Error (bad_input) where a notch is not finite, or crosses none
std::vector<std::size_t> contacts_across(const Assembly& assembly, std::span<const Notch> notches);

}  // namespace equidem
