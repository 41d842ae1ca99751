// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The keys of a case of bodies that collide: the same schema, [grains] or [[grain]] in place of [assembly].
#pragma once

#include "equidem/casefile/engine/keys.hpp"

namespace equidem {

/// The tables and keys; [[schedule]] and [output] are those of other cases.
const casefile::FileSpec& grain_file_spec();

/// Whether a document describes bodies that collide: it has [grains], [[grain]] or [collisions] and no [assembly].
/// \throws Error (bad_input) where it has [assembly] as well
bool describes_grains(const TomlValue& root);

}  // namespace equidem
