// SPDX-License-Identifier: GPL-3.0-or-later

#include <array>
#include <cstddef>

#include "equidem/homogenize/contact_sums.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/sample_solver.hpp"

namespace equidem {
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
          deformations[k] = solver.solver().deformation(cases[k], solutions[k].motion, c);
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
