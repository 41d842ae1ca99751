// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/sample_solver.hpp"
#include "equidem/homogenize/stress.hpp"

namespace equidem {
namespace {

/// Sums over the contacts of the part that carries load.
struct StrainSums {
  PairEnergies energies;
  Matrix3 of_prestress{};
  std::vector<Tensor2> stresses;  ///< of each case, times the area
  /// Bound, N, on the error of an energy of two cases by rounding of normals and lever arms: the motion is stationary,
  /// so that the change of sum kN dn_a dn_b + kT ds_a ds_b is that of the deformations of given motions.
  double rounding = 0;
};

/// Energies of pairs of mean strains in the prestress, N. \param motion_of of a contact by a case
template <typename MotionOf>
Matrix3 prestress_energies(const SampleSolver& solver, const MotionOf& motion_of) {
  const auto sums = contact_sums<6>(solver.assembly().contacts.size(), [&](std::size_t c, auto& total) {
    const ContactMotion motions[] = {motion_of(c, 0), motion_of(c, 1), motion_of(c, 2)};
    add_prestress_energies(*solver.springs().prestress(c), motions, total.data());
  });
  return symmetric(sums.data());
}

StrainSums sum_up(const SampleSolver& solver, const std::vector<RightHandSide>& cases,
                  const std::vector<Solution>& solutions) {
  constexpr std::size_t most_cases = strain_cases, first_stress = pair_sums;
  const Assembly& assembly = solver.assembly();
  const auto b = static_cast<std::size_t>(solver.unknowns().per_disc);
  const double scale = solver.unknowns().rotation_scale;
  const auto reach = [](double lever, double offset) { return std::abs(lever) + std::abs(offset); };
  const bool prestressed = solver.springs().prestressed();
  const auto motion_of_case = [&](std::size_t c, std::size_t k) {
    return solver.solver().contact_motion(cases[k], solutions[k].motion, c);
  };
  using Sums = std::array<double, first_stress + 4 * most_cases + 1>;
  const Sums sums = contact_sums<std::tuple_size_v<Sums>>(assembly.contacts.size(), [&](std::size_t c, Sums& total) {
    const Contact& contact = assembly.contacts[c];
    const ContactFrame frame = frame_of(assembly, c);
    std::array<ContactDeformation, most_cases> deformations;
    double largest_force = 0, distance = 0;
    for (std::size_t k = 0; k < cases.size(); ++k) {
      const ContactMotion motion = motion_of_case(c, k);
      deformations[k] = motion.deformation;
      const ContactForce force = prestressed ? force_of(solver.springs(), c, motion)
                                             : linear_spring_force(solver.springs()[c], deformations[k]);
      const Tensor2 work = force_by_branch(frame, force);
      const double entries[] = {work.xx, work.xy, work.yx, work.yy};
      for (std::size_t e = 0; e < 4; ++e) total[first_stress + 4 * k + e] += entries[e];
      if (k >= 3) continue;
      const double *u_i = &solutions[k].motion.high[contact.i * b], *u_j = &solutions[k].motion.high[contact.j * b];
      const double rolled = b == 3 ? (reach(frame.lever_i, frame.offset_i) * std::abs(u_i[2]) +
                                      reach(frame.lever_j, frame.offset_j) * std::abs(u_j[2])) /
                                         scale
                                   : 0;
      distance = std::max(distance, rolled + norm(unit_gradients[k] * assembly.branch(contact) +
                                                  Vec2{u_j[0] - u_i[0], u_j[1] - u_i[1]}));
      largest_force = std::max(largest_force, std::abs(force.normal) + std::abs(force.tangential));
    }
    add_pair_energies(solver.springs()[c], deformations.data(), total.data());
    total.back() += normal_rounding(assembly, contact) * largest_force * distance;
  });
  StrainSums result{.energies = pair_energies(sums.data()),
                    .of_prestress = prestressed ? prestress_energies(solver, motion_of_case) : Matrix3{},
                    .stresses = {},
                    .rounding = 2 * std::numeric_limits<double>::epsilon() * sums.back()};
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const double* stress = &sums[first_stress + 4 * k];
    result.stresses.push_back({stress[0], stress[1], stress[2], stress[3]});
  }
  return result;
}

}  // namespace

