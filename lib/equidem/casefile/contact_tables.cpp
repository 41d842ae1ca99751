// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/contact_tables.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {
namespace {

/// A file with one table, whose name may stand in the place of that table.
template <class T>
struct TableFile : CaseDocument {
  T table;
};

/// "equidem-springs/1"
std::string schema_of(const std::string& table) {
  return fmt::format("equidem-{}/1", table);
}

template <class T>
void resolve_table_file(TomlValue& root, const std::string& table, CaseKind kind, const std::vector<Key<T>>& keys,
                        const std::filesystem::path& folder) {
  TomlValue* named = root.find(table);
  if (named == nullptr || named->type != TomlValue::Type::text) return;
  File<TableFile<T>> format(schema_of(table), table + " file", kind);
  format.table(table, &TableFile<T>::table, required, table + " of contacts").keys(keys);
  const std::filesystem::path path = opened(named->text, folder);
  TomlValue document = with_place(fmt::format("{}: {}", named->where(), table),
                                  [&] { return parse_toml(read_file(path), path.string()); });
  static_cast<void>(format.read(document, folder));
  *named = *document.find(table);
}

/// The lines of such a file above the keys; the comment without the control characters that TOML must not have there.
std::string head_of_file(const std::string& table, const std::string& title, const std::string& comment) {
  std::string out;
  for (std::string_view rest = comment; !rest.empty();) {
    std::string line(rest.substr(0, rest.find('\n')));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    for (char& c : line)
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    out += line.empty() ? "#\n" : fmt::format("# {}\n", line);
  }
  return out + fmt::format("schema = \"{}\"\ntitle = {}\n\n[{}]\n", schema_of(table), toml_text(title), table);
}

constexpr const char *normal_spring = "normal spring",
                     *tangential_spring =
                         "tangential spring; 0: none; negative: a static answer exists for small ones only",
                     *strengths_of_contact =
                         "a contact breaks where its normal force reaches tension, of a bond of colliding bodies with "
                         "what its moment adds at the outer fibre, or where |T| reaches shear - friction N, N positive "
                         "in tension; left out: the assembly gives strengths",
                     *unit_of_strength = "N/m (with bond_length: Pa)";

/// The groups of [[springs.between]] and [[strength.between]].
template <class Property>
std::vector<Key<OfPair<Property>>> pair_keys() {
  using P = OfPair<Property>;
  return {
      key("groups", &P::groups, required, "the two groups, of [[group]] or of the assembly; twice the same: inside it"),
      key("across", &P::across, "only contacts between two cells of [[group]], as those between grains of a rock")};
}

}  // namespace

std::vector<Key<SpringsTable>> springs_keys() {
  using S = SpringsTable;
  using B = BendingOptions;
  const std::string how_stiff =
      "two numbers say how stiff contacts are: kN and kT, or shear_wave_speed and poisson_ratio";
  const auto of_packings = only_in({CaseKind::packing}), of_assemblies = only_in({CaseKind::assembly});
  return {
      key("kN", &S::constants, &SpringConstants::kN, or_instead({"shear_wave_speed"}, how_stiff), unit("Pa"), positive,
          normal_spring),
      key("kT", &S::constants, &SpringConstants::kT, or_instead({"shear_wave_speed"}, how_stiff), unit("Pa"),
          tangential_spring),
      key("shear_wave_speed", &S::shear_wave_speed, of_packings, unit("m/s"), positive,
          only_with({"poisson_ratio"}, how_stiff), "Vs: kT = pi/4 rho Vs², kN = pi/4 rho Vp²"),
      key("poisson_ratio", &S::poisson_ratio, of_packings, between(-1, 0.5), only_with({"shear_wave_speed"}, how_stiff),
          "plane strain; with shear_wave_speed"),
      key("weighting", &S::weighting,
          "uniform: the same at every contact; contact_density: k/psi(theta), Abe (11), (21); "
          "local_contact_density: psi of the two discs of the contact alone; voronoi: k h/l, shared cell edge over "
          "centre distance. Bodies of a packing fall on uniform ones, and with others its assembly has no springs"),
      key("density", &S::density, unit("kg/m³"), positive,
          "density of the discs that these springs are for; calibrate writes it into a springs file"),
      key("kM", &S::bending, &B::kM, of_assemblies, unit("N"), not_negative,
          not_beside({"bond_width"}, "each says how stiff contacts are in bending"),
          "bending spring of every contact, N m/rad per metre of depth: the moment by the rotation of one disc against "
          "the other; left out: contacts carry no moments"),
      key("bond_width", &S::bending, &B::bond_width, of_assemblies, not_negative,
          "width w of a bond over the diameter of its smaller disc: contacts have kM = kN w²/12, the bending stiffness "
          "of a parallel bond")};
}

