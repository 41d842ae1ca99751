// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// States of rest that are known beforehand, what a solve reports, and that its bits are always the same.
#include "equidem/statics/equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/stress.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const EquilibriumOptions restrained{.rotation = Rotation::restrained, .solver = {}};

/// Two numbers for every motion and contact, in one array.
std::vector<double> numbers_of(const Equilibrium& state) {
  std::vector<double> all;
  for (const DiscMotion& m : state.motions) all.insert(all.end(), {m.u.x, m.u.y, m.theta});
  for (const ContactForce& f : state.contact_forces) all.insert(all.end(), {f.normal, f.tangential});
  for (const Reaction& r : state.reactions) all.insert(all.end(), {r.force.x, r.force.y, r.moment});
  all.insert(all.end(), {state.energy, state.relative_residual, state.pivot_growth, state.factor_nonzeros});
  all.push_back(static_cast<double>(state.negative_pivots.value_or(-1)));
  return all;
}

}  // namespace

TEST_CASE("a_sheared_chain_of_discs_that_cannot_turn_needs_moments_to_hold_it") {
  const Assembly chain = chain_of_discs(4, 0.01);
  const ContactSprings springs(SpringConstants{1e9, 5e8});
  const std::vector<Support> supports{{.group = "first", .ux = 0.0, .uy = 0.0, .rotation = {}}};
  const double force = 1000;
  const Equilibrium state = solve_equilibrium(
      chain, springs, supports, {{.group = "last", .kind = LoadKind::total, .force = {0, force}}}, restrained);
  CHECK(state.motions.back().u.y == Approx(3 * force / 5e8).epsilon(1e-14));
  // Every contact carries the force as slip, at a lever of 0.01 m on either disc: the holding moment is its
  // opposite.
  REQUIRE(state.rotation_moments.size() == 4);
  CHECK(state.rotation_moments[0] == Approx(-0.01 * force).epsilon(1e-13));
  CHECK(state.rotation_moments[1] == Approx(-0.02 * force).epsilon(1e-13));
  CHECK(state.rotation_moments[3] == Approx(-0.01 * force).epsilon(1e-13));
}

TEST_CASE("a_prescribed_translation_moves_all_discs_and_loads_no_contact") {
  for (const AssemblyKind& kind : assembly_kinds()) {
    if (kind.loose) continue;
    for (const double ratio : {0.5, -0.05}) {
      const ContactSprings springs(SpringConstants{1e9, ratio * 1e9});
      const Vec2 t{0.003, -0.001};
      std::vector<Support> supports{{.group = "anchor", .ux = t.x, .uy = t.y, .rotation = 0.0}};
      if (!kind.assembly.periodic()) supports.push_back({.group = "guide", .ux = {}, .uy = t.y, .rotation = {}});
      const Equilibrium state =
          solve_equilibrium(kind.assembly, springs, supports, {},
                            {.rotation = kind.chain ? Rotation::restrained : Rotation::free, .solver = {}});
      double off = 0, force = 0, turn = 0;
      for (const DiscMotion& m : state.motions) {
        off = std::max(off, norm(m.u - t));
        turn = std::max(turn, std::abs(m.theta));
      }
      for (const ContactForce& f : state.contact_forces)
        force = std::max({force, std::abs(f.normal), std::abs(f.tangential)});
      CAPTURE(kind.name, ratio, off, turn, force, state.relative_residual);
      CHECK(off <= 1e-14 * norm(t));
      CHECK(turn * kind.assembly.mean_radius() <= 1e-14 * norm(t));
      CHECK(force <= 1e-14 * 1e9 * norm(t));
    }
  }
}

