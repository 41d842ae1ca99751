// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The case text in checkpoints of colliding bodies: all data that affect the motion, including those of files that the
/// case names, without how long it lasts and what is written.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "equidem/casefile/grains/grain_case.hpp"

namespace equidem {

/// Returns what acts in all stages, the time step, each stage, and the schedules as they are given, which the checksums
/// of the stages contain as well. \param step s
std::string case_text_of(const GrainCase& resolved, double step);
/// The checkpoint of another run with whose state a run has begun.
struct Beginning {
  std::string path;
  std::string stage;  ///< that ended there
};
/// What a case text has of it at its end.
std::string text_of(const Beginning& beginning);
/// None: the run has begun with its case.
std::optional<Beginning> beginning_in(std::string_view text);
/// The number of stages that a case text has.
std::size_t stages_in(std::string_view text);
/// The part of a case text that decides on the motion until the end of some stages. \param stages at most stages_in()
std::string until_stage(std::string_view text, std::size_t stages);

}  // namespace equidem
