// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts with dashpots stepped in time creep and oscillate as their complex moduli say.
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "equidem/dynamics/simulation.hpp"
#include "equidem/dynamics/time_step.hpp"
#include "equidem/homogenize/boundary.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/homogenize/viscoelastic_stiffness.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "dynamics/moving_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

using Amplitude = std::complex<double>;
using std::numbers::pi;

const SpringConstants creeping_springs{1e9, 0.4e9};

/// Density at which the highest frequency of the springs times tau is that number: the larger, the less inertia counts.
double density_of(const Assembly& assembly, const ContactSprings& springs, double tau, double highest) {
  const Scene unit(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  const double omega = choose_time_step(unit, {}).omega_max;
  return std::pow(omega * tau / highest, 2);
}

/// Largest difference of the motions at `time` under a load that acts from t = 0 on, from the motion at rest times
/// 1 - exp(-t/tau), over the largest motion.
double creep_error(double highest) {
  constexpr double tau = 0.02;
  Assembly block = hexagonal_block(5);
  const ContactSprings springs(creeping_springs);
  const TensionSetup setup = tension_setup(block, {});
  Scene scene(block, springs, inertia_of(block.radii, density_of(block, springs, tau, highest), Body::disc));
  scene.supports = held_still(block, setup.supports);
  scene.loads = lasting(setup.loads);
  SimulationOptions options{.damping = {.normal_time = tau, .tangential_time = tau}};
  options.time_step = choose_time_step(scene, options).step;
  Simulation run(scene, options);
  const Equilibrium rest = solve_equilibrium(block, springs, setup.supports, setup.loads);
  double error = 0, size = 0;
  for (const double until : {0.5 * tau, tau, 2 * tau}) {
    const auto steps = static_cast<std::int64_t>(until / options.time_step);
    run.advance(steps - run.step());
    const double share = -std::expm1(-static_cast<double>(steps) * options.time_step / tau);
    const std::vector<DiscMotion> motions = run.motions();
    for (std::size_t d = 0; d < motions.size(); ++d) {
      error = std::max(error, norm(motions[d].u - share * rest.motions[d].u));
      size = std::max(size, norm(rest.motions[d].u));
    }
  }
  return error / size;
}

/// G of a block by displacements in shear at its boundary, from the motions of a run in its second period.
Amplitude shear_modulus_of_run(const Assembly& block, const ContactSprings& springs, const Viscoelasticity& law,
                               double frequency, double density, int steps) {
  Scene scene(block, springs, inertia_of(block.radii, density, Body::disc));
  const std::vector<std::uint8_t> boundary = boundary_discs(block);
  constexpr Tensor2 strain{0, 0.5e-6, 0.5e-6, 0};
  for (std::size_t d = 0; d < block.size(); ++d) {
    if (boundary[d] == 0) continue;
    const Vec2 u = strain * block.centres[d];
    const auto wave = [&](double value) {
      return Schedule{.kind = Schedule::Kind::sine, .value = value, .frequency = frequency};
    };
    scene.supports.push_back({std::to_string(d), wave(u.x), wave(u.y), {}});
  }
  Simulation run(scene, {.damping = {.normal_time = law.normal.time, .tangential_time = law.tangential.time},
                         .time_step = 1 / (frequency * steps)});
  run.advance(2 * steps);
  constexpr int samples = 16;
  // sin(w t + phase) = Im exp(i (w t + phase)): the amplitude is 2/N sum u (sin w t + i cos w t).
  struct Motion {
    std::array<Amplitude, 3> of = {};
  };
  std::vector<Motion> amplitudes(block.size());
  for (int k = 0; k < samples; ++k) {
    run.advance(steps / samples);
    const double angle = 2 * pi * (k + 1) / samples;
    const Amplitude wave = 2.0 / samples * Amplitude{std::sin(angle), std::cos(angle)};
    const std::vector<DiscMotion> motions = run.motions();
    for (std::size_t d = 0; d < motions.size(); ++d) {
      amplitudes[d].of[0] += wave * motions[d].u.x;
      amplitudes[d].of[1] += wave * motions[d].u.y;
      amplitudes[d].of[2] += wave * motions[d].theta;
    }
  }
  // Love-Weber stress of complex forces: real and imaginary parts each by itself.
  const auto part = [&](auto which) {
    std::vector<DiscMotion> motions(block.size());
    for (std::size_t d = 0; d < motions.size(); ++d) {
      const auto& a = amplitudes[d].of;
      motions[d] = {{which(a[0]), which(a[1])}, which(a[2])};
    }
    return motions;
  };
  const std::vector<DiscMotion> in_phase = part([](const Amplitude& a) { return a.real(); });
  const std::vector<DiscMotion> out_of_phase = part([](const Amplitude& a) { return a.imag(); });
  const Amplitude normal = law.normal.factor(frequency), tangential = law.tangential.factor(frequency);
  Amplitude shear = 0;
  for (std::size_t c = 0; c < block.contacts.size(); ++c) {
    const Contact& contact = block.contacts[c];
    const ContactFrame frame = frame_of(block, c);
    const ContactDeformation x = deformation(frame, in_phase[contact.i], in_phase[contact.j]);
    const ContactDeformation y = deformation(frame, out_of_phase[contact.i], out_of_phase[contact.j]);
    const SpringConstants k = springs[c];
    const Amplitude f_n = k.kN * normal * Amplitude{x.normal, y.normal};
    const Amplitude f_t = k.kT * tangential * Amplitude{x.tangential, y.tangential};
    const Vec2 n = frame.normal, s = frame.tangent(), l = block.branch(contact);
    shear += 0.5 * ((f_n * n.x + f_t * s.x) * l.y + (f_n * n.y + f_t * s.y) * l.x);
  }
  return shear / (block.area() * 1e-6);
}

}  // namespace

