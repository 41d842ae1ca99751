// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Undamped motion has the frequencies, waves and rates of growth that the stiffness matrix predicts.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/dynamics/time_step.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/waves/bloch.hpp"

#include "dynamics/moving_scenes.hpp"
#include "support/catch.hpp"
#include "support/dense_oracle.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Sum of m u.w + I theta theta' over discs.
double inner_product(const Scene& scene, const std::vector<DiscMotion>& a, const std::vector<DiscMotion>& b) {
  double sum = 0;
  for (std::size_t d = 0; d < a.size(); ++d) {
    sum += scene.inertia[d].mass * dot(a[d].u, b[d].u) + scene.inertia[d].moment * a[d].theta * b[d].theta;
  }
  return sum;
}

/// omega of q_n = cos(omega n h) from all of q: q_{n+1} + q_{n-1} = 2 cos(omega h) q_n, so that (q_{n+1} - 2 q_n +
/// q_{n-1}) = -4 sin²(omega h/2) q_n, least squares.
double measured_frequency(const std::vector<double>& q, double h) {
  double above = 0, below = 0;
  for (std::size_t n = 1; n + 1 < q.size(); ++n) {
    above -= q[n] * (q[n + 1] - 2 * q[n] + q[n - 1]);
    below += q[n] * q[n];
  }
  return 2 / h * std::asin(0.5 * std::sqrt(above / below));
}

/// The frequency of (K, M) whose leapfrog oscillates at the measured one: sin(omega' h/2) = omega h/2.
double without_leapfrog_error(double measured, double h) {
  return 2 / h * std::sin(0.5 * measured * h);
}

/// Amplitudes of a motion in given shapes, step by step.
std::vector<std::vector<double>> amplitudes(Simulation& run, const Scene& scene,
                                            const std::vector<std::vector<DiscMotion>>& shapes, int steps) {
  const ThreadsFor one(1);
  std::vector<std::vector<double>> q(shapes.size());
  for (int n = 0; n <= steps; ++n) {
    const std::vector<DiscMotion> u = run.motions();
    for (std::size_t k = 0; k < shapes.size(); ++k) q[k].push_back(inner_product(scene, shapes[k], u));
    run.advance(1);
  }
  return q;
}

constexpr double hexagonal_radius = 0.5;

/// Re(U exp(i q.x)) of the lattice of one disc per cell, branch counted from the lowest frequency.
std::vector<DiscMotion> bloch_wave(const Assembly& assembly, const BlochWaves& waves, Vec2 q, std::size_t branch,
                                   const Inertia& body) {
  const HermitianSpectrum modes = spectrum(waves.dynamic_matrix(q));
  const double scale[3] = {1 / std::sqrt(body.mass), 1 / std::sqrt(body.mass), 1 / std::sqrt(body.moment)};
  std::vector<DiscMotion> wave(assembly.size());
  for (std::size_t d = 0; d < wave.size(); ++d) {
    const Complex phase = std::polar(1.0, dot(q, assembly.centres[d]));
    double u[3] = {0, 0, 0};
    for (std::size_t r = 0; r < waves.size(); ++r) u[r] = scale[r] * std::real(modes.vectors(r, branch) * phase);
    wave[d] = {{u[0], u[1]}, u[2]};
  }
  return wave;
}

}  // namespace

