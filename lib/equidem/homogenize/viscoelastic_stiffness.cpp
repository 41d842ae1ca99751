// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/viscoelastic_stiffness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "equidem/core/error.hpp"
#include "equidem/core/ordered_sums.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/sample_solver.hpp"
#include "equidem/statics/harmonic/harmonic_solver.hpp"

namespace equidem {
namespace {

void check_harmonic(const ContactSprings& springs, const Viscoelasticity& viscoelasticity,
                    std::span<const double> frequencies, const HomogenizeOptions& options) {
  check(viscoelasticity.normal, "normal");
  check(viscoelasticity.tangential, "tangential");
  if (springs.any_negative()) {
    bad_input("some kT is negative, and the springs are viscoelastic",
              "an assembly with kT < 0 rests in a balance that no dashpot keeps: every rotation grows",
              "Use kT >= 0, or elastic springs");
  }
  if (springs.bends()) {
    bad_input("bonds resist bending, and the springs are viscoelastic",
              "the relaxation of the normal and the tangential spring does not tell that of bending",
              "Take kM and bond_width out, or [viscoelastic]");
  }
  if (springs.prestressed()) {
    bad_input("forces at rest count, and the springs are viscoelastic",
              "their geometric stiffness is that of elastic springs alone", "Use effects.prestress = \"off\"");
  }
  if (options.boundary == Boundary::traction) {
    bad_input("the boundary is traction, and the springs are viscoelastic",
              "complex stiffness is computed from mean strains", "Use boundary = \"periodic\" or \"displacement\"");
  }
  for (const double frequency : frequencies) {
    if (frequency > 0 && std::isfinite(frequency)) continue;
    bad_input(
        fmt::format("a frequency is {} Hz", frequency),
        frequency == 0 ? "at rest a Maxwell spring has flowed and carries nothing, and others are elastic"
                       : "motions change as exp(i 2 pi frequency t)",
        frequency == 0 ? "Use a small frequency, or elastic springs of the relaxed stiffness" : "Give frequencies > 0");
  }
}

/// Adds the energies of pairs of unit strains, N, and bounds their rounding as `EffectiveStiffness` is bounded.
void sum_harmonic(const SampleSolver& sample, const HarmonicSolver& solver, const std::vector<HarmonicMotion>& motions,
                  HarmonicStiffness& result) {
  constexpr std::size_t pairs = 6;
  const Assembly& assembly = sample.assembly();
  using Sums = std::array<double, 2 * pairs + 1>;
  const Sums sums = contact_sums<std::tuple_size_v<Sums>>(assembly.contacts.size(), [&](std::size_t c, Sums& total) {
    const Contact& contact = assembly.contacts[c];
    const SpringConstantsOf<Complex> k = solver.springs_of(c);
    std::array<HarmonicDeformation, 3> d;
    double largest_force = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      d[a] = solver.deformation(unit_gradients[a], motions[a], c);
      largest_force = std::max(largest_force, std::abs(k.kN * d[a].normal) + std::abs(k.kT * d[a].tangential));
    }
    std::size_t entry = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = a; b < 3; ++b, ++entry) {
        const Complex energy = k.kN * d[a].normal * d[b].normal + k.kT * d[a].tangential * d[b].tangential;
        total[2 * entry] += energy.real();
        total[2 * entry + 1] += energy.imag();
      }
    }
    total.back() += normal_rounding(assembly, contact) * largest_force * norm(assembly.branch(contact));
  });
  std::size_t entry = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = a; b < 3; ++b, ++entry) {
      result.storage[a][b] = result.storage[b][a] = sums[2 * entry];
      result.loss[a][b] = result.loss[b][a] = sums[2 * entry + 1];
    }
  }
  result.error_bound += 2 * std::numeric_limits<double>::epsilon() * sums.back();
}

/// All springs lie between the real and the imaginary axis: storage + loss is positive definite unless some strain
/// costs nothing.
void judge_harmonic(const HarmonicStiffness& result) {
  constexpr double nothing = 1e-13;
  const StiffnessEigen eigen = eigenstrains(result.storage + result.loss);
  if (eigen.values[0] > nothing * eigen.values[2] + 2 * result.error_bound) return;
  computation_failed(
      fmt::format("at {:.6g} Hz the mean strain (xx {:.3f}, yy {:.3f}, shear {:.3f}) costs no energy beyond rounding",
                  result.frequency, eigen.strains[0][0], eigen.strains[0][1], eigen.strains[0][2]),
      fmt::format("the springs are kN times {:.1e} and kT times {:.1e} there, too far apart for this network",
                  std::abs(result.normal), std::abs(result.tangential)),
      "Choose another frequency, add contacts, or give the contacts tangential springs that do not relax");
}

