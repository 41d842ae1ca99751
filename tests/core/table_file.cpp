// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/table_file.hpp"

#include <string>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "support/temporary_folder.hpp"

using namespace equidem;

namespace {

using Cells = std::vector<std::vector<std::string>>;
const TableFile::Names x_and_r = {{"x"}, {"radius", "r"}};

/// The names and the cells of a text; "refused: ..." where it is refused.
struct Read {
  std::vector<std::string> names, units;
  Cells rows;
  std::string refused;
};
Read read(const std::string& text, const TableFile::Names& needed = x_and_r) {
  Read result;
  try {
    TableFile file(text, "a.csv", needed);
    for (const ColumnName& column : file.names()) {
      result.names.push_back(column.name);
      result.units.push_back(column.unit);
    }
    while (file.next()) result.rows.emplace_back(file.cells().begin(), file.cells().end());
  } catch (const Error& error) {
    result.refused = error.what();
  }
  return result;
}

/// The numbers of the columns x and r, multiplied by their units.
std::vector<std::vector<double>> numbers(const std::string& text) {
  std::vector<std::vector<double>> rows;
  TableFile file(text, "a.csv", x_and_r);
  const std::size_t x = file.names().empty() ? 0 : file.need({"x"}, ""),
                    r = file.names().empty() ? 1 : file.need({"r"}, "");
  const double unit = file.factor(x, Dimension::length).value_or(1);
  while (file.next()) rows.push_back({unit * file.number(x), unit * file.number(r)});
  return rows;
}

std::string refusal_of_numbers(const std::string& text) {
  const test::Refusal refused = test::refusal_of([&] { numbers(text); });
  return refused.message.empty() ? "(accepted)" : refused.message;
}

}  // namespace

TEST_CASE("a_table_file_leaves_out_comments_and_blank_rows_and_counts_lines") {
  const test::TemporaryFolder folder;
  write_file(folder / "a.csv", "\xef\xbb\xbf x , y\r\n\n# none\n1,+2,\n , ,\n3, last", false);
  TableFile file(folder / "a.csv", {{"x"}, {"y"}});
  CHECK(file.names().size() == 2);
  REQUIRE(file.next());
  CHECK((file.line() == 4 && file.where() == (folder / "a.csv").string() + ":4" && file.whole(1) == 2));
  CHECK_THROWS_WITH(file.fail("a", "b", "c"), Catch::Contains("a.csv:4"));
  REQUIRE(file.next());
  CHECK((file.cells().back() == "last" && file.line() == 6));
  CHECK_FALSE(file.next());
}

TEST_CASE("one_table_is_the_same_in_all_its_spellings") {
  const std::vector<std::vector<double>> wanted = {{0, 0.002}, {0.0045, 0.002}};
  const std::string text = GENERATE(
      as<std::string>(), "x_mm,r_mm\n0,2\n4.5,2\n", "x_mm;r_mm\n0;2\n4,5;2\n", "x (mm)\tr (mm)\n0\t2\n4.5\t2\n",
      "x [mm] r [mm]\n0 2\n4.5 2\n", "# x_mm r_mm\n0 2\n4,5 2\n", "\"x_mm\",\"r_mm\"\n\"0\",\"2\"\n\"4.5\",\"2\"\n",
      "\"x_mm\",\"r_mm\"\n\"0\",\"2\"\n\"4,5\",\"2,0\"\n", "x_mm,r_mm\r0,2\r4.5,2\r", "x_mm,r_mm\r\n0,2\r\n4.5,2",
      "\tx_mm\tr_mm\n0\t0\t2\n1\t4.5\t2\n", ";x_mm;r_mm\n0;0;2\n1;4,5;2\n", "X_mm,R_mm,\n0,2,\n4.5,2,\n",
      "# settled 3 May\n# x_mm, r_mm\n0, 2\n# in between\n4.5, 2\n", "\xef\xbb\xbfx_mm,r_mm\n0,2\n4.5,2\n",
      "x_mm,label,r_mm\n0,\"gneis, \"\"dark\"\"\",2\n4.5,\"two\nlines\",2\n", "x_mm;r_mm\n0;2\n4,5E+00;2\n",
      "x_um,r_um\n0,2000\n4500,2000\n", "x (\xc2\xb5m),r (\xce\xbcm)\n0,2e3\n4500,2e3\n",
      "x_m  r_m\n 0 \t 2e-3\n4.5e-3 2e-3\n", "sep=;\r\nx_mm;r_mm\r\n0;2\r\n4,5;2\r\n");
  CAPTURE(text);
  const auto found = numbers(text);
  REQUIRE(found.size() == 2);
  for (std::size_t row = 0; row < 2; ++row)
    for (std::size_t k = 0; k < 2; ++k) CHECK(found[row][k] == Approx(wanted[row][k]).epsilon(1e-15));
}

TEST_CASE("a_comment_names_the_columns_only_where_the_needed_names_are_in_it") {
  CHECK(read("# settled on 3 May\n0 0 0 2\n").names.empty());
  CHECK(read("# settled on 3 May\n0 0 0 2\n").rows == Cells{{"0", "0", "0", "2"}});
  CHECK(read("# x and the r of all\n0 2\n").names.empty());
  CHECK(read("# x radius\n# by hand\n0 2\n").names == std::vector<std::string>{"x", "radius"});
  CHECK(read("x,r\n# r x\n0,2\n").names == std::vector<std::string>{"x", "r"});
  CHECK(read("vx_m_per_s,short_half_axis_mm,lever_i,x [in]\n").units ==
        std::vector<std::string>{"m_per_s", "mm", "", "in"});
}

