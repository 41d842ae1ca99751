// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sukegawa (2010), sections 2.4 and 3, as printed: the discs of `equidem-papers sukegawa2010`.
#include <cmath>
#include <vector>

#include "equidem/contact/restitution.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/material/wave_speed_springs.hpp"
#include "equidem/packing/settling.hpp"

#include "sukegawa2010/printed_discs.hpp"
#include "support/catch.hpp"

using namespace equidem;
using sukegawa2010::PrintedDiscs;
using sukegawa2010::PrintedOptions;
using Integrator = PrintedOptions::Integrator;

namespace {

constexpr double radius = 0.01, density = 2480, free_fall = 9.8;

/// Discs without gravity in a box 1 m wide. \param damping h
GrainScene scene_of(const std::vector<Grain>& grains, double damping, double acceleration = 0) {
  const SettlingOptions material{.springs = springs_of_wave_speeds(density, wave_speeds_from_shear(150, 0.25)),
                                 .damping = damping > 0 ? damping : 1};
  GrainScene scene = scene_of_box(1, material);
  scene.gravity = {0, -acceleration};
  scene.grains = grains;
  return scene;
}

Grain disc(Vec2 position, Vec2 velocity = {}, double r = radius) {
  Grain grain;
  grain.position = position;
  grain.velocity = velocity;
  grain.radius = r;
  grain.inertia = inertia_of(r, density, Body::disc);
  return grain;
}

/// Two discs that meet head on. \return speed of parting over that of approach
double rebound(double damping, Integrator integrator, double step) {
  const GrainScene scene = scene_of({disc({0.4, 0.5}, {0.5, 0}), disc({0.4205, 0.5}, {-0.5, 0})}, damping);
  PrintedDiscs discs(scene, {.integrator = integrator, .damping = damping, .time_step = step});
  discs.advance(static_cast<std::int64_t>(0.002 / step));
  const auto velocities = discs.velocities();
  return velocities[1].u.x - velocities[0].u.x;
}

}  // namespace

TEST_CASE("discs_as_printed_part_with_the_restitution_of_a_dashpot_that_may_pull") {
  for (const double h : {0.02, 0.1, 0.3}) {
    // The damping ratio of two equal discs is sqrt(2) h.
    const double exact = restitution_of(std::sqrt(2.0) * h, ContactEnd::at_zero_overlap);
    CAPTURE(h, exact, rebound(h, Integrator::semi_implicit, 1e-8));
    CHECK(rebound(h, Integrator::semi_implicit, 1e-8) == Approx(exact).epsilon(2e-3));
    CHECK(rebound(h, Integrator::printed, 1e-8) == Approx(exact).epsilon(2e-3));
  }
}

TEST_CASE("without_damping_the_printed_integrator_gains_energy_and_the_semi_implicit_one_hardly_any") {
  const double printed = rebound(0, Integrator::printed, 1e-6), semi = rebound(0, Integrator::semi_implicit, 1e-6);
  CAPTURE(printed, semi);
  CHECK(printed > 1.01);
  CHECK(std::abs(semi - 1) < 0.3 * (printed - 1));
}

TEST_CASE("a_disc_as_printed_rests_on_the_floor_at_beta_times_its_radius") {
  for (const double beta : {1.0, 1.05}) {
    const GrainScene scene = scene_of({disc({0.5, 1.06 * radius})}, 1, free_fall);
    PrintedDiscs discs(scene, {.integrator = Integrator::semi_implicit, .beta = beta, .time_step = 2e-6});
    discs.advance(100'000);
    const double sag = scene.grains[0].inertia.mass * free_fall / scene.pairs[1].stiffness;
    const double height = discs.motions()[0].u.y;
    CAPTURE(beta, height, sag);
    CHECK(height == Approx(beta * radius - sag).epsilon(1e-3));
    CHECK(discs.contacts().size() == 1);
  }
}

TEST_CASE("the_damping_c_of_each_disc_limits_its_fall_and_its_spin") {
  GrainScene scene = scene_of({disc({0.5, 0.9})}, 1, free_fall);
  scene.grains[0].spin = 3;
  constexpr double rate = 20;
  PrintedDiscs discs(scene, {.mass_damping = rate, .time_step = 1e-5});
  discs.advance(30'000);
  CHECK(discs.velocities()[0].u.y == Approx(-free_fall / rate).epsilon(4e-3));
  CHECK(discs.velocities()[0].theta == Approx(3 * std::exp(-2 * rate * 0.3)).epsilon(0.01));
}

TEST_CASE("discs_as_printed_keep_momentum_and_angular_momentum_and_go_on_from_a_saved_state") {
  const GrainScene scene = scene_of(
      {disc({0.4, 0.5}, {0.5, 0.1}), disc({0.4155, 0.511}, {-0.5, 0}, 0.009), disc({0.42, 0.494}, {0, 0.2})}, 0.3);
  const PrintedOptions options{.damping = 0.3, .time_step = 1e-6};
  PrintedDiscs discs(scene, options);
  const auto momentum_of = [&](const std::vector<Grain>& grains) {
    Vec2 sum;
    double turning = 0;
    for (const Grain& grain : grains) {
      sum += grain.inertia.mass * grain.velocity;
      turning += grain.inertia.mass * cross(grain.position, grain.velocity) + grain.inertia.moment * grain.spin;
    }
    return std::pair(sum, turning);
  };
  const auto [before, turning_before] = momentum_of(discs.grains());
  discs.advance(700);
  PrintedDiscs other(scene, options);
  other.restore(discs.save());
  discs.advance(3000);
  other.advance(3000);
  const auto [after, turning_after] = momentum_of(discs.grains());
  CHECK(norm(after - before) < 1e-12);
  // The contact point lies on the line of centres, at r_i from one and r_j from the other: overlaps leave a moment.
  CHECK(turning_after == Approx(turning_before).margin(1e-4));
  CHECK(std::abs(discs.velocities()[0].theta) > 0.01);
  for (std::size_t g = 0; g < 3; ++g) CHECK(norm(discs.motions()[g].u - other.motions()[g].u) == 0);
}
