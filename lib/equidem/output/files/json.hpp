// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// JSON texts.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace equidem {

/// The number at a path of keys and positions such as "poisson_ratio.plane_strain" or "stress.0" in a JSON text; none
/// where there is none.
std::optional<double> number_in_json(std::string_view text, const std::string& path);

/// The version of the library, "0.2.0".
std::string library_version();

}  // namespace equidem
