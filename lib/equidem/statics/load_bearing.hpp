// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The part of a contact network that can carry load: what is left once rattlers, dangling discs and floating pieces
/// are taken out.
///
/// A disc or a group of discs on which no load acts is left out where its own equilibrium lets its contacts carry no
/// force under any motion of the rest (a disc is loaded where it is held; elsewhere loads come through contacts):
/// - a disc without contacts, or with a single one: its force has nothing to balance it;
/// - a disc with two contacts that are not in line, where slip is resisted at neither of them, or at one only and the
///   disc turns freely: the balance of moments leaves no tangential force, that of forces then no normal ones. Where
///   one of them carries moments it stays;
/// - what a single contact joins to the rest (dangling): no force can pass it;
/// - what a single disc joins to the rest (dangling): it can follow that disc rigidly, without energy where rotation is
///   restrained, kT = 0 or levers add up to their branch; elsewhere it stays;
/// - a connected piece that reaches neither an image of itself across the period nor a held disc (floating): it
///   follows no mean strain. With a free boundary and nothing held, pieces stay.
/// This is repeated for discs and groups that have become such. A contact of a disc with its own image carries force in
/// balance with itself, so that its disc stays. Where kT < 0, at a ratio where what is left out is itself at its limit
/// of stability, its state is not unique and zero is the one meant.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"

namespace equidem {

/// Discs that carry no load under any mean strain, and the network without them. Removing them changes no force.
struct LoadBearingNetwork {
  std::int64_t rattlers = 0;           ///< discs without contacts
  std::int64_t dangling = 0;           ///< discs whose contacts can carry no force
  std::int64_t floating = 0;           ///< discs of pieces that are joined to none of their images and to no held disc
  std::vector<std::string> sentences;  ///< "3 rattlers (disc 4 at (0.1, 0.2), ...) touch nothing and are left out", ...
  std::int64_t pieces = 0;             ///< connected pieces that are left
  /// Directions of the period (0, 1 or 2) in which the pieces left, taken together, are joined to their images; 2 with
  /// a free boundary.
  int spanned = 2;

  [[nodiscard]] std::int64_t removed() const { return rattlers + dangling + floating; }
  /// The network left, with discs, contacts and groups numbered anew; none where nothing is left out. Its period is
  /// that of the whole. With a free boundary its area() counts the cells of its own discs only: what is averaged over
  /// the sample divides by the area() of the whole assembly.
  struct Part {
    Assembly assembly;
    ContactSprings springs;
    std::vector<std::int32_t> discs;     ///< of the whole assembly, ascending
    std::vector<std::int32_t> contacts;  ///< likewise
  };
  std::optional<Part> part;
};

/// The discs to leave out.
enum class LeaveOut {
  unloaded,  ///< all that carries no force, as above
  /// only those that no contact holds in place under loads: rattlers, floating pieces, and what a single contact
  /// joins to the rest that lets it turn or slide (rotation is free, or its kT = 0), and, where rotation is free,
  /// neighbours with two contacts each that are not in line. Motions of most others are determined.
  loose,
};

/// In a time proportional to the contacts (once more for every time that leaving out discs with two contacts lets
/// others dangle).
/// \param held per disc, 1: held or loaded from outside, never left out (a sample between boundaries); empty: none
LoadBearingNetwork load_bearing_network(const Assembly& assembly, const ContactSprings& springs, const Effects& effects,
                                        const std::vector<std::uint8_t>& held = {},
                                        LeaveOut which = LeaveOut::unloaded);

}  // namespace equidem
