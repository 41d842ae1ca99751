// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>

#include "equidem/contact/laws/normal_law.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/simd.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

template <class Law, class Lanes>
void compare_with_one_by_one() {
  Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    std::array<double, 8> k{}, c{}, depth{}, spring{}, dashpot{};
    for (std::size_t lane = 0; lane < 8; ++lane) {
      k[lane] = random.uniform(1, 1e6);
      c[lane] = random.uniform(0, 1e3);
      depth[lane] = random.uniform(0, 1);
    }
    const auto depths = eight::load<Lanes>(depth.data());
    eight::store(Lanes(Law::spring(eight::load<Lanes>(k.data()), depths)), spring.data());
    eight::store(Lanes(Law::dashpot(eight::load<Lanes>(c.data()), depths)), dashpot.data());
    for (std::size_t lane = 0; lane < 8; ++lane) {
      CAPTURE(Law::facts.name, k[lane], c[lane], depth[lane], sizeof(Lanes));
      CHECK(spring[lane] == Law::spring(k[lane], depth[lane]));
      CHECK(dashpot[lane] == Law::dashpot(c[lane], depth[lane]));
    }
  }
}

}  // namespace

TEST_CASE("a_law_gives_eight_contacts_at_a_time_what_it_gives_one") {
  for (const LawDescription& law : normal_laws()) {
    visit_law(law.law, []<class Law>(std::type_identity<Law>) {
      if constexpr (Law::facts.kind == LawKind::force) {
        compare_with_one_by_one<Law, eight::Eight>();
        compare_with_one_by_one<Law, eight::Twice<eight::Four>>();
        compare_with_one_by_one<Law, eight::Twice<eight::Twice<eight::Two>>>();
      }
    });
  }
}
