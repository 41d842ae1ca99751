// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/contact_graph.hpp"

namespace equidem {

ContactGraph::ContactGraph(const Assembly& assembly) : first_(assembly.size() + 1, 0) {
  const auto& contacts = assembly.contacts;
  for (const Contact& c : contacts) {
    ++first_[c.i + 1];
    if (c.j != c.i) ++first_[c.j + 1];
  }
  for (std::size_t d = 0; d < assembly.size(); ++d) first_[d + 1] += first_[d];
  incidences_.resize(first_.back());
  std::vector<std::int64_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Contact& c = contacts[k];
    incidences_[next[c.i]++] = {c.j, static_cast<std::int32_t>(k)};
    if (c.j != c.i) incidences_[next[c.j]++] = {c.i, static_cast<std::int32_t>(k)};
  }
}

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
