// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Cost of tangential springs and rotations in statics: unknowns, entries of the factor, memory and time.
#include <memory>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/study/built_in.hpp"

namespace equidem {
namespace {

struct StaticsCase {
  const char* name;
  double ratio;  ///< kT/kN
  Rotation rotation;
};

}  // namespace

Study effects_statics_study(bool quick) {
  constexpr StaticsCase cases[] = {{"normal springs, kT = 0", 0, Rotation::from_scene},
                                   {"+ tangential springs, rotation restrained", 0.5, Rotation::restrained},
                                   {"+ rotation free", 0.5, Rotation::from_scene},
                                   {"or kT/kN = -0.2, by L D L^T", -0.2, Rotation::from_scene}};
  const int side = quick ? 30 : 150;
  Study study{.name = "effects_statics",
              .title = fmt::format("{} x {} discs in tension, solved", side, side),
              .quantities = {{.name = "unknowns", .label = "unknowns per disc", .fact = true},
                             {.name = "factor_entries", .label = "entries of the factor per disc", .fact = true},
                             {.name = "factor_bytes", .label = "bytes of the factor per disc", .fact = true},
                             {.name = "residual", .label = "relative residual", .fact = true}},
              .tasks = {}};
  const auto block =
      std::make_shared<const Assembly>(hexagonal_lattice({.columns = side, .rows = side, .radius = 0.005}));
  const auto setup = std::make_shared<const TensionSetup>(tension_setup(*block, {}));
  study.pieces = static_cast<double>(block->size());
  study.piece = "disc";
  for (const StaticsCase& one : cases) {
    const auto springs =
        std::make_shared<const ContactSprings>(SpringConstants{study_springs.kN, one.ratio * study_springs.kN});
    study.tasks.push_back(task_on(
        {.method = one.name}, [] { return Equilibrium(); },
        [=, rotation = one.rotation](Equilibrium& rest) {
          EquilibriumOptions options;
          options.rotation = rotation;
          rest = solve_equilibrium(*block, *springs, setup->supports, setup->loads, options);
        },
        [discs = study.pieces](const Equilibrium& rest) {
          return std::vector{static_cast<double>(rest.unknowns) / discs, rest.factor_nonzeros / discs,
                             rest.factor_bytes / discs, rest.relative_residual};
        }));
  }
  study.notes = {"The time is that of the whole answer: checks, ordering, factorization, solution and refinement."};
  return study;
}

}  // namespace equidem
