// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/study_samples.hpp"

#include <cstdint>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"

namespace equidem {
namespace {

std::vector<std::string> column_names(const Study& study) {
  std::vector<std::string> names{"setting", "round", "seconds", "processor_seconds"};
  for (const Quantity& quantity : study.quantities) names.push_back(quantity.name);
  names.emplace_back("refusal");
  names.emplace_back("checksum");
  return names;
}

}  // namespace

std::string study_samples_csv(const Study& study, const StudySamples& samples, const std::string& checksum) {
  CsvText csv(column_names(study));
  for (std::size_t k = 0; k < samples.tasks.size(); ++k) {
    const TaskSamples& task = samples.tasks[k];
    if (!task.tried()) continue;
    for (std::size_t round = 0; round <= task.times.size(); ++round) {
      csv.cell(static_cast<std::int64_t>(k));
      csv.cell(static_cast<std::int64_t>(round));
      if (round == 0) {
        csv.empty_cell();
        csv.empty_cell();
      } else {
        csv.cell(task.times[round - 1].seconds);
        csv.cell(task.times[round - 1].processor_seconds);
      }
      for (std::size_t q = 0; q < study.quantities.size(); ++q) {
        if (round == 0 && !task.values.empty())
          csv.cell(task.values[q]);
        else
          csv.empty_cell();
      }
      csv.cell(std::string_view(round == 0 ? task.refusal : ""));
      csv.cell(std::string_view(checksum));
      csv.end_row();
    }
  }
  return csv.text();
}

StudySamples read_study_samples(const std::filesystem::path& path, const Study& study, const std::string& checksum) {
  const auto fail = [&](const std::string& problem, const std::string& why) {
    throw Error(ErrorKind::bad_input, problem, why, "Choose another --out, or pass --overwrite to begin anew",
                path.string());
  };
  const auto rows = csv_cells(read_file(path));
  const auto names = column_names(study);
  if (rows.empty() || rows.front() != names)
    fail("the measurements there are of another study", "their columns are others");
  StudySamples samples;
  samples.tasks.resize(study.tasks.size());
  for (std::size_t r = 1; r < rows.size(); ++r) {
    const auto& row = rows[r];
    if (row.size() != names.size())
      fail("the measurements to continue cannot be read",
           fmt::format("line {} has {}", r + 1, counted(std::ssize(row), "cell")));
    if (row.back() != checksum)
      fail("the measurements there are of another study",
           "settings, quantities, seed, machine or build differ: they would not fit together");
    const auto setting = csv_integer(row[0]), round = csv_integer(row[1]);
    if (!setting || !round || *setting < 0 || *setting >= std::ssize(samples.tasks))
      fail("the measurements to continue cannot be read", fmt::format("line {} names no setting", r + 1));
    TaskSamples& task = samples.tasks[static_cast<std::size_t>(*setting)];
    const auto number = [&](std::size_t column) {
      const auto value = csv_number(row[column]);
      if (!value)
        fail("the measurements to continue cannot be read",
             fmt::format("'{}' in line {} is not a number", row[column], r + 1));
      return *value;
    };
    if (*round > 0) {
      task.times.push_back({number(2), number(3)});
      continue;
    }
    task.refusal = row[names.size() - 2];
    for (std::size_t q = 0; task.refusal.empty() && q < study.quantities.size(); ++q)
      task.values.push_back(number(4 + q));
  }
  return samples;
}

}  // namespace equidem
