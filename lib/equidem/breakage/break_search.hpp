// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The next contact to break in a network as it is (statics/breaking/least_load_factor.hpp has the rules).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "equidem/breakage/strengths.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/names.hpp"
#include "equidem/statics/breaking/least_load_factor.hpp"

namespace equidem {

/// A bond breaks in tension, in shear or in bending; contacts without a bond open, close, slip and stick.
enum class BreakMode { tension, shear, open, close, slip, stick, bending };

template <>
struct EnumNames<BreakMode> {
  using enum BreakMode;
  static constexpr const char* what = "mode of breaking";
  static constexpr NamedValue<BreakMode> list[] = {{tension, "tension"}, {shear, "shear"}, {open, "open"},
                                                   {close, "close"},     {slip, "slip"},   {stick, "stick"},
                                                   {bending, "bending"}};
};

struct NextBreak {
  double lambda = 0;
  std::size_t contact = 0;
  BreakMode mode = BreakMode::tension;
  std::int64_t ties = 0;  ///< other contacts that break at the same lambda, to 1e-10: the first number goes first
  double gap = 0;         ///< of lambda, relative, to the next contact that does not tie; infinite: none
};

/// \return none where no contact breaks
std::optional<NextBreak> next_break_of(const FirstToBreak& first, const LoadFactorSearch& search);

/// In a time proportional to the contacts. Contacts with the forces 0 are taken as removed.
/// \param pattern N/m, at lambda = 1, without dead loads
/// \param dead N/m; empty: none
std::optional<NextBreak> next_break(std::span<const ContactForce> pattern, std::span<const ContactForce> dead,
                                    const ContactStrengths& strengths, const LoadFactorSearch& search);

}  // namespace equidem
