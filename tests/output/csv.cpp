// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Tables and matrices as text.
#include "equidem/output/files/csv.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/random.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/files/matrix_market.hpp"
#include "equidem/output/results.hpp"

#include "output/states.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using equidem::test::refusal_of;

namespace {

/// Lines of unquoted cells.
std::vector<std::vector<std::string>> cells_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

double number(const std::string& cell) {
  double value = std::nan("");
  std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return value;
}

std::size_t column(const std::vector<std::string>& header, const std::string& name) {
  const auto found = std::find(header.begin(), header.end(), name);
  CAPTURE(name);
  REQUIRE(found != header.end());
  return static_cast<std::size_t>(found - header.begin());
}

}  // namespace

TEST_CASE("numbers_in_csv_read_back_to_the_same_bits") {
  Random random(7);
  std::vector<double> numbers{0.0, -0.0, 0.1, 5e-324, 1.7976931348623157e308};
  std::vector<std::int64_t> integers{0, -1, INT64_MAX, INT64_MIN, 42};
  while (numbers.size() < 1000) {
    const double candidate = std::bit_cast<double>(random.bits());
    if (!std::isfinite(candidate)) continue;
    numbers.push_back(candidate);
    integers.push_back(static_cast<std::int64_t>(random.bits()));
  }
  const auto rows = cells_of(Table().add("x_m", numbers).add("count", integers).csv());
  REQUIRE(rows.size() == numbers.size() + 1);
  REQUIRE(rows[0] == std::vector<std::string>{"x_m", "count"});
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    CAPTURE(rows[k + 1][0], rows[k + 1][1]);
    CHECK(std::bit_cast<std::uint64_t>(number(rows[k + 1][0])) == std::bit_cast<std::uint64_t>(numbers[k]));
    CHECK(std::stoll(rows[k + 1][1]) == integers[k]);
  }
}

TEST_CASE("csv_quotes_only_where_it_must") {
  const Table table = Table()
                          .add("plain", std::vector<std::string>{"stable", "a \"b\""})
                          .add("with, comma", std::vector<std::string>{"line\nbreak", ""})
                          .add("number", std::vector<double>{std::nan(""), INFINITY});
  CHECK(table.csv() == "plain,\"with, comma\",number\nstable,\"line\nbreak\",nan\n\"a \"\"b\"\"\",,inf\n");
}

TEST_CASE("a_table_of_samples_reads_back_or_is_refused") {
  const TemporaryFolder folder;
  const auto path = folder / "samples.csv";
  const auto table = [](std::vector<double> values, std::vector<std::string> messages) {
    return Table().add("value", std::move(values)).add("message", std::move(messages));
  };
  write_samples(path, table({0.1, -2e-300, std::nan("")}, {"", "a, \"b\"\nc", "failed"}));
  const std::string good = read_file(path);
  const auto read = [&](const std::string& text) {
    write_file(path, text, true);
    return StoredTable(path, table({}, {}), "sweep", "Start afresh");
  };
  CHECK(read(good).rows() == 3);
  CHECK(read(good).number(1, 0) == -2e-300);
  CHECK(read(good).text(1, 1) == "a, \"b\"\nc");
  CHECK(refusal_of([&] { read(good.substr(0, good.rfind(',') + 9)); }).says("line 4 was altered since it was written"));
  CHECK(refusal_of([&] { read("value,message\n0.1,\n"); }).says("its columns are those of another sweep"));
  const auto of_version = refusal_of([&] { read("value,text,checksum\n0.1,,a\n"); });
  CHECK(of_version.says("a version other than " + library_version() + ": column 2 is 'text' there and 'message' here"));
}

