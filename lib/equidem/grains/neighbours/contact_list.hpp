// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts in groups of eight for the vectorized loops, and how a list is found anew from the one before.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "equidem/grains/contacts/contact_effects.hpp"
#include "equidem/grains/neighbours/body_blocks.hpp"
#include "equidem/motion/lane_vector.hpp"

namespace equidem {

constexpr std::size_t lanes_of_pairs = 8;
using PairLanes = double[lanes_of_pairs];

/// Eight contacts; derived groups add their numbers, each a column of eight lanes.
struct alignas(64) ContactGroup {
  static constexpr std::int64_t apart = -1, unused = -2;
  std::int32_t i[lanes_of_pairs], j[lanes_of_pairs];
  /// First step of the contact, counted from 1 (Verlet schemes: from 0); `apart`: no contact; `unused`: no pair.
  std::int64_t since[lanes_of_pairs];
};

/// The contacts of a block of bodies, ordered by (i, j).
template <class Group>
struct GroupList {
  LaneVector<Group> groups;
  bool has_effects = false;            ///< which columns there are
  LaneVector<ContactEffects> effects;  ///< of the groups
  std::size_t count = 0;
  OutwardImpulses outward;
  std::size_t first_outward = 0;  ///< first group with a body of a later block

  [[nodiscard]] Group& group(std::size_t p) { return groups[p / lanes_of_pairs]; }
  [[nodiscard]] const Group& group(std::size_t p) const { return groups[p / lanes_of_pairs]; }
  [[nodiscard]] std::int32_t first(std::size_t p) const { return group(p).i[p % lanes_of_pairs]; }
  [[nodiscard]] std::int32_t second(std::size_t p) const { return group(p).j[p % lanes_of_pairs]; }
  [[nodiscard]] std::int64_t& since(std::size_t p) { return group(p).since[p % lanes_of_pairs]; }
  [[nodiscard]] std::int64_t since(std::size_t p) const { return group(p).since[p % lanes_of_pairs]; }
  [[nodiscard]] bool touching(std::size_t p) const { return since(p) > ContactGroup::apart; }
  [[nodiscard]] ContactEffects& effects_of(std::size_t p) { return effects[p / lanes_of_pairs]; }
  [[nodiscard]] const ContactEffects& effects_of(std::size_t p) const { return effects[p / lanes_of_pairs]; }
  [[nodiscard]] std::size_t bytes() const {
    return groups.capacity() * sizeof(Group) + effects.capacity() * sizeof(ContactEffects) + outward.bytes();
  }

 protected:
  /// Room for contacts as in an earlier list.
  void make_room(const GroupList& before) {
    has_effects = before.has_effects;
    const std::size_t room = before.groups.size() + before.groups.size() / 16 + 8;
    groups.reserve(room);
    if (has_effects) effects.reserve(room);
    first_outward = std::numeric_limits<std::size_t>::max();
  }
  void add_columns() {
    groups.emplace_back();
    if (has_effects) effects.push_back({});
  }
  void copy_effects(const GroupList& other, std::size_t from, std::size_t to);
};

/// Copy a lane of all columns of eight numbers, from the given one on.
template <class Columns>
void copy_lane(const Columns& from, std::size_t from_lane, Columns& to, std::size_t to_lane, std::size_t first = 0) {
  static_assert(sizeof(Columns) % sizeof(PairLanes) == 0);
  const char* source = reinterpret_cast<const char*>(&from);
  char* target = reinterpret_cast<char*>(&to);
  for (std::size_t column = first * sizeof(PairLanes); column < sizeof(Columns); column += sizeof(PairLanes))
    std::memcpy(target + column + to_lane * sizeof(double), source + column + from_lane * sizeof(double),
                sizeof(double));
}

template <class Group>
void GroupList<Group>::copy_effects(const GroupList& other, std::size_t from, std::size_t to) {
  if (has_effects) copy_lane(other.effects_of(from), from % lanes_of_pairs, effects_of(to), to % lanes_of_pairs);
}

/// A list as it comes to be, from contacts of the list before and from new ones. The list has
///   List emptied()                    the list before, leaving an empty one with room for as many groups
///   void add_group()                  eight lanes that touch nothing
///   void copy(const List&, from, to)  all columns of a contact
template <class List>
class NewList {
 public:
  /// \param end of the bodies of the block; nothing() where j gets no impulse
  /// \param bodies of parts; null: j is a body
  NewList(List& list, std::size_t end, const std::vector<std::int32_t>* bodies)
      : list_(list), old_(list.emptied()), end_(static_cast<std::int32_t>(end)), bodies_(bodies) {}
  static constexpr std::size_t nothing() { return std::numeric_limits<std::int32_t>::max(); }

  /// Contacts stay until the loop has seen them end.
  void keep_contacts_before(std::int32_t i, std::int32_t j) {
    for (; at_ < old_.count && std::pair(old_.first(at_), old_.second(at_)) < std::pair(i, j); ++at_) {
      if (old_.touching(at_)) keep();
    }
  }
  /// Keep the contacts that were not found again.
  void keep_others() { keep_contacts_before(std::numeric_limits<std::int32_t>::max(), 0); }
  /// Advance to a pair; keep it if it is in contact. \return whether it is
  bool keep_contact(std::int32_t i, std::int32_t j) {
    keep_contacts_before(i, j);
    listed_ = at_ < old_.count && old_.first(at_) == i && old_.second(at_) == j;
    if (!listed_ || !old_.touching(at_)) return false;
    keep();
    ++at_;
    return true;
  }
  /// The place of this pair in the list before; old().count: it was not listed.
  [[nodiscard]] std::size_t place_before() const { return listed_ ? at_ : old_.count; }
  [[nodiscard]] const List& old() const { return old_; }
  /// For this pair, if it is apart: keep it where it is near. \return whether it was listed
  bool leave(bool near) {
    if (!listed_) return false;
    if (near) keep();
    ++at_;
    return true;
  }
  /// Room for a new contact. \return its place
  std::size_t add(std::int32_t i, std::int32_t j) {
    const std::size_t p = list_.count++, k = p % lanes_of_pairs;
    if (k == 0) {
      list_.add_group();
      // unused lanes have bodies of this block, to which they give nothing
      std::fill_n(list_.groups.back().i, lanes_of_pairs, i);
      std::fill_n(list_.groups.back().j, lanes_of_pairs, i);
      std::fill_n(list_.groups.back().since, lanes_of_pairs, ContactGroup::unused);
    }
    auto& group = list_.groups.back();
    group.i[k] = i;
    group.j[k] = j;
    group.since[k] = ContactGroup::apart;
    const std::int32_t receiver = bodies_ == nullptr ? j : (*bodies_)[j];
    if (receiver >= end_) {
      list_.first_outward = std::min(list_.first_outward, list_.groups.size() - 1);
      list_.outward.add(receiver);
    }
    return p;
  }

 private:
  void keep() {
    const std::size_t p = add(old_.first(at_), old_.second(at_));
    list_.copy(old_, at_, p);
  }

  List& list_;
  List old_;
  std::int32_t end_;
  const std::vector<std::int32_t>* bodies_;
  std::size_t at_ = 0;
  bool listed_ = false;
};

}  // namespace equidem