std::vector<Key<OfPair<SpringConstants>>> springs_between_keys() {
  using P = OfPair<SpringConstants>;
  std::vector<Key<P>> keys = pair_keys<SpringConstants>();
  keys.push_back(key("kN", &P::property, &SpringConstants::kN, required, unit("Pa"), positive, normal_spring));
  keys.push_back(key("kT", &P::property, &SpringConstants::kT, required, unit("Pa"), tangential_spring));
  return keys;
}

void resolve_springs_file(TomlValue& root, const std::filesystem::path& folder) {
  resolve_table_file(root, "springs", CaseKind::assembly, springs_keys(), folder);
}

void check_stable_in_motion(const TomlValue& root, const SpringConstants& springs) {
  if (springs.kT < 0)
    fail_at(*root.find("springs")->find("kT"), fmt::format("kT = {:.6g} Pa is negative", springs.kT),
            "no motion of the discs is stable with it", "Give springs with kT of 0 or more");
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
          *root.find(other.table)->find("density"),
          fmt::format("it is {:.9g} kg/m³ here and {:.9g} kg/m³ in [{}]", *other.value, *first->value, first->table),
          "both are the density of the discs themselves", "Remove one of them");
    }
  }
  return first != nullptr ? first->value : std::nullopt;
}

std::vector<Key<StrengthOptions>> strength_keys(CaseKind kind) {
  using S = StrengthOptions;
  const auto of_assemblies = only_in({CaseKind::assembly});
  std::vector<std::string> lengths = names_of<BondLength>();
  std::vector<std::string> after{"gone", "frictional"};
  const bool collide = kind == CaseKind::colliding;
  if (collide) std::erase(lengths, to_string(BondLength::facet)), after = {"frictional", "parallel"};
  return {key("tension", &S::tension, unit(unit_of_strength), not_negative, strengths_of_contact),
          key("shear", &S::shear, unit(unit_of_strength), not_negative, strengths_of_contact),
          key("friction", &S::friction, not_negative, "by how much compression adds to the strength in shear"),
          key("bond_length", &S::bond_length, choices(lengths),
              "the length by which strengths in Pa are multiplied: the edge that the cells of both discs share, or "
              "the diameter of the smaller disc; none: strengths are forces"),
          key("weibull_modulus", &S::weibull_modulus, positive,
              "m: a share exp(-x^m) of the contacts is more than x times as strong as given; left out: all are "
              "equal"),
          key("seed", &S::seed, not_negative, "of the strengths: same seed, same strengths"),
          key(
              "after_breaking", &S::after_breaking, choices(after),
              [&](KeySpec& key) {
                if (collide) optional(key);
              },
              "gone: a broken contact carries nothing; frictional: it opens, closes, sticks and slips. Contacts whose "
              "strengths are both 0 are then no bonds from the start. Colliding bodies: frictional (default): discs "
              "touch once their bond has broken; parallel: from the start, beside the bond"),
          key("residual_friction", &S::residual_friction, of_assemblies, not_negative,
              when("after_breaking", {"frictional"}),
              "coefficient of friction of contacts without a bond, where they are frictional; left out: friction")};
}

std::vector<Key<OfPair<PairStrengths>>> strength_between_keys() {
  using P = OfPair<PairStrengths>;
  std::vector<Key<P>> keys = pair_keys<PairStrengths>();
  keys.push_back(key("tension", &P::property, &PairStrengths::tension, required, unit(unit_of_strength), not_negative,
                     strengths_of_contact));
  keys.push_back(key("shear", &P::property, &PairStrengths::shear, required, unit(unit_of_strength), not_negative,
                     strengths_of_contact));
  return keys;
}