TEST_CASE("events_whose_last_row_was_cut_short_are_those_before_it") {
  const TemporaryFolder folder;
  const auto path = folder / "events.csv";
  const auto table = [](std::vector<double> values) { return Table().add("value", std::move(values)); };
  write_samples(path, table({0.1, 0.2, 0.3}));
  const std::string good = read_file(path);
  const std::size_t last = good.rfind("0.3"), before = good.rfind("0.2");
  const auto read = [&](const std::string& text) {
    write_file(path, text, true);
    return StoredTable(path, table({}), "path", "Start afresh", "events", CutRow::left_out);
  };
  for (std::size_t size = last; size <= good.size(); ++size) {
    const StoredTable stored = read(good.substr(0, size));
    CAPTURE(size, good.size());
    CHECK(stored.rows() == (size + 1 < good.size() ? 2 : 3));
    CHECK(stored.cut() == (size > last && size + 1 < good.size()));
  }
  // A row that is cut in the middle of a table was not cut by an end.
  const auto refusal = refusal_of([&] { read(good.substr(0, before + 5) + "\n" + good.substr(last)); });
  CHECK(refusal.says("the events to continue cannot be read"));
}

TEST_CASE("a_table_refuses_columns_it_cannot_hold") {
  Table table;
  table.add("ratio", std::vector<double>{0, 1});
  CHECK_THROWS_WITH(table.add("ratio", std::vector<double>{0, 1}), Catch::Contains("'ratio'"));
  CHECK_THROWS_WITH(table.add("nu", std::vector<double>{0, 1, 2}),
                    Catch::Contains("'nu' has 3 values but the table has 2 rows"));
  CHECK_THROWS_AS(table.add("", std::vector<double>{0, 1}), Error);
}

TEST_CASE("disc_and_contact_tables_hold_the_state") {
  const bool periodic = GENERATE(false, true);
  CAPTURE(periodic);
  const MadeUpState state = stretched_block(4, 4, periodic);
  const TemporaryFolder folder;
  write_disc_csv(folder / "discs.csv", state.view(), false);
  write_contact_csv(folder / "contacts.csv", state.view(), false);

  const auto discs = cells_of(read_file(folder / "discs.csv"));
  REQUIRE(discs.size() == state.assembly.size() + 1);
  for (std::size_t k = 0; k < state.assembly.size(); ++k) {
    CHECK(number(discs[k + 1][column(discs[0], "y_m")]) == state.assembly.centres[k].y);
    CHECK(number(discs[k + 1][column(discs[0], "ux_m")]) == state.motions[k].u.x);
    CHECK(number(discs[k + 1][column(discs[0], "stress_yx_Pa")]) == state.stresses[k].yx);
    CHECK(number(discs[k + 1][column(discs[0], "cell_area_m2")]) == state.assembly.cell_areas[k]);
  }
  const auto contacts = cells_of(read_file(folder / "contacts.csv"));
  REQUIRE(contacts.size() == state.assembly.contacts.size() + 1);
  for (std::size_t k = 0; k < state.assembly.contacts.size(); ++k) {
    const double fx = number(contacts[k + 1][column(contacts[0], "force_x_N_per_m")]);
    const double fy = number(contacts[k + 1][column(contacts[0], "force_y_N_per_m")]);
    CHECK(number(contacts[k + 1][column(contacts[0], "normal_force_N_per_m")]) == state.forces[k].normal);
    CHECK(std::hypot(fx, fy) == Approx(std::hypot(state.forces[k].normal, state.forces[k].tangential)));
    CHECK(contacts[k + 1][column(contacts[0], "shift_x")] == std::to_string(state.assembly.contacts[k].shift_x));
  }
}

TEST_CASE("what_was_not_computed_has_no_column") {
  const Assembly assembly = hexagonal_lattice({.columns = 2, .rows = 2});
  const TemporaryFolder folder;
  write_disc_csv(folder / "discs.csv", {assembly}, false);
  write_contact_csv(folder / "contacts.csv", {assembly}, false);
  CHECK(cells_of(read_file(folder / "discs.csv"))[0] ==
        std::vector<std::string>{"disc", "x_m", "y_m", "radius_m", "cell_area_m2"});
  CHECK(cells_of(read_file(folder / "contacts.csv"))[0].back() == "lever_j_m");
}

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
