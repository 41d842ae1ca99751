// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// One contact: the law's energy, force and tangent belong together, and rigid motions cost nothing.
#include "equidem/contact/linear_spring.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "equidem/core/random.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

using Motion6 = std::array<double, 6>;  ///< (u_i, a theta_i, u_j, a theta_j)

struct Scene {
  ContactFrame frame;
  SpringConstants springs;
  double rotation_scale = 0;
  Motion6 motion{};
};

/// Directions all around, levers that differ by up to a factor of 10, kT/kN from -2 to 2.
std::vector<Scene> random_scenes(int count) {
  Random random(20240131);
  std::vector<Scene> scenes;
  for (int k = 0; k < count; ++k) {
    Scene scene;
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    scene.frame = {{std::cos(angle), std::sin(angle)}, random.uniform(0.1, 1), random.uniform(0.1, 1)};
    scene.springs = {random.uniform(0.5, 2), random.uniform(-1, 1)};
    scene.rotation_scale = random.uniform(0.2, 3);
    for (double& q : scene.motion) q = random.uniform(-1, 1);
    scenes.push_back(scene);
  }
  return scenes;
}

ContactDeformation deformation(const Scene& scene, const Motion6& q) {
  const double a = scene.rotation_scale;
  return deformation(scene.frame, {{q[0], q[1]}, q[2] / a}, {{q[3], q[4]}, q[5] / a});
}

double energy(const Scene& scene, const Motion6& q) {
  return linear_spring_energy(scene.springs, deformation(scene, q));
}

/// dW/dq as mechanics has it: what the contact does to the discs, with the opposite sign; moments over a.
Motion6 internal_force(const Scene& scene, const Motion6& q) {
  const ContactForce f = linear_spring_force(scene.springs, deformation(scene, q));
  const Vec2 on_i = force_on_i(scene.frame, f);
  const double a = scene.rotation_scale;
  return {-on_i.x, -on_i.y, -scene.frame.lever_i * f.tangential / a,
          on_i.x,  on_i.y,  -scene.frame.lever_j * f.tangential / a};
}

/// K_pq = kN n_p n_q^T + kT t_p t_q^T, as the assembly of the stiffness matrix builds it.
std::array<Motion6, 6> tangent(const Scene& scene) {
  const DeformationGradient g = deformation_gradient(scene.frame, scene.rotation_scale);
  Motion6 normal{};
  Motion6 tangential{};
  for (std::size_t k = 0; k < 3; ++k) {
    normal[k] = g.normal_i[k];
    normal[k + 3] = g.normal_j[k];
    tangential[k] = g.tangential_i[k];
    tangential[k + 3] = g.tangential_j[k];
  }
  std::array<Motion6, 6> K{};
  for (std::size_t p = 0; p < 6; ++p) {
    for (std::size_t q = 0; q < 6; ++q) {
      K[p][q] = scene.springs.kN * normal[p] * normal[q] + scene.springs.kT * tangential[p] * tangential[q];
    }
  }
  return K;
}

Motion6 moved(Motion6 q, std::size_t component, double by) {
  q[component] += by;
  return q;
}

}  // namespace

TEST_CASE("force_is_the_derivative_of_energy") {
  for (const Scene& scene : random_scenes(50)) {
    CAPTURE(scene.frame.normal.x, scene.frame.lever_i, scene.frame.lever_j, scene.springs.ratio());
    const Motion6 f = internal_force(scene, scene.motion);
    const double h = 1e-3;  // the energy is quadratic: central differences are exact but for rounding
    for (std::size_t p = 0; p < 6; ++p) {
      CAPTURE(p);
      const double difference =
          (energy(scene, moved(scene.motion, p, h)) - energy(scene, moved(scene.motion, p, -h))) / (2 * h);
      CHECK(f[p] == Approx(difference).margin(1e-11));
    }
  }
}

