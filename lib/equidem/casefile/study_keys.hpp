// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The keys of a study file: the same schema, [study] in place of [assembly].
#pragma once

#include "equidem/casefile/keys.hpp"

namespace equidem {

const FileSpec& study_file_spec();

}  // namespace equidem
