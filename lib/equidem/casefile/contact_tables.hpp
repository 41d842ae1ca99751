// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [springs] and [strength] of a case, or the springs file (schema "equidem-springs/1") and the strength file (schema
/// "equidem-strength/1") that stand in their place: `springs = "FILE"`; and [strength_target].
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "equidem/breakage/calibrate/calibrate_strength.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/materials.hpp"
#include "equidem/core/text.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

/// A springs file, which `springs = "FILE"` of a case file names; it reads back to the same bits.
/// \param comment lines for people at the top of the file, may be empty
/// \param density kg/m³, of the discs; none: not written
/// \param bond_width as BendingOptions; none: not written
std::string springs_file(const SpringConstants& springs, SpringWeighting weighting, std::optional<double> density,
                         std::optional<double> bond_width, const std::string& title, const std::string& comment);

/// [strength_target]: strengths of the material, for which calibrate finds those of the contacts.
struct StrengthTargetCase {
  StrengthTargets wanted;
  StrengthTestOptions test;
  std::optional<double> shear_over_tension;
  std::int64_t samples = 5;
};

/// A strength file, which `strength = "FILE"` of a case file names; it reads back to the same bits.
/// \param strengths with tension and shear
/// \param comment lines for people at the top of the file
std::string strength_file(const StrengthOptions& strengths, const std::string& title, const std::string& comment);

}  // namespace equidem

namespace equidem::casefile {

/// Binds `TABLE = "FILE"` at the top of a case file.
template <class F>
void bind_table_file(File<F>& file, const char* table) {
  file.table("").keys({unbound_key<F>(
      table, KeyType::path, fmt::format("a {0} file, as calibrate writes it, in place of the table [{0}]", table))});
}

/// [springs]. Of a packing kN and kT, or the other two.
struct SpringsTable {
  SpringConstants constants;                              ///< Pa, before weighting
  std::optional<double> shear_wave_speed, poisson_ratio;  ///< m/s, -
  SpringWeighting weighting = SpringWeighting::uniform;
  std::optional<double> density;  ///< kg/m³, of the discs that these springs are for
  BendingOptions bending;
};

std::vector<Key<SpringsTable>> springs_keys();

/// Binds [springs], and the name of a file in its place.
template <class F, class... Arguments>
void bind_springs(File<F>& file, Arguments... arguments) {
  bind_table_file(file, "springs");
  file.table(
          "springs", arguments...,
          "the springs of a contact; of colliding bodies those of all contacts, with walls too, instead of stiffness "
          "and tangential_ratio")
      .keys(springs_keys());
}

std::vector<Key<OfPair<SpringConstants>>> springs_between_keys();

/// Binds [[springs.between]].
template <class F, class Link>
void bind_springs_between(File<F>& file, Link between) {
  file.table(
          "springs.between", between, like("springs"),
          "springs of the contacts of two groups, or inside one. A pair that is not named has those of half a contact "
          "of each in series, 2 a b/(a + b); contacts inside a group that is not named, or of discs without a group, "
          "have those of [springs]")
      .keys(springs_between_keys());
}

/// The table of a springs file takes the place of its name.
/// \throws Error (bad_input) with file, line and key: a file that cannot be read, or is of another format
void resolve_springs_file(TomlValue& root, const std::filesystem::path& folder);

/// \throws Error (bad_input) with the line of [springs]: a negative kT, with which no motion is stable
void check_stable_in_motion(const TomlValue& root, const SpringConstants& springs);

/// Density of the discs as one table states it.
struct StatedDensity {
  const char* table;
  std::optional<double> value;  ///< kg/m³
};

/// The density that the tables state; none where none does.
/// \throws Error (bad_input) where two of them differ by more than 1e-6
std::optional<double> one_density(const TomlValue& root, std::initializer_list<StatedDensity> stated);

/// \param kind of the case: without a bond colliding bodies are always frictional, and have no facets
std::vector<Key<StrengthOptions>> strength_keys(CaseKind kind);
std::vector<Key<StrengthTargetCase>> strength_target_keys();

/// Binds [strength], and the name of a file in its place.
template <class F, class Link>
void bind_strength(File<F>& file, Link strength) {
  bind_table_file(file, "strength");
  file.table("strength", strength,
             "strengths of the contacts, for quasistatic and calibrate, or of the bonds of colliding bodies, which "
             "without them never break")
      .keys(strength_keys(file.spec().kind));
}

std::vector<Key<OfPair<PairStrengths>>> strength_between_keys();

/// Binds [[strength.between]].
template <class F, class Link>
void bind_strength_between(File<F>& file, Link between) {
  file.table("strength.between", between, like("strength"),
             "strengths of the contacts of two groups, or inside one; a pair that is not named has the smaller ones of "
             "both")
      .keys(strength_between_keys());
}

/// The table of a strength file takes the place of its name.
/// \param kind of the case, whose keys the file may have
/// \throws Error (bad_input) as resolve_springs_file
void resolve_strength_file(TomlValue& root, const std::filesystem::path& folder, CaseKind kind);

/// \throws Error (bad_input) with the line: strengths of contacts beside [strength_target], which asks for them
void check_strength_target(const TomlValue& root);

}  // namespace equidem::casefile
