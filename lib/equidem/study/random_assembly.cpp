// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Moduli of random periodic cells: how well the mean of S cells of N discs is known.
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/study/built_in.hpp"

namespace equidem {
namespace {

EffectiveModuli moduli_of_cell(std::int64_t discs, std::uint64_t seed) {
  DelaunayOptions options;
  options.discs = discs;
  options.seed = seed;
  options.periodic = true;
  const Assembly cell = delaunay_assembly(options);
  return effective_moduli(effective_stiffness(cell, ContactSprings(study_springs)).stiffness);
}

struct Sampled {
  std::vector<double> poisson, shear;
};

StudyTask task_of(Setting setting, std::int64_t discs, int seeds) {
  const auto work = [=](Sampled& sampled) {
    sampled = {};
    for (int seed = 1; seed <= seeds; ++seed) {
      const EffectiveModuli moduli = moduli_of_cell(discs, static_cast<std::uint64_t>(seed));
      sampled.poisson.push_back(moduli.poisson_strain);
      sampled.shear.push_back(moduli.shear_modulus);
    }
  };
  const auto values = [](const Sampled& sampled) {
    const MeanEstimate shear = estimate_mean(sampled.shear, 0.95);
    return std::vector{estimate_mean(sampled.poisson, 0.95).standard_error, shear.standard_error / shear.mean};
  };
  return task_on(
      std::move(setting), [] { return Sampled{}; }, work, values);
}

}  // namespace

Study random_assembly_study(bool quick) {
  const char* source = "independent seeds: scatter of the samples over the root of their number";
  Study study{
      .name = "random_assembly",
      .title = "Random periodic cells, poisson_disc, kT/kN = 0.5",
      .quantities =
          {{.name = "poisson_ratio", .label = "standard error of Poisson's ratio (plane strain)", .source = source},
           {.name = "shear_modulus", .label = "relative standard error of the shear modulus", .source = source}},
      .tasks = {}};
  const int seeds = quick ? 24 : 96;
  const std::string more_discs = fmt::format("{} cells, more discs", seeds);
  for (std::int64_t discs = 25; discs <= (quick ? 400 : 1600); discs *= 2) {
    const auto n = static_cast<double>(discs);
    study.tasks.push_back(
        task_of({.method = more_discs, .values = {{"discs", n}, {"seeds", seeds * 1.0}}, .resolution = 1 / (n * seeds)},
                discs, seeds));
  }
  constexpr std::int64_t few = 50;
  for (int more = 6; more <= (quick ? 96 : 384); more *= 2) {
    study.tasks.push_back(task_of({.method = fmt::format("cells of {} discs, more seeds", few),
                                   .values = {{"discs", few * 1.0}, {"seeds", more * 1.0}},
                                   .resolution = 1.0 / static_cast<double>(few * more)},
                                  few, more));
  }
  study.orders = {{.order = 0.5,
                   .why = "many independent patches average as the root of their number (Kanit et al. 2003); "
                          "the scatter of n samples is itself known to 1/sqrt(2 n) only"}};
  study.notes = {
      "h is one over all discs, cells times seeds. The standard error does not contain a drift with the size of cells: "
      "that is what [ensemble] of equidem homogenize measures."};
  return study;
}

}  // namespace equidem
