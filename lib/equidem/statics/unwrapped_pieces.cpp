// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/unwrapped_pieces.hpp"

namespace equidem {

UnwrappedPieces unwrap_pieces(const Assembly& assembly, const ContactGraph& graph) {
  struct Image {
    std::int32_t x = 0;
    std::int32_t y = 0;
    bool operator==(const Image&) const = default;
  };
  const std::size_t n = assembly.size();
  UnwrappedPieces result{std::vector<std::int32_t>(n, -1), assembly.centres, {}};
  std::vector<Image> image(n);
  std::vector<std::int32_t> reached;
  for (std::size_t start = 0; start < n; ++start) {
    if (result.piece[start] >= 0) continue;
    const auto number = static_cast<std::int32_t>(result.winds.size());
    std::uint8_t winds = 0;
    result.piece[start] = number;
    reached.assign(1, static_cast<std::int32_t>(start));
    for (std::size_t next = 0; next < reached.size(); ++next) {
      const std::int32_t i = reached[next];
      for (const auto& edge : graph.of(i)) {
        const Contact& c = assembly.contacts[edge.contact];
        const int sign = c.i == i ? 1 : -1;
        const Image there{image[i].x + sign * c.shift_x, image[i].y + sign * c.shift_y};
        if (result.piece[edge.other] >= 0) {
          if (image[edge.other] != there) winds = 1;
          continue;
        }
        result.piece[edge.other] = number;
        image[edge.other] = there;
        if (assembly.period) {
          result.centres[edge.other] += {there.x * assembly.period->x, there.y * assembly.period->y};
        }
        reached.push_back(edge.other);
      }
    }
    result.winds.push_back(winds);
  }
  return result;
}

}  // namespace equidem