void add_prestress_energies(const ContactPrestress& prestress, const ContactMotion* motions, double* sums) {
  add_triangle(sums, [&](std::size_t a, std::size_t b) {
    const ContactMotion &by_a = motions[a], &by_b = motions[b];
    return prestress_form(prestress, by_a.deformation, by_a.theta_i, by_a.theta_j, by_b.deformation, by_b.theta_i,
                          by_b.theta_j);
  });
}

double power_difference(const std::vector<Tensor2>& stresses, const Matrix3& stiffness) {
  double largest = 0;
  for (int k = 0; k < 3; ++k) {
    const Voigt s = voigt_stress(stresses[k]);
    const double row[] = {s.xx, s.yy, s.xy};
    for (int a = 0; a < 3; ++a) largest = std::max(largest, std::abs(row[a] - stiffness[a][k]));
  }
  return largest / largest_entry(stiffness);
}

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

SampleSolver strain_sample(const Assembly& assembly, const ContactSprings& springs, const HomogenizeOptions& options,
                           EffectiveStiffness& result) {
  const bool displaced = options.boundary == Boundary::displacement;
  std::vector<std::uint8_t> held;
  if (displaced) {  // of discs without contacts no motion matters: they are rattlers
    held.resize(assembly.size());
    const std::vector<std::uint8_t> outer = boundary_discs(assembly);
    for (const Contact& c : assembly.contacts)
      for (const std::int32_t disc : {c.i, c.j}) held[disc] = outer[disc];
  }
  return {assembly, springs, options, held, displaced, result};
}

void solve_strains(const Assembly& assembly, const ContactSprings& springs, const HomogenizeOptions& options,
                   EffectiveStiffness& result) {
  SampleSolver solver = strain_sample(assembly, springs, options, result);
  const bool turned = result.effects.restrained;
  std::vector<RightHandSide> cases(turned ? 4 : 3);
  for (std::size_t k = 0; k < cases.size(); ++k) {
    cases[k].gradient = unit_gradients[k];
  }
  const std::vector<Solution> solutions = solver.solve(cases, result);

  Stopwatch watch;
  StrainSums sums = sum_up(solver, cases, solutions);
  for (Tensor2& stress : sums.stresses) stress *= 1 / result.area;
  result.normal_part = (1 / result.area) * sums.energies.normal;
  result.tangential_part = (1 / result.area) * sums.energies.tangential;
  result.prestress_part = (1 / result.area) * sums.of_prestress;
  result.stiffness = result.normal_part + result.tangential_part;
  if (result.effects.bending) {
    result.bending_part = (1 / result.area) * bending_energies(solver, cases, solutions);
    result.stiffness = result.stiffness + result.bending_part;
  }
  if (springs.prestressed()) result.stiffness = result.stiffness + result.prestress_part;
  result.error_bound = (solver.energy_error() + sums.rounding) / result.area;
  result.hill_mandel = power_difference(sums.stresses, result.stiffness);
  keep_gradient_stiffness(sums.stresses, result);
  for (std::size_t k = 0; k < 3; ++k) {
    result.fluctuations.push_back(solver.motions_of_whole(solutions[k].motion));
  }
  result.times.add("stiffness", watch.lap());
}

