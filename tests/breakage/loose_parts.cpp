// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs that come loose as contacts break, and ends of paths, against plain walks and networks solved anew.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/breakage/disjoint_ways.hpp"
#include "equidem/core/random.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/motion_description.hpp"

#include "breakage/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Whether contacts that are left lead from one disc to another, past a third one; -1: past none.
bool leads(const Assembly& assembly, const std::vector<std::uint8_t>& broken, std::int32_t from, std::int32_t to,
           std::int32_t past) {
  std::vector<std::uint8_t> seen(assembly.size(), 0);
  seen[from] = 1;
  for (bool more = true; more;) {
    more = false;
    for (std::size_t c = 0; c < broken.size(); ++c) {
      const auto [i, j] = std::pair(assembly.contacts[c].i, assembly.contacts[c].j);
      if (broken[c] != 0 || i == past || j == past || seen[i] == seen[j]) continue;
      seen[i] = seen[j] = 1;
      more = true;
    }
  }
  return seen[to] != 0;
}

/// The number behind the first "disc ".
std::size_t first_disc_in(const std::string& sentence) {
  const std::size_t at = sentence.find("disc ");
  REQUIRE(at != std::string::npos);
  return std::stoul(sentence.substr(at + 5));
}

}  // namespace

TEST_CASE("a_contact_has_two_ways_around_it_unless_one_disc_parts_its_ends") {
  const Assembly assembly = hexagonal_lattice({.columns = 8, .rows = 8, .radius = 0.01});
  const ContactGraph graph(assembly);
  const ContactSprings springs(SpringConstants{1e9, 4e8});
  std::int64_t around = 0, parted = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    std::vector<std::uint8_t> broken(assembly.contacts.size(), 0);
    const std::vector<std::uint8_t> left(assembly.size(), 0);
    DisjointWays ways(assembly, graph, springs, broken, left);
    std::vector<std::int64_t> contacts_of(assembly.size());
    for (std::size_t d = 0; d < assembly.size(); ++d) contacts_of[d] = std::ssize(graph.of(d));
    for (int step = 0; step < 110; ++step) {
      const std::size_t contact = random.below(broken.size());
      if (broken[contact] != 0) continue;
      const auto [i, j] = std::pair(assembly.contacts[contact].i, assembly.contacts[contact].j);
      broken[contact] = 1;
      --contacts_of[i], --contacts_of[j];
      bool joined = contacts_of[i] > 1 && contacts_of[j] > 1 && leads(assembly, broken, i, j, -1);
      for (std::int32_t past = 0; joined && past < static_cast<std::int32_t>(assembly.size()); ++past)
        joined = past == i || past == j || leads(assembly, broken, i, j, past);
      CAPTURE(seed, step, contact, i, j);
      CHECK(ways.around(contact) == joined);
      (joined ? around : parted) += 1;
    }
  }
  CAPTURE(around, parted);
  CHECK(around > 100);
  CHECK(parted > 100);
}

TEST_CASE("a_part_that_loads_move_is_told_alike_by_an_updated_factor_and_by_factorizing_anew") {
  int shifted = 0;  // sentences that name a disc behind one that has left the network
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}) {
    const Assembly assembly = hexagonal_lattice({.columns = 14, .rows = 14, .radius = 0.01});
    ContactStrengths strengths{.tension = {}, .shear = {}, .friction = 0.3};
    Random random(seed);
    for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
      strengths.tension.push_back(0.5 + random.uniform());
      strengths.shear.push_back(1 + random.uniform());
    }
    LoadPathOptions options;
    options.supports = {{"bottom", 0.0, 0.0, std::nullopt}};
    options.loads = {{"top", LoadKind::per_disc, {0.1, 1}, 0}};
    const ContactSprings springs(SpringConstants{1e9, 4e8});
    Broken fast(assembly, springs, strengths, options);
    Broken slow(assembly, springs, strengths, options, Rotation::from_scene, Factor::anew);
    fast.all();
    slow.all();
    const SolverReport counters = fast.system().report();
    CAPTURE(seed, fast.events().size(), slow.events().size(), fast.run().why(), slow.run().why(), counters.mended);
    REQUIRE(fast.events().size() == slow.events().size());
    for (std::size_t k = 0; k < slow.events().size(); ++k) {
      CAPTURE(k);
      CHECK(fast.event(k).contact == slow.event(k).contact);
      CHECK(fast.event(k).loosened == slow.event(k).loosened);
      CHECK(fast.event(k).energy_after == Approx(slow.event(k).energy_after).epsilon(1e-8));
    }
    CHECK(fast.run().end() == PathEnd::load_moves_part);
    CHECK(slow.run().end() == PathEnd::load_moves_part);
    CHECK(fast.run().why().find("a load drives ") == 0);
    // A part that can move in several ways has no one disc that moves most.
    const auto part_of = [](const std::string& why) { return why.substr(0, why.find(", most of all")); };
    CHECK(part_of(slow.run().why()) == part_of(fast.run().why()));
    const auto left = slow.system().left();
    for (const std::string& why : {fast.run().why(), slow.run().why()}) {
      const std::size_t disc = first_disc_in(why);
      CHECK(why.find(describe_disc(assembly, disc)) != std::string::npos);
      CHECK(left[disc] == 0);
      shifted += std::any_of(left.begin(), left.begin() + static_cast<std::ptrdiff_t>(disc),
                             [](std::uint8_t gone) { return gone != 0; });
    }
    CHECK(counters.factorizations == 1 + counters.mended);
    CHECK(fast.system().report().name.find("did not serve") == std::string::npos);
    for (const ContactForce& f : fast.system().forces(0)) CHECK((f.normal == 0 && f.tangential == 0));
  }
  CAPTURE(shifted);
  CHECK(shifted > 0);
}
