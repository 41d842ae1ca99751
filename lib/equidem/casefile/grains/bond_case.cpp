// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;
using casefile::fail_at;
using casefile::repeated;

struct Strength {
  const char* key;
  double GrainBond::*value;
  const char* unit;
  const char* help;
};
constexpr Strength strengths[] = {
    {"normal_dashpot", &GrainBond::normal_dashpot, "N s/m (discs: per m of depth)",
     "C_n along the line of centres: a pair stops as exp(-C_n t/m), m the reduced mass; a steady pull N makes it creep "
     "at N/C_n"},
    {"tangential_dashpot", &GrainBond::tangential_dashpot, "N s/m (discs: per m of depth)",
     "C_s across it, at the point of the bond; no friction limits it"},
    {"rolling_dashpot", &GrainBond::rolling_dashpot, "N m s",
     "against the relative spin; 0 in the thesis: discs roll freely on one another"},
    {"normal_spring", &GrainBond::normal_spring, "N/m (discs: per m of depth)",
     "back to the distance at the start; 0 in the thesis: bonds creep"},
    {"tangential_spring", &GrainBond::tangential_spring, "N/m (discs: per m of depth)", "the same across"},
};

/// Takes the first cell off a row.
std::string_view next_cell(std::string_view& row) {
  const std::size_t comma = std::min(row.find(','), row.size());
  const std::string_view cell = trimmed(row.substr(0, comma));
  row.remove_prefix(std::min(comma + 1, row.size()));
  return cell;
}

/// Knows where each pair was written.
class Pairs {
 public:
  explicit Pairs(std::size_t grains) : grains_(grains) {}

  /// \throws Error at the place given
  void add(GrainBond bond, std::int64_t i, std::int64_t j, const std::string& where, std::vector<GrainBond>& result) {
    const auto fail = [&](const std::string& problem, const std::string& why, const std::string& remedy) {
      throw Error(ErrorKind::bad_input, problem, why, remedy, where);
    };
    for (const std::int64_t grain : {i, j})
      if (grain < 0 || static_cast<std::size_t>(grain) >= grains_)
        fail(fmt::format("there is no grain {}", grain), fmt::format("they are counted 0 to {}", grains_ - 1),
             "Correct the number");
    if (i == j) fail(fmt::format("grain {} is tied to itself", i), "a bond ties two", "Name two grains");
    const auto [before, fresh] = places_.try_emplace(std::minmax(i, j), where);
    if (!fresh)
      fail(fmt::format("grains {} and {} are tied twice", i, j), "the first time at " + before->second,
           "Remove one of them");
    bond.i = static_cast<std::size_t>(i);
    bond.j = static_cast<std::size_t>(j);
    result.push_back(bond);
  }

 private:
  std::size_t grains_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::string> places_;
};

bool ties(const GrainBond& bond) {
  return std::any_of(std::begin(strengths), std::end(strengths), [&](const Strength& s) { return bond.*s.value > 0; });
}

constexpr const char* no_strength = "it would tie nothing";
constexpr const char* give_strength = "Add normal_dashpot and tangential_dashpot to [bonds]";

/// The strengths that the cells after i and j give, by the names of the columns; null for others, which are passed
/// over.
std::vector<const Strength*> strengths_of_columns(std::string_view row) {
  std::vector<const Strength*> columns;
  while (!row.empty()) {
    const std::string_view name = next_cell(row);
    const auto known =
        std::find_if(std::begin(strengths), std::end(strengths), [&](const Strength& s) { return name == s.key; });
    columns.push_back(known == std::end(strengths) ? nullptr : known);
  }
  return columns;
}