namespace {

constexpr Tensor2 unit_stresses[] = {{1, 0, 0, 0}, {0, 0, 0, 1}, {0, 1, 1, 0}};

std::vector<std::uint8_t> loaded_discs(const Assembly& assembly, const TractionSample& sample) {
  std::vector<std::uint8_t> loaded(assembly.size(), 0);
  for (const auto& share : sample.shares) loaded[share.disc] = 1;
  for (const auto& cut : sample.cuts) {
    loaded[assembly.contacts[cut.contact].i] = loaded[assembly.contacts[cut.contact].j] = 1;
  }
  return loaded;
}

/// Forces and moments on the components for a uniform stress.
std::vector<double> tractions(const Assembly& assembly, const TractionSample& sample, const SampleSolver& solver,
                              const Tensor2& stress) {
  const DegreesOfFreedom& unknowns = solver.unknowns();
  const std::vector<std::int32_t> index = solver.indices();
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  std::vector<double> force(unknowns.held.size(), 0.0);
  const auto add = [&](std::int32_t disc, Vec2 f, double moment) {
    const std::size_t d = static_cast<std::size_t>(index[disc]) * b;
    force[d] += f.x;
    force[d + 1] += f.y;
    if (b == 3 && unknowns.held[d + 2] != DegreesOfFreedom::without_stiffness)
      force[d + 2] += moment / unknowns.rotation_scale;
  };
  for (const auto& share : sample.shares) add(share.disc, stress * share.a, 0);
  for (const auto& cut : sample.cuts) {
    const Contact& contact = assembly.contacts[cut.contact];
    const Vec2 f = stress * cut.a;
    const ContactFrame frame = frame_of(assembly, cut.contact);
    const ContactForce carried{dot(f, frame.normal), dot(f, frame.tangent())};
    add(contact.i, f, moment_on_i(frame, carried));
    add(contact.j, -f, moment_on_j(frame, carried));
  }
  return force;
}

/// Energy stored by the cut contacts under the forces that they carry, without moments.
PairEnergies energies_of_cuts(const Assembly& assembly, const ContactSprings& springs, const TractionSample& sample) {
  PairEnergies energies;
  for (const auto& cut : sample.cuts) {
    const ContactFrame frame = frame_of(assembly, cut.contact);
    const SpringConstants k = springs[cut.contact];
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        const Vec2 f = unit_stresses[a] * cut.a, g = unit_stresses[b] * cut.a;
        energies.normal[a][b] += dot(f, frame.normal) * dot(g, frame.normal) / k.kN;
        energies.tangential[a][b] += dot(f, frame.tangent()) * dot(g, frame.tangent()) / k.kT;
      }
    }
  }
  return energies;
}

}  // namespace

void solve_tractions(const Assembly& assembly, const ContactSprings& springs, const HomogenizeOptions& options,
                     EffectiveStiffness& result) {
  const TractionSample sample = traction_sample(assembly, springs);
  SampleSolver solver(sample.assembly, sample.springs, options, loaded_discs(assembly, sample), false, result);
  std::vector<RightHandSide> cases(3);
  for (int k = 0; k < 3; ++k) cases[k].force = tractions(assembly, sample, solver, unit_stresses[k]);
  const std::vector<Solution> solutions = solver.solve(cases, result);

  Stopwatch watch;
  const PairEnergies inside = pair_energies(
      contact_sums<pair_sums>(solver.assembly().contacts.size(), [&](std::size_t c,
                                                                     std::array<double, pair_sums>& sums) {
        std::array<ContactDeformation, 3> deformations;
        for (std::size_t k = 0; k < 3; ++k) {
          deformations[k] = solver.solver().contact_motion(cases[k], solutions[k].motion, c).deformation;
        }
        add_pair_energies(solver.springs()[c], deformations.data(), sums.data());
      }).data());
  const PairEnergies cut = energies_of_cuts(assembly, springs, sample);
  Matrix3 stored = inside.normal + inside.tangential, bent{};
  if (result.effects.bending) {
    bent = bending_energies(solver, cases, solutions);
    stored = stored + bent;
  }
  Matrix3 compliance = cut.normal + cut.tangential;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      double work = 0;  // f_a u_b + f_b u_a - u_a K u_b is stationary at the solution
      for (std::size_t k = 0; k < cases[a].force.size(); ++k) {
        work += cases[a].force[k] * solutions[b].motion.high[k] + cases[b].force[k] * solutions[a].motion.high[k];
      }
      compliance[a][b] += work - stored[a][b];
    }
  }
  const double area = result.area;
  result.stiffness = inverse((1 / area) * compliance);
  // C = D^-1 and kT dD/dkT = -(tangential energies): kT dC/dkT = C (tangential energies) C; likewise kN.
  result.normal_part = result.stiffness * ((1 / area) * (inside.normal + cut.normal)) * result.stiffness;
  result.tangential_part = result.stiffness * ((1 / area) * (inside.tangential + cut.tangential)) * result.stiffness;
  result.bending_part = result.stiffness * ((1 / area) * bent) * result.stiffness;
  const double size = largest_entry(result.stiffness);
  result.error_bound = 9 * size * size * solver.energy_error() / area;
  result.times.add("stiffness", watch.lap());
}

}  // namespace equidem
