// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The assembled stiffness matrix and the contact law are the same thing, on every kind of assembly.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/random.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/motion_description.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/dense_oracle.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// An assembly with its springs, nothing held: K by assembly, f by the contact law.
struct Free {
  std::string name;
  const Assembly& assembly;
  ContactSprings springs;
  DegreesOfFreedom unknowns;
  ContactGraph graph;
  StiffnessMatrix matrix;

  Free(std::string title, const Assembly& discs, ContactSprings k, int per_disc)
      : name(std::move(title)),
        assembly(discs),
        springs(std::move(k)),
        unknowns(all_free(discs, per_disc)),
        graph(discs),
        matrix(assemble_stiffness(discs, graph, springs, unknowns)) {}

  [[nodiscard]] std::size_t components() const { return unknowns.held.size(); }

  /// K u by the assembled matrix.
  [[nodiscard]] std::vector<double> times(const std::vector<double>& u) const {
    std::vector<double> f(u.size());
    multiply(matrix, assembly, graph, u, f);
    return f;
  }
  /// K u by the contact law.
  [[nodiscard]] std::vector<double> force(const std::vector<double>& u) const {
    PreciseMotion motion(u.size());
    motion.high = u;
    std::vector<ContactForce> forces(assembly.contacts.size());
    contact_forces_of(assembly, springs, unknowns, motion, forces);
    std::vector<double> f(u.size());
    internal_force(assembly, graph, unknowns, forces, f);
    return f;
  }
  [[nodiscard]] double energy(const std::vector<double>& u) const {
    return elastic_energy(assembly, springs, as_motions(unknowns, u));
  }
};

/// Largest |x - y| where the largest |y| is 1; 0 where both are nothing, as is K of a single disc that cannot turn.
double difference(const std::vector<double>& x, const std::vector<double>& y) {
  return largest(x) == 0 && largest(y) == 0 ? 0 : relative_difference(x, y);
}

/// `body` for every kind, 2 and 3 unknowns per disc, kT positive, zero and negative, springs alike and weighted.
void for_all(const std::function<void(const Free&)>& body) {
  for (const AssemblyKind& kind : assembly_kinds()) {
    for (const int per_disc : {2, 3}) {
      for (const double ratio : {0.7, 0.0, -0.4}) {
        for (const SpringWeighting weighting : {SpringWeighting::uniform, SpringWeighting::voronoi}) {
          const Free scene(kind.name, kind.assembly, contact_springs(kind.assembly, {1e9, ratio * 1e9}, weighting),
                           per_disc);
          CAPTURE(kind.name, per_disc, ratio, to_string(weighting));
          body(scene);
        }
      }
    }
  }
}

}  // namespace

TEST_CASE("stiffness_times_motion_is_the_force_of_the_contact_law") {
  for_all([](const Free& scene) {
    const std::vector<double> u = random_vector(scene.components(), 11);
    CHECK(difference(scene.times(u), scene.force(u)) < 1e-12);
  });
}

TEST_CASE("stiffness_is_the_derivative_of_the_force") {
  for_all([](const Free& scene) {
    const std::vector<double> u = random_vector(scene.components(), 1), v = random_vector(u.size(), 2);
    const std::vector<double> expected = scene.times(v);
    // The law is linear: a central difference of any step is exact but for round-off, which grows as 1/h.
    for (const double h : {1.0, 1e-2, 1e-5}) {
      const std::vector<double> ahead = scene.force(combined(u, h, v)), behind = scene.force(combined(u, -h, v));
      std::vector<double> slope(u.size());
      for (std::size_t k = 0; k < u.size(); ++k) slope[k] = (ahead[k] - behind[k]) / (2 * h);
      CAPTURE(h);
      CHECK(difference(slope, expected) < 1e-13 + 1e-14 / h);
    }
  });
}

TEST_CASE("force_is_the_derivative_and_stiffness_the_second_derivative_of_energy") {
  for_all([](const Free& scene) {
    const std::vector<double> u = random_vector(scene.components(), 3), v = random_vector(u.size(), 4);
    const double here = scene.energy(u), ahead = scene.energy(combined(u, 1, v)),
                 behind = scene.energy(combined(u, -1, v));
    // Energies of kT < 0 may cancel: the sum of both signs is the measure of what round-off can do.
    const double scale = reference_energy(scene.assembly, scene.springs, as_motions(scene.unknowns, u)) +
                         reference_energy(scene.assembly, scene.springs, as_motions(scene.unknowns, v));
    CAPTURE(here, ahead, behind, scale);
    CHECK(std::abs((ahead - behind) / 2 - product(scene.force(u), v)) <= 1e-13 * scale);
    CHECK(std::abs(ahead - 2 * here + behind - product(scene.times(v), v)) <= 1e-13 * scale);
    CHECK(std::abs(here - 0.5 * product(scene.force(u), u)) <= 1e-13 * scale);
  });
}

