// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The unknowns of a scene follow from its effects.
#include "equidem/contact/effects.hpp"

#include <string>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"

#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;

TEST_CASE("rotations_are_unknowns_only_where_springs_can_turn_a_disc") {
  struct Case {
    double kT;
    Rotation rotation;
    int unknowns;
  };
  const auto c =
      GENERATE(Case{0.0, Rotation::from_scene, 2}, Case{0.0, Rotation::free, 2}, Case{0.0, Rotation::restrained, 2},
               Case{0.5, Rotation::from_scene, 3}, Case{0.5, Rotation::free, 3}, Case{0.5, Rotation::restrained, 2},
               Case{-0.2, Rotation::from_scene, 3}, Case{-0.2, Rotation::restrained, 2});
  const Effects effects = derive_effects(ContactSprings({1.0, c.kT}), c.rotation);
  CAPTURE(c.kT, static_cast<int>(c.rotation), effects.report());
  CHECK(effects.unknowns_per_disc() == c.unknowns);
  CHECK(effects.tangential_springs == (c.kT != 0));
}

TEST_CASE("one_tangential_spring_among_many_contacts_is_enough") {
  const ContactSprings springs(std::vector<SpringConstants>{{1, 0}, {1, 0}, {1, 1e-9}});
  CHECK(derive_effects(springs, Rotation::from_scene).rotation);
}

TEST_CASE("every_inactive_effect_says_why") {
  const Effects without = derive_effects(ContactSprings({1.0, 0.0}), Rotation::from_scene);
  CHECK(without.report() ==
        "active: normal springs. inactive: tangential springs (kT = 0 everywhere), "
        "rotation (kT = 0 everywhere: nothing can turn a disc).");
  const Effects restrained = derive_effects(ContactSprings({1.0, 0.5}), Rotation::restrained);
  INFO(restrained.report());
  CHECK(restrained.report().find("rotation (restrained as asked") != std::string::npos);
  const Effects all = derive_effects(ContactSprings({1.0, 0.5}), Rotation::from_scene);
  CHECK(all.report() == "active: normal springs, tangential springs, rotation.");
}

TEST_CASE("springs_of_more_or_fewer_contacts_than_the_assembly_has_are_refused") {
  const Assembly lattice = square_lattice({.columns = 3, .rows = 3, .radius = 1});
  const std::size_t contacts = lattice.contacts.size();
  for (const std::size_t given : {std::size_t{1}, contacts - 1, contacts + 1}) {
    const ContactSprings springs(std::vector<SpringConstants>(given, {1, 0.5}));
    test::check_refused([&] { derive_effects(lattice, springs, Rotation::from_scene); },
                        {"springs of " + std::to_string(given), "the assembly has 12", "in the order"});
  }
  const ContactSprings bending = ContactSprings({1, 0.5}).with_bending(std::vector<double>(contacts - 1, 1));
  test::check_refused([&] { derive_effects(lattice, bending, Rotation::from_scene); }, {"bending springs of 11"});
  CHECK_NOTHROW(derive_effects(lattice, ContactSprings({1, 0.5}).with_bending({1}), Rotation::from_scene));
}
