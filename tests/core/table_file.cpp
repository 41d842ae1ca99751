// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/table_file.hpp"

#include <cstdio>
#include <fstream>

#include "equidem/core/error.hpp"

#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("a_table_file_leaves_out_comments_and_blank_rows_and_counts_lines") {
  const std::string path = "equidem_test_table.csv";
  std::ofstream(path) << "\xef\xbb\xbf x , y\r\n\n# none\n1,,+2,\n last";
  TableFile file(path);
  using Cells = std::vector<std::string_view>;
  REQUIRE(file.next());
  CHECK((file.is_first() && file.line() == 1 && file.cells() == Cells{"x", "y"}));
  REQUIRE(file.next());
  CHECK((!file.is_first() && file.where() == path + ":4" && file.cells() == Cells{"1", "", "+2", ""}));
  CHECK_THROWS_WITH(file.fail("a", "b", "c"), Catch::Contains(path + ":4"));
  REQUIRE(file.next());
  CHECK((file.cells() == Cells{"last"} && file.row() == "last"));
  CHECK_FALSE(file.next());
  std::remove(path.c_str());
}

TEST_CASE("a_number_is_read_from_the_whole_of_a_text") {
  CHECK(number_from<double>("-1.5e3") == -1500);
  CHECK(number_from<int>("12") == 12);
  for (const char* text : {"", " 1", "1 ", "1.5x", "+2"}) {
    CAPTURE(text);
    CHECK_FALSE(number_from<double>(text));
  }
  CHECK_FALSE(number_from<std::size_t>("-1"));
}