/// Rows "i,j,..." under a row of names.
void read_file_of_bonds(const fs::path& path, const GrainBond& common, Pairs& pairs, std::vector<GrainBond>& result) {
  const std::string content = read_file(path);
  std::string_view rest = without_byte_order_mark(content);
  bool heading = true;
  std::vector<const Strength*> columns;
  for (int line = 1; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view row = trimmed(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (row.empty() || row.front() == '#') continue;
    const std::string where = fmt::format("{}:{}", path.string(), line);
    const std::string_view left = next_cell(row), right = next_cell(row);
    if (std::exchange(heading, false)) {
      if (left != "i" || right != "j")
        throw Error(ErrorKind::bad_input, "the first two columns are not i and j", "they say which grains are tied",
                    "Begin the file with i,j", where);
      columns = strengths_of_columns(row);
      continue;
    }
    std::int64_t grains[2] = {};
    for (const auto& [cell, number] : {std::pair{left, &grains[0]}, std::pair{right, &grains[1]}}) {
      const auto [stop, problem] = std::from_chars(cell.data(), cell.data() + cell.size(), *number);
      if (problem == std::errc() && stop == cell.data() + cell.size()) continue;
      throw Error(ErrorKind::bad_input, fmt::format("'{}' is no number of a grain", cell),
                  "grains are counted 0, 1, 2, ...", "Correct it", where);
    }
    GrainBond bond = common;
    for (const Strength* strength : columns) {
      const std::string_view cell = next_cell(row);
      if (strength == nullptr || cell.empty()) continue;
      double& value = bond.*strength->value;
      const auto [stop, problem] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      if (problem == std::errc() && stop == cell.data() + cell.size() && std::isfinite(value) && value >= 0) continue;
      throw Error(ErrorKind::bad_input, fmt::format("'{}' is no {}", cell, strength->key), "a number >= 0 is needed",
                  "Correct it", where);
    }
    if (!ties(bond)) throw Error(ErrorKind::bad_input, "the bond has no dashpot", no_strength, give_strength, where);
    pairs.add(bond, grains[0], grains[1], where, result);
  }
}

}  // namespace

std::vector<casefile::Key<GrainBond>> casefile::bond_keys(bool base) {
  std::vector<Key<GrainBond>> keys;
  for (const Strength& strength : strengths)
    keys.push_back(key(strength.key, strength.value, optional, unit(strength.unit), not_negative,
                       base ? strength.help : "instead of that of [bonds]"));
  return keys;
}

void casefile::bind_bonds(File<GrainTables>& file) {
  file.table("bonds", &GrainTables::bonds, "properties of all bonds")
      .keys({key("path", &BondsTable::path,
                 "a CSV file whose first two columns i, j number the grains that are tied; columns named like the keys "
                 "below say how, instead of these; bonds.csv of run and pack can be read back"),
             key("step", &BondsTable::step, optional,
                 "exact (default): each bond decays as it should in whatever step; explicit: dashpots by the "
                 "velocities at the start of the step, as in Sukegawa (2010), with the limit dt < 2 m/C_n, 2 m/(3 C_s) "
                 "of equal discs")});
  file.table("bonds", &GrainTables::bonds, &BondsTable::common).keys(bond_keys(true));
  std::vector<Key<GrainBond>> keys{
      unbound_key<GrainBond>("grains", KeyType::discs, required,
                             "[i, j]: two discs, counted from 0, those of the file first; they do not collide")};
  for (Key<GrainBond>& key : bond_keys(false)) keys.push_back(std::move(key));
  file.table("bond", repeated_table, "two discs tied by dashpots").described(std::move(keys));
}

std::vector<GrainBond> casefile::read_bonds(const TomlValue& root, const BondsTable& given, std::size_t grains) {
  static const auto keys = casefile::bond_keys(false);
  std::vector<GrainBond> result;
  Pairs pairs(grains);
  if (const TomlValue* table = root.find("bonds")) {
    if (given.path) {
      try {
        read_file_of_bonds(*given.path, given.common, pairs, result);
      } catch (const Error& error) {
        throw error.at(fmt::format("{}: bonds.path", table->find("path")->where()));
      }
    } else if (repeated(root, "bond").empty()) {
      fail_at(*table, "bonds", "no grains are tied", "the table only says how", "Add [[bond]] with grains, or a path");
    }
  }
  for (const TomlValue& table : repeated(root, "bond")) {
    const TomlValue& two = *table.find("grains");
    if (two.items.size() != 2)
      fail_at(two, "bond.grains",
              fmt::format("{} are {}", two.shown(), counted(static_cast<long long>(two.items.size()), "grain")),
              "a bond ties two", "Write it like grains = [0, 1]");
    GrainBond bond = given.common;
    TomlValue copy = table;
    casefile::read_table(keys, copy, {}, bond);
    if (!ties(bond)) fail_at(table, "bond", "the bond has no dashpot", no_strength, give_strength);
    pairs.add(bond, two.items[0].integer, two.items[1].integer, fmt::format("{}: bond.grains", two.where()), result);
  }
  return result;
}

}  // namespace equidem
