// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Ways around a contact that broke, over what is left of a network.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/linear/contact_graph.hpp"

namespace equidem {

class DisjointWays {
 public:
  /// All must outlive the object. \param broken per contact, `left` per disc, 1: no way goes there
  DisjointWays(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
               const std::vector<std::uint8_t>& broken, const std::vector<std::uint8_t>& left)
      : assembly_(assembly),
        graph_(graph),
        springs_(springs),
        broken_(broken),
        left_(left),
        reached_(2 * assembly.size(), none),
        place_(assembly.size(), none) {}

  /// True where the network stays biconnected without this contact: no disc becomes idle, and no part is joined by one
  /// contact or disc that was not so before, since the other contacts of its discs can carry forces, and two ways that
  /// share nothing join them. False: nothing is found.
  [[nodiscard]] bool around(std::size_t contact);

 private:
  [[nodiscard]] bool carries_on(const ContactGraph::Incidence& edge) const {
    return broken_[edge.contact] == 0 && left_[edge.other] == 0;
  }
  /// Whether the contacts that a disc has left admit forces in balance: more than two do, and two do where both resist
  /// slip at a point on the line of centres (statics/load_bearing.cpp).
  [[nodiscard]] bool carries(std::int32_t disc) const;
  static constexpr std::int32_t none = -1;
  /// A disc as a search reaches it.
  struct Step {
    std::int32_t disc, before, contact;  ///< step before; contact by which it was reached
    std::int32_t shift_x, shift_y;       ///< of its image, periods
    bool backwards;                      ///< along the first way, towards its begin
  };
  /// The first way between the ends of a contact, which is kept, or whether there is a second one; in a periodic cell
  /// to the image of j that the contact joins to i.
  bool finds_way(const Contact& gone);
  void keep(const Step& last);

  const Assembly& assembly_;
  const ContactGraph& graph_;
  const ContactSprings& springs_;
  const std::vector<std::uint8_t>&broken_, &left_;
  std::vector<Step> steps_, way_;              // of a search; the first way from i to j
  std::vector<std::int32_t> reached_, place_;  // per disc: steps, forwards and backwards; index in way_
};

}  // namespace equidem
