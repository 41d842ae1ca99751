// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_case_text.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

void erase_keys(TomlValue& table, std::initializer_list<std::string_view> names) {
  std::erase_if(table.entries,
                [&](const auto& entry) { return std::find(names.begin(), names.end(), entry.name) != names.end(); });
}

void add(Checksum& sum, const Schedule& schedule) {
  for (const double number :
       {static_cast<double>(schedule.kind), schedule.value, schedule.start, schedule.end, schedule.frequency})
    sum.add(number);
  for (const auto* numbers : {&schedule.times, &schedule.values}) sum.add(*numbers);
}

std::optional<StepInText> step_in(std::string_view text) {
  const std::size_t at = text.rfind(step_line);
  if (at == std::string_view::npos) return {};
  text.remove_prefix(at + step_line.size());
  StepInText found;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), found.step);
  if (failed != std::errc()) return {};
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  found.rest = text.substr(0, text.find('\n'));
  return found;
}

MissedEvent check_event(const Schedule& schedule, double step, double duration, const std::string& where) {
  constexpr double most = 0.5;
  const MissedEvent missed = missed_event(schedule, step, duration);
  if (missed.share <= most) return missed;
  bad_input_at(where,
               fmt::format("its schedule has an event at {:.6g} s that steps of {:.6g} s miss", missed.time, step),
               fmt::format("between two steps lie {:.0f} % of the range of its values", 100 * missed.share),
               "Give a time_step well below its length, or let it last longer");
}

}  // namespace equidem
