// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/strength_tables.hpp"

#include "equidem/casefile/engine/table_file.hpp"
#include "equidem/casefile/engine/value.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {
namespace {

struct StrengthFile : CaseDocument {
  StrengthOptions strength;
};

constexpr const char* strength_schema = "equidem-strength/1";

}  // namespace

std::vector<Key<StrengthOptions>> strength_keys() {
  using S = StrengthOptions;
  return {key("tension", &S::tension, unit("N/m (with bond_length: Pa)"), not_negative,
              "a contact breaks where its normal force reaches it; left out: the assembly gives strengths"),
          key("shear", &S::shear, unit("N/m (with bond_length: Pa)"), not_negative,
              "a contact breaks where |T| reaches shear - friction N, N positive in tension"),
          key("friction", &S::friction, not_negative, "by how much compression adds to the strength in shear"),
          key("bond_length", &S::bond_length,
              "the length by which strengths in Pa are multiplied: the edge that the cells of both discs share, or "
              "the diameter of the smaller disc; none: strengths are forces"),
          key("weibull_modulus", &S::weibull_modulus, positive,
              "m: a share exp(-x^m) of the contacts is more than x times as strong as given; left out: all are "
              "equal"),
          key("seed", &S::seed, not_negative, "of the strengths: same seed, same strengths"),
          key("after_breaking", &S::after_breaking,
              "gone: a broken contact carries nothing; rubs: it opens, closes, sticks and slips. Contacts whose "
              "strengths are both 0 are then no bonds from the start"),
          key("residual_friction", &S::residual_friction, not_negative, when("after_breaking", {"rubs"}),
              "coefficient of friction of contacts without a bond, where they rub; left out: friction")};
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

void resolve_strength_file(TomlValue& root, const std::filesystem::path& folder,
                           std::vector<Key<StrengthOptions>> keys) {
  File<StrengthFile> file(strength_schema, "strength file");
  file.table("strength", &StrengthFile::strength, required, "strengths of the contacts").keys(std::move(keys));
  resolve_table_file(root, "strength", file, folder);
}

void check_strength_target(const TomlValue& root) {
  const TomlValue* target = root.find("strength_target");
  if (target == nullptr) return;
  const TomlValue* strength = root.find("strength");
  if (strength == nullptr) return;
  for (const char* name : {"tension", "shear"}) {
    if (const TomlValue* given = strength->find(name); given != nullptr)
      fail_at(*given, fmt::format("strength.{}", name), "it is given beside [strength_target]",
              "calibrate looks for it; friction, bond_length and weibull_modulus of [strength] are kept",
              "Remove one of them");
  }
  // The default, 0, is in the case that a calibration writes.
  const TomlValue* friction = strength->find("friction");
  if (friction != nullptr && friction->real != 0 && target->find("shear_over_tension") != nullptr)
    fail_at(*friction, "strength.friction", "it is given beside strength_target.shear_over_tension",
            "calibrate looks for the friction where f_s/f_t is given", "Remove one of them");
  if (const TomlValue* given = strength->find("after_breaking"); given != nullptr && given->text == "rubs")
    fail_at(*given, "strength.after_breaking", "\"rubs\" is given beside [strength_target]",
            "calibrate finds strengths of contacts that carry nothing once they are broken", "Remove it");
}

}  // namespace equidem::casefile

namespace equidem {

std::string strength_file(const StrengthOptions& strengths, const std::string& title, const std::string& comment) {
  std::string out = casefile::comment_lines(comment);
  out += fmt::format("schema = \"{}\"\ntitle = {}\n\n[strength]\ntension = {}\nshear = {}\nfriction = {}\n",
                     casefile::strength_schema, toml_text(title), toml_number(*strengths.tension),
                     toml_number(*strengths.shear), toml_number(strengths.friction));
  out += fmt::format("bond_length = {}\nseed = {}\n", toml_text(to_string(strengths.bond_length)), strengths.seed);
  if (strengths.weibull_modulus) out += fmt::format("weibull_modulus = {}\n", toml_number(*strengths.weibull_modulus));
  return out;
}

}  // namespace equidem
