// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// In which order strips are stepped: several steps at once while data are near, on all threads.
#pragma once

#include <cstdint>
#include <functional>

namespace equidem {

/// Work to be done on one strip for one stage (counted through all steps): reads this strip and its neighbours as the
/// stage before left them.
using StripWork = std::function<void(std::int32_t strip, std::int64_t stage)>;

/// Do stages 0 .. stages - 1 on all strips, each only once its own and both neighbouring strips have done the one
/// before.
///
/// Stage s begins two waves after stage s - 1 and follows it from strip to strip: `depth` stages (as many per thread)
/// are under way at a time, on data that still lie in the cache, and at any moment on strips that do not touch, so that
/// threads share them. With fewer stages than threads the strips of one stage are shared out.
/// \param threads at most these, and no more than parallel loops use: strips of few discs are not worth waiting for one
///         another
/// Every strip does the same work on the same data in any case: the bits do not depend on threads or depth.
void step_strips(std::int32_t strips, std::int64_t stages, int depth, int threads, const StripWork& work);

}  // namespace equidem
