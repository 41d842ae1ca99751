// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/motion/ledger.hpp"

#include <set>
#include <string>

#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("the_balance_follows_from_the_roles_of_the_terms") {
  for (const EnergyTerm& term : energy_terms()) {
    EnergyLedger ledger;
    ledger.*term.value = 2;
    const bool adds = term.role == EnergyRole::stored || term.role == EnergyRole::lost;
    CAPTURE(term.key);
    CHECK(ledger.error() == (adds ? 2 : -2));
    CHECK(ledger.lost() == (term.role == EnergyRole::lost ? 2 : 0));
    CHECK(ledger.work() == (term.role == EnergyRole::work ? 2 : 0));
    CHECK(ledger.largest() == (term.role == EnergyRole::sway ? 0 : 2));
  }
}

TEST_CASE("every_term_belongs_to_a_family_and_its_keys_are_unique") {
  std::set<std::string> listed;
  for (const BodyFamily family : {BodyFamily::bonded, BodyFamily::colliding}) {
    std::set<std::string> keys;
    for (const EnergyTerm& term : energy_terms(family)) {
      CAPTURE(term.key);
      CHECK(keys.insert(term.key).second);
      listed.insert(term.key);
    }
  }
  CHECK(listed.size() == energy_terms().size());
}
