// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The graph of discs and contacts with its unknowns and springs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"

namespace equidem {

/// Compressed lists of the contacts of every disc. A contact of a disc with an image of itself is listed once.
class ContactGraph {
 public:
  /// One contact seen from a disc.
  struct Incidence {
    std::int32_t other;    ///< the disc at the other end
    std::int32_t contact;  ///< index into Assembly::contacts
  };

  explicit ContactGraph(const Assembly& assembly);

  [[nodiscard]] std::size_t size() const { return first_.size() - 1; }
  /// In ascending order of the contact index.
  [[nodiscard]] std::span<const Incidence> of(std::size_t disc) const {
    return {incidences_.data() + first_[disc], incidences_.data() + first_[disc + 1]};
  }

 private:
  std::vector<std::int64_t> first_;
  std::vector<Incidence> incidences_;
};

/// The connected pieces of an assembly, each laid out as one cluster even where contacts cross the period.
struct UnwrappedPieces {
  std::vector<std::int32_t> piece;  ///< per disc: pieces are numbered from 0 in the order of their first disc
  std::vector<Vec2> centres;        ///< m, per disc: of the image that contacts join to the piece's first disc
  std::vector<std::uint8_t> winds;  ///< per piece: 1 where it meets an image of itself across the period

  [[nodiscard]] std::size_t count() const { return winds.size(); }
};

UnwrappedPieces unwrap_pieces(const Assembly& assembly, const ContactGraph& graph);

/// Which components of the motion of each disc are unknown. Held components keep their place in blocks, so that
/// blocks stay whole: their rows are those of a unit matrix (elimination without renumbering).
struct DegreesOfFreedom {
  int per_disc = 2;           ///< 2: (u_x, u_y); 3: (u_x, u_y, a theta)
  double rotation_scale = 1;  ///< a, m: the mean radius
  /// Why a component is no unknown: `supported`, its motion is prescribed; `without_stiffness`, no contact resists it.
  static constexpr std::uint8_t free = 0, supported = 1, without_stiffness = 2;
  std::vector<std::uint8_t> held;  ///< per component (disc * per_disc + k): one of the above
  std::vector<double> prescribed;  ///< m, per component: the value where held, else 0
  std::int64_t unknowns = 0;
  std::int64_t free_rotations = 0;  ///< unknowns that are rotations
  std::int64_t rotations_without_stiffness =
      0;  ///< rotations that no contact resists: held at 0, without effect on the result
};

/// Components of a disc that are no unknowns do not deform its contacts.
inline void hold_end(const DegreesOfFreedom& unknowns, std::int32_t disc, EndGradient& end) {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  for (std::size_t k = 0; k < 3; ++k) {
    if (k < b && unknowns.held[static_cast<std::size_t>(disc) * b + k] == 0) continue;
    end.normal[k] = end.tangential[k] = 0;
    if (k == 2) end.turns = {};
  }
}

/// Discs, contacts, springs and unknowns, from which forces are evaluated.
struct SpringNetwork {
  const Assembly& assembly;
  const ContactGraph& graph;
  const ContactSprings& springs;
  const DegreesOfFreedom& unknowns;
};

}  // namespace equidem
