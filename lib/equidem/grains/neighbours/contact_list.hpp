// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts under a force law in groups of eight for the vectorized loops: one layout for pairs of discs, of parts of
/// bodies, and of bodies and walls. Lists differ in the columns that they have beside the groups.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/geometry/neighbours.hpp"
#include "equidem/grains/contacts/contact_effects.hpp"
#include "equidem/grains/neighbours/body_blocks.hpp"
#include "equidem/motion/lane_vector.hpp"

namespace equidem {

struct GrainSystem;
struct ContactState;

constexpr std::size_t lanes_of_pairs = 8;
using PairLanes = double[lanes_of_pairs];

/// Eight pairs i < j of bodies, or of parts, where not both bodies are discs; or parts i, in scenes of discs bodies, at
/// walls j.
struct alignas(64) ContactGroup {
  static constexpr std::int64_t apart = -1, unused = -2;
  std::int32_t i[lanes_of_pairs], j[lanes_of_pairs];
  /// First step of the contact, counted from 1 (Verlet schemes: from 0); `apart`: no contact; `unused`: no pair.
  std::int64_t since[lanes_of_pairs];
  PairLanes reach;          ///< a_i + a_j, of discs r_i + r_j, m; of lanes without a pair negative: discs never touch
  PairLanes dashpot;        ///< normal, times dt; kg, hertz: kg/m^(1/4)
  PairLanes half_mobility;  ///< (1/m_i + 1/m_j)/2
  PairLanes impulse;        ///< normal, of the last step, N s
};

/// Friction data of a group. Half the mobility of discs along the contact: half_mobility + half_turning * distance².
struct alignas(64) PairSlips {
  PairLanes half_turning;  ///< discs: (r_i²/I_i + r_j²/I_j)/(r_i + r_j)²/2
  PairLanes dashpot;       ///< discs: times dt, kg; others: ContactConstants::tangential_damping
  PairLanes stretch;       ///< m
  PairLanes impulse;       ///< tangential, on j, of the last step, N s
};

/// Law constants if all pairs have the same.
struct PairLaw {
  double stiffness = 0;             ///< N/m, hertz: N/m^(3/2)
  double least = 0;                 ///< least normal impulse: 0, or minus infinity if contacts may attract
  double friction = 0;              ///< mu
  double tangential_stiffness = 0;  ///< N/m
};
struct alignas(64) PairLaws {
  PairLanes stiffness, least, friction, tangential_stiffness;
};

/// Data of the last step. Ellipses apart: the normal is a direction along which they were apart, or {}.
struct alignas(64) PairRecords {
  PairLanes overlap, closing, normal_x, normal_y;
};

/// Parts, and parts at walls.
struct alignas(64) PartShapes {
  PairLanes inverse_moment_i, inverse_moment_j;  ///< 1/I
  PairLanes share;                               ///< share of i in the overlap
  PairLanes covered;             ///< walls: not 0 where a wall continues the end of this one (wall_joints.hpp)
  PairLanes a_i, a_j, b_i, b_j;  ///< half-axes, m
  PairLanes arrived;             ///< angle at which Newton's iteration has converged (contact_of_ellipses)
  PairLanes sharpest;            ///< b_i²/a_i + b_j²/a_j, m: shallower overlaps have a unique normal
  // of the last step, m
  PairLanes arm_i_x, arm_i_y, arm_j_x, arm_j_y;
};

/// Periodic cells: numbers of periods along x and along y to the image of j that i meets.
struct alignas(64) PairImages {
  PairLanes a, b;
};

/// Eight contacts of one list.
struct ContactRows {
  ContactGroup& group;
  PairSlips& slips;
  PairLaws& laws;
  PairRecords& records;
  PartShapes& shapes;
  ContactEffects* effects;   ///< null: there are none
  const PairImages* images;  ///< null: without a cell
};

/// A column beside the groups of a list; empty where the list has none.
template <class Rows>
struct Column : LaneVector<Rows> {
  bool used = false;
};

/// Copy a lane of all numbers of a row, from the given number on.
template <class Rows>
void copy_lane(const Rows& from, std::size_t from_lane, Rows& to, std::size_t to_lane, std::size_t first = 0) {
  static_assert(sizeof(Rows) % sizeof(PairLanes) == 0);
  const char* source = reinterpret_cast<const char*>(&from);
  char* target = reinterpret_cast<char*>(&to);
  for (std::size_t row = first * sizeof(PairLanes); row < sizeof(Rows); row += sizeof(PairLanes))
    std::memcpy(target + row + to_lane * sizeof(double), source + row + from_lane * sizeof(double), sizeof(double));
}

/// The partners of the contacts of a list.
enum class Between { discs, round_parts, ellipses, walls };

/// A pair in the order of lists: i and an image of j, as bodies or parts; or a wall j.
struct PairKey {
  std::int32_t i = 0;
  PeriodicImage j;
  auto operator<=>(const PairKey&) const = default;

