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
                          instance.empty() ? "" : " (" + instance + ")"),
              row.why, row.remedy);
  }
}

std::string engine_features_table() {
  std::string text = "| | " + joined(names_of<Engine>(), " | ") + " |\n|---|---|---|---|\n";
  for (const EngineFeatureRow& row : EnumNames<EngineFeature>::list) {
    text += fmt::format("| {} |", row.name);
    for (const auto& engine : EnumNames<Engine>::list) text += row.carried_by(engine.value) ? " yes |" : " refused |";
    text += '\n';
  }
  return text;
}

}  // namespace equidem