TEST_CASE("what_a_table_cannot_mean_is_a_sentence_with_its_line") {
  const auto refused = [](const std::string& text, const std::vector<std::string>& words) {
    const std::string sentence = refusal_of_numbers(text);
    for (const std::string& word : words) {
      CAPTURE(text, sentence, word);
      CHECK(sentence.find(word) != std::string::npos);
    }
    CHECK_FALSE(place_of_wrong_byte(sentence));
  };
  refused("x,r\n0,5,1,0\n", {"a.csv:2", "4 cells", "decimal comma", "semicolons"});
  refused("x;r\n0,5;1.5\n", {"a.csv:2", "'1.5' has a decimal point", "line 2 has a decimal comma"});
  refused("x;r\n1.234,5;1\n", {"a.csv:2", "'1.234,5' is no x", "a point and a comma", "between thousands"});
  refused("x,r\n1,\"2\n3,4\n", {"a.csv:2", "quote", "Close it"});
  refused("x [\xb5m],r [\xb5m]\n1,2\n",
          {"a.csv:1", "not UTF-8", "byte 4", "0xb5", "Latin-1", "Save the file as UTF-8"});
  refused("x,r,name\n1,2,a\n1,2,\xe4\n", {"a.csv:3", "byte 5", "0xe4"});
  refused(std::string("\xff\xfex\0,\0r\0\n\0", 10), {"a.csv:1", "UTF-16", "0xff"});
  refused(std::string("x\0,\0r\0\n\0", 8), {"a.csv:1", "UTF-16"});
  refused(std::string("\0x\0,\0r\0\n", 8), {"a.csv:1", "UTF-16"});
  refused(std::string("\xff\xfe\0\0x\0\0\0", 8), {"a.csv:1", "UTF-32", "0xff"});
  refused(std::string("\0\0\xfe\xff\0\0\0x", 8), {"a.csv:1", "UTF-32", "0x00"});
  refused(std::string("x\0\0\0,\0\0\0", 8), {"a.csv:1", "UTF-32"});
  refused(std::string("\0\0\0x\0\0\0,", 8), {"a.csv:1", "UTF-32"});
  refused("X_MM,R_MM\n1,2\n", {"a.csv:1", "'x' is missing", "'X_MM' ends in no unit"});
  refused("x [in],r [in]\n1,2\n", {"a.csv:1", "'x [in]' has the unit 'in'", "mm"});
  refused("x_mm,X [m],r\n1,2,3\n", {"a.csv:1", "'x' is there twice", "'x_mm' and 'X [m]'", "columns 1 and 2"});
  refused("x,r\n1,2,3\n", {"a.csv:2", "3 cells", "line 1 names 2 columns"});
  refused("x,r\n1,inf\n", {"a.csv:2", "'inf' is no r"});
  refused("x,r\n1,1e999\n", {"a.csv:2", "'1e999' is no r"});
  CHECK(refusal_of_numbers("# Stra\xdf"
                           "e\nx,r\n1,2\n") == "(accepted)");  // a comment may be anything
}

// A search of all names for each would take longer than a test may.
TEST_CASE("a_table_of_a_million_columns_is_read") {
  std::string names = "x,r", row = "1,2";
  for (int c = 0; c < 1000000; ++c) {
    names += fmt::format(",column_{}", c);
    row += ",0";
  }
  CHECK(numbers(names + "\n" + row + "\n").size() == 1);
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

TEST_CASE("lengths_are_read_with_their_unit") {
  CHECK(length_unit("mm") == 1e-3);
  CHECK(length_unit(" 2.5 mm ") == 2.5e-3);
  CHECK(length_unit("\xc2\xb5m") == length_unit("um"));
  for (const char* text : {"", "inch", "-1 mm", "s", "MM"}) {
    CAPTURE(text);
    CHECK_FALSE(length_unit(text));
  }
}

TEST_CASE("messages_repeat_bytes_that_are_no_utf8_as_numbers") {
  const Error error(ErrorKind::bad_input, "'\xb5m' is no unit", "of '\xe2\x82'", "Write it in UTF-8 (\xc2\xb5)",
                    "gr\xfc"
                    "n.csv");
  const std::string sentence = error.what();
  CAPTURE(sentence);
  CHECK_FALSE(place_of_wrong_byte(sentence));
  CHECK_FALSE(place_of_wrong_byte(error.problem() + error.why() + error.where()));
  CHECK(sentence.find("\\xb5m") != std::string::npos);
  CHECK(sentence.find("\xc2\xb5") != std::string::npos);
  for (const char* wrong : {"\x80", "\xc0\xaf", "\xe0\x80\x80", "\xed\xa0\x80", "\xf0\x80\x80\x80", "\xf4\x90\x80\x80",
                            "\xf5", "a\xe2\x82"}) {
    CAPTURE(wrong);
    CHECK(place_of_wrong_byte(wrong));
  }
  CHECK_FALSE(place_of_wrong_byte("\xc2\xb5 \xe2\x82\xac \xf0\x9d\x84\x9e"));
}
