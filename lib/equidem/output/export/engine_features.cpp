// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/export/engine_features.hpp"

#include <algorithm>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

std::vector<std::string> acceptable_features() {
  std::vector<std::string> words;
  for (const EngineFeatureRow& row : EnumNames<EngineFeature>::list)
    if (row.accept != nullptr) words.emplace_back(row.accept);
  return words;
}

void require_carried(const FoundFeatures& found, Engine engine, const std::vector<std::string>& accepted) {
  const std::vector<std::string> words = acceptable_features();
  for (const std::string& word : accepted) {
    if (std::ranges::find(words, word) != words.end()) continue;
    bad_input(fmt::format("--accept {}: nothing of that name can be accepted", word),
              "what an engine does not carry is refused", fmt::format("Give --accept {}", joined(words, " or ")));
  }
  for (const auto& [feature, instance] : found) {
    const EngineFeatureRow& row = entry_of(feature);
    if (row.carried_by(engine)) continue;
    if (row.accept != nullptr && std::ranges::find(accepted, row.accept) != accepted.end()) continue;
    bad_input(fmt::format("the export to {} does not carry {}{}", to_string(engine), row.name,
                          instance.empty() ? "" : ", here " + instance),
              row.why, row.remedy);
  }
}

std::string engine_features_table() {
  const auto names = names_of<Engine>();
  std::string text =
      fmt::format("| part of a model | {} | why it is refused |\n|---|---|---|---|\n", joined(names, " | "));
  for (const EngineFeatureRow& row : EnumNames<EngineFeature>::list) {
    std::vector<std::string> cells;
    for (const auto& engine : EnumNames<Engine>::list) {
      const std::string otherwise = row.accept != nullptr ? fmt::format("with --accept {}", row.accept) : "no";
      cells.push_back(row.carried_by(engine.value) ? "yes" : otherwise);
    }
    text += fmt::format("| {} | {} | {} |\n", row.name, joined(cells, " | "), row.why);
  }
  return text;
}

}  // namespace equidem