TEST_CASE("tangent_is_the_derivative_of_force_and_the_second_derivative_of_energy") {
  for (const Scene& scene : random_scenes(50)) {
    CAPTURE(scene.frame.normal.x, scene.frame.lever_i, scene.frame.lever_j, scene.springs.ratio());
    const auto K = tangent(scene);
    const double h = 0.5;
    for (std::size_t q = 0; q < 6; ++q) {
      const Motion6 ahead = internal_force(scene, moved(scene.motion, q, h));
      const Motion6 behind = internal_force(scene, moved(scene.motion, q, -h));
      for (std::size_t p = 0; p < 6; ++p) {
        CAPTURE(p, q);
        CHECK(K[p][q] == Approx((ahead[p] - behind[p]) / (2 * h)).margin(1e-12));
        const auto W = [&](double dp, double dq) { return energy(scene, moved(moved(scene.motion, p, dp), q, dq)); };
        CHECK(K[p][q] == Approx((W(h, h) - W(h, -h) - W(-h, h) + W(-h, -h)) / (4 * h * h)).margin(1e-11));
      }
    }
  }
}

TEST_CASE("force_is_linear_in_the_motion_with_the_tangent") {
  for (const Scene& scene : random_scenes(50)) {
    const auto K = tangent(scene);
    const Motion6 f = internal_force(scene, scene.motion);
    for (std::size_t p = 0; p < 6; ++p) {
      double Ku = 0;
      for (std::size_t q = 0; q < 6; ++q) Ku += K[p][q] * scene.motion[q];
      CAPTURE(p, scene.springs.ratio());
      CHECK(Ku == Approx(f[p]).margin(1e-14 * 20));
    }
  }
}

TEST_CASE("rigid_motions_cost_no_energy") {
  Random random(7);
  for (const Scene& scene : random_scenes(50)) {
    const Vec2 i{random.uniform(-3, 3), random.uniform(-3, 3)};
    const Vec2 j = i + (scene.frame.lever_i + scene.frame.lever_j) * scene.frame.normal;
    const Vec2 translation{random.uniform(-1, 1), random.uniform(-1, 1)};
    const Vec2 pole{random.uniform(-3, 3), random.uniform(-3, 3)};
    const double theta = random.uniform(-1, 1);
    const auto rigid = [&](Vec2 x) { return DiscMotion{translation + theta * perpendicular(x - pole), theta}; };
    const ContactDeformation d = deformation(scene.frame, rigid(i), rigid(j));
    CAPTURE(d.normal, d.tangential, theta, pole.x, pole.y);
    CHECK(std::abs(d.normal) < 1e-14);
    CHECK(std::abs(d.tangential) < 1e-14);
  }
}

TEST_CASE("a_rotation_costs_energy_where_the_levers_do_not_span_the_distance") {
  const ContactFrame overlapping{{1, 0}, 1.0, 1.0};
  const double distance = 1.9;
  const double theta = 0.01;
  const ContactDeformation d = deformation(overlapping, {{0, 0}, theta}, {{0, theta * distance}, theta});
  CHECK(d.tangential == Approx(-theta * 0.1));
}

TEST_CASE("reaction_equals_action_and_moments_balance") {
  for (const Scene& scene : random_scenes(50)) {
    const ContactForce f = linear_spring_force(scene.springs, deformation(scene, scene.motion));
    const Motion6 internal = internal_force(scene, scene.motion);
    CAPTURE(f.normal, f.tangential);
    CHECK(internal[0] == -internal[3]);
    CHECK(internal[1] == -internal[4]);

    const Vec2 i{0.3, -2};
    const Vec2 j = i + (scene.frame.lever_i + scene.frame.lever_j) * scene.frame.normal;
    const double a = scene.rotation_scale;
    const double about_origin =
        cross(i, {internal[0], internal[1]}) + cross(j, {internal[3], internal[4]}) + a * (internal[2] + internal[5]);
    CHECK(std::abs(about_origin) < 1e-13);
  }
}

TEST_CASE("a_contact_seen_from_its_other_disc_is_the_same_contact") {
  for (const Scene& scene : random_scenes(20)) {
    const ContactFrame back{-scene.frame.normal, scene.frame.lever_j, scene.frame.lever_i};
    const DiscMotion i{{0.1, -0.4}, 0.7};
    const DiscMotion j{{-0.3, 0.2}, -0.5};
    const ContactDeformation there = deformation(scene.frame, i, j);
    const ContactDeformation here = deformation(back, j, i);
    CHECK(here.normal == Approx(there.normal));
    CHECK(here.tangential == Approx(there.tangential));
    const Vec2 action = force_on_i(scene.frame, linear_spring_force(scene.springs, there));
    const Vec2 reaction = force_on_i(back, linear_spring_force(scene.springs, here));
    CHECK(norm(action + reaction) < 1e-15);
  }
}
