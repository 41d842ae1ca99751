// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/laws/visit.hpp"
#include "equidem/core/random.hpp"
#include "equidem/grains/kernels/pair_lanes.hpp"

#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("a_law_gives_eight_contacts_at_a_time_what_it_gives_one") {
  for (const LawDescription& law : normal_laws()) {
    visit_law(law.law, []<class Law>(std::type_identity<Law>) {
      if constexpr (Law::kind == LawKind::force) {
        Random random(5);
        for (int trial = 0; trial < 100; ++trial) {
          eight::Lanes k{}, c{}, depth{};
          for (int lane = 0; lane < 8; ++lane) {
            k[lane] = random.uniform(1, 1e6);
            c[lane] = random.uniform(0, 1e3);
            depth[lane] = random.uniform(0, 1);
          }
          const eight::Lanes spring = Law::spring(k, depth), dashpot = Law::dashpot(c, depth);
          for (int lane = 0; lane < 8; ++lane) {
            const double one_k = k[lane], one_c = c[lane], one_depth = depth[lane];
            CAPTURE(Law::name, one_k, one_c, one_depth);
            CHECK(spring[lane] == Law::spring(one_k, one_depth));
            CHECK(dashpot[lane] == Law::dashpot(one_c, one_depth));
          }
        }
      }
    });
  }
}