TEST_CASE("contacts_with_dashpots_of_one_time_creep_as_one_of_them") {
  // The creep of all discs is 1 - exp(-t/tau) but for inertia, whose share falls with the square of the frequencies.
  const double heavy = creep_error(100), light = creep_error(200);
  CAPTURE(heavy, light);
  CHECK(light < 0.3 * heavy);
  CHECK(light < 2e-3);
}

TEST_CASE("a_network_of_unequal_dashpots_oscillates_with_its_complex_modulus") {
  const Assembly block = delaunay_block(40, 3);
  const ContactSprings springs(creeping_springs);
  constexpr double tau = 0.01, frequency = 1 / (2 * pi * tau);
  const auto dashpot = [](double time) { return ViscoelasticSpring{.model = SpringModel::kelvin_voigt, .time = time}; };
  const Viscoelasticity law{dashpot(tau), dashpot(4 * tau)};
  const HarmonicStiffness c =
      viscoelastic_stiffness(block, springs, law, std::array{frequency}, {.boundary = Boundary::displacement})
          .harmonic[0];
  const Amplitude exact{c.storage[2][2], c.loss[2][2]};
  // A run of steps h lacks a h, removed by halving, and the share of inertia, which falls with the density.
  const auto at = [&](double highest, int steps) {
    return shear_modulus_of_run(block, springs, law, frequency, density_of(block, springs, tau, highest), steps);
  };
  const auto error = [&](const Amplitude& modulus) { return std::abs(modulus - exact) / std::abs(exact); };
  struct Halved {
    Amplitude full, half, extrapolated;
  };
  const auto halved = [&](double highest, int steps) {
    const Amplitude full = at(highest, steps), half = at(highest, 2 * steps);
    return Halved{full, half, 2.0 * half - full};
  };
  const Halved heavy = halved(30, 16000), light = halved(60, 64000);
  const Amplitude massless = (4.0 * light.extrapolated - heavy.extrapolated) / 3.0;
  CAPTURE(exact, error(heavy.full), error(heavy.half), error(heavy.extrapolated), error(light.extrapolated),
          error(massless));
  CHECK(error(light.extrapolated) < 0.3 * error(heavy.extrapolated));
  CHECK(error(light.extrapolated) < 2e-4);
  CHECK(error(massless) < 5e-6);
}
