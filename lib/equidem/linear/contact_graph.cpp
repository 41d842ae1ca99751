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

std::vector<std::int32_t> ContactGraph::pieces() const {
  std::vector<std::int32_t> piece(size(), -1);
  std::vector<std::int32_t> open;
  std::int32_t count = 0;
  for (std::size_t start = 0; start < size(); ++start) {
    if (piece[start] >= 0) continue;
    piece[start] = count;
    open.push_back(static_cast<std::int32_t>(start));
    while (!open.empty()) {
      const std::int32_t disc = open.back();
      open.pop_back();
      for (const Incidence& edge : of(disc)) {
        if (piece[edge.other] >= 0) continue;
        piece[edge.other] = count;
        open.push_back(edge.other);
      }
    }
    ++count;
  }
  return piece;
}

}  // namespace equidem
