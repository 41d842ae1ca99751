// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/export/engine_features.hpp"

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

void require_carried(const FoundFeatures& found, Engine engine) {
  for (const auto& [feature, instance] : found) {
    const EngineFeatureRow& row = entry_of(feature);
    if (row.carried_by(engine)) continue;
    bad_input(fmt::format("the export to {} does not carry {}{}", to_string(engine), row.name,
                          instance.empty() ? "" : ", here " + instance),
              row.why, row.remedy);
  }
}

std::string engine_features_table() {
  const auto names = names_of<Engine>();
  std::string text = fmt::format("| part of a model | {} |\n|---|---|---|---|\n", joined(names, " | "));
  for (const EngineFeatureRow& row : EnumNames<EngineFeature>::list) {
    std::vector<std::string> cells;
    for (const auto& engine : EnumNames<Engine>::list) cells.emplace_back(row.carried_by(engine.value) ? "yes" : "no");
    text += fmt::format("| {} | {} |\n", row.name, joined(cells, " | "));
  }
  return text;
}

}  // namespace equidem
