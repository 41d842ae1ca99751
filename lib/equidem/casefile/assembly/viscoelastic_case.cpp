// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/viscoelastic_case.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/engine/value.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr const char* table_header = "frequency,kN_storage,kN_loss,kT_storage,kT_loss";

std::vector<ViscoelasticCase::Row> read_spring_table(const std::filesystem::path& path) {
  constexpr std::size_t columns = 5;
  TableFile::Names names;
  for (const std::string_view name : parts_of(table_header, ',')) names.push_back({std::string(name)});
  TableFile file(path, names);
  std::array<std::size_t, columns> places{};
  std::array<double, columns> units{};
  for (std::size_t c = 0; c < columns; ++c) {
    places[c] = file.names().empty() ? c : file.need(names[c], fmt::format("the columns are {}", table_header));
    units[c] = file.factor(places[c], c == 0 ? Dimension::frequency : Dimension::stress).value_or(1);
  }
  std::vector<ViscoelasticCase::Row> rows;
  while (file.next()) {
    if (file.cells().size() < columns)
      file.fail(fmt::format("this row is not of the columns {}", table_header), "five numbers with commas are needed",
                "Write it like 10,1.0e9,2.0e7,0.5e9,1.0e7: Hz and Pa");
    std::array<double, columns> numbers{};
    for (std::size_t c = 0; c < columns; ++c) numbers[c] = units[c] * file.number(places[c]);
    if (!(numbers[0] > 0)) {
      file.fail(fmt::format("the frequency {} Hz is not above 0", numbers[0]),
                "the springs of a frequency are those of motions that change as exp(i 2 pi frequency t)",
                "Begin with the lowest frequency that was measured");
    }
    if (!rows.empty() && numbers[0] <= rows.back().frequency) {
      file.fail(fmt::format("the frequency {} Hz comes after {} Hz", numbers[0], rows.back().frequency),
                "springs are read between neighbours", "Sort the rows and leave out repeated frequencies");
    }
    rows.push_back({numbers[0], {{numbers[1], numbers[2]}, {numbers[3], numbers[4]}}});
  }
  return rows;
}

bool any_of_springs(const Viscoelasticity& springs, SpringModel model) {
  return springs.normal.model == model || springs.tangential.model == model;
}

}  // namespace

namespace casefile {

std::vector<Key<ViscoelasticCase>> viscoelastic_keys() {
  using V = ViscoelasticCase;
  using L = Viscoelasticity;
  using S = ViscoelasticSpring;
  const std::vector<std::string> timed = {"kelvin_voigt", "maxwell", "standard_solid"}, armed = {"standard_solid"};
  return {
      key("normal", &V::springs, &L::normal, &S::model,
          "kN of every contact at rest or at once; elastic; kelvin_voigt: a dashpot beside it, kN (1 + i x) with x = 2 "
          "pi f tauN; maxwell: a dashpot behind it, kN i x/(1 + i x); standard_solid: a Maxwell arm beside it, kN (1 + "
          "armN i x/(1 + i x)); table: by path"),
      key("tangential", &V::springs, &L::tangential, &S::model, "kT of every contact, likewise"),
      key("tauN", &V::springs, &L::normal, &S::time, required, unit("s"), not_negative, when("normal", timed),
          "viscosity of the dashpot over the stiffness of its spring (of the arm: over that of the arm)"),
      key("tauT", &V::springs, &L::tangential, &S::time, required, unit("s"), not_negative, when("tangential", timed),
          "as tauN, of the tangential spring"),
      key("armN", &V::springs, &L::normal, &S::arm, positive, when("normal", armed),
          "spring of the Maxwell arm over kN"),
      key("armT", &V::springs, &L::tangential, &S::arm, positive, when("tangential", armed),
          "spring of the Maxwell arm over kT"),
      key("path", &V::path,
          fmt::format("a CSV file with the columns {}, Hz and Pa, of a contact with the kN and kT of the case; others "
                      "are scaled as their elastic springs are",
                      table_header)),
      key("frequencies", &V::frequencies, unit("Hz"), not_beside({"lowest"}, "each says which frequencies to take"),
          "of complex moduli; left out: 3 decades either side of 1/(2 pi tau), or those of the table"),
      key("lowest", &V::lowest, unit("Hz"), positive, only_with({"highest"}, "a range has two ends"),
          "frequencies from here"),
      key("highest", &V::highest, unit("Hz"), positive, only_with({"lowest"}, "a range has two ends"),
          "to here, evenly spaced over their logarithm"),
      key("per_decade", &V::per_decade, from(1, 100), "frequencies in a decade")};
}

void complete_viscoelastic(const TomlValue& root, ViscoelasticCase& viscoelastic) {
  const TomlValue& table = *root.find("viscoelastic");
  const Viscoelasticity& springs = viscoelastic.springs;
  if (springs.normal.model == SpringModel::elastic && springs.tangential.model == SpringModel::elastic) {
    fail_at(table, "viscoelastic", "both springs are elastic", "[viscoelastic] would change nothing",
            "Choose a model for normal or tangential, or remove the table");
  }
  const bool tabulated = any_of_springs(springs, SpringModel::table);
  if (tabulated && !viscoelastic.path) {
    fail_at(table, "viscoelastic.path", "the table of springs is missing", "the model \"table\" reads them there",
            "Add path = \"FILE.csv\"");
  }
  if (!tabulated && viscoelastic.path) {
    fail_at(*table.find("path"), "viscoelastic.path", "no spring is read from the table",
            "neither normal nor tangential is \"table\"", "Set one of them, or remove path");
  }
  if (viscoelastic.path)
    with_key(table, "viscoelastic", "path", [&] { viscoelastic.rows = read_spring_table(*viscoelastic.path); });
}

}  // namespace casefile

