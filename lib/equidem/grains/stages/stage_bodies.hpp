// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies that are removed, renamed or added where a stage begins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

/// Some of the present bodies.
struct BodyChoice {
  std::vector<int> kinds = {};        ///< bodies of these kinds; empty: of any kind
  std::optional<Rectangle> box = {};  ///< bodies with their centre inside, its sides included, m; none: anywhere

  [[nodiscard]] bool holds(const Grain& grain) const;
};

/// Bodies get another kind.
struct BodyRenaming {
  BodyChoice which;
  std::vector<int> kinds;  ///< that each body of the run would get, by its number
};

/// In this order: bodies are removed, renamed, added. Bonds go with their bodies.
struct StageBodies {
  std::vector<BodyChoice> removed = {};
  std::vector<BodyRenaming> renamed = {};
  std::vector<Grain> added = {};

  [[nodiscard]] bool change() const { return !removed.empty() || !renamed.empty() || !added.empty(); }
};

/// The bodies that are there. A body keeps its number in the run: those of the first scene come first, then those that
/// stages add.
struct PresentBodies {
  std::vector<std::size_t> numbers;  ///< ascending
  std::vector<Grain> grains;         ///< in the same order
};

struct ChangedBodies {
  PresentBodies now;
  std::vector<std::int32_t> origins;  ///< place of each among those before; -1: it is new
  std::size_t removed = 0, renamed = 0;
  std::vector<std::size_t> idle_removals, idle_renamings;  ///< numbers of choices that held no body
};

/// \param first_added number in the run of the first body that is added
/// \throws Error (bad_input) if no body is left
ChangedBodies change_bodies(const PresentBodies& before, const StageBodies& how, std::size_t first_added);

}  // namespace equidem
