// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The strengths of contacts that break in a brittle way, and notches: contacts that are cut before anything is loaded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/materials.hpp"
#include "equidem/core/names.hpp"

namespace equidem {

/// The length by which strengths that are given as stresses are multiplied.
enum class BondLength {
  none,              ///< strengths are forces, N/m
  facet,             ///< the edge that the cells of both discs share
  smaller_diameter,  ///< the diameter of the smaller disc
};

template <>
struct EnumNames<BondLength> {
  using enum BondLength;
  static constexpr const char* what = "length of a bond";
  static constexpr NamedValue<BondLength> list[] = {
      {none, "none"}, {facet, "facet"}, {smaller_diameter, "smaller_diameter"}};
};

/// The behaviour of a contact without a bond.
enum class AfterBreaking {
  gone,        ///< it carries nothing
  frictional,  ///< it opens, closes, sticks and slips
  parallel,    ///< of bodies that collide: so it does beside the bond too, from the start
};

template <>
struct EnumNames<AfterBreaking> {
  using enum AfterBreaking;
  static constexpr const char* what = "behaviour of broken contacts";
  static constexpr NamedValue<AfterBreaking> list[] = {
      {gone, "gone"}, {frictional, "frictional"}, {parallel, "parallel"}};
};

/// Strengths of the contacts of two groups.
struct PairStrengths {
  double tension = 0, shear = 0;  ///< >= 0, N/m; with a bond length Pa
};

struct StrengthOptions {
  std::optional<double> tension = {};  ///< f_t >= 0, N/m; with a bond length Pa
  std::optional<double> shear = {};    ///< f_s >= 0, likewise
  double friction = 0;                 ///< mu >= 0
  BondLength bond_length = BondLength::none;
  /// m > 0 of the distribution of Weibull, by which both strengths of a contact are multiplied: a share exp(-x^m) of
  /// the contacts is more than x times as strong as given. None: all are equal.
  std::optional<double> weibull_modulus = {};
  std::uint64_t seed = 1;
  AfterBreaking after_breaking = AfterBreaking::gone;
  /// mu >= 0 of contacts without a bond, where they are frictional. None: `friction`.
  std::optional<double> residual_friction = {};
  /// Pairs of groups have strengths of their own; one that is not named is as strong as the weaker inside of either.
  std::vector<OfPair<PairStrengths>> between = {};
};

/// A contact with the forces N (tension positive) and T breaks in tension where N >= tension, in shear where |T| >=
/// shear - friction N.
struct ContactStrengths {
  std::vector<double> tension;  ///< N/m, per contact
  std::vector<double> shear;    ///< N/m, per contact
  double friction = 0;
  bool beside_contact = false;  ///< bodies that collide: bonded discs touch as others do, and go on when it has broken
};

/// Strengths of the assembly itself, where it has some, are taken as they are.
/// \throws Error (bad_input) where neither the options nor the assembly give strengths, where both do, where a number
///         is out of range, where facets are asked for and not known, or as Materials
ContactStrengths contact_strengths(const Assembly& assembly, const StrengthOptions& options);

/// A straight cut.
struct Notch {
  Vec2 from, to;  ///< m
};

/// The contacts whose branch a notch crosses, also those across a period, ascending.
/// \throws Error (bad_input) where a notch is not finite, or crosses none
std::vector<std::size_t> contacts_across(const Assembly& assembly, std::span<const Notch> notches);

}  // namespace equidem