  /// Behind all pairs.
  static constexpr PairKey last() { return {std::numeric_limits<std::int32_t>::max(), {}}; }
};

/// The contacts of a block of bodies that touch or nearly touch, ordered as PairKey. Bodies that are taken back into a
/// cell change the images of all pairs of two bodies by as much: the order stays.
struct NearList {
  Between between = Between::discs;
  LaneVector<ContactGroup> groups;
  Column<PairSlips> slips;
  Column<PairLaws> laws;        ///< unless discs all have the same
  Column<PairRecords> records;  ///< discs: after a recorded step
  Column<PartShapes> shapes;    ///< of parts and walls
  Column<ContactEffects> effects;
  Column<PairImages> images;  ///< of pairs in a periodic cell
  std::size_t count = 0;
  OutwardImpulses outward;
  std::size_t first_outward = 0;  ///< first group with a body of a later block

  [[nodiscard]] std::int32_t first(std::size_t p) const { return groups[p / lanes_of_pairs].i[p % lanes_of_pairs]; }
  [[nodiscard]] std::int32_t second(std::size_t p) const { return groups[p / lanes_of_pairs].j[p % lanes_of_pairs]; }
  [[nodiscard]] PairKey pair(std::size_t p) const {
    PairKey pair{first(p), {second(p)}};
    if (!images.used) return pair;
    pair.j.a = static_cast<std::int32_t>(images[p / lanes_of_pairs].a[p % lanes_of_pairs]);
    pair.j.b = static_cast<std::int32_t>(images[p / lanes_of_pairs].b[p % lanes_of_pairs]);
    return pair;
  }
  [[nodiscard]] std::int64_t& since(std::size_t p) { return groups[p / lanes_of_pairs].since[p % lanes_of_pairs]; }
  [[nodiscard]] bool touching(std::size_t p) const {
    return groups[p / lanes_of_pairs].since[p % lanes_of_pairs] > ContactGroup::apart;
  }
  [[nodiscard]] Vec2 normal(std::size_t p) const {
    const PairRecords& of = records[p / lanes_of_pairs];
    return {of.normal_x[p % lanes_of_pairs], of.normal_y[p % lanes_of_pairs]};
  }
  /// Rows of a list of parts or of walls.
  [[nodiscard]] ContactRows rows(std::size_t g) {
    return {groups[g],
            slips[g],
            laws[g],
            records[g],
            shapes[g],
            effects.used ? &effects[g] : nullptr,
            images.used ? &images[g] : nullptr};
  }
  [[nodiscard]] std::size_t bytes() const;

  /// Call work(column...) with each column of some lists.
  template <class Work, class... Lists>
  static void each_column(const Work& work, Lists&... lists) {
    work(lists.slips...), work(lists.laws...), work(lists.records...), work(lists.shapes...), work(lists.effects...),
        work(lists.images...);
  }
  /// Take the list out, and leave an empty one with room for as many contacts.
  NearList emptied();
  /// Eight lanes more, which touch nothing.
  void add_group();
  /// Copy all numbers of a contact but those of its partners.
  void copy(const NearList& other, std::size_t from, std::size_t to);
  /// End a contact; what its springs held is counted nowhere.
  void end(std::size_t p);
};

/// The lists of all blocks of bodies.
struct NearLists {
  using Loop = void (*)(GrainSystem& system, NearList& list, std::size_t block);
  Loop loop = nullptr;           ///< finds the impulses of this step by the contacts of a block
  std::vector<NearList> blocks;  ///< empty: the scene has no such contacts

  [[nodiscard]] bool active() const { return !blocks.empty(); }
};

/// A list as it comes to be, from contacts of the list before and from new ones.
class NewList {
 public:
  /// \param block of the bodies of the list
  NewList(const GrainSystem& system, NearList& list, std::size_t block);