TEST_CASE("rigid_motions_cost_no_energy_and_no_force") {
  for_all([](const Free& scene) {
    const std::size_t b = scene.unknowns.per_disc;
    Random random(5);
    const double a = scene.unknowns.rotation_scale;
    struct Rigid {
      std::string name;
      Vec2 t;
      double omega;
      Vec2 about;
    };
    std::vector<Rigid> motions{{"along x", {a, 0}, 0, {}}, {"along y", {0, a}, 0, {}}};
    // Two unknowns per disc and kT != 0: rotation restrained, which resists a rigid rotation. Periods do,
    // too.
    const bool can_turn = !scene.assembly.periodic() && (b == 3 || scene.springs[0].kT == 0);
    if (can_turn) {
      for (int k = 0; k < 3; ++k) {
        motions.push_back({"rotation", {}, 1, {a * random.uniform(-9, 9), a * random.uniform(-9, 9)}});
      }
    }
    for (const Rigid& rigid : motions) {
      std::vector<double> u(scene.components());
      for (std::size_t d = 0; d < scene.assembly.size(); ++d) {
        const Vec2 at = rigid.t + rigid.omega * perpendicular(scene.assembly.centres[d] - rigid.about);
        u[d * b] = at.x;
        u[d * b + 1] = at.y;
        if (b == 3) u[d * b + 2] = a * rigid.omega;
      }
      const double soft = softness(scene.assembly, scene.springs, as_motions(scene.unknowns, u));
      const double scale = scene.springs.largest() * largest(u);
      CAPTURE(rigid.name, rigid.about.x, rigid.about.y, soft, scale);
      CHECK(std::abs(soft) < 1e-28);
      CHECK(largest(scene.force(u)) < 1e-14 * scale);
      CHECK(largest(scene.times(u)) < 1e-14 * scale);
    }
  });
}

TEST_CASE("without_levers_that_span_the_branch_a_rotation_does_cost_energy") {
  // The test above would also pass if rotations were left out: here one lever is cut by half.
  Assembly discs = assembly_kind("hexagonal, free").assembly;
  discs.contacts[0].lever_i *= 0.5;
  const Free scene("cut lever", discs, ContactSprings(SpringConstants{1e9, 0.7e9}), 3);
  std::vector<double> u(scene.components());
  for (std::size_t d = 0; d < discs.size(); ++d) {
    const Vec2 at = perpendicular(discs.centres[d]);
    u[3 * d] = at.x;
    u[3 * d + 1] = at.y;
    u[3 * d + 2] = scene.unknowns.rotation_scale;
  }
  const double slip = 0.5 * discs.radii[0];
  CHECK(scene.energy(u) == Approx(0.5 * 0.7e9 * slip * slip).epsilon(1e-9));
}

TEST_CASE("stiffness_is_symmetric_in_the_matrix_and_in_the_law") {
  for_all([](const Free& scene) {
    const std::size_t b = scene.unknowns.per_disc;
    for (std::size_t d = 0; d < scene.assembly.size(); ++d) {
      const double* block = scene.matrix.diagonal_block(d);
      for (std::size_t r = 0; r < b; ++r) {
        for (std::size_t c = 0; c < r; ++c) {
          REQUIRE(std::abs(block[r * b + c] - block[c * b + r]) < 1e-15 * scene.springs.largest());
        }
      }
    }
    const std::vector<double> u = random_vector(scene.components(), 8), v = random_vector(u.size(), 9);
    const double scale = scene.springs.largest() * static_cast<double>(u.size());
    CAPTURE(scale);
    CHECK(std::abs(product(scene.times(u), v) - product(scene.times(v), u)) < 1e-13 * scale);
    CHECK(std::abs(product(scene.force(u), v) - product(scene.force(v), u)) < 1e-13 * scale);
  });
}

TEST_CASE("stiffness_does_not_depend_on_numbers_of_discs_nor_on_which_disc_a_contact_names_first") {
  for (const AssemblyKind& kind : assembly_kinds()) {
    const int per_disc = GENERATE(2, 3);
    const Assembly& before = kind.assembly;
    Random random(21);
    std::vector<std::int32_t> disc_now(before.size()), contact_before(before.contacts.size());
    for (auto* numbers : {&disc_now, &contact_before}) {
      std::iota(numbers->begin(), numbers->end(), 0);
      for (std::size_t k = numbers->size(); k-- > 1;) std::swap((*numbers)[k], (*numbers)[random.below(k + 1)]);
    }
    Assembly after = before;
    for (std::size_t d = 0; d < before.size(); ++d) {
      after.centres[disc_now[d]] = before.centres[d];
      after.radii[disc_now[d]] = before.radii[d];
    }
    std::vector<SpringConstants> springs_before, springs_after;
    for (std::size_t c = 0; c < before.contacts.size(); ++c) {
      springs_before.push_back({random.uniform(1e8, 1e9), random.uniform(-1e9, 1e9)});
    }
    for (std::size_t c = 0; c < before.contacts.size(); ++c) {
      Contact contact = before.contacts[contact_before[c]];
      springs_after.push_back(springs_before[contact_before[c]]);
      contact.i = disc_now[contact.i];
      contact.j = disc_now[contact.j];
      if (random.below(2) == 0) {
        std::swap(contact.i, contact.j);
        std::swap(contact.lever_i, contact.lever_j);
        contact.shift_x = -contact.shift_x;
        contact.shift_y = -contact.shift_y;
      }
      after.contacts[c] = contact;
    }
    const Free first(kind.name, before, ContactSprings(springs_before), per_disc);
    const Free second(kind.name, after, ContactSprings(springs_after), per_disc);
    const std::size_t b = per_disc;
    const std::vector<double> u = random_vector(first.components(), 22);
    std::vector<double> renumbered(u.size()), back(u.size());
    for (std::size_t k = 0; k < u.size(); ++k) renumbered[disc_now[k / b] * b + k % b] = u[k];
    const std::vector<double> f = second.times(renumbered);
    for (std::size_t k = 0; k < u.size(); ++k) back[k] = f[disc_now[k / b] * b + k % b];
    CAPTURE(kind.name, per_disc);
    CHECK(difference(back, first.times(u)) < 1e-14);
    CHECK(difference(second.force(renumbered), f) < 1e-12);
  }
}
