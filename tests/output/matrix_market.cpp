// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/matrix_market.hpp"

#include <string>
#include <vector>

#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("a_matrix_is_written_by_its_lower_triangle_with_indices_from_1_and_all_digits") {
  CompressedColumns lower;
  lower.size = 2;
  lower.first = {0, 2, 3};
  lower.rows = {0, 1, 1};
  lower.values = {0.1, -1e-300, 4};
  lower.component = {0, 1};
  CHECK(matrix_market(lower, "K\nPa") ==
        "%%MatrixMarket matrix coordinate real symmetric\n% K\n% Pa\n2 2 3\n1 1 0.1\n2 1 -1e-300\n2 2 4\n");
  const std::vector<std::vector<double>> columns{{1, 2.5}, {-3, 0}};
  CHECK(matrix_market(columns, "f") == "%%MatrixMarket matrix array real general\n% f\n2 2\n1\n2.5\n-3\n0\n");
}