TEST_CASE("the_first_20_modes_have_the_natural_frequencies_of_the_matrix") {
  const bool hexagonal = GENERATE(true, false);
  const Rotation rotation = GENERATE(Rotation::from_scene, Rotation::restrained);
  const Assembly assembly = hexagonal ? hexagonal_block(7) : delaunay_block(50, 5);
  const ContactSprings springs(SpringConstants{1, 0.4});
  const std::vector<Support> supports{{"bottom", 0.0, 0.0, {}}};
  Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  scene.supports = held_still(assembly, supports);
  // The modes of M^-1/2 K M^-1/2 over the free components.
  const DegreesOfFreedom unknowns = number_unknowns(assembly, springs, derive_effects(springs, rotation), supports);
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  const ContactGraph graph(assembly);
  const DenseMatrix k = dense_matrix(assemble_stiffness(assembly, graph, springs, unknowns), assembly);
  std::vector<std::size_t> free;
  for (std::size_t c = 0; c < unknowns.held.size(); ++c) {
    if (unknowns.held[c] == DegreesOfFreedom::free) free.push_back(c);
  }
  const double a = unknowns.rotation_scale;
  const auto root_mass = [&](std::size_t c) {
    const Inertia& body = scene.inertia[c / b];
    return std::sqrt(c % b == 2 ? body.moment / (a * a) : body.mass);
  };
  ComplexMatrix scaled(free.size());
  for (std::size_t r = 0; r < free.size(); ++r) {
    for (std::size_t c = 0; c < free.size(); ++c) {
      scaled(r, c) = k(free[r], free[c]) / (root_mass(free[r]) * root_mass(free[c]));
    }
  }
  const HermitianSpectrum modes = spectrum(scaled);
  constexpr std::size_t count = 20;
  std::vector<std::vector<DiscMotion>> shapes;
  std::vector<DiscMotion> start(assembly.size());
  for (std::size_t m = 0; m < count; ++m) {
    std::vector<double> components(unknowns.held.size(), 0.0);
    const Complex phase = modes.vectors(0, m) / std::abs(modes.vectors(0, m));
    for (std::size_t r = 0; r < free.size(); ++r) {
      components[free[r]] = std::real(modes.vectors(r, m) / phase) / root_mass(free[r]);
    }
    shapes.push_back(as_motions(unknowns, components));
    const double amplitude = 1 + 0.1 * static_cast<double>(m);
    for (std::size_t d = 0; d < start.size(); ++d) {
      start[d].u += amplitude * shapes[m][d].u;
      start[d].theta += amplitude * shapes[m][d].theta;
    }
  }
  SimulationOptions options{.rotation = rotation};
  options.time_step = choose_time_step(scene, options, {.fraction = 0.5}).step;
  const double h = options.time_step;
  Simulation run(scene, options);
  displace(run, scene, h, start);
  const auto q = amplitudes(run, scene, shapes, 1000);
  for (std::size_t m = 0; m < count; ++m) {
    const double exact = std::sqrt(modes.values[m]), measured = measured_frequency(q[m], h);
    CAPTURE(hexagonal, static_cast<int>(rotation), m, exact, measured, exact * h);
    CHECK(without_leapfrog_error(measured, h) == Approx(exact).epsilon(1e-9));
    // As it stands: omega'/omega = 1 + (omega h)²/24 + 3 (omega h)^4/640 + ...
    const double w = exact * h;
    CHECK(measured / exact - 1 == Approx(w * w / 24).epsilon(0.2 * w * w).margin(1e-9));
    // And it is an oscillation all along.
    CHECK(q[m].back() == Approx(q[m].front() * std::cos(1000 * measured * h)).margin(1e-7));
  }
}

TEST_CASE("plane_waves_oscillate_at_the_bloch_frequency") {
  const double kT = GENERATE(0.2, 1.0);
  constexpr int columns = 24, rows = 12;
  const Assembly assembly =
      hexagonal_lattice({.columns = columns, .rows = rows, .radius = hexagonal_radius, .periodic = true});
  const ContactSprings springs(SpringConstants{1, kT});
  const Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  const BlochWaves waves(primitive_cell(assembly, springs), scene.inertia, true);
  SimulationOptions options;
  options.time_step = choose_time_step(scene, options, {.fraction = 0.5}).step;
  const double h = options.time_step;
  for (const auto& [along_x, along_y] : {std::pair{1, 0}, std::pair{3, 2}, std::pair{0, 3}, std::pair{7, -5}}) {
    const Vec2 q{2 * std::numbers::pi * along_x / assembly.period->x,
                 2 * std::numbers::pi * along_y / assembly.period->y};
    const std::vector<double> squared = waves.squared_frequencies(q);
    for (std::size_t branch = 0; branch < 3; ++branch) {
      const std::vector<DiscMotion> wave = bloch_wave(assembly, waves, q, branch, scene.inertia[0]);
      Simulation run(scene, options);
      displace(run, scene, h, wave);
      const auto amplitude = amplitudes(run, scene, {wave}, 300);
      const double exact = std::sqrt(squared[branch]), measured = measured_frequency(amplitude[0], h);
      CAPTURE(kT, along_x, along_y, branch, exact, measured, without_leapfrog_error(measured, h) / exact - 1);
      CHECK(without_leapfrog_error(measured, h) == Approx(exact).epsilon(1e-6));
      CHECK(amplitude[0].back() ==
            Approx(amplitude[0].front() * std::cos(300 * measured * h)).margin(1e-6 * amplitude[0].front()));
    }
  }
}