Viscoelasticity build_viscoelasticity(const Case& resolved, const std::optional<SpringConstants>& constants) {
  const ViscoelasticCase& given = *resolved.viscoelastic;
  return casefile::with_place(resolved.where("viscoelastic"), [&] {
    Viscoelasticity result = given.springs;
    if (!given.rows.empty() && !constants) {
      bad_input("a table of springs in Pa is given, and each contact has springs of its own",
                "it is not known to which of them the table belongs",
                "Set assembly.own_springs = false and give [springs], or choose other models");
    }
    const auto fill = [&](ViscoelasticSpring& spring, const std::string& of, double elastic, auto measured) {
      if (spring.model == SpringModel::table) {
        if (elastic == 0) {
          bad_input(
              fmt::format("the table gives {} springs, and the case has {} = 0", of, of == "normal" ? "kN" : "kT"),
              "a contact without such a spring has no dashpot either", "Give the case the spring, or another model");
        }
        for (const ViscoelasticCase::Row& row : given.rows)
          spring.table.push_back({row.frequency, measured(row.springs) / elastic});
      }
      check(spring, of);
    };
    const SpringConstants k = constants.value_or(SpringConstants{1, 1});
    fill(result.normal, "normal", k.kN, [](const auto& springs) { return springs.kN; });
    fill(result.tangential, "tangential", k.kT, [](const auto& springs) { return springs.kT; });
    return result;
  });
}

std::vector<double> frequencies_of(const Case& resolved, const Viscoelasticity& springs) {
  const ViscoelasticCase& given = *resolved.viscoelastic;
  if (!given.frequencies.empty()) return given.frequencies;
  return casefile::with_place(resolved.where("viscoelastic"), [&] {
    return given.lowest ? logarithmic_frequencies(*given.lowest, *given.highest, given.per_decade)
                        : frequencies_of_interest(springs, given.per_decade);
  });
}

void check_viscoelastic(const Case& resolved, std::string_view verb) {
  if (!resolved.viscoelastic || verb == "homogenize" || verb == "sweep") return;
  const Viscoelasticity& springs = resolved.viscoelastic->springs;
  const auto refuse = [&](const std::string& problem, const char* why, const char* remedy) {
    bad_input_at(resolved.where("viscoelastic"), problem, why, remedy);
  };
  const auto any = [&](SpringModel model) { return any_of_springs(springs, model); };
  if (verb == "solve") {
    if (any(SpringModel::maxwell))
      refuse("a Maxwell spring has no equilibrium", "its dashpot flows as long as it carries a force",
             "Use 'equidem homogenize', which gives complex moduli, or another model");
    if (any(SpringModel::table))
      refuse("a table of springs over frequency has no equilibrium", "its stiffness at rest is not known",
             "Use 'equidem homogenize', or remove [viscoelastic] to solve with elastic springs");
  } else if (verb == "run") {
    for (const SpringModel model : {SpringModel::maxwell, SpringModel::standard_solid, SpringModel::table}) {
      if (any(model))
        refuse(fmt::format("a run has no springs of the model \"{}\"", to_string(model)),
               "its contacts are springs with dashpots beside them, Kelvin-Voigt",
               "Use kelvin_voigt, or 'equidem homogenize' for complex moduli");
    }
  } else {
    refuse(fmt::format("{} takes elastic springs, and the case gives [viscoelastic]", verb),
           "its answer would be that of other springs", "Remove [viscoelastic]; homogenize, solve and run take it");
  }
}

}  // namespace equidem
