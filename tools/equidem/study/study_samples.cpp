// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/study_samples.hpp"

#include <cstdint>
#include <optional>

namespace equidem {
namespace {

/// Round 0 gives the values, later ones the times.
struct Row {
  std::int64_t setting = 0, round = 0;
  const TaskSamples* task = nullptr;
};

}  // namespace

Table study_samples_table(const Study& study, const StudySamples& samples, const std::string& checksum) {
  std::vector<Row> rows;
  for (std::size_t k = 0; k < samples.tasks.size(); ++k) {
    const TaskSamples& task = samples.tasks[k];
    for (std::int64_t round = 0; task.tried() && round <= std::ssize(task.times); ++round)
      rows.push_back({static_cast<std::int64_t>(k), round, &task});
  }
  Table table;
  table.add("setting", rows, &Row::setting).add("round", rows, &Row::round);
  const auto add_time = [&](const char* name, double TimeSample::*time) {
    table.add(name, rows, [&](const Row& row) {
      return row.round == 0 ? std::nullopt
                            : std::optional(row.task->times[static_cast<std::size_t>(row.round - 1)].*time);
    });
  };
  add_time("seconds", &TimeSample::seconds);
  add_time("processor_seconds", &TimeSample::processor_seconds);
  for (std::size_t q = 0; q < study.quantities.size(); ++q) {
    table.add(study.quantities[q].name, rows, [q](const Row& row) {
      return row.round == 0 && !row.task->values.empty() ? std::optional(row.task->values[q]) : std::nullopt;
    });
  }
  table.add("refusal", rows, [](const Row& row) { return row.round == 0 ? row.task->refusal : std::string(); });
  return table.add("checksum", rows, [&](const Row&) { return checksum; });
}

StudySamples read_study_samples(const std::filesystem::path& path, const Study& study, const std::string& checksum) {
  const StoredTable table(path, study_samples_table(study, {}, checksum), "study",
                          "Choose another --out, or pass --overwrite to begin anew");
  StudySamples samples;
  samples.tasks.resize(study.tasks.size());
  const std::size_t first = 4, refusal = first + study.quantities.size();
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.text(row, refusal + 1) != checksum)
      table.refuse("they are of another study: settings, quantities, seed, machine or build differ");
    TaskSamples& task =
        samples.tasks[static_cast<std::size_t>(table.integer(row, 0, 0, std::ssize(samples.tasks) - 1))];
    if (table.integer(row, 1) > 0) {
      task.times.push_back({table.number(row, 2), table.number(row, 3)});
      continue;
    }
    task.refusal = table.text(row, refusal);
    for (std::size_t column = first; task.refusal.empty() && column < refusal; ++column)
      task.values.push_back(table.number(row, column));
  }
  return samples;
}

}  // namespace equidem
