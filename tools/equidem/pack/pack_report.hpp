// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What `equidem pack` says.
#pragma once

#include <optional>
#include <string>

#include "equidem/casefile/pack_case.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/output/files/json.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/network.hpp"

namespace equidem {

/// What statics says of bodies that settled.
struct ConfirmedRest {
  std::optional<RestConfirmation> confirmation;
  std::string why_not = {};  ///< where there is none
};

/// What shall be packed.
std::string describe_pack_case(const PackCase& resolved);

/// How it came to lie.
std::string describe_packing(const PackCase& resolved, const GrainPacking& packing, const PackingMeasures& measures,
                             const std::optional<ConfirmedRest>& rest, const StageTimes& times);

void add_packing(JsonObject& object, const PackCase& resolved, const GrainPacking& packing,
                 const PackingMeasures& measures, const std::optional<ConfirmedRest>& rest);

}  // namespace equidem
