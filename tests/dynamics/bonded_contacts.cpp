// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <vector>

#include "dynamics/moving_scenes.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Force and moment of all contacts on each body.
std::vector<DiscForce> sums_of(const std::vector<BodyContact>& contacts, const std::vector<Vec2>& centres) {
  std::vector<DiscForce> sums(centres.size());
  for (const BodyContact& c : contacts) {
    sums[c.i].force += c.force;
    sums[c.i].moment += cross(c.arm, c.force);
    if (c.j < 0) continue;
    sums[c.j].force -= c.force;
    sums[c.j].moment -= cross(centres[c.i] + c.arm - centres[c.j] - c.shift, c.force);
  }
  return sums;
}

}  // namespace

TEST_CASE("contact_forces_add_up_to_mass_times_acceleration") {
  const bool periodic = GENERATE(false, true);
  const auto motion = GENERATE(LoopKind::Motion::small, LoopKind::Motion::finite);
  CAPTURE(periodic, to_string(motion));
  const Assembly assembly = delaunay_block(60, 3, periodic);
  const ContactSprings springs(SpringConstants{1e6, 4e5});
  Scene scene(assembly, springs, inertia_of(assembly, 2000, Body::disc));
  scene.gravity = {1, -9.81};
  if (!periodic) {
    double low = 1e9;
    for (std::size_t d = 0; d < assembly.size(); ++d) low = std::min(low, assembly.centres[d].y - assembly.radii[d]);
    scene.walls = {
        {.name = "slope", .point = {0, low + 0.02}, .normal = {0.1 / std::sqrt(1.01), 1 / std::sqrt(1.01)}, .kN = 2e6}};
  }
  const double h = 2e-4;
  Simulation run(scene, {.motion = motion, .time_step = h});
  displace(run, scene, h, random_motions(assembly.size(), 5, 0.02, 0.05));
  std::vector<std::vector<DiscMotion>> at;
  std::vector<BodyContact> contacts;
  std::size_t walls = 0;
  for (int k = 0; k < 3; ++k) {
    at.push_back(run.motions());
    if (k == 1) contacts = run.body_contacts();
    run.advance(1);
  }
  for (const BodyContact& c : contacts) walls += c.j < 0 ? 1 : 0;
  CHECK((walls > 0) == !periodic);
  const std::vector<DiscForce> sums = sums_of(contacts, assembly.centres);
  double largest = 0, error = 0, turning = 0, error_of_moment = 0;
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    const Inertia& body = scene.inertia[d];
    const Vec2 acceleration = (at[2][d].u - 2 * at[1][d].u + at[0][d].u) / (h * h);
    const double spinning = (at[2][d].theta - 2 * at[1][d].theta + at[0][d].theta) / (h * h);
    largest = std::max(largest, norm(sums[d].force));
    error = std::max(error, norm(body.mass * (acceleration - scene.gravity) - sums[d].force));
    turning = std::max(turning, std::abs(sums[d].moment));
    error_of_moment = std::max(error_of_moment, std::abs(body.moment * spinning - sums[d].moment));
  }
  CAPTURE(largest, turning);
  CHECK(error <= 1e-9 * largest);
  // Arms are those of the start: of finite motions they have turned since.
  if (motion == LoopKind::Motion::small) CHECK(error_of_moment <= 1e-9 * turning);
}

TEST_CASE("force_components_are_along_and_across_the_contact") {
  const Assembly assembly = hexagonal_block(3);
  const ContactSprings springs(SpringConstants{1e6, 4e5});
  const Scene scene(assembly, springs, inertia_of(assembly, 2000, Body::disc));
  for (const auto motion : {LoopKind::Motion::small, LoopKind::Motion::finite}) {
    const auto contacts = bonded_contacts(scene, motion, random_motions(assembly.size(), 5, 1e-7, 1e-7), 0);
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      const Vec2 n = frame_of(assembly, c).normal;
      const double size = norm(contacts[c].force);
      CHECK(dot(contacts[c].force, n) == Approx(contacts[c].normal_force).margin(1e-6 * size));
      CHECK(cross(n, contacts[c].force) == Approx(contacts[c].tangential_force).margin(1e-6 * size));
    }
  }
}
