// SPDX-License-Identifier: GPL-3.0-or-later
// The tangent of a contact beside its energy: bending, prestress, contact points off the line of centres, own images.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/random.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

constexpr double scale_of_turns = 0.7;  // a, m

/// A contact of any springs, of a contact point anywhere.
struct AnyContact {
  ContactFrame frame;
  SpringConstants k;
  double kM = 0;
  ContactPrestress rest;

  explicit AnyContact(Random& random) {
    const double angle = random.uniform(0, 6.28);
    const auto number = [&] { return random.uniform(-1, 1); };
    frame = {{std::cos(angle), std::sin(angle)}, number(), number(), number(), number()};
    k = {random.uniform(0.5, 2), number()};
    kM = random.uniform(0, 1);
    rest = {number(), number(), number(), number(), number(), number(), number(), number(), number()};
  }
  [[nodiscard]] ContactStiffness stiffness() const {
    return {.ends = end_gradients(frame, scale_of_turns),
            .kN = k.kN,
            .kT = k.kT,
            .kM = kM / (scale_of_turns * scale_of_turns),
            .prestress = &rest,
            .rotation_scale = scale_of_turns};
  }
  /// Written out from the definitions of stretch, slip and the form of the forces at rest.
  [[nodiscard]] double energy(const std::array<double, 3>& i, const std::array<double, 3>& j) const {
    const double theta_i = i[2] / scale_of_turns, theta_j = j[2] / scale_of_turns;
    const double dx = j[0] - i[0], dy = j[1] - i[1], nx = frame.normal.x, ny = frame.normal.y;
    const double dn = dx * nx + dy * ny + frame.offset_i * theta_i + frame.offset_j * theta_j;
    const double ds = -dx * ny + dy * nx - frame.lever_i * theta_i - frame.lever_j * theta_j;
    const double springs = k.kN * dn * dn + k.kT * ds * ds + kM * (theta_j - theta_i) * (theta_j - theta_i);
    const double beside_n = dn * (rest.ns * ds + rest.ni * theta_i + rest.nj * theta_j);
    const double beside_s = ds * (0.5 * rest.ss * ds + rest.si * theta_i + rest.sj * theta_j);
    const double turns =
        0.5 * rest.ii * theta_i * theta_i + rest.ij * theta_i * theta_j + 0.5 * rest.jj * theta_j * theta_j;
    return 0.5 * springs + beside_n + beside_s + turns;
  }
};

/// Second derivatives of a quadratic energy, E(x + y) - E(x) - E(y) of unit motions.
template <std::size_t N>
std::array<std::array<double, N>, N> second_derivatives(const std::function<double(std::array<double, N>)>& energy) {
  std::array<std::array<double, N>, N> result{};
  for (std::size_t p = 0; p < N; ++p) {
    for (std::size_t q = 0; q < N; ++q) {
      std::array<double, N> x{}, y{}, both{};
      x[p] += 1, y[q] += 1, both[p] += 1, both[q] += 1;
      result[p][q] = energy(both) - energy(x) - energy(y);
    }
  }
  return result;
}

}  // namespace

TEST_CASE("the_tangent_of_a_contact_is_the_second_derivative_of_its_energy") {
  Random random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const AnyContact contact(random);
    const ContactStiffness k = contact.stiffness();
    const auto wanted = second_derivatives<6>([&](std::array<double, 6> x) {
      return contact.energy({x[0], x[1], x[2]}, {x[3], x[4], x[5]});
    });
    const EndGradient* const ends[] = {&k.ends.i, &k.ends.j};
    double difference = 0;
    for (std::size_t p = 0; p < 2; ++p) {
      for (std::size_t q = 0; q < 2; ++q) {
        std::array<double, 9> block{};
        std::array<double, 4> without_rotations{};
        k.add<3>(*ends[p], *ends[q], block.data());
        k.add<2>(*ends[p], *ends[q], without_rotations.data());
        for (std::size_t r = 0; r < 3; ++r) {
          for (std::size_t c = 0; c < 3; ++c) {
            difference = std::max(difference, std::abs(block[3 * r + c] - wanted[3 * p + r][3 * q + c]));
            if (r < 2 && c < 2) CHECK(without_rotations[2 * r + c] == block[3 * r + c]);
          }
        }
      }
    }
    CAPTURE(trial, difference);
    CHECK(difference < 1e-13);
  }
}

TEST_CASE("a_contact_of_a_body_with_its_own_image_moves_with_it_or_against_it") {
  Random random(4);
  for (int trial = 0; trial < 100; ++trial) {
    const AnyContact contact(random);
    const ContactStiffness k = contact.stiffness();
    for (const double sign : {1.0, -1.0}) {
      const auto wanted = second_derivatives<3>([&](std::array<double, 3> x) {
        return contact.energy(x, {sign * x[0], sign * x[1], sign * x[2]});
      });
      std::array<double, 9> block{};
      const EndGradient both = k.ends.as_one(sign);
      k.add<3>(both, both, block.data());
      double difference = 0;
      for (std::size_t e = 0; e < 9; ++e) difference = std::max(difference, std::abs(block[e] - wanted[e / 3][e % 3]));
      CAPTURE(trial, sign, difference);
      CHECK(difference < 1e-13);
    }
  }
}

TEST_CASE("the_parts_of_a_tangent_add_up_and_a_slipping_contact_pulls_along_its_limit") {
  Random random(5);
  const AnyContact contact(random);
  ContactStiffness k = contact.stiffness();
  k.prestress = nullptr, k.kM = 0;
  std::array<double, 9> whole{}, parts{}, slips{};
  k.add<3>(k.ends.i, k.ends.j, whole.data());
  k.normal_part().add<3>(k.ends.i, k.ends.j, parts.data());
  k.tangential_part().add<3>(k.ends.i, k.ends.j, parts.data());
  // T = mu N on the limit: the force on i by a motion of j, -(N n + T s), and its moment.
  constexpr double mu = 0.3;
  const ContactStiffness slipping{.ends = k.ends, .kN = k.kN, .tn = mu * k.kN};
  slipping.add<3>(k.ends.i, k.ends.j, slips.data());
  for (std::size_t c = 0; c < 3; ++c) {
    const double N = k.kN * k.ends.j.normal[c];
    const ContactForce force{N, mu * N};
    const Vec2 on_i = force_on_i(contact.frame, force);
    const double moment = moment_on_i(contact.frame, force) / scale_of_turns;
    CAPTURE(c);
    CHECK(std::abs(slips[c] + on_i.x) < 1e-15);
    CHECK(std::abs(slips[3 + c] + on_i.y) < 1e-15);
    CHECK(std::abs(slips[6 + c] + moment) < 1e-15);
    for (std::size_t r = 0; r < 3; ++r) CHECK(std::abs(whole[3 * r + c] - parts[3 * r + c]) < 1e-15);
  }
}
