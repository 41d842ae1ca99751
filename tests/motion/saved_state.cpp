// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/motion/saved_state.hpp"

#include <cmath>

#include "equidem/core/error.hpp"

#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("arrays_of_a_state_are_found_by_name") {
  SavedState state{.step = 3, .arrays = {{"motions", 3, {1, 2, 3}}, {"sums", 1, {4}}}};
  CHECK(state["sums"] == std::vector<double>{4});
  CHECK(numbers_of(motions_of(state["motions"])) == state["motions"]);
  CHECK_THROWS_WITH(state["previous"], Catch::Contains("no array 'previous'"));
}

TEST_CASE("saved_rows_become_the_structs_they_were") {
  struct Row {
    std::int32_t body = 0;
    bool touches = false;
    double force = 0;
  };
  const auto numbers = [](auto& row, const auto& visit) { visit(row.body), visit(row.touches), visit(row.force); };
  SavedState state{.arrays = {saved_rows("rows", std::vector<Row>{{-7, true, 0.1}, {3, false, -2}}, numbers)}};
  REQUIRE(state.arrays[0].columns == 3);
  const auto rows = rows_in<Row>(state, "rows", numbers);
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].body == -7);
  CHECK(rows[0].touches);
  CHECK(rows[1].force == -2);
  for (const double body : {0.5, 1e10, std::nan("")}) {
    state["rows"][0] = body;
    CHECK_THROWS_AS(rows_in<Row>(state, "rows", numbers), Error);
  }
  state["rows"] = {1, 0, 2, 3, 0, 4};
  state.arrays[0].columns = 2;  // as many numbers, but other rows
  CHECK_THROWS_WITH(rows_in<Row>(state, "rows", numbers), Catch::Contains("in rows of 2"));
  state.arrays[0].columns = 3;
  state["rows"] = {1, 0};
  CHECK_THROWS_AS(rows_in<Row>(state, "rows", numbers), Error);
}
