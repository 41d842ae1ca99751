// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The graph of an assembly: the contacts of each disc, and its connected pieces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"

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

}  // namespace equidem
