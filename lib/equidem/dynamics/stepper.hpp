// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Order of strips in time stepping: several steps at once while data are in the cache, on all threads.
#pragma once

#include <cstdint>
#include <functional>

namespace equidem {

/// Work to be done on one strip for one stage (counted through all steps): reads this strip and its neighbours as the
/// stage before left them.
using StripWork = std::function<void(std::int32_t strip, std::int64_t stage)>;

/// Perform stages 0 .. stages - 1 on all strips. A stage of a strip starts after this strip and both neighbours have
/// completed the previous stage.
///
/// Stage s begins two waves after stage s - 1 and follows it from strip to strip: `depth` stages (as many per thread)
/// are in progress at a time, on data in the cache and on strips that are not adjacent, so that threads share them.
/// With fewer stages than threads the strips of one stage are divided among threads.
/// \param threads largest number of threads, limited to that of parallel loops: with few discs per strip,
///        synchronization costs more than it gains The work and data of every strip do not depend on threads or depth;
///        results are bit-identical.
void step_strips(std::int32_t strips, std::int64_t stages, int depth, int threads, const StripWork& work);

}  // namespace equidem
