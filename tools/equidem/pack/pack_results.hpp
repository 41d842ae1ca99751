// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Report and JSON of `equidem pack`.
#pragma once

#include "equidem/casefile/packing/pack_case.hpp"
#include "equidem/output/results.hpp"
#include "equidem/packing/measures.hpp"

namespace equidem {

/// Bodies, box, method and springs of the case; the report alone.
Results pack_case_results(const PackCase& resolved);

/// Steps and time that are expected of bodies that fall; empty for other methods, which have no steps.
Results pack_estimate_results(const PackCase& resolved);

/// Report and JSON of the verb.
/// \param network of the packing, as it is written
/// \param density kg/m³, of the bodies
Results packing_results(const PackCase& resolved, const GrainPacking& packing, const Assembly& network, double density,
                        const PackingMeasures& measures);

}  // namespace equidem
