// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/motion/saved_state.hpp"

#include "equidem/core/error.hpp"

#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("arrays_of_a_state_are_found_by_name") {
  SavedState state{.step = 3, .arrays = {{"motions", 3, {1, 2, 3}}, {"sums", 1, {4}}}};
  CHECK(state["sums"] == std::vector<double>{4});
  CHECK(numbers_of(motions_of(state["motions"])) == state["motions"]);
  CHECK_THROWS_WITH(state["previous"], Catch::Contains("no array 'previous'"));
}
