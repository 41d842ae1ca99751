// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The keys of a case that fills a box: the same schema, [packing] in place of [assembly].
#pragma once

#include "equidem/casefile/engine/keys.hpp"

namespace equidem {

const casefile::FileSpec& pack_file_spec();

}  // namespace equidem