HarmonicStiffness at_frequency(const SampleSolver& sample, const Viscoelasticity& viscoelasticity, double frequency,
                               const HomogenizeOptions& options, double area, ViscoelasticStiffness& all) {
  HarmonicStiffness result;
  result.frequency = frequency;
  result.normal = viscoelasticity.normal.factor(frequency);
  result.tangential = viscoelasticity.tangential.factor(frequency);
  // Sizes near 1, so that no sum of squares leaves the range of a double.
  const double unit = std::exp2(std::ilogb(std::max(std::abs(result.normal), std::abs(result.tangential)))) *
                      spring_unit(sample.springs());
  const ComplexSprings springs = complex_springs(sample.springs(), viscoelasticity, frequency, 1 / unit);
  const StiffnessSolver& elastic = sample.solver();
  DegreesOfFreedom unknowns = elastic.unknowns();
  for (const std::size_t k : elastic.factor().null_components()) unknowns.held[k] = DegreesOfFreedom::supported;
  const SpringNetwork geometry{sample.assembly(), elastic.graph(), sample.springs(), unknowns};
  const HarmonicSolver solver(geometry, springs, elastic.symbolic(), options.solver.memory_limit, all.times);
  const std::span<const Tensor2> strains(unit_gradients, 3);
  const std::vector<HarmonicMotion> motions = solver.solve(strains, options.solver.max_refinements, all.times);
  const Stopwatch watch;
  result.condition = solver.scaled_inverse_norm(motions[0]);
  double residual = 0;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    residual = std::max(residual, solver.scaled_residual(strains[k], motions[k]));
    result.relative_residual = std::max(result.relative_residual, motions[k].relative_residual());
  }
  constexpr double safety = 10;  // the norm of the inverse is estimated from below
  result.error_bound = safety * residual * residual * result.condition;
  sum_harmonic(sample, solver, motions, result);
  constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
  result.error_bound += rounding * (largest_entry(result.storage) + largest_entry(result.loss));
  const double scale = unit / area;
  result.storage = scale * result.storage;
  result.loss = scale * result.loss;
  result.error_bound *= scale;
  judge_harmonic(result);
  all.solver = solver.report().name;
  all.factor_bytes = solver.report().bytes;
  all.times.add("stiffness", watch.seconds());
  return result;
}

}  // namespace

HarmonicModuli harmonic_moduli(const HarmonicStiffness& stiffness) {
  const auto complex = [&](auto part) { return std::complex(part(stiffness.storage), part(stiffness.loss)); };
  const std::complex<double> K = complex([](const Matrix3& c) { return isotropic_part(c).bulk; });
  const std::complex<double> G = complex([](const Matrix3& c) { return isotropic_part(c).shear; });
  const std::complex<double> nu = (K - G) / (2.0 * K);
  return {.bulk_modulus_2d = K,
          .shear_modulus = G,
          .poisson_strain = nu,
          .poisson_stress = (K - G) / (K + G),
          .young_strain = 2.0 * G * (1.0 + nu),
          .young_stress = 4.0 * K * (G / (K + G))};
}

ViscoelasticStiffness viscoelastic_stiffness(const Assembly& assembly, const ContactSprings& springs,
                                             const Viscoelasticity& viscoelasticity,
                                             std::span<const double> frequencies, const HomogenizeOptions& options) {
  check_sample(assembly, springs, options);
  check_harmonic(springs, viscoelasticity, frequencies, options);
  HomogenizeOptions of_fronts = options;
  of_fronts.solver.method = SolverMethod::multifrontal;
  of_fronts.solver.ordering = CholmodOrdering::equidem;
  EffectiveStiffness elastic;
  elastic.boundary = options.boundary;
  elastic.effects = derive_effects(assembly, springs, options.rotation);
  const SampleSolver sample = strain_sample(assembly, springs, of_fronts, elastic);
  ViscoelasticStiffness result;
  result.times = elastic.times;
  Progress progress("frequencies");
  for (std::size_t k = 0; k < frequencies.size(); ++k) {
    result.harmonic.push_back(at_frequency(sample, viscoelasticity, frequencies[k], options, assembly.area(), result));
    progress.update(static_cast<double>(k + 1) / static_cast<double>(frequencies.size()));
  }
  return result;
}

}  // namespace equidem
