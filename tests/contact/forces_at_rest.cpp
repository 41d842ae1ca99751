// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/prestress/forces_at_rest.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("a_force_that_is_round_off_of_the_others_loads_no_contact") {
  Assembly chain = chain_of_discs(4, 1);
  chain.contact_normal_force = {-2, -1, 1e-15};
  chain.contact_tangential_force = {0, 0, -3e-16};
  for (const double scale : {1.0, 1e-9, 1e12}) {
    Assembly scaled = chain;
    for (double& force : scaled.contact_normal_force) force *= scale;
    for (double& force : scaled.contact_tangential_force) force *= scale;
    const RestBalance balance = balance_at_rest(scaled);
    CAPTURE(scale, balance.loaded, balance.mean_force, balance.relative);
    CHECK(balance.loaded == 2);
    CHECK(balance.mean_force == Approx(1.5 * scale));
    CHECK(balance.relative == Approx(2 / 1.5));
  }
}
