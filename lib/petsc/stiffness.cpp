// SPDX-License-Identifier: GPL-3.0-or-later
#include "petsc/stiffness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/sample_solver.hpp"
#include "equidem/homogenize/stress.hpp"

namespace equidem::petsc {
namespace {

/// Sums over the contacts of all ranks: energies of pairs of strains, and stresses of each case times the area.
struct Sums {
  PairEnergies energies;
  std::vector<Tensor2> stresses;
};

Sums sum_up(const Network& network, std::span<const Refined> cases) {
  constexpr std::size_t first_stress = pair_sums;
  std::vector<double> total(first_stress + 4 * cases.size(), 0.0);
  const Assembly& assembly = network.assembly();
  const SpringNetwork local{assembly, network.graph(), network.springs(), network.unknowns()};
  std::array<ContactDeformation, strain_cases> deformations;
  std::vector<double> some(total.size());
  constexpr std::size_t run = 64;  // equal terms round to the same side: no long run of them
  for (std::size_t begin = 0; begin < assembly.contacts.size(); begin += run) {
    std::ranges::fill(some, 0.0);
    for (std::size_t c = begin; c < std::min(begin + run, assembly.contacts.size()); ++c) {
      const ContactFrame frame = frame_of(assembly, c);
      for (std::size_t k = 0; k < cases.size(); ++k) {
        deformations[k] = deformation_of(local, cases[k].motion, unit_gradients[k], c);
        const Tensor2 work = force_by_branch(frame, linear_spring_force(network.springs()[c], deformations[k]));
        double* const stress = &some[first_stress + 4 * k];
        stress[0] += work.xx, stress[1] += work.xy, stress[2] += work.yx, stress[3] += work.yy;
      }
      add_pair_energies(network.springs()[c], deformations.data(), some.data());
    }
    for (std::size_t k = 0; k < total.size(); ++k) total[k] += some[k];
  }
  network.ranks().sum(total);
  Sums sums{.energies = pair_energies(total.data()), .stresses = {}};
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const double* stress = &total[first_stress + 4 * k];
    sums.stresses.push_back({stress[0], stress[1], stress[2], stress[3]});
  }
  return sums;
}

/// Refuses a cell that some mean strain costs no energy, and counts those that release energy.
void judge(EffectiveStiffness& result) {
  const StiffnessEigen eigen = eigenstrains(result.stiffness);
  const double largest = std::max(std::abs(eigen.values[0]), std::abs(eigen.values[2]));
  constexpr double nothing = 1e-12;
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::abs(eigen.values[k]) > nothing * largest + 2 * result.error_bound) continue;
    const auto& e = eigen.strains[k];
    bad_input("the network is floppy",
              fmt::format("the mean strain (xx {:.3f}, yy {:.3f}, shear {:.3f}) costs no energy beyond rounding", e[0],
                          e[1], e[2]),
              "It has no modulus. Add contacts, or give the contacts tangential springs (kT > 0)");
  }
  result.count_unstable_strains();
}

/// Whether all discs can counter-rotate: neighbours along rows and columns turn the other way.
bool is_even_square(const Part& part) {
  const Assembly& assembly = part.assembly;
  if (assembly.kind != "square" || assembly.radii.empty()) return false;
  const auto even = [&](double length) { return std::llround(length / (2 * assembly.radii.front())) % 2 == 0; };
  return even(assembly.period->x) && even(assembly.period->y);
}

}  // namespace

std::vector<std::int64_t> free_components(const Part& part, const Effects& effects) {
  std::vector<std::int64_t> components{0, 1};
  if (effects.rotation && is_even_square(part)) components.push_back(2);
  return components;
}

CellSolver::CellSolver(const Ranks& ranks, const Part& part, const Whole& whole, const ContactSprings& springs,
                       const Effects& effects, SolverMethod method, std::span<const std::int64_t> held)
    : effects_(effects), network_(ranks, part, whole, springs, effects, {}) {
  Stopwatch watch;
  if (!part.assembly.periodic()) {
    bad_input("the boundary is periodic but the assembly is not", "it has no images to be joined to",
              "Take a periodic assembly, or 'equidem homogenize' for other boundaries");
  }
  network_.hold(held);
  times_.add("network", watch.lap());
  solver_.emplace(network_, method, times_);
}

EffectiveStiffness CellSolver::solve() {
  EffectiveStiffness result;
  result.effects = effects_;
  result.area = network_.whole().area;
  result.times = times_;
  Stopwatch watch;
  std::vector<Refined> cases;
  double worst = 0;
  for (std::size_t k = 0; k < (effects_.restrained ? 4U : 3U); ++k) {
    cases.push_back(refine(network_, *solver_, {}, unit_gradients[k]));
    const Refined& one = cases.back();
    if (one.scale > 0 && one.iterations > 0)
      result.relative_residual = std::max(result.relative_residual, one.residual / one.scale);
    result.iterations += one.iterations;
    worst = std::max(worst, one.error);
  }
  result.times.add("solve", watch.lap());
  Sums sums = sum_up(network_, cases);
  for (Tensor2& stress : sums.stresses) stress *= 1 / result.area;
  result.normal_part = (1 / result.area) * sums.energies.normal;
  result.tangential_part = (1 / result.area) * sums.energies.tangential;
  result.stiffness = result.normal_part + result.tangential_part;
  constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();
  result.error_bound = (worst * worst + rounding) * largest_entry(result.stiffness);
  result.hill_mandel = power_difference(sums.stresses, result.stiffness);
  keep_gradient_stiffness(sums.stresses, result);
  for (std::size_t k = 0; k < 3; ++k)
    result.fluctuations.push_back(disc_motions(network_.unknowns(), cases[k].motion.high));
  result.times.add("stiffness", watch.lap());
  result.unknowns = network_.free_count();
  result.negative_pivots = result.unstable_modes = network_.any_negative() ? -1 : 0;
  result.self_stresses = -1;
  result.solver = solver_->name();
  result.factor_bytes = solver_->grid_bytes();
  judge(result);
  return result;
}

}  // namespace equidem::petsc
