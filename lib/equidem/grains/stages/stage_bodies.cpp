// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/stages/stage_bodies.hpp"

#include <algorithm>

#include "equidem/core/error.hpp"

namespace equidem {
namespace {

std::vector<std::size_t> idle(const std::vector<char>& held) {
  std::vector<std::size_t> numbers;
  for (std::size_t k = 0; k < held.size(); ++k)
    if (held[k] == 0) numbers.push_back(k);
  return numbers;
}

}  // namespace

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
  std::vector<char> removes(how.removed.size(), 0), renames(how.renamed.size(), 0);
  for (std::size_t k = 0; k < before.grains.size(); ++k) {
    const Grain& grain = before.grains[k];
    bool goes = false;
    for (std::size_t c = 0; c < how.removed.size(); ++c)
      if (how.removed[c].holds(grain)) {
        goes = true;
        removes[c] = 1;
      }
    if (goes) {
      ++changed.removed;
      continue;
    }
    put(before.numbers[k], grain, static_cast<std::int32_t>(k));
    Grain& kept = changed.now.grains.back();
    for (std::size_t c = 0; c < how.renamed.size(); ++c)
      if (how.renamed[c].which.holds(kept)) kept.kind = how.renamed[c].kinds[before.numbers[k]], renames[c] = 1;
    if (kept.kind != grain.kind) ++changed.renamed;
  }
  changed.idle_removals = idle(removes);
  changed.idle_renamings = idle(renames);
  for (std::size_t k = 0; k < how.added.size(); ++k) put(first_added + k, how.added[k], -1);
  if (changed.now.grains.empty())
    bad_input("all bodies are removed", "there is nothing left to move", "Remove fewer, or add some");
  return changed;
}

}  // namespace equidem