  /// Contacts stay until the loop has seen them end.
  void keep_contacts_before(const PairKey& pair) {
    for (; next_ < pair; advance())
      if (old_.touching(at_)) keep();
  }
  /// Keep the contacts that were not found again.
  void keep_others() { keep_contacts_before(PairKey::last()); }
  /// Advance to a pair that is near: keep it, or list it where it was not.
  void take(const PairKey& pair) {
    keep_contacts_before(pair);
    if (next_ == pair) {
      keep();
      advance();
    } else {
      add(pair, {});
    }
  }
  /// Advance to a pair; keep it if it is in contact. \return whether it is
  bool keep_contact(const PairKey& pair) {
    keep_contacts_before(pair);
    listed_ = next_ == pair;
    if (!listed_ || !old_.touching(at_)) return false;
    keep();
    advance();
    return true;
  }
  /// NearList::normal of this pair in the list before, {} if it was not listed.
  [[nodiscard]] Vec2 normal_before() const { return listed_ ? old_.normal(at_) : Vec2{}; }
  /// For this pair, if it is apart: keep it where it is near, and list it where it was not.
  /// \param apart a direction along which it is, or {}
  void leave(const PairKey& pair, bool near, Vec2 apart = {}) {
    if (near && listed_) keep();
    if (near && !listed_) add(pair, apart);
    if (listed_) advance();
  }
  /// A new contact, which is apart, with its constants. \return its place
  std::size_t add(const PairKey& pair, Vec2 apart);

 private:
  std::size_t add(const PairKey& pair);
  void keep() { list_.copy(old_, at_, add(next_)); }
  void advance() { next_ = ++at_ < old_.count ? old_.pair(at_) : PairKey::last(); }

  const GrainSystem& system_;
  NearList& list_;
  NearList old_;
  std::int32_t end_;    ///< of the bodies of the block
  std::size_t at_ = 0;  ///< place in the list before, and the pair there
  PairKey next_;
  bool listed_ = false;
};

/// Two bodies and their parts, or a body and a wall.
struct Partners {
  std::int32_t i = 0, j = 0;            ///< bodies, or a body and a wall ~j
  std::int32_t part_i = 0, part_j = 0;  ///< indices in Shapes::parts; 0: of a wall, or in scenes of discs
  std::int32_t a = 0, b = 0;            ///< periods to the image of j that i meets

  [[nodiscard]] PeriodicImage image() const { return {j, b, a}; }
};
Partners partners_of(const GrainSystem& system, const NearList& list, std::size_t p);

/// Call work(list) for all lists: of discs, round parts, ellipses and walls.
template <class Contacts, class Work>
void each_list(Contacts& contacts, const Work& work) {
  for (auto& lists : contacts.near)
    for (auto& list : lists.blocks) work(list);
}

/// The law of all pairs of grains, where they have the same one, and contacts stick by a spring if there is friction.
std::optional<PairLaw> common_law(const GrainSystem& system);

/// The law of a contact.
PairLaw law_of(const GrainSystem& system, const NearList& list, std::size_t p);

/// Prepare the lists under a force law, and choose their loops.
void prepare_lists(GrainSystem& system);

/// Mark contacts that overlap as touching.
void touch_contacts(GrainSystem& system);

/// Replace the contacts of all lists.
void take_contacts(GrainSystem& system, std::vector<ContactState> contacts);

/// Set the state of a contact.
void set_state(const GrainSystem& system, NearList& list, std::size_t p, ContactState contact);

/// The state of a contact.
ContactState state_of(const GrainSystem& system, const NearList& list, std::size_t p);

/// Energies that contacts store at the present positions, that of cohesion at the time of the velocities, J.
struct StoredEnergy {
  double normal = 0, tangential = 0, rolling = 0, cohesion = 0;

  StoredEnergy& operator+=(const StoredEnergy& other) {
    normal += other.normal;
    tangential += other.tangential;
    rolling += other.rolling;
    cohesion += other.cohesion;
    return *this;
  }
};
StoredEnergy stored_energy(const GrainSystem& system);

/// The loops of pairs of discs, and of parts and walls, compiled for the law of the scene.
NearLists::Loop loop_of_discs(const GrainSystem& system);
NearLists::Loop loop_of_parts(const GrainSystem& system, Between between);

}  // namespace equidem
