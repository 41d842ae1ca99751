// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Zero-energy modes and the work of loads on them, against singular values of all stretches and slips.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "equidem/contact/frame.hpp"
#include "equidem/core/random.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

struct TiedDiscs {
  std::string name;
  Assembly assembly;  ///< discs of the group "held" do not move, but turn
};

Assembly of_discs(std::vector<Vec2> centres, double r) {
  Assembly a;
  a.kind = "network";
  a.centres = std::move(centres);
  a.radii.assign(a.centres.size(), r);
  return a;
}

void join(Assembly& a, std::size_t i, std::size_t j) {
  const double half = 0.5 * norm(a.centres[j] - a.centres[i]);
  a.contacts.push_back(
      {.i = static_cast<std::int32_t>(i), .j = static_cast<std::int32_t>(j), .lever_i = half, .lever_j = half});
}

void join_touching(Assembly& a) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = i + 1; j < a.size(); ++j) {
      if (norm(a.centres[j] - a.centres[i]) < 1.000001 * (a.radii[i] + a.radii[j])) join(a, i, j);
    }
  }
}

std::vector<TiedDiscs> networks() {
  std::vector<TiedDiscs> all;
  for (const std::size_t n : {3, 4, 5, 9}) {
    std::vector<Vec2> row(n);
    for (std::size_t k = 0; k < n; ++k) row[k] = {static_cast<double>(k), 0};
    Assembly a = of_discs(row, 0.5);
    join_touching(a);
    a.groups["held"] = {{0, static_cast<std::int32_t>(n - 1)}, {}};
    all.push_back({"strut of " + std::to_string(n), std::move(a)});
  }
  for (const std::size_t n : {4, 5, 6, 9}) {
    std::vector<Vec2> ring(n);
    const double turn = 2 * std::numbers::pi / static_cast<double>(n), out = 0.5 / std::sin(turn / 2);
    for (std::size_t k = 0; k < n; ++k)
      ring[k] = out * Vec2{std::cos(turn * static_cast<double>(k)), std::sin(turn * static_cast<double>(k))};
    for (const std::size_t other : {std::size_t{1}, n / 2}) {
      Assembly a = of_discs(ring, 0.5);
      for (std::size_t k = 0; k < n; ++k) join(a, k, (k + 1) % n);
      a.groups["held"] = {{0, static_cast<std::int32_t>(other)}, {}};
      all.push_back({"polygon of " + std::to_string(n) + " held at " + std::to_string(other), std::move(a)});
    }
  }
  for (const bool rider : {false, true}) {
    std::vector<Vec2> patch;
    for (int y = 0; y < 4; ++y) {
      for (int x = 0; x < 5; ++x) {
        if (!rider || x != 2 || y != 2) patch.push_back({static_cast<double>(x), static_cast<double>(y)});
      }
    }
    if (rider) patch.push_back({2, 1.9});  // small, on the disc below and one beside it
    Assembly a = of_discs(patch, 0.5);
    if (rider) a.radii.back() = 0.4;
    join_touching(a);
    if (rider) {
      std::erase_if(a.contacts, [&](const Contact& c) { return c.j + 1 == static_cast<std::int32_t>(a.size()); });
      join(a, 7, a.size() - 1);
      join(a, 11, a.size() - 1);
    }
    a.groups["held"] = {{0, 1, 2, 3, 4}, {}};
    all.push_back({rider ? "disc that rides on gears" : "gears", std::move(a)});
  }
  std::vector<Vec2> comb;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      const double row = 1.5 * y, step = std::sqrt(3.0);
      comb.push_back({step * (x + 0.5 * (y % 2)), row});
      comb.push_back({step * (x + 0.5 * (y % 2) + 0.5), row + 0.5});
    }
  }
  Assembly a = of_discs(comb, 0.5);
  join_touching(a);
  a.groups["held"] = {{0, 1, 2, 3, 4, 5, 6, 7}, {}};
  all.push_back({"honeycomb", std::move(a)});
  return all;
}

/// Turned, mirrored, in another unit, and with the discs in another order.
Assembly moved(Assembly a, double degrees, bool mirror, double unit, Random& random) {
  const double angle = degrees * std::numbers::pi / 180;
  std::vector<std::int32_t> order(a.size());
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t k = order.size(); k > 1; --k)
    std::swap(order[k - 1], order[static_cast<std::size_t>(random.uniform() * static_cast<double>(k))]);
  Assembly result = a;
  for (std::size_t d = 0; d < a.size(); ++d) {
    const Vec2 x{a.centres[d].x, mirror ? -a.centres[d].y : a.centres[d].y};
    const auto to = static_cast<std::size_t>(order[d]);
    result.centres[to] =
        unit * Vec2{std::cos(angle) * x.x - std::sin(angle) * x.y, std::sin(angle) * x.x + std::cos(angle) * x.y};
    result.radii[to] = unit * a.radii[d];
  }
  result.contacts.clear();
  for (const Contact& c : a.contacts)
    join(result, static_cast<std::size_t>(order[c.i]), static_cast<std::size_t>(order[c.j]));
  for (auto& [name, group] : result.groups) {
    for (std::int32_t& disc : group.discs) disc = order[disc];
    std::ranges::sort(group.discs);
  }
  return result;
}

/// Stretch and, where kT > 0, slip of every contact by every free motion (rotations times the mean radius).
struct Kinematics {
  Eigen::MatrixXd rows;
  Eigen::VectorXd springs;  ///< of every row
  std::vector<std::size_t> free;
  int per_disc = 2;

