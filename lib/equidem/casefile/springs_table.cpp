// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/springs_table.hpp"

#include <cmath>

#include "equidem/casefile/engine/table_file.hpp"
#include "equidem/casefile/engine/value.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {
namespace {

struct SpringsFile : CaseDocument {
  SpringsTable springs;
};

const File<SpringsFile>& springs_file_format() {
  static const File<SpringsFile> file = [] {
    File<SpringsFile> made("equidem-springs/1", "springs file");
    made.table("springs", &SpringsFile::springs, required, "the springs of a contact").keys(springs_keys());
    made.table("springs", &SpringsFile::springs).keys(bond_keys());
    return made;
  }();
  return file;
}

}  // namespace

std::vector<Key<SpringsTable>> springs_keys() {
  using S = SpringsTable;
  return {key("kN", &S::constants, &SpringConstants::kN, required, unit("Pa"), positive, "normal spring"),
          key("kT", &S::constants, &SpringConstants::kT, required, unit("Pa"),
              "tangential spring; 0: none; negative: a static answer exists for small ones only"),
          key("weighting", &S::weighting,
              "uniform: the same at every contact; contact_density: k/psi(theta), Abe (11), (21); "
              "local_contact_density: psi of the two discs of the contact alone; voronoi: k h/l, shared cell edge over "
              "centre distance"),
          key("density", &S::density, unit("kg/m³"), positive,
              "density of the discs that these springs are for; calibrate writes it into a springs file")};
}

std::vector<Key<SpringsTable>> bond_keys() {
  using S = SpringsTable;
  using B = BendingOptions;
  const std::string both = "each says how stiff contacts are in bending";
  return {key("kM", &S::bending, &B::kM, unit("N"), not_negative, not_beside({"bond_width"}, both),
              "bending spring of every contact, N m/rad per metre of depth: the moment by the rotation of one disc "
              "against the other; left out: contacts carry no moments"),
          key("bond_width", &S::bending, &B::bond_width, not_negative,
              "width w of a bond over the diameter of its smaller disc: contacts have kM = kN w²/12, the bending "
              "stiffness of a parallel bond")};
}

void resolve_springs_file(TomlValue& root, const std::filesystem::path& folder) {
  resolve_table_file(root, "springs", springs_file_format(), folder);
}

std::optional<double> one_density(const TomlValue& root, std::initializer_list<StatedDensity> stated) {
  constexpr double tolerance = 1e-6;
  const StatedDensity* first = nullptr;
  for (const StatedDensity& other : stated) {
    if (!other.value) continue;
    if (first == nullptr) {
      first = &other;
    } else if (std::abs(*other.value - *first->value) > tolerance * *first->value) {
      fail_at(
          *root.find(other.table)->find("density"), fmt::format("{}.density", other.table),
          fmt::format("it is {:.9g} kg/m³ here and {:.9g} kg/m³ in [{}]", *other.value, *first->value, first->table),
          "both are the density of the discs themselves", "Remove one of them");
    }
  }
  return first != nullptr ? first->value : std::nullopt;
}

}  // namespace equidem::casefile

namespace equidem {

std::string springs_file(const SpringConstants& springs, SpringWeighting weighting, std::optional<double> density,
                         std::optional<double> bond_width, const std::string& title, const std::string& comment) {
  std::string out = casefile::comment_lines(comment);
  out += fmt::format("schema = \"{}\"\ntitle = {}\n\n[springs]\nkN = {}\nkT = {}\nweighting = {}\n",
                     casefile::springs_file_format().spec().schema, toml_text(title), toml_number(springs.kN),
                     toml_number(springs.kT), toml_text(to_string(weighting)));
  if (bond_width) out += fmt::format("bond_width = {}\n", toml_number(*bond_width));
  if (density) out += fmt::format("density = {}\n", toml_number(*density));
  return out;
}

}  // namespace equidem