TEST_CASE("a_prescribed_rotation_of_two_discs_turns_the_rest_with_them") {
  Assembly block = assembly_kind("hexagonal, free").assembly;
  const double turn = 1e-3;
  const std::int32_t other = block.groups["guide"].discs[0];
  const Vec2 branch = block.centres[other] - block.centres[0];
  const ContactSprings springs(SpringConstants{1e9, 0.5e9});
  const std::vector<Support> supports{
      {.group = "anchor", .ux = 0.0, .uy = 0.0, .rotation = {}},
      {.group = "guide", .ux = -turn * branch.y, .uy = turn * branch.x, .rotation = {}}};
  const Equilibrium state = solve_equilibrium(block, springs, supports, {});
  for (std::size_t d = 0; d < block.size(); ++d) {
    const Vec2 expected = turn * perpendicular(block.centres[d] - block.centres[0]);
    CAPTURE(d, state.motions[d].u.x, state.motions[d].u.y, state.motions[d].theta);
    CHECK(norm(state.motions[d].u - expected) < 1e-14 * turn * norm(branch));
    CHECK(state.motions[d].theta == Approx(turn).epsilon(1e-12));
  }
}

TEST_CASE("uniform_strain_of_the_rim_is_uniform_strain_inside_a_hexagonal_lattice") {
  Assembly block = hexagonal_lattice({.columns = 12, .rows = 11, .radius = 0.005});
  const double ratio = GENERATE(0.5, 0.0, -0.2);
  const ContactSprings springs(SpringConstants{1e9, ratio * 1e9});
  const Tensor2 gradient{1e-3, 4e-4, -7e-4, 5e-4};
  const double turn = mean_rotation(gradient);
  std::vector<int> neighbours(block.size(), 0);
  for (const Contact& c : block.contacts) ++neighbours[c.i], ++neighbours[c.j];
  std::vector<Support> supports;
  for (std::size_t d = 0; d < block.size(); ++d) {
    if (neighbours[d] == 6) continue;
    const std::string name = fmt::format("rim {}", d);
    block.groups[name].discs = {static_cast<std::int32_t>(d)};
    const Vec2 u = gradient * block.centres[d];
    supports.push_back({.group = name, .ux = u.x, .uy = u.y, .rotation = {}});
    if (ratio != 0) supports.back().rotation = turn;
  }
  const Equilibrium state = solve_equilibrium(block, springs, supports, {});
  const std::vector<ContactForce> expected = affine_contact_forces(block, springs, gradient, turn);
  double off = 0, spin = 0, force = 0, scale = 0;
  for (std::size_t d = 0; d < block.size(); ++d) {
    off = std::max(off, norm(state.motions[d].u - gradient * block.centres[d]));
    if (ratio != 0) spin = std::max(spin, std::abs(state.motions[d].theta - turn));
  }
  for (std::size_t c = 0; c < block.contacts.size(); ++c) {
    force = std::max({force, std::abs(state.contact_forces[c].normal - expected[c].normal),
                      std::abs(state.contact_forces[c].tangential - expected[c].tangential)});
    scale = std::max(scale, std::abs(expected[c].normal));
  }
  CAPTURE(ratio, supports.size(), off, spin, force, scale, state.relative_residual);
  CHECK(supports.size() < block.size() / 2);
  CHECK(off < 1e-12 * 1e-3 * 0.1);
  CHECK(spin < 1e-12 * 1e-3);
  CHECK(force < 1e-12 * scale);
}

TEST_CASE("loads_are_meant_per_disc_in_total_or_per_length") {
  const Assembly block = hexagonal_lattice({.columns = 6, .rows = 5, .radius = 0.01});
  const ContactSprings springs(SpringConstants{1e9, 0.5e9});
  const std::vector<Support> supports{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}};
  EquilibriumSolver solver(block, springs, supports);
  const DiscGroup right = group(block, "right");
  double length = 0;
  for (const double share : right.tributary_lengths) length += share;
  const auto reaction = [&](const Load& load) {
    Vec2 sum;
    for (const Reaction& r : solver.solve({load}).reactions) sum += r.force;
    return sum;
  };
  const Vec2 per_disc = reaction({.group = "right", .kind = LoadKind::per_disc, .force = {10, -3}});
  const Vec2 total = reaction({.group = "right", .kind = LoadKind::total, .force = {10, -3}});
  const Vec2 traction = reaction({.group = "right", .kind = LoadKind::traction, .force = {10, -3}});
  CHECK(per_disc.x == Approx(-50).epsilon(1e-12));
  CHECK(per_disc.y == Approx(15).epsilon(1e-12));
  CHECK(total.x == Approx(-10).epsilon(1e-12));
  CHECK(total.y == Approx(3).epsilon(1e-12));
  CHECK(traction.x == Approx(-10 * length).epsilon(1e-12));
  CHECK(length == Approx(5 * std::sqrt(3.0) * 0.01).epsilon(1e-14));
}

