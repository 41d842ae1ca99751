// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/rigid_growth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "equidem/core/statistics.hpp"

namespace equidem {
namespace {

class RigidGrowth {
 public:
  RigidGrowth(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs, bool pinned)
      : assembly_(assembly), graph_(graph), springs_(springs), pinned_(pinned), discs_(assembly.size()) {}

  bool covers_pieces() {
    for (std::size_t d = 0; d < discs_.size(); ++d) {
      if (discs_[d].cluster < 0) grow_from(static_cast<std::int32_t>(d));
    }
    constexpr std::size_t contacts_at_once = 1 << 14;
    return sums_over<1>(assembly_.contacts.size(), contacts_at_once, [&](std::size_t begin, std::size_t end) {
             const auto inside = [&](const Contact& c) {
               return discs_[c.i].cluster >= 0 && discs_[c.i].cluster == discs_[c.j].cluster;
             };
             const auto first = assembly_.contacts.begin();
             const bool all = std::all_of(first + static_cast<std::ptrdiff_t>(begin),
                                          first + static_cast<std::ptrdiff_t>(end), inside);
             return std::array{all ? 0.0 : 1.0};
           })[0] == 0;
  }

 private:
  /// The image of a disc in a cluster that is laid out as one: rigid motions do not repeat with the period.
  struct Image {
    std::int32_t x = 0, y = 0;
    bool operator==(const Image&) const = default;
  };
  struct Disc {
    std::int32_t cluster = -1;
    std::int32_t touches = -1;  ///< the cluster that it touches once
    Image image;                ///< in either
    Vec2 normal;                ///< of that contact
  };
  struct Neighbour {
    std::int32_t disc;
    Image image;
    Vec2 direction;
  };

  /// The other end of a contact seen from the image of a disc.
  [[nodiscard]] Neighbour across(std::int32_t disc, Image image, const ContactGraph::Incidence& edge) const {
    const Contact& c = assembly_.contacts[edge.contact];
    const int sign = c.i == disc ? 1 : -1;
    return {edge.other, {image.x + sign * c.shift_x, image.y + sign * c.shift_y}, sign * assembly_.branch(c)};
  }
  /// Bodies that turn are held together at a contact by both springs, and away from their centres.
  [[nodiscard]] bool joins(const ContactGraph::Incidence& edge) const {
    const Contact& c = assembly_.contacts[edge.contact];
    return c.i != c.j && (!pinned_ || (springs_[edge.contact].kT > 0 && c.lever_i > 0 && c.lever_j > 0));
  }
  [[nodiscard]] static bool apart(Vec2 a, Vec2 b) {
    constexpr double least = 0.05;  // sine of the angle
    return std::abs(cross(a, b)) > least * norm(a) * norm(b);
  }

  void grow_from(std::int32_t start) {
    for (const auto& to_a : graph_.of(start)) {
      if (!joins(to_a)) continue;
      const Neighbour a = across(start, {}, to_a);
      for (const auto& to_b : graph_.of(a.disc)) {
        if (!joins(to_b)) continue;
        const Neighbour b = across(a.disc, a.image, to_b);
        if (b.disc == start || !apart(a.direction, b.direction)) continue;
        for (const auto& back : graph_.of(start)) {
          const Neighbour other = across(start, {}, back);
          if (other.disc != b.disc || other.image != b.image || !joins(back)) continue;
          if (std::max(discs_[a.disc].cluster, discs_[b.disc].cluster) >= 0) return;  // a part of the piece stays out
          grow({{start, {}, {}}, a, b});
          return;
        }
      }
    }
  }

  void grow(std::vector<Neighbour> members) {
    const std::int32_t cluster = clusters_++;
    for (const Neighbour& m : members) discs_[m.disc] = {cluster, cluster, m.image, {}};
    while (!members.empty()) {  // the last one first: its neighbours are near in memory
      const auto [here, image, direction] = members.back();
      members.pop_back();
      for (const auto& edge : graph_.of(here)) {
        Disc& disc = discs_[edge.other];
        if (disc.cluster >= 0 || !joins(edge)) continue;
        const Neighbour n = across(here, image, edge);
        if (disc.touches != cluster) {
          disc = {-1, cluster, n.image, n.direction};
        } else if (disc.image == n.image && apart(disc.normal, n.direction)) {
          disc.cluster = cluster;
          members.push_back(n);
        }
      }
    }
  }

  const Assembly& assembly_;
  const ContactGraph& graph_;
  const ContactSprings& springs_;
  bool pinned_;
  std::vector<Disc> discs_;
  std::int32_t clusters_ = 0;
};

}  // namespace

bool grows_rigid(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs, int per_disc) {
  if (!assembly.contact_arms.empty()) return false;
  return RigidGrowth(assembly, graph, springs, per_disc == 3).covers_pieces();
}

}  // namespace equidem
