// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The next contact to break in a network as it is.
///
/// With forces N0 + lambda N1, T0 + lambda T1 the criteria of a contact are linear in lambda:
///
///   tension   N - f_t >= 0
///   shear     +-T + mu N - f_s >= 0
///
/// Seen from a value lambda_0 in the direction of a leg, a criterion a + b t >= 0 with lambda = lambda_0 +- t, t >= 0,
/// is met first at
///
///   t = 0      where a > 0, or a = 0 and b >= 0: it is met at lambda_0 itself (b of whatever sign: on from there, or
///              only there)
///   t = -a/b   where a < 0 and b > 0, or never where b <= 0
///
/// A path without control has lambda_0 = 0 in every network: each network is loaded anew from its dead loads, and a
/// contact that they alone break does so at lambda = 0. Under control lambda_0 is where the control holds the network;
/// of several contacts that are beyond their strength there, that goes first which reached it at the least load.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "equidem/breakage/strengths.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/names.hpp"

namespace equidem {

/// The value and the direction of lambda from which the next break is sought.
struct LoadFactorSearch {
  double from = 0;             ///< lambda_0
  double direction = 1;        ///< of lambda, 1 or -1
  bool by_least_load = false;  ///< order of contacts that are beyond their strength at `from`; false: their numbers
  /// N/m of live and dead forces, below which a component is round-off and counts as 0. A contact that carries no force
  /// does not break, whatever its strength. Negative: no component is cut.
  double no_live = -1, no_dead = -1;
};

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

/// The first of the keys that tie for the least, the number of the others, and the least key beyond them.
struct TiedKeys {
  std::size_t first = 0;
  std::int64_t others = -1;
  double beyond = std::numeric_limits<double>::infinity();
};
/// \param tied the largest key that ties
TiedKeys tied_keys(std::span<const double> keys, double tied);

/// The contact that breaks next, of ties that of least number. Contacts with the forces 0 are taken as removed.
/// \return none where no contact breaks
/// \param pattern N/m, at lambda = 1, without dead loads
/// \param dead N/m; empty: none
std::optional<NextBreak> next_break(std::span<const ContactForce> pattern, std::span<const ContactForce> dead,
                                    const ContactStrengths& strengths, const LoadFactorSearch& search);

}  // namespace equidem