TEST_CASE("a_load_on_a_held_component_goes_into_its_support") {
  const Assembly chain = chain_of_discs(3, 0.01);
  const ContactSprings springs(SpringConstants{1e9, 5e8});
  const std::vector<Support> supports{{.group = "first", .ux = 0.0, .uy = 0.0, .rotation = {}}};
  const Equilibrium state = solve_equilibrium(
      chain, springs, supports, {{.group = "first", .kind = LoadKind::total, .force = {7, 5}}}, restrained);
  REQUIRE(state.reactions.size() == 1);
  CHECK(state.reactions[0].force == Vec2{-7, -5});
  CHECK(state.relative_residual == 0);
  for (const DiscMotion& m : state.motions) CHECK(norm(m.u) == 0);
}

TEST_CASE("a_moment_on_an_inert_disc_is_refused_unless_a_support_takes_it") {
  // The last disc of a fan has no tangential spring at any contact.
  Assembly fan = hexagonal_lattice({.columns = 4, .rows = 3});
  const std::int32_t last = static_cast<std::int32_t>(fan.size()) - 1;
  fan.groups["last"].discs = {last};
  std::vector<SpringConstants> k;
  for (const Contact& c : fan.contacts) k.push_back({1e9, c.i == last || c.j == last ? 0.0 : 5e8});
  const ContactSprings springs(k);
  const Load moment{.group = "last", .kind = LoadKind::per_disc, .force = {}, .moment = 2.0};
  std::vector<Support> supports{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}};

  const Refusal refusal = refusal_of([&] { static_cast<void>(solve_equilibrium(fan, springs, supports, {moment})); });
  CAPTURE(refusal.message);
  CHECK(refusal.says(fmt::format("a moment acts on disc {}", last)));
  CHECK(refusal.says("tangential spring"));

  // Another disc whose rotation has no stiffness, so that there are some although the loaded one is held.
  Assembly two = fan;
  two.groups["first"].discs = {last - 1};
  for (std::size_t c = 0; c < two.contacts.size(); ++c) {
    if (two.contacts[c].i == last - 1 || two.contacts[c].j == last - 1) k[c].kT = 0;
  }
  const ContactSprings fewer(k);
  supports.push_back({.group = "last", .ux = {}, .uy = {}, .rotation = 0.0});
  const Refusal none = refusal_of([&] {
    const Equilibrium state = solve_equilibrium(two, fewer, supports, {moment});
    double sum = 0;
    for (const Reaction& r : state.reactions) sum += r.moment;
    CHECK(sum == Approx(-2.0));
  });
  CAPTURE(none.message);
  CHECK(none.message.empty());
}

TEST_CASE("a_moment_on_a_disc_whose_contacts_have_no_lever_is_refused") {
  // Its contacts have tangential springs, but none can turn it.
  Assembly block = hexagonal_lattice({.columns = 4, .rows = 3});
  const std::int32_t last = static_cast<std::int32_t>(block.size()) - 1;
  block.groups["last"].discs = {last};
  for (Contact& c : block.contacts) {
    if (c.i == last) c.lever_i = 0;
    if (c.j == last) c.lever_j = 0;
  }
  const ContactSprings springs(SpringConstants{1e9, 5e8});
  const std::vector<Support> supports{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}};
  const Refusal refusal = refusal_of([&] {
    static_cast<void>(solve_equilibrium(block, springs, supports,
                                        {{.group = "last", .kind = LoadKind::per_disc, .force = {}, .moment = 2.0}}));
  });
  CAPTURE(refusal.message);
  CHECK(refusal.says(fmt::format("a moment acts on disc {}", last)));
}

