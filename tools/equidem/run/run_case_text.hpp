// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Parts of the case texts of checkpoints, and events that time steps cannot resolve.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "equidem/casefile/engine/toml.hpp"
#include "equidem/core/checksum.hpp"
#include "equidem/motion/schedule.hpp"

namespace equidem {

void erase_keys(TomlValue& table, std::initializer_list<std::string_view> names);
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

}  // namespace equidem
