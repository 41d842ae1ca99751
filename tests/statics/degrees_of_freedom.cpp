// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/statics/number_unknowns.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

DegreesOfFreedom number(const Assembly& assembly, SpringConstants k, Rotation rotation,
                        const std::vector<Support>& supports) {
  const ContactSprings springs(k);
  return number_unknowns(assembly, springs, derive_effects(springs, rotation), supports);
}

std::string refused(const Assembly& assembly, const std::vector<Support>& supports, SpringConstants k = {1e9, 1e9}) {
  const Refusal refusal = refusal_of([&] { number(assembly, k, Rotation::free, supports); });
  CHECK(refusal.kind == ErrorKind::bad_input);
  return refusal.message;
}

void check_words(const std::string& sentence, const std::vector<std::string>& words) {
  INFO("the sentence: " << (sentence.empty() ? "(accepted)" : sentence));
  for (const std::string& word : words) {
    INFO("looked for: " << word);
    CHECK(sentence.find(word) != std::string::npos);
  }
}

}  // namespace

TEST_CASE("effects_and_supports_decide_the_unknowns") {
  for (const AssemblyKind& kind : assembly_kinds()) {
    const auto n = static_cast<std::int64_t>(kind.assembly.size());
    CAPTURE(kind.name, n);
    CHECK(number(kind.assembly, {1e9, 1e9}, Rotation::from_scene, {}).unknowns == 3 * n);
    CHECK(number(kind.assembly, {1e9, 1e9}, Rotation::from_scene, {}).free_rotations == n);
    CHECK(number(kind.assembly, {1e9, -1e8}, Rotation::free, {}).unknowns == 3 * n);
    CHECK(number(kind.assembly, {1e9, 1e9}, Rotation::restrained, {}).unknowns == 2 * n);
    CHECK(number(kind.assembly, {1e9, 0}, Rotation::free, {}).unknowns == 2 * n);
    CHECK(number(kind.assembly, {1e9, 0}, Rotation::free, {}).free_rotations == 0);

    const std::vector<Support> supports{{.group = "anchor", .ux = 0.0, .uy = {}, .rotation = 0.5}};
    const DegreesOfFreedom held = number(kind.assembly, {1e9, 1e9}, Rotation::free, supports);
    CHECK(held.unknowns == 3 * n - 2);
    CHECK(held.free_rotations == n - 1);
    CHECK(held.unknowns == static_cast<std::int64_t>(held.held.size()) -
                               std::accumulate(held.held.begin(), held.held.end(), std::int64_t{0}));
    CHECK(held.rotation_scale == kind.assembly.mean_radius());
    CHECK(held.prescribed[2] == held.rotation_scale * 0.5);
  }
}

TEST_CASE("prescribed_values_stand_where_components_are_held_and_nowhere_else") {
  const Assembly block = hexagonal_lattice({.columns = 4, .rows = 3});
  const DegreesOfFreedom unknowns = number(block, {1e9, 1e9}, Rotation::free,
                                           {{.group = "left", .ux = -2e-3, .uy = {}, .rotation = {}},
                                            {.group = "bottom", .ux = {}, .uy = 1e-3, .rotation = {}}});
  for (std::size_t k = 0; k < unknowns.held.size(); ++k) {
    CAPTURE(k);
    if (unknowns.held[k] == 0) CHECK(unknowns.prescribed[k] == 0);
  }
  CHECK(unknowns.prescribed[0] == -2e-3);
  CHECK(unknowns.prescribed[1] == 1e-3);
  CHECK(unknowns.unknowns == static_cast<std::int64_t>(3 * block.size()) - 3 - 4);
}

TEST_CASE("rotations_that_no_contact_resists_are_held_and_counted") {
  // A row of discs; the tangential springs of the last contact are missing, and a lever of the first one.
  Assembly chain = chain_of_discs(5, 0.01);
  chain.contacts[0].lever_i = 0;
  std::vector<SpringConstants> k(4, {1e9, 1e9});
  k[3].kT = 0;
  const ContactSprings springs(k);
  const DegreesOfFreedom unknowns = number_unknowns(chain, springs, derive_effects(springs, Rotation::free), {});
  CHECK(unknowns.rotations_without_stiffness == 2);  // of disc 0 (lever) and disc 4 (spring)
  CHECK(unknowns.free_rotations == 3);
  CHECK(unknowns.unknowns == 13);
  CHECK(unknowns.held[2] != 0);
  CHECK(unknowns.held[14] != 0);
  CHECK(unknowns.held[5] == 0);
}

TEST_CASE("supports_that_make_no_sense_are_refused_with_their_reason") {
  Assembly block = hexagonal_lattice({.columns = 4, .rows = 3});
  block.groups["nobody"] = {};
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  check_words(refused(block, {{.group = "lft", .ux = 0.0, .uy = {}, .rotation = {}}}),
              {"no group 'lft'", "its groups are", "left"});
  check_words(refused(block, {{.group = "nobody", .ux = 0.0, .uy = {}, .rotation = {}}}),
              {"support", "'nobody'", "is empty", "it would hold nothing"});
  check_words(refused(block, {{.group = "left", .ux = nan, .uy = {}, .rotation = {}}}),
              {"'left'", "ux = nan", "finite"});
  check_words(refused(block, {{.group = "left", .ux = {}, .uy = -infinity, .rotation = {}}}),
              {"'left'", "uy = -inf", "finite"});
  check_words(refused(block, {{.group = "left", .ux = {}, .uy = {}, .rotation = nan}}),
              {"'left'", "rotation = nan", "finite"});
  // Disc 0 is in both groups.
  check_words(refused(block, {{.group = "left", .ux = 0.0, .uy = {}, .rotation = {}},
                              {.group = "bottom", .ux = 1e-3, .uy = {}, .rotation = {}}}),
              {"'bottom' prescribes ux of disc 0 a second time", "different value", "once"});
  check_words(refused(block, {{.group = "left", .ux = {}, .uy = 0.0, .rotation = 0.1},
                              {.group = "bottom", .ux = {}, .uy = 0.0, .rotation = 0.2}}),
              {"prescribes rotation of disc 0 a second time"});
  check_words(refused(block, {{.group = "left", .ux = {}, .uy = {}, .rotation = 0.1}}, {1e9, 0}),
              {"prescribes a rotation of 0.1 rad", "no unknowns", "tangential springs"});
}

TEST_CASE("the_same_value_twice_is_no_contradiction_and_a_rotation_held_at_zero_needs_no_rotation") {
  const Assembly block = hexagonal_lattice({.columns = 4, .rows = 3});
  const std::vector<Support> supports{{.group = "left", .ux = 0.0, .uy = {}, .rotation = 0.0},
                                      {.group = "bottom", .ux = 0.0, .uy = {}, .rotation = 0.0}};
  CHECK(number(block, {1e9, 1e9}, Rotation::free, supports).unknowns ==
        static_cast<std::int64_t>(3 * block.size()) - 2 * 6);
  CHECK(number(block, {1e9, 0}, Rotation::free, supports).unknowns == static_cast<std::int64_t>(2 * block.size()) - 6);
}
