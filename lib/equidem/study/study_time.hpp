// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Prediction of the time of a study.
#pragma once

#include <cstddef>
#include <functional>

#include "equidem/study/run_study.hpp"

namespace equidem {

/// Carries out a setting once, by the clock: s, at least 1 ms. One that fails has the time until it does.
/// \throws Error (interrupted)
double time_setting(const StudyTask& task);

struct StudyEstimate {
  double round = 0;       ///< s of one round over all settings
  double least = 0;       ///< s of the rounds that are made in any case, the one to warm up among them
  double most = 0;        ///< s at most: where times are not trusted before the budget is spent
  std::size_t timed = 0;  ///< settings that were carried out for it
};

/// Carries out settings once each, coarse ones first, until about `seconds` are spent. The time of the others follows
/// from the two finest ones of the same problem and method by a power of the resolution, else from the mean of all.
/// \param seconds_of carries out a setting once and gives its time, s
/// \throws Error (interrupted)
StudyEstimate estimate_study(const Study& study, const StudyOptions& options, double seconds = 2,
                             const std::function<double(const StudyTask&)>& seconds_of = time_setting);

}  // namespace equidem
