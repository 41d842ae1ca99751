// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The connected pieces of an assembly, each laid out as one cluster even where contacts cross the period.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/linear/contact_graph.hpp"

namespace equidem {

struct UnwrappedPieces {
  std::vector<std::int32_t> piece;  ///< per disc, as ContactGraph::pieces() numbers them
  std::vector<Vec2> centres;        ///< m, per disc: of the image that contacts join to the piece's first disc
  std::vector<std::uint8_t> winds;  ///< per piece: 1 where it meets an image of itself across the period

  [[nodiscard]] std::size_t count() const { return winds.size(); }
};

UnwrappedPieces unwrap_pieces(const Assembly& assembly, const ContactGraph& graph);

}  // namespace equidem