  Kinematics(const Assembly& a, SpringConstants k) {
    per_disc = k.kT > 0 ? 3 : 2;
    const auto b = static_cast<std::size_t>(per_disc);
    const std::vector<std::int32_t>& held = a.groups.at("held").discs;
    for (std::size_t d = 0; d < a.size(); ++d) {
      const bool fixed = std::ranges::find(held, static_cast<std::int32_t>(d)) != held.end();
      for (std::size_t c = 0; c < b; ++c) {
        if (!fixed || c == 2) free.push_back(d * b + c);
      }
    }
    const auto each = static_cast<Eigen::Index>(k.kT > 0 ? 2 : 1), contacts = std::ssize(a.contacts);
    rows.resize(each * contacts, std::ssize(free));
    springs.resize(rows.rows());
    for (Eigen::Index column = 0; column < rows.cols(); ++column) {
      std::vector<DiscMotion> motions(a.size());
      DiscMotion& one = motions[free[column] / b];
      if (free[column] % b == 0) one.u.x = 1;
      if (free[column] % b == 1) one.u.y = 1;
      if (free[column] % b == 2) one.theta = 1 / a.mean_radius();
      for (Eigen::Index c = 0; c < contacts; ++c) {
        const Contact& contact = a.contacts[c];
        const ContactDeformation d = deformation(frame_of(a, c), motions[contact.i], motions[contact.j]);
        rows(each * c, column) = d.normal;
        if (each == 2) rows(2 * c + 1, column) = d.tangential;
      }
    }
    for (Eigen::Index r = 0; r < rows.rows(); ++r) springs[r] = each == 2 && r % 2 == 1 ? k.kT : k.kN;
  }

  /// Per disc, of components as in `free`.
  [[nodiscard]] std::vector<DiscForce> forces(const Assembly& a, const Eigen::VectorXd& f) const {
    const auto b = static_cast<std::size_t>(per_disc);
    std::vector<DiscForce> result(a.size());
    for (std::size_t k = 0; k < free.size(); ++k) {
      DiscForce& disc = result[free[k] / b];
      if (free[k] % b == 0) disc.force.x = f[k];
      if (free[k] % b == 1) disc.force.y = f[k];
      if (free[k] % b == 2) disc.moment = f[k] * a.mean_radius();
    }
    return result;
  }
};

EquilibriumOptions holding() {
  EquilibriumOptions options;
  options.mechanisms = Mechanisms::hold;
  return options;
}

}  // namespace

TEST_CASE("zero_energy_modes_and_the_work_on_them_do_not_depend_on_rotation_units_order_or_kT") {
  Random random(1);
  for (const TiedDiscs& network : networks()) {
    for (const double kT : {0.0, 1e-4, 1e-2, 1.0, 10.0, 1e3, 1e5, 1e8}) {
      for (int turn = 0; turn < 17; ++turn) {
        const double unit = std::pow(10.0, turn % 7 - 3);
        const Assembly a = moved(network.assembly, 7.3 * turn, turn % 2 == 1, unit, random);
        const SpringConstants k{1e8, kT};
        const Kinematics exact(a, k);
        const Eigen::JacobiSVD<Eigen::MatrixXd> svd(exact.rows / exact.rows.norm(), Eigen::ComputeFullV);
        const Eigen::Index rank = (svd.singularValues().array() > 1e-9).count(), modes = exact.rows.cols() - rank;
        CAPTURE(network.name, kT, turn, unit, modes);
        const std::vector<Support> supports{{.group = "held", .ux = 0.0, .uy = 0.0, .rotation = {}}};
        const ContactSprings springs(k);
        EquilibriumSolver solver(a, springs, supports, holding());

        // A load that some motion balances does no work on the modes: its contact forces are those of the motion.
        Eigen::VectorXd motion(exact.rows.cols());
        for (double& u : motion) u = unit * 1e-6 * (random.uniform() - 0.5);
        const Eigen::VectorXd by_contact = exact.springs.cwiseProduct(exact.rows * motion);
        const Eigen::VectorXd load = exact.rows.transpose() * by_contact;
        Equilibrium found;
        const Refusal lost = refusal_of([&] { found = solver.solve(exact.forces(a, load)); });
        const bool far_apart = kT > 0 && kT < 1e-8 * k.kN;  // an answer, or the reason that there is none
        CAPTURE(lost.message);
        REQUIRE((lost.message.empty() || (far_apart && lost.says("digits of a double"))));
        if (!lost.message.empty()) continue;
        REQUIRE(found.mechanisms == modes);
        double wrong = 0;
        const Eigen::Index each = exact.rows.rows() / std::ssize(a.contacts);
        for (Eigen::Index c = 0; c < std::ssize(a.contacts); ++c) {
          wrong = std::max(wrong, std::abs(found.contact_forces[c].normal - by_contact[each * c]));
          if (each == 2) wrong = std::max(wrong, std::abs(found.contact_forces[c].tangential - by_contact[2 * c + 1]));
        }
        // Where states of self-stress leave the forces to the springs, they are those of K u = f as well.
        CHECK(wrong < 1e-9 * by_contact.cwiseAbs().maxCoeff());

        // A load with a part along a mode is refused, and names the remedies that this network does not have yet.
        if (modes == 0) continue;
        const Eigen::VectorXd mode = svd.matrixV().col(exact.rows.cols() - 1 - turn % modes);
        const Eigen::VectorXd driving = load + 1e-3 * load.norm() * mode;
        const Refusal refused = refusal_of([&] { static_cast<void>(solver.solve(exact.forces(a, driving))); });
        CAPTURE(refused.message);
        CHECK(refused.says("a load drives a mechanism"));
        CHECK(refused.says("kT > 0") == (kT == 0));
        CHECK(refused.says("kM > 0") == (kT > 0));
      }
    }
  }
}