TEST_CASE("the_estimate_is_what_the_solve_then_reports") {
  for (const HeldScene& scene : held_scenes()) {
    const SolveEstimate estimate = estimate_solve(scene.assembly(), scene.springs, scene.supports, scene.options);
    const Equilibrium state = solve_equilibrium(scene.assembly(), scene.springs, scene.supports, {}, scene.options);
    CAPTURE(scene.name, estimate.factor_nonzeros, state.factor_nonzeros, estimate.factor_bytes, state.factor_bytes);
    CHECK(estimate.unknowns == state.unknowns);
    CHECK(estimate.peak_bytes >= estimate.factor_bytes);
    CHECK(estimate.operations >= estimate.factor_nonzeros);
    if (!scene.springs.any_negative()) {
      CHECK(estimate.factor_nonzeros == state.factor_nonzeros);
      CHECK(estimate.factor_bytes == state.factor_bytes);
    } else {  // delayed pivots add some
      CHECK(state.factor_nonzeros >= estimate.factor_nonzeros);
      CHECK(state.factor_nonzeros <= 1.2 * estimate.factor_nonzeros);
    }
  }
}

TEST_CASE("too_little_memory_is_told_before_it_is_used") {
  const Assembly block = hexagonal_lattice({.columns = 40, .rows = 40});
  const double ratio = GENERATE(0.5, -0.05);
  const ContactSprings springs(SpringConstants{1e9, ratio * 1e9});
  const std::vector<Support> supports{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};
  const SolveEstimate estimate = estimate_solve(block, springs, supports);
  EquilibriumOptions options;
  options.solver.memory_limit = 12345;
  const Refusal refusal = refusal_of([&] { EquilibriumSolver(block, springs, supports, options); });
  CAPTURE(refusal.message, estimate.peak_bytes);
  CHECK(refusal.kind == ErrorKind::out_of_memory);
  CHECK(refusal.says(readable_bytes(estimate.peak_bytes)));
  CHECK(refusal.says(readable_bytes(12345)));
  CHECK(refusal.says("memory_limit"));
  CHECK(refusal.says(fmt::format("{} unknowns", grouped(estimate.unknowns))));
  options.solver.memory_limit = 0.99 * estimate.peak_bytes;
  CHECK(!refusal_of([&] { EquilibriumSolver(block, springs, supports, options); }).message.empty());
  options.solver.memory_limit = 1.01 * estimate.peak_bytes;
  CHECK(refusal_of([&] { EquilibriumSolver(block, springs, supports, options); }).message.empty());
}

TEST_CASE("a_state_of_rest_has_the_same_bits_for_every_number_of_threads") {
  struct Case {
    std::string name;
    Assembly assembly;
    double ratio;
  };
  const Assembly hexagonal = hexagonal_lattice({.columns = 60, .rows = 60});
  const Assembly random = delaunay_assembly({.discs = 1500, .seed = 5, .radii = {.smallest = 0.004, .largest = 0.006}});
  for (const Case& scene : {Case{"hexagonal", hexagonal, 0.5}, Case{"hexagonal", hexagonal, -0.1},
                            Case{"delaunay", random, 0.5}, Case{"delaunay", random, -0.05}}) {
    const ContactSprings springs(SpringConstants{1e9, scene.ratio * 1e9});
    const std::vector<Support> supports{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}};
    const auto solved = [&](int threads) {
      const ThreadsFor with(threads);
      return numbers_of(solve_equilibrium(scene.assembly, springs, supports,
                                          {{.group = "right", .kind = LoadKind::traction, .force = {1e6, 2e5}}}));
    };
    const std::vector<double> one = solved(1);
    for (const int threads : {2, 3, 7}) {
      const std::vector<double> many = solved(threads);
      CAPTURE(scene.name, scene.ratio, threads);
      REQUIRE(many.size() == one.size());
      CHECK(std::memcmp(many.data(), one.data(), one.size() * sizeof(double)) == 0);
    }
  }
}
