// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The end of a path at an increment without an answer, in a sentence: which loads the contacts no longer bear, and
/// what moves.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "equidem/assembly/assembly.hpp"
#include "equidem/breakage/event_path.hpp"
#include "equidem/breakage/unbonded/contact_rates.hpp"
#include "equidem/breakage/unbonded/rate_search.hpp"

namespace equidem {

/// The part of a path in which it ends.
struct PathStage {
  bool dead = false;       ///< dead loads are put on
  bool releasing = false;  ///< a broken bond gives up its force
  double share = 0;        ///< of the dead loads that act
  double lambda = 0;
};

struct PathEnding {
  PathEnd end = PathEnd::no_answer;
  std::string sentence;
};

/// \param search that found no answer
/// \param status per contact, before the increment
PathEnding ending_of(const Assembly& assembly, const RateProblem& problem, const RateSearch& search,
                     std::span<const ContactStatus> status, const PathStage& stage);

}  // namespace equidem
