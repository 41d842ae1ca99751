// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>

#include "equidem/assembly/import/particle_rows.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

const std::vector<std::string> names_of_i = {"i", "id1", "id_1", "batom1"}, names_of_j = {"j", "id2", "id_2", "batom2"};
/// Pairs of columns of which both are given or none.
constexpr std::array<std::array<const char*, 2>, 4> column_pairs = {
    {{"shift_x", "shift_y"}, {"lever_i", "lever_j"}, {"normal_x", "normal_y"}, {"offset_i", "offset_j"}}};

using OptionalColumn = std::optional<std::size_t>;

struct ContactColumns {
  std::size_t i = 0, j = 1;
  std::array<std::array<OptionalColumn, 2>, column_pairs.size()> optional{};
};

/// A column that is nearly one of those that are read is taken for a typing error.
void refuse_near_names(const TableFile& table) {
  std::vector<std::string> known;
  for (const auto& pair : column_pairs) known.insert(known.end(), pair.begin(), pair.end());
  for (const ColumnName& column : table.names()) {
    if (std::ranges::find(known, column.name) != known.end() || column.name.size() < 4) continue;
    if (const auto meant = nearest(column.name, known))
      table.fail_at_names(fmt::format("there is no column '{}' of contacts", column.name),
                          "it is nearly one that is read", fmt::format("Did you mean '{}'?", *meant));
  }
}

ContactColumns contact_columns(const TableFile& table, bool local_dump) {
  ContactColumns c;
  if (table.names().empty() || (local_dump && !table.find(names_of_i))) {
    if (table.width() == 2) return c;
    table.fail(fmt::format("the table has {} columns", table.width()),
               local_dump ? "their names do not say which are the two particles" : "they have no names",
               local_dump ? "Dump two columns, or name them: dump_modify colname 1 i colname 2 j"
                          : "Name them in a first line: i j");
  }
  refuse_near_names(table);
  c.i = table.need(names_of_i, "a contact joins two particles");
  c.j = table.need(names_of_j, "a contact joins two particles");
  for (std::size_t p = 0; p < column_pairs.size(); ++p) {
    for (std::size_t k = 0; k < 2; ++k) c.optional[p][k] = table.find({column_pairs[p][k]});
    if (c.optional[p][0].has_value() != c.optional[p][1].has_value())
      table.fail_at_names(
          fmt::format("only one of the columns {} and {} is there", column_pairs[p][0], column_pairs[p][1]),
          "they belong together", "Give both, or none");
  }
  const auto& [shifts, levers, normals, offsets] = c.optional;
  if ((normals[0] || offsets[0]) && !(normals[0] && offsets[0] && levers[0]))
    table.fail_at_names("normals, offsets and levers are not all there",
                        "off the line of centres a contact has a normal, levers along it and offsets across it",
                        "Give all six columns, or none of normal_x, normal_y, offset_i, offset_j");
  return c;
}

/// The unit that the names of levers and offsets carry; none where none does.
std::optional<double> unit_of_contact_lengths(const TableFile& table, const ContactColumns& columns) {
  const auto& [shifts, levers, normals, offsets] = columns.optional;
  if (!levers[0]) return {};
  const auto unit = table.factor(*levers[0], Dimension::length);
  for (const OptionalColumn place : {levers[1], offsets[0], offsets[1]}) {
    if (place && table.factor(*place, Dimension::length) != unit)
      table.fail_at_names("levers and offsets are in different units", "they have one unit", "Convert one of them");
  }
  return unit;
}

/// The rows of the last frame of a local dump, with the names of their columns before them.
std::string table_of_local_dump(std::string_view text) {
  constexpr std::string_view heading = "ITEM: ENTRIES";
  const std::size_t at = text.rfind(heading);
  if (at == std::string_view::npos)
    bad_input_at("line 1", "the dump has no ENTRIES", "contacts are those of \"dump local\"",
                 "Dump them by \"compute 1 all property/local batom1 batom2\" and \"dump local\"");
  // Empty lines in place of what stands before keep the numbers of the lines.
  return std::string(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'), '\n') +
         std::string(text.substr(at + heading.size()));
}

}  // namespace

std::vector<ContactRow> read_contact_rows(std::string_view text) {
  const bool local_dump = text.starts_with("ITEM:");
  const std::string kept = local_dump ? table_of_local_dump(text) : std::string();
  TableFile table(local_dump ? std::string_view(kept) : text, {}, {names_of_i, names_of_j});
  if (!table.next()) bad_input("the table has no rows", "every row is a contact", "Write it again");
  const ContactColumns columns = contact_columns(table, local_dump);
  const auto& [shifts, levers, normals, offsets] = columns.optional;
  const std::optional<double> unit = unit_of_contact_lengths(table, columns);
  std::vector<ContactRow> rows;
  do {
    ContactRow row{.line = table.line(), .unit = unit};
    row.i = table.whole(columns.i, "particle");
    row.j = table.whole(columns.j, "particle");
    if (shifts[0]) {
      row.shift_x = table.whole(*shifts[0]);
      row.shift_y = table.whole(*shifts[1]);
    }
    if (levers[0]) {
      row.lever_i = table.number(*levers[0]);
      row.lever_j = table.number(*levers[1]);
    }
    if (normals[0]) {
      row.normal = Vec2{table.number(*normals[0]), table.number(*normals[1])};
      row.offset_i = table.number(*offsets[0]);
      row.offset_j = table.number(*offsets[1]);
    }
    rows.push_back(row);
  } while (table.next());
  return rows;
}

}  // namespace equidem
