// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Slender bodies and springs and radii of very different size: right to a stated accuracy, or refused with a
/// sentence.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/random.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/law_oracle.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Motions of an assembly whose discs of group "held" are held, under the same force on the discs of group "pulled":
/// largest error of any component over the largest motion, against long double; the sentence where it is refused.
struct Comparison {
  double error = 0;
  std::string refusal;
  double residual = 0;
};

Comparison compare(const Assembly& assembly, const ContactSprings& springs, Vec2 force) {
  std::vector<char> held(3 * assembly.size(), 0);
  std::vector<double> forces(3 * assembly.size(), 0.0);
  for (const std::int32_t d : group(assembly, "held").discs) held[3 * d] = held[3 * d + 1] = held[3 * d + 2] = 1;
  for (const std::int32_t d : group(assembly, "pulled").discs) forces[3 * d] = force.x, forces[3 * d + 1] = force.y;
  Comparison comparison;
  comparison.refusal =
      refusal_of([&] {
        const Equilibrium state = solve_equilibrium(
            assembly, springs, std::vector<Support>{{.group = "held", .ux = 0.0, .uy = 0.0, .rotation = 0.0}},
            {{.group = "pulled", .kind = LoadKind::per_disc, .force = force}});
        const auto exact = solve_in_long_double(assembly, springs, held, forces);
        double off = 0, size = 0;
        for (std::size_t d = 0; d < assembly.size(); ++d) {
          const long double r = assembly.radii[d];
          const long double u[3] = {exact[3 * d], exact[3 * d + 1], r * exact[3 * d + 2]};
          const double v[3] = {state.motions[d].u.x, state.motions[d].u.y, assembly.radii[d] * state.motions[d].theta};
          for (int k = 0; k < 3; ++k) {
            off = std::max(off, static_cast<double>(std::abs(u[k] - v[k])));
            size = std::max(size, static_cast<double>(std::abs(u[k])));
          }
        }
        comparison.error = off / size;
        comparison.residual = state.relative_residual;
      }).message;
  return comparison;
}

Assembly held_block(int columns, int rows) {
  Assembly block = hexagonal_lattice({.columns = columns, .rows = rows});
  block.groups["held"] = block.groups["left"];
  block.groups["pulled"] = block.groups["right"];
  return block;
}

}  // namespace

TEST_CASE("a_chain_of_2000_springs_of_all_sizes_stretches_by_the_sum_of_its_flexibilities") {
  const int n = 2000;
  const Assembly chain = chain_of_discs(n, 0.01);
  Random random(1);
  std::vector<SpringConstants> k;
  double flexibility = 0;
  for (int c = 0; c + 1 < n; ++c) {
    const double stiffness = 1e9 * std::pow(10.0, static_cast<double>(random.below(7)) - 3);
    k.push_back({stiffness, 0.3 * stiffness});
    flexibility += 1 / stiffness;
  }
  const ContactSprings springs(k);
  const Equilibrium state =
      solve_equilibrium(chain, springs, std::vector<Support>{{.group = "first", .ux = 0.0, .uy = 0.0, .rotation = {}}},
                        {{.group = "last", .kind = LoadKind::total, .force = {1, 0.5}}},
                        {.rotation = Rotation::restrained, .solver = {}});
  double normal = 0, tangential = 0;
  for (const ContactForce& f : state.contact_forces) {
    normal = std::max(normal, std::abs(f.normal - 1));
    tangential = std::max(tangential, std::abs(f.tangential - 0.5));
  }
  CAPTURE(normal, tangential, state.relative_residual, state.refinements);
  CHECK(normal < 1e-13);
  CHECK(tangential < 1e-13);
  CHECK(state.motions.back().u.x == Approx(flexibility).epsilon(1e-12));
  CHECK(state.motions.back().u.y == Approx(0.5 * flexibility / 0.3).epsilon(1e-12));
}

TEST_CASE("every_section_of_a_strip_of_2_by_2000_carries_the_load_and_its_moment") {
  const double ratio = GENERATE(0.5, 0.0, -0.05);
  const Vec2 force = GENERATE(Vec2{1000, 0}, Vec2{0, 1000});
  const double a = 0.005;
  const Assembly strip = hexagonal_lattice({.columns = 2000, .rows = 2, .radius = a});
  const ContactSprings springs(SpringConstants{1e9, ratio * 1e9});
  const Equilibrium state =
      solve_equilibrium(strip, springs, std::vector<Support>{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}},
                        {{.group = "bottom_right", .kind = LoadKind::total, .force = force}});
  const Vec2 at = strip.centres[group(strip, "bottom_right").discs[0]];
  // Cut between discs; contacts across the cut carry force and moment of the part to the right.
  double worst_force = 0, worst_moment = 0;
  for (int section = 1; section < 100; ++section) {
    const double cut = (40 * section + 0.5) * a;
    Vec2 sum;
    double moment = 0;
    for (std::size_t c = 0; c < strip.contacts.size(); ++c) {
      const Contact& contact = strip.contacts[c];
      const Vec2 i = strip.centres[contact.i], j = strip.centres[contact.j];
      if ((i.x < cut) == (j.x < cut)) continue;
      const ContactFrame frame = frame_of(strip, contact);
      const Vec2 f = (i.x < cut ? 1.0 : -1.0) * force_on_i(frame, state.contact_forces[c]);
      sum += f;
      moment += cross(i + contact.lever_i * frame.normal - at, f);
    }
    worst_force = std::max(worst_force, norm(sum - force));
    worst_moment = std::max(worst_moment, std::abs(moment));
  }
  const double length = at.x;
  CAPTURE(ratio, force.x, force.y, worst_force, worst_moment, state.relative_residual, state.refinements,
          state.unstable_modes);
  CHECK(worst_force < 1e-8 * 1000);
  CHECK(worst_moment < 1e-8 * 1000 * length);
  const double half_work = 0.5 * dot(force, state.motions[group(strip, "bottom_right").discs[0]].u);
  CHECK(state.energy == Approx(half_work).epsilon(1e-8));
  // What round-off of contact forces, here up to the length over the height times the load, leaves of the
  // residual.
  double largest_force = 0;
  for (const ContactForce& f : state.contact_forces)
    largest_force = std::max({largest_force, std::abs(f.normal), std::abs(f.tangential)});
  CAPTURE(largest_force);
  CHECK(state.relative_residual <= std::max(1e-13, 1e-15 * largest_force / 1000 * std::sqrt(2.0 * 4000)));
}