TEST_CASE("long_waves_tend_to_the_speeds_of_sound_with_the_square_of_the_wave_number") {
  const double kT = 0.5;
  std::vector<double> away_p, away_s;
  for (const int discs : {16, 32, 64}) {  // per wavelength
    const Assembly assembly =
        hexagonal_lattice({.columns = discs, .rows = 2, .radius = hexagonal_radius, .periodic = true});
    const ContactSprings springs(SpringConstants{1, kT});
    const Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
    const BlochWaves waves(primitive_cell(assembly, springs), scene.inertia, true);
    const BlochWaves::SoundSpeeds sound = waves.sound_speeds({1, 0});
    const double q = 2 * std::numbers::pi / assembly.period->x;
    SimulationOptions options;
    options.time_step = choose_time_step(scene, options, {.fraction = 0.5}).step;
    for (const std::size_t branch : {0, 1}) {
      const std::vector<DiscMotion> wave = bloch_wave(assembly, waves, {q, 0}, branch, scene.inertia[0]);
      Simulation run(scene, options);
      displace(run, scene, options.time_step, wave);
      const auto amplitude = amplitudes(run, scene, {wave}, 600);
      const double speed =
          without_leapfrog_error(measured_frequency(amplitude[0], options.time_step), options.time_step) / q;
      (branch == 0 ? away_s : away_p)
          .push_back(speed / std::sqrt(branch == 0 ? sound.transverse_squared : sound.longitudinal_squared) - 1);
    }
  }
  CAPTURE(away_p, away_s);
  for (const auto& away : {away_p, away_s}) {
    CHECK(away[1] / away[2] == Approx(4).epsilon(0.02));
    CHECK(away[0] / away[1] == Approx(4).epsilon(0.06));
    CHECK(std::abs(away[2]) < 6e-4);
  }
}

TEST_CASE("negative_kT_grows_at_the_rate_that_the_waves_predict") {
  const double kT = GENERATE(-0.05, -0.2);
  const Assembly assembly = hexagonal_lattice({.columns = 6, .rows = 6, .radius = hexagonal_radius, .periodic = true});
  const ContactSprings springs(SpringConstants{1, kT});
  const Scene scene(assembly, springs, inertia_of(assembly.radii, 1, Body::disc));
  const double mass = scene.inertia[0].mass, rate = std::sqrt(24 * std::abs(kT) / mass);
  const BlochWaves waves(primitive_cell(assembly, springs), scene.inertia, true);
  SimulationOptions options;
  const TimeStep chosen = choose_time_step(scene, options, {.fraction = 0.2, .allow_unstable = true});
  CHECK(std::sqrt(-waves.squared_frequencies({0, 0})[0]) == Approx(rate).epsilon(1e-10));
  CHECK(chosen.growth_rate == Approx(rate).epsilon(1e-9));
  const double h = options.time_step = chosen.step;
  Simulation run(scene, options);
  // Uniform spin: theta_n = cosh(gamma' n h), sinh(gamma' h/2) = gamma h/2.
  displace(run, scene, h, std::vector<DiscMotion>(assembly.size(), {{}, 1e-6}));
  const double stepped = 2 / h * std::asinh(0.5 * rate * h);
  run.advance(100);
  const double first = run.motions()[7].theta;
  CAPTURE(kT, rate, stepped, h);
  CHECK(first == Approx(1e-6 * std::cosh(100 * stepped * h)).epsilon(1e-9));
  // Any motion ends in the fastest one.
  Simulation any(scene, options);
  displace(any, scene, h, random_motions(assembly.size(), 3, 1e-6, 1e-6));
  const auto size = [&] { return std::sqrt(inner_product(scene, any.motions(), any.motions())); };
  any.advance(static_cast<std::int64_t>(40 / (rate * h)));
  const double before = size();
  any.advance(50);
  CHECK(std::log(size() / before) / (50 * h) == Approx(stepped).epsilon(1e-3));
}
