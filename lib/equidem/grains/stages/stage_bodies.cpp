// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/stages/stage_bodies.hpp"

#include <algorithm>

#include "equidem/core/error.hpp"

namespace equidem {

bool BodyChoice::holds(const Grain& grain) const {
  if (!kinds.empty() && std::ranges::find(kinds, grain.kind) == kinds.end()) return false;
  if (!box) return true;
  const Vec2 at = grain.position;
  return box->low.x <= at.x && at.x <= box->high.x && box->low.y <= at.y && at.y <= box->high.y;
}

ChangedBodies change_bodies(const PresentBodies& before, const StageBodies& how, std::size_t first_added) {
  ChangedBodies changed;
  const auto put = [&](std::size_t number, const Grain& grain, std::int32_t origin) {
    changed.now.numbers.push_back(number);
    changed.now.grains.push_back(grain);
    changed.origins.push_back(origin);
  };
  for (std::size_t k = 0; k < before.grains.size(); ++k) {
    const Grain& grain = before.grains[k];
    if (std::ranges::any_of(how.removed, [&](const BodyChoice& choice) { return choice.holds(grain); })) {
      ++changed.removed;
      continue;
    }
    put(before.numbers[k], grain, static_cast<std::int32_t>(k));
    Grain& kept = changed.now.grains.back();
    for (const BodyRenaming& renaming : how.renamed)
      if (renaming.which.holds(kept)) kept.kind = renaming.kinds[before.numbers[k]];
    if (kept.kind != grain.kind) ++changed.renamed;
  }
  for (std::size_t k = 0; k < how.added.size(); ++k) put(first_added + k, how.added[k], -1);
  if (changed.now.grains.empty())
    bad_input("all bodies are removed", "there is nothing left to move", "Remove fewer, or add some");
  return changed;
}

}  // namespace equidem