std::vector<Key<StrengthTargetCase>> strength_target_keys() {
  using T = StrengthTargetCase;
  using W = StrengthTargets;
  using O = StrengthTestOptions;
  return {
      key("tensile", &T::wanted, &W::tensile, required, unit("Pa"), positive, "strength in tension"),
      key("compressive", &T::wanted, &W::compressive, unit("Pa"), positive,
          or_instead({"toughness"}, "one of them goes with the strength in tension"),
          "unconfined compressive strength"),
      key("toughness", &T::wanted, &W::toughness, unit("Pa sqrt(m)"), positive,
          "K_Ic of samples with a notch in the middle, the mean over notches"),
      key("notches", &T::wanted, &W::notches, unit("m"), only_with({"toughness"}, "it is read off notched samples"),
          "their lengths 2a, across the axis, each below the width of the sample"),
      key("samples", &T::samples, from(1, 1e4),
          "samples from the seeds s, s + 1, ... of the assembly and of the strengths; one where neither is random"),
      key("shear_over_tension", &T::shear_over_tension, positive,
          "f_s/f_t of the contacts: the friction is found, and not given in [strength]; left out: f_s is found, with "
          "the friction of [strength]"),
      key("axis", &T::test, &O::axis, "direction of both tests: between left and right, or bottom and top"),
      key("ends", &T::test, &O::ends,
          "of the samples; frictionless: free to slide along the plates, the usual setting of unconfined tests of "
          "bonded discs; glued: held"),
      key("fallen_to", &T::test, &O::fallen_to, between(0, 1),
          "a test is over where the load has fallen to this share of its peak")};
}

void resolve_strength_file(TomlValue& root, const std::filesystem::path& folder, CaseKind kind) {
  resolve_table_file(root, "strength", kind, strength_keys(kind), folder);
}

void check_strength_target(const TomlValue& root) {
  const TomlValue* target = root.find("strength_target");
  if (target == nullptr) return;
  const TomlValue* strength = root.find("strength");
  if (strength == nullptr) return;
  for (const char* name : {"tension", "shear", "between"}) {
    if (const TomlValue* given = strength->find(name); given != nullptr)
      fail_at(*given, "it is given beside [strength_target]",
              "calibrate looks for it; friction, bond_length and weibull_modulus of [strength] are kept",
              "Remove one of them");
  }
  // The default, 0, is in the case that a calibration writes.
  const TomlValue* friction = strength->find("friction");
  if (friction != nullptr && friction->real != 0 && target->find("shear_over_tension") != nullptr)
    fail_at(*friction, "it is given beside strength_target.shear_over_tension",
            "calibrate looks for the friction where f_s/f_t is given", "Remove one of them");
  if (const TomlValue* given = strength->find("after_breaking"); given != nullptr && given->text == "frictional")
    fail_at(*given, "\"frictional\" is given beside [strength_target]",
            "calibrate finds strengths of contacts that carry nothing once they are broken", "Remove it");
}

}  // namespace equidem::casefile

namespace equidem {

std::string springs_file(const SpringConstants& springs, SpringWeighting weighting, std::optional<double> density,
                         std::optional<double> bond_width, const std::string& title, const std::string& comment) {
  std::string out = casefile::head_of_file("springs", title, comment);
  out += fmt::format("kN = {}\nkT = {}\nweighting = {}\n", toml_number(springs.kN), toml_number(springs.kT),
                     toml_text(to_string(weighting)));
  if (bond_width) out += fmt::format("bond_width = {}\n", toml_number(*bond_width));
  if (density) out += fmt::format("density = {}\n", toml_number(*density));
  return out;
}

std::string strength_file(const StrengthOptions& strengths, const std::string& title, const std::string& comment) {
  std::string out = casefile::head_of_file("strength", title, comment);
  out += fmt::format("tension = {}\nshear = {}\nfriction = {}\n", toml_number(*strengths.tension),
                     toml_number(*strengths.shear), toml_number(strengths.friction));
  out += fmt::format("bond_length = {}\nseed = {}\n", toml_text(to_string(strengths.bond_length)), strengths.seed);
  if (strengths.weibull_modulus) out += fmt::format("weibull_modulus = {}\n", toml_number(*strengths.weibull_modulus));
  return out;
}

}  // namespace equidem
