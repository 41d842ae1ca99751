// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// JSON texts.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "equidem/contact/effects.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/output/results.hpp"

namespace equidem {

using JsonObject = Results;

/// The number at a path of keys and positions such as "poisson_ratio.plane_strain" or "stress.0" in a JSON text; none
/// where there is none.
std::optional<double> number_in_json(std::string_view text, const std::string& path);

/// The version of the library, "0.1.0".
std::string library_version();

/// The keys of every verb: status, report, times (seconds per stage), effects {active: [names], inactive: {name:
/// why}}, version.
void add_common(Results& results, const std::string& status, const std::string& report, const StageTimes& times,
                const Effects& effects);

}  // namespace equidem