TEST_CASE("tangential_springs_of_any_size_give_the_answer_of_long_double_or_a_sentence") {
  const Assembly block = held_block(5, 6);
  for (int exponent = -8; exponent <= 8; ++exponent) {
    const double ratio = std::pow(10.0, exponent);
    const ContactSprings springs(SpringConstants{1e9, ratio * 1e9});
    const Comparison c = compare(block, springs, {1000, 300});
    CAPTURE(exponent, c.error, c.residual, c.refusal);
    CHECK(c.refusal.empty());
    // Soft tangential springs lose no digits; stiff ones do, as discs are then locked to each other.
    CHECK(c.error < 1e-15 * std::max(10.0, 0.01 * ratio));
  }
}

TEST_CASE("small_negative_tangential_springs_give_the_answer_of_long_double_or_a_sentence") {
  const Assembly block = held_block(5, 6);
  for (const double ratio : {-1e-2, -1e-4, -1e-6, -1e-8, -1e-10}) {
    const ContactSprings springs(SpringConstants{1e9, ratio * 1e9});
    const Comparison c = compare(block, springs, {1000, 300});
    CAPTURE(ratio, c.error, c.residual, c.refusal);
    CHECK(c.refusal.empty());
    CHECK(c.error < 1e-14);
  }
}

TEST_CASE("radii_of_1000_to_1_give_the_answer_of_long_double") {
  // A spiral: each disc touches the two before it, which are larger; neighbours differ by a factor of 2.
  Assembly spiral;
  Vec2 at{0, 0};
  for (int d = 0; d < 11; ++d) {
    const double radius = std::pow(0.5, d);
    spiral.centres.push_back(at);
    spiral.radii.push_back(radius);
    const double angle = 0.9 * d;
    at += 1.5 * radius * Vec2{std::cos(angle), std::sin(angle)};
    for (int before = std::max(0, d - 2); before < d; ++before) {
      const double length = norm(spiral.centres[d] - spiral.centres[before]);
      const double share = spiral.radii[before] / (spiral.radii[before] + radius);
      spiral.contacts.push_back({before, d, 0, 0, share * length, (1 - share) * length});
    }
  }
  spiral.groups["held"].discs = {0};
  for (const double ratio : {0.5, 1e-3, -0.01}) {
    for (const std::int32_t pulled : {1, 5, 10}) {
      spiral.groups["pulled"].discs = {pulled};
      const ContactSprings springs(SpringConstants{1e9, ratio * 1e9});
      const Comparison c = compare(spiral, springs, {1000, 300});
      CAPTURE(ratio, pulled, spiral.radii[0] / spiral.radii.back(), c.error, c.residual, c.refusal);
      CHECK(c.refusal.empty());
      CHECK(c.error < 1e-14);
    }
  }
}

TEST_CASE("a_delaunay_assembly_of_radii_1000_to_1_is_solved_or_refused_with_a_sentence") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Assembly random = delaunay_assembly({.discs = 120, .seed = seed, .radii = {.smallest = 1e-5, .largest = 1e-2}});
    random.groups["held"] = random.groups["left"];
    random.groups["pulled"] = random.groups["right"];
    const ContactSprings springs(SpringConstants{1e9, 0.5e9});
    const Comparison c = compare(random, springs, {1000, 300});
    CAPTURE(seed, c.error, c.residual, c.refusal);
    if (c.refusal.empty()) {
      CHECK(c.error < 1e-9);
    } else {
      CHECK((c.refusal.find("disc") != std::string::npos && c.refusal.back() == '.'));
    }
  }
}

TEST_CASE("two_halves_joined_by_springs_of_nearly_nothing_are_right_to_the_digits_left_or_refused") {
  Assembly halves = held_block(6, 4);
  const double middle = 0.5 * (halves.centres.front().x + halves.centres[group(halves, "right").discs[0]].x) + 0.002;
  for (const double weak : {1e-4, 1e-8, 1e-10, 1e-12, 1e-14, 1e-16, 1e-18}) {
    for (const double sign : {1.0, -0.05}) {
      std::vector<SpringConstants> k;
      int joints = 0;
      for (const Contact& c : halves.contacts) {
        const bool joint = (halves.centres[c.i].x < middle) != (halves.centres[c.j].x < middle);
        joints += joint ? 1 : 0;
        k.push_back(joint ? SpringConstants{weak * 1e9, sign * weak * 0.5e9} : SpringConstants{1e9, sign * 0.5e9});
      }
      const ContactSprings springs(k);
      const Comparison c = compare(halves, springs, {1000, 0});
      CAPTURE(weak, sign, joints, c.error, c.residual, c.refusal);
      if (c.refusal.empty()) {
        CHECK(c.error < std::max(1e-13, 1e-17 / weak));
      } else {
        CHECK(weak < 1e-9);
        CHECK(c.refusal.back() == '.');
      }
    }
  }
}
