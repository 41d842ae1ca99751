// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/homogenize/contact_sums.hpp"
#include "equidem/homogenize/sample_solver.hpp"
#include "equidem/homogenize/stress.hpp"

namespace equidem {
namespace {

/// Displacement gradients of unit strains xx, yy, xy (engineering) and of the unit rotation.
constexpr Tensor2 unit_gradients[] = {{1, 0, 0, 0}, {0, 0, 0, 1}, {0, 0.5, 0.5, 0}, {0, -1, 1, 0}};

/// Hill & Mandel: mean stress times mean strain is the mean of the powers.
double power_difference(const std::vector<Tensor2>& stresses, const Matrix3& stiffness) {
  double largest = 0;
  for (int k = 0; k < 3; ++k) {
    const Voigt s = voigt_stress(stresses[k]);
    const double row[] = {s.xx, s.yy, s.xy};
    for (int a = 0; a < 3; ++a) largest = std::max(largest, std::abs(row[a] - stiffness[a][k]));
  }
  return largest / largest_entry(stiffness);
}

/// Bound, N, on the error of an energy of two cases by rounding of normals and lever arms: the motion is stationary, so
/// that the change of sum kN dn_a dn_b + kT ds_a ds_b is that of the deformations of given motions.
double rounding_of_energies(const SampleSolver& solver, const std::vector<Solution>& solutions,
                            const std::vector<std::vector<ContactDeformation>>& deformations) {
  const Assembly& assembly = solver.assembly();
  const auto b = static_cast<std::size_t>(solver.unknowns().per_disc);
  const double scale = solver.unknowns().rotation_scale;
  const auto reach = [](double lever, double offset) { return std::abs(lever) + std::abs(offset); };
  const auto sum = contact_sums<1>(assembly.contacts.size(), [&](std::size_t c, std::array<double, 1>& total) {
    const Contact& contact = assembly.contacts[c];
    const ContactFrame frame = frame_of(assembly, c);
    double force = 0, distance = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double *u_i = &solutions[k].motion.high[contact.i * b], *u_j = &solutions[k].motion.high[contact.j * b];
      const double rolled = b == 3 ? (reach(frame.lever_i, frame.offset_i) * std::abs(u_i[2]) +
                                      reach(frame.lever_j, frame.offset_j) * std::abs(u_j[2])) /
                                         scale
                                   : 0;
      distance = std::max(distance, rolled + norm(unit_gradients[k] * assembly.branch(contact) +
                                                  Vec2{u_j[0] - u_i[0], u_j[1] - u_i[1]}));
      const auto f = linear_spring_force(solver.springs()[c], deformations[k][c]);
      force = std::max(force, std::abs(f.normal) + std::abs(f.tangential));
    }
    total[0] += normal_rounding(assembly, contact) * force * distance;
  });
  return 2 * std::numeric_limits<double>::epsilon() * sum[0];
}

/// Stresses of unit displacement gradients xx, yy, xy, yx from those of unit strains and of the unit rotation.
void keep_gradient_stiffness(const std::vector<Tensor2>& stresses, EffectiveStiffness& result) {
  const Tensor2 turned = stresses.size() > 3 ? stresses[3] : Tensor2{};
  const Tensor2 columns[] = {stresses[0], stresses[1], stresses[2] + (-0.5) * turned, stresses[2] + 0.5 * turned};
  double asymmetric = 0;
  for (int c = 0; c < 4; ++c) {
    const Tensor2& s = columns[c];
    const double column[] = {s.xx, s.yy, s.xy, s.yx};
    for (int r = 0; r < 4; ++r) result.gradient_stiffness[r][c] = column[r];
    asymmetric = std::max(asymmetric, std::abs(asymmetry(s)));
  }
  result.stress_asymmetry = asymmetric / largest_entry(result.gradient_stiffness);
}

/// Stiffness of the part that carries load, over the area of the whole.
Tensor2 mean_stress(const SampleSolver& solver, const std::vector<ContactDeformation>& deformations, double area) {
  std::vector<ContactForce> forces(deformations.size());
  for (std::size_t c = 0; c < forces.size(); ++c) {
    forces[c] = linear_spring_force(solver.springs()[c], deformations[c]);
  }
  return (solver.assembly().area() / area) * macroscopic_stress(solver.assembly(), forces);
}

}  // namespace

void solve_strains(const Assembly& assembly, const ContactSprings& springs, const HomogenizeOptions& options,
                   EffectiveStiffness& result) {
  const bool displaced = options.boundary == Boundary::displacement;
  SampleSolver solver(assembly, springs, options, displaced ? boundary_discs(assembly) : std::vector<std::uint8_t>{},
                      displaced, result);
  const bool turned = result.effects.restrained;
  std::vector<RightHandSide> cases(turned ? 4 : 3);
  for (std::size_t k = 0; k < cases.size(); ++k) {
    cases[k].imposed = affine_deformations(solver.assembly(), unit_gradients[k], 0);
  }
  const std::vector<Solution> solutions = solver.solve(cases, result);

  Stopwatch watch;
  std::vector<std::vector<ContactDeformation>> deformations;
  std::vector<Tensor2> stresses;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    deformations.push_back(solver.solver().deformations(cases[k], solutions[k].motion));
    stresses.push_back(mean_stress(solver, deformations[k], result.area));
  }
  const PairEnergies energies = pair_energies(solver.springs(), deformations);
  result.normal_part = (1 / result.area) * energies.normal;
  result.tangential_part = (1 / result.area) * energies.tangential;
  result.stiffness = result.normal_part + result.tangential_part;
  result.error_bound = (solver.energy_error() + rounding_of_energies(solver, solutions, deformations)) / result.area;
  result.hill_mandel = power_difference(stresses, result.stiffness);
  keep_gradient_stiffness(stresses, result);
  for (std::size_t k = 0; k < 3; ++k) {
    result.fluctuations.push_back(solver.motions_of_whole(solutions[k].motion));
  }
  result.times.add("stiffness", watch.lap());
}

}  // namespace equidem
