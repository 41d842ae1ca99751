// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Abe (1996), section 3: the tension test reads the moduli of the infinite lattice off a block with sides.

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/material/spring_relations.hpp"
#include "equidem/study/built_in.hpp"

namespace equidem {
namespace {

struct Tension {
  double poisson_ratio = 0, shear_modulus = 0;
};

/// (35), and G from (36): 2G/((1 - nu) kN).
Tension tension_of(int rows, GaugePlacement gauge) {
  const Assembly block = hexagonal_lattice({.columns = rows, .rows = rows, .radius = 0.005});
  const ContactSprings springs(study_springs);
  const TensionTest test{.gauge = gauge};
  const TensionSetup setup = tension_setup(block, test);
  const Equilibrium rest = solve_equilibrium(block, springs, setup.supports, setup.loads);
  const TensionResult result = evaluate_tension(block, springs, test, setup, rest);
  return {result.poisson_ratio, 0.5 * result.stiffness_ratio * (1 - result.poisson_ratio) * study_springs.kN};
}

}  // namespace

Study abe_lattice_study(bool quick) {
  const ElasticModuli exact = moduli_of(study_springs, lattices::hexagonal.relation);
  Study study{.name = "abe_lattice",
              .title = fmt::format("Abe's tension test, hexagonal lattice, kT/kN = {:g}", study_springs.ratio()),
              .quantities = {{.name = "poisson_ratio",
                              .label = "error of Poisson's ratio",
                              .truth = exact.poisson_ratio,
                              .source = "closed form of the infinite lattice, Abe (1996), eq. (34)"},
                             {.name = "shear_modulus",
                              .label = "relative error of the shear modulus",
                              .relative = true,
                              .truth = exact.shear_modulus,
                              .source = "closed form of the infinite lattice, Abe (1996), eq. (34)"}},
              .tasks = {}};
  study.orders = {
      {.order = 1, .why = "a layer of discs at the sides, 1/rows of the block, is stiffer or softer than the rest"}};
  for (const GaugePlacement gauge : {GaugePlacement::centre, GaugePlacement::quarter}) {
    for (int rows = 9; rows <= (quick ? 129 : 257); rows = 2 * rows - 1) {
      Setting setting{.method = "gauge at " + to_string(gauge),
                      .values = {{"rows", static_cast<double>(rows)}},
                      .resolution = 1.0 / rows};
      study.tasks.push_back(task_on(
          std::move(setting), [] { return Tension{}; },
          [rows, gauge](Tension& result) { result = tension_of(rows, gauge); },
          [](const Tension& result) {
            return std::vector{result.poisson_ratio, result.shear_modulus};
          }));
    }
  }
  study.notes = {"A periodic cell of two rows has no sides: equidem homogenize gives both moduli to round-off."};
  return study;
}

}  // namespace equidem
