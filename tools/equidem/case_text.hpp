// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Which tables of a case decide a result. The case text in checkpoints of runs: all data that affect the motion,
/// including those of files that the case names, without how long it lasts and what is written. Events that time steps
/// cannot resolve.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "equidem/casefile/engine/toml.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/checksum.hpp"
#include "equidem/motion/schedule.hpp"

namespace equidem {

/// A result that a case decides: the assembly of its discs, the motion of bonded discs or of bodies that collide, the
/// path of contacts that break.
enum class Decided { assembly, bonded_motion, colliding_motion, path };
/// The case without the tables and keys that do not decide the result.
TomlValue deciding_tables(TomlValue document, Decided result);

void add(Checksum& sum, const Schedule& schedule);

/// Begins the line of a case text that names the time step, in s.
inline constexpr std::string_view step_line = "\n# step ";
struct StepInText {
  double step = 0;        ///< s
  std::string_view rest;  ///< of its line
};
/// The step that a case text names.
std::optional<StepInText> step_in(std::string_view text);

/// \param where the user wrote the schedule
/// \return the event of the schedule that steps miss the most of
/// \throws Error (bad_input) where they miss more than half of the range of its values
MissedEvent check_event(const Schedule& schedule, double step, double duration, const std::string& where);

/// The text of a run of colliding bodies: what acts in all stages, the time step, each stage, and the schedules as they
/// are given, which the checksums of the stages contain as well. \param step s
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
