// SPDX-License-Identifier: GPL-3.0-or-later
#include "quasistatic/event_table.hpp"

#include <map>
#include <utility>

#include "equidem/breakage/avalanches.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

std::string numbers_of(const std::vector<std::int32_t>& discs) {
  return joined(
      discs, [](std::int32_t disc) { return fmt::format("{}", disc); }, " ");
}

std::vector<std::int32_t> discs_of(const StoredTable& table, std::size_t row, std::size_t column) {
  const std::string& text = table.text(row, column);
  std::vector<std::int32_t> discs;
  if (text.empty()) return discs;
  for (const std::string_view word : parts_of(text, ' ')) {
    const auto disc = number_from<std::int32_t>(word);
    if (!disc) table.refuse(fmt::format("line {} has '{}' in place of numbers of discs", row + 2, text));
    discs.push_back(*disc);
  }
  return discs;
}

/// A member of an event that is a number, and its column.
struct Number {
  std::string name;
  double BreakEvent::*member;
};

std::vector<Number> numbers(DrivenBy driven_by) {
  const bool strain = driven_by == DrivenBy::strain;
  const std::string load = strain ? "load_Pa" : "load_N_per_m", motion = strain ? "motion" : "motion_m";
  return {{"lambda", &BreakEvent::lambda},
          {"gap", &BreakEvent::gap},
          {load, &BreakEvent::load},
          {motion, &BreakEvent::motion},
          {"rate_of_" + load, &BreakEvent::load_rate},
          {"rate_of_" + motion, &BreakEvent::motion_rate},
          {"energy_before_N", &BreakEvent::energy_before},
          {"energy_after_N", &BreakEvent::energy_after},
          {"energy_released_N", &BreakEvent::energy_released},
          {"work_N", &BreakEvent::work},
          {"relative_residual", &BreakEvent::relative_residual}};
}

struct Count {
  std::string name;
  std::int64_t BreakEvent::*member;
};

const std::vector<Count> count_columns = {{"leg", &BreakEvent::leg},
                                          {"contact", &BreakEvent::contact},
                                          {"ties", &BreakEvent::ties},
                                          {"unstable_modes", &BreakEvent::unstable_modes}};

struct StressColumn {
  std::string name;
  double Tensor2::*member;
};

const std::vector<StressColumn> stress_columns = {{"stress_xx_Pa", &Tensor2::xx},
                                                  {"stress_yx_Pa", &Tensor2::yx},
                                                  {"stress_xy_Pa", &Tensor2::xy},
                                                  {"stress_yy_Pa", &Tensor2::yy}};

}  // namespace

std::string unit_of_load(DrivenBy driven_by) {
  return driven_by == DrivenBy::strain ? "Pa" : "N/m";
}

std::string unit_of_motion(DrivenBy driven_by) {
  return driven_by == DrivenBy::strain ? "" : "m";
}

Table event_table(const EventPath& run, const BreakageScene& scene) {
  const std::vector<BreakEvent>& events = run.events();
  Table table;
  std::vector<std::int64_t> number;
  for (std::int64_t k = 0; k < std::ssize(events); ++k) number.push_back(k);
  table.add("event", std::move(number));
  for (const Count& count : count_columns) table.add(count.name, events, count.member);
  const auto& contacts = scene.assembly.contacts;
  const auto contact = [&](const BreakEvent& event) { return contacts[static_cast<std::size_t>(event.contact)]; };
  table.add("i", events, [&](const BreakEvent& event) { return contact(event).i; });
  table.add("j", events, [&](const BreakEvent& event) { return contact(event).j; });
  table.add("mode", events, [](const BreakEvent& event) { return to_string(event.mode); });
  for (const Number& n : numbers(scene.path.driven_by)) table.add(n.name, events, n.member);
  for (const StressColumn& c : stress_columns)
    table.add(c.name, events, [&](const BreakEvent& event) { return event.stress.*c.member; });
  table.add("avalanche_of_load", avalanches_by(run, &BreakEvent::load).number);
  table.add("avalanche_of_motion", avalanches_by(run, &BreakEvent::motion).number);
  table.add("loosened", events, [](const BreakEvent& event) { return numbers_of(event.loosened); });
  if (!run.has_history()) return table;
  table.add("friction_N", events, &BreakEvent::friction);
  return table;
}

StoredEvents read_events(const std::filesystem::path& path, const EventPath& run, const BreakageScene& scene) {
  const StoredTable table(path, event_table(run, scene), "quasistatic",
                          "Begin anew, without --resume and with --overwrite", "events", CutRow::left_out);
  std::map<std::string, std::size_t> column;
  for (std::size_t k = 0; k < table.columns().size(); ++k) column[table.columns()[k]] = k;
  std::vector<BreakEvent> events(table.rows());
  for (std::size_t row = 0; row < events.size(); ++row) {
    if (const std::int64_t number = table.integer(row, column.at("event")); number != static_cast<std::int64_t>(row)) {
      table.refuse(fmt::format("line {} has the event {} where {} should be: rows are missing, or are in another order",
                               row + 2, number, row));
    }
    BreakEvent& event = events[row];
    for (const Count& count : count_columns) event.*count.member = table.integer(row, column.at(count.name));
    for (const Number& n : numbers(scene.path.driven_by)) event.*n.member = table.number(row, column.at(n.name));
    for (const StressColumn& c : stress_columns) event.stress.*c.member = table.number(row, column.at(c.name));
    event.mode = enum_from<BreakMode>(table.text(row, column.at("mode")));
    event.loosened = discs_of(table, row, column.at("loosened"));
  }
  return {std::move(events), table.cut()};
}

}  // namespace equidem
