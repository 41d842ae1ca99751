// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/load_bearing.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/loads.hpp"
#include "equidem/statics/motion_description.hpp"

namespace equidem {
namespace {

/// Multiples of the period.
struct Shift {
  std::int32_t x = 0;
  std::int32_t y = 0;

  [[nodiscard]] bool zero() const { return x == 0 && y == 0; }
};

/// Number of directions that the windings found so far span.
struct Span {
  Shift first;
  int rank = 0;

  void add(Shift winding) {
    if (rank == 0) first = winding;
    const std::int64_t area = std::int64_t{first.x} * winding.y - std::int64_t{first.y} * winding.x;
    rank = std::max(rank, area != 0 ? 2 : 1);
  }
};

constexpr double round_off = 1e-9;  ///< sine of an angle, share of a length: less counts as zero

enum class Fate : std::uint8_t { left, rattler, dangling, floating };

/// Whether the centres of a rigid group may turn with its discs: no slip where levers add up to their branch.
bool turns_rigidly(const Assembly& assembly, const ContactSprings& springs, const Effects& effects) {
  if (!effects.rotation) return true;               // it translates
  if (!assembly.contact_arms.empty()) return true;  // their arms meet
  for (std::size_t k = 0; k < assembly.contacts.size(); ++k) {
    const Contact& c = assembly.contacts[k];
    const double length = norm(assembly.branch(c));
    if (springs[k].kT != 0 && std::abs(length - c.lever_i - c.lever_j) > round_off * length) return false;
  }
  return true;
}

class Pruning {
 public:
  Pruning(const Assembly& assembly, const ContactSprings& springs, const Effects& effects,
          const std::vector<std::uint8_t>& held, LeaveOut which)
      : assembly_(assembly),
        springs_(springs),
        rotation_(effects.rotation),
        held_(held),
        anchored_(assembly.periodic() ||
                  std::any_of(held.begin(), held.end(), [](std::uint8_t value) { return value != 0; })),
        only_loose_(which == LeaveOut::loose),
        turns_rigidly_(turns_rigidly(assembly, springs, effects)),
        cut_at_discs_(!only_loose_ && turns_rigidly_),
        graph_(assembly),
        fate_(assembly.size(), Fate::left),
        contacts_left_(assembly.size()) {
    assert(held.empty() || held.size() == assembly.size());
    for (std::size_t d = 0; d < assembly.size(); ++d) {
      contacts_left_[d] = static_cast<std::int32_t>(graph_.of(d).size());
      if (contacts_left_[d] == 0 && !is_held(d)) fate_[d] = Fate::rattler;
    }
  }

  LoadBearingNetwork prune() {
    do walk();
    while (leave_out_single_discs() || (only_loose_ && leave_out_chains()));
    LoadBearingNetwork network;
    network.pieces = pieces_;
    network.spanned = assembly_.periodic() ? span_.rank : 2;
    describe(network);
    if (network.removed() > 0) network.part = part();
    return network;
  }

 private:
  [[nodiscard]] bool is_held(std::size_t disc) const { return !held_.empty() && held_[disc] != 0; }
  [[nodiscard]] bool left(std::size_t disc) const { return fate_[disc] == Fate::left; }

  void leave_out(std::size_t disc, Fate fate) {
    if (!left(disc)) return;
    fate_[disc] = fate;
    for (const auto& edge : graph_.of(disc)) {
      --contacts_left_[edge.other];
      open_.push_back(edge.other);
    }
  }

  /// The equations of equilibrium of a disc admit no contact force but zero: with columns (n, -offset) for the normal
  /// and (s, lever) for the tangential force of each contact, moments where rotation is free, they have full column
  /// rank. Three rows allow two contacts at most.
  [[nodiscard]] bool carries_nothing(std::size_t disc) const {
    if (contacts_left_[disc] > 2 || is_held(disc)) return false;
    if (only_loose_) return contacts_left_[disc] < 2 && is_loosely_joined(disc);
    struct Column {
      Vec2 force;
      double moment = 0;  ///< of the unit force, over the radius
    };
    Column columns[4];
    int count = 0;
    for (const auto& edge : graph_.of(disc)) {
      if (!left(edge.other)) continue;
      if (static_cast<std::size_t>(edge.other) == disc) return false;  // a column of zeros
      if (carries_moment(edge.contact) && contacts_left_[disc] == 2) return false;
      const auto k = static_cast<std::size_t>(edge.contact);
      const ContactFrame frame = frame_of(assembly_, k);
      const bool is_i = static_cast<std::size_t>(assembly_.contacts[k].i) == disc;
      const double radius = assembly_.radii[disc];
      columns[count++] = {frame.normal, -(is_i ? frame.offset_i : frame.offset_j) / radius};
      if (springs_[k].kT != 0) columns[count++] = {frame.tangent(), (is_i ? frame.lever_i : frame.lever_j) / radius};
    }
    if (count < 2) return true;
    const auto& [a, b, c, d] = columns;
    const double plane = cross(a.force, b.force);
    if (!rotation_ || count > 3) return count == 2 && std::abs(plane) > round_off;
    const Vec2 lever = b.moment * a.force - a.moment * b.force;
    if (count == 2) return std::abs(plane) > round_off || norm(lever) > round_off;
    return std::abs(plane * c.moment - cross(lever, c.force)) > round_off;
  }

  [[nodiscard]] bool carries_moment(std::int32_t contact) const {
    return rotation_ && springs_.bending(static_cast<std::size_t>(contact)) > 0;
  }

  /// Whether a contact as the only one between two parts lets them turn or slide.
  [[nodiscard]] bool is_loose(std::int32_t contact) const {
    return (rotation_ && !carries_moment(contact)) || springs_[static_cast<std::size_t>(contact)].kT == 0;
  }

  /// A disc with one contact left, or none, is joined loosely unless that contact holds it in place.
  [[nodiscard]] bool is_loosely_joined(std::size_t disc) const {
    for (const auto& edge : graph_.of(disc)) {
      if (!left(edge.other)) continue;
      return static_cast<std::size_t>(edge.other) != disc && is_loose(edge.contact);
    }
    return true;
  }

  /// Whether there were any.
  bool leave_out_single_discs() {
    open_.clear();
    bool any = false;
    const auto visit = [&](std::size_t disc) {
      if (!left(disc) || !carries_nothing(disc)) return;
      leave_out(disc, Fate::dangling);
      any = true;
    };
    for (std::size_t disc = 0; disc < assembly_.size(); ++disc) visit(disc);
    while (!open_.empty()) {
      const std::int32_t disc = open_.back();
      open_.pop_back();
      visit(disc);
    }
    return any;
  }

  /// The other contact of a disc that has two left.
  [[nodiscard]] std::size_t other_contact(std::size_t disc, std::int32_t known) const {
    std::int32_t found = known;
    for (const auto& edge : graph_.of(disc))
      if (left(edge.other) && edge.contact != known) found = edge.contact;
    return static_cast<std::size_t>(found);
  }

  /// Leave out neighbours that have two contacts each, unless their three points of contact lie in line: the moments
  /// of both vanish only for a force along both chords. Loads would roll them on one another.
  bool leave_out_chains() {
    if (!rotation_) return false;
    const auto in_chain = [&](std::size_t disc) { return left(disc) && contacts_left_[disc] == 2 && !is_held(disc); };
    std::vector<std::size_t> chained;
    for (std::size_t disc = 0; disc < assembly_.size(); ++disc) {
      if (!in_chain(disc)) continue;
      for (const auto& edge : graph_.of(disc)) {
        const auto other = static_cast<std::size_t>(edge.other);
        if (other == disc || !in_chain(other) || carries_moment(edge.contact)) continue;
        const std::size_t mine = other_contact(disc, edge.contact), theirs = other_contact(other, edge.contact);
        if (carries_moment(static_cast<std::int32_t>(mine)) || carries_moment(static_cast<std::int32_t>(theirs)))
          continue;
        if (!points_in_line(assembly_, {mine, static_cast<std::size_t>(edge.contact), theirs})) chained.push_back(disc);
      }
    }
    for (const std::size_t disc : chained) leave_out(disc, Fate::dangling);
    return !chained.empty();
  }

  /// A disc in the order in which a depth-first walk meets them; those that it meets through this one follow it in one
  /// stretch.
  struct Step {
    std::int32_t disc = 0;
    std::int32_t parent = -1;   ///< step
    std::int32_t contact = -1;  ///< with the parent
    std::int32_t next = 0;      ///< index of its next contact
    std::int32_t low = 0;       ///< first step that a contact joins to this stretch (Tarjan 1972)
    std::int32_t size = 1;      ///< of the stretch
    std::int32_t anchors = 0;   ///< of the stretch: held discs, and contacts that close a ring around the period
    Shift image{};              ///< of the disc, joined to the first one of its piece inside the cell
  };

  /// Walk over all pieces; leave out those that float and what dangles from the others.
  void walk() {
    pieces_ = 0;
    span_ = {};
    step_of_.assign(assembly_.size(), -1);
    for (std::size_t disc = 0; disc < assembly_.size(); ++disc) {
      if (!left(disc) || step_of_[disc] >= 0) continue;
      steps_.clear();
      follow(static_cast<std::int32_t>(disc));
      for (std::size_t k = steps_.size(); k-- > 1;) {
        const Step& step = steps_[k];
        Step& parent = steps_[step.parent];
        parent.low = std::min(parent.low, step.low);
        parent.size += step.size;
        parent.anchors += step.anchors;
      }
      if (anchored_ && steps_.front().anchors == 0) {
        leave_out_steps(0, steps_.size(), Fate::floating);
        continue;
      }
      ++pieces_;
      if (anchored_) leave_out_dangling();
    }
  }

  void follow(std::int32_t first_disc) {
    add_step({.disc = first_disc});
    std::int32_t here = 0;
    while (here >= 0) {
      Step& step = steps_[here];
      const auto edges = graph_.of(step.disc);
      if (step.next == static_cast<std::int32_t>(edges.size())) {
        here = step.parent;
        continue;
      }
      const auto [other, contact] = edges[step.next++];
      if (contact == step.contact || !left(other)) continue;
      const Contact& c = assembly_.contacts[contact];
      const int sign = c.i == step.disc ? 1 : -1;
      const Shift image{step.image.x + sign * c.shift_x, step.image.y + sign * c.shift_y};
      const std::int32_t there = step_of_[other];
      if (there < 0) {
        add_step({.disc = other, .parent = here, .contact = contact, .image = image});
        here = static_cast<std::int32_t>(steps_.size()) - 1;
      } else if (there <= here) {  // the other end has seen the contact where it comes later
        step.low = std::min(step.low, there);
        const Shift winding{image.x - steps_[there].image.x, image.y - steps_[there].image.y};
        if (winding.zero()) continue;
        span_.add(winding);
        ++step.anchors;
      }
    }
  }

  void add_step(Step step) {
    step.low = step_of_[step.disc] = static_cast<std::int32_t>(steps_.size());
    step.anchors = is_held(step.disc) ? 1 : 0;
    steps_.push_back(step);
  }

  void leave_out_steps(std::size_t first, std::size_t end, Fate fate, std::int32_t but = -1) {
    for (std::size_t k = first; k < end; ++k) {
      if (steps_[k].disc != but) leave_out(steps_[k].disc, fate);
    }
  }

  /// A stretch is joined to the rest of its piece at its parent alone where low is not before the parent, and by a
  /// single contact where low is after it. The side without anchors dangles. Stretches that hold all anchors lie
  /// within one another: the last one is what is left.
  void leave_out_dangling() {
    const auto end = static_cast<std::int32_t>(steps_.size());
    std::int32_t core = 0;
    for (std::int32_t k = 1; k < end;) {
      const Step& step = steps_[k];
      // A bending spring balances the couple of a force whose levers do not add up to the branch.
      const bool by_one = step.low > step.parent && (!only_loose_ || is_loose(step.contact)) &&
                          (turns_rigidly_ || !carries_moment(step.contact));
      const bool parts = by_one || (cut_at_discs_ && step.low == step.parent);
      if (parts && step.anchors == 0) {
        leave_out_steps(k, k + step.size, Fate::dangling);
        k += step.size;
        continue;
      }
      if (parts && step.anchors == steps_.front().anchors) core = k;
      ++k;
    }
    if (core == 0) return;
    const std::int32_t joint = cut_at_discs_ ? steps_[steps_[core].parent].disc : -1;
    leave_out_steps(0, core, Fate::dangling, joint);
    leave_out_steps(core + steps_[core].size, end, Fate::dangling, joint);
  }

  /// Counts, and a sentence for each kind of disc left out.
  void describe(LoadBearingNetwork& network) const {
    const auto add = [&](Fate fate, const char* name, const char* one, const char* several) {
      std::int64_t count = 0;
      std::vector<std::string> names;
      for (std::size_t d = 0; d < assembly_.size(); ++d) {
        if (fate_[d] != fate || ++count > 3) continue;
        names.push_back(describe_disc(assembly_, d));
      }
      if (count > 0) {
        network.sentences.push_back(fmt::format("{} ({}{}) {} left out", counted(count, name), joined(names),
                                                count > 3 ? ", ..." : "", count == 1 ? one : several));
      }
      return count;
    };
    network.rattlers = add(Fate::rattler, "rattler", "touches nothing and is", "touch nothing and are");
    network.dangling = add(Fate::dangling, "dangling disc", "can carry no force and is", "can carry no force and are");
    const bool periodic = assembly_.periodic();
    network.floating = add(Fate::floating, "floating disc",
                           periodic ? "belongs to a piece joined to none of its images and is"
                                    : "belongs to a piece joined to nothing that is held and is",
                           periodic ? "belong to pieces joined to none of their images and are"
                                    : "belong to pieces joined to nothing that is held and are");
  }

  [[nodiscard]] LoadBearingNetwork::Part part() const {
    const Assembly& whole = assembly_;
    LoadBearingNetwork::Part result{{}, springs_, {}, {}};
    Assembly& rest = result.assembly;
    rest.kind = whole.kind;
    rest.gap_tolerance = whole.gap_tolerance;
    rest.period = whole.period;
    rest.box = whole.box;
    std::vector<std::int32_t> number(whole.size(), -1);
    for (std::size_t d = 0; d < whole.size(); ++d) {
      if (!left(d)) continue;
      number[d] = static_cast<std::int32_t>(result.discs.size());
      result.discs.push_back(static_cast<std::int32_t>(d));
    }
    for (std::size_t k = 0; k < whole.contacts.size(); ++k) {
      Contact c = whole.contacts[k];
      if (!left(c.i) || !left(c.j)) continue;
      c.i = number[c.i], c.j = number[c.j];
      rest.contacts.push_back(c);
      result.contacts.push_back(static_cast<std::int32_t>(k));
    }
    const auto take = [](const auto& from, const std::vector<std::int32_t>& which, auto& to) {
      if (from.empty()) return;
      for (const std::int32_t k : which) to.push_back(from[k]);
    };
    take(whole.centres, result.discs, rest.centres);
    take(whole.radii, result.discs, rest.radii);
    take(whole.cell_areas, result.discs, rest.cell_areas);
    take(whole.contact_arms, result.contacts, rest.contact_arms);
    take(whole.sections, result.discs, rest.sections);
    take(whole.facet_lengths, result.contacts, rest.facet_lengths);
    for (const ContactNumbers& numbers : contact_numbers) {
      take(whole.*numbers.first, result.contacts, rest.*numbers.first);
      take(whole.*numbers.second, result.contacts, rest.*numbers.second);
    }
    for (const auto& [name, group] : whole.groups) {
      DiscGroup& kept = rest.groups[name];
      for (std::size_t k = 0; k < group.discs.size(); ++k) {
        if (!left(group.discs[k])) continue;
        kept.discs.push_back(number[group.discs[k]]);
        if (!group.tributary_lengths.empty()) kept.tributary_lengths.push_back(group.tributary_lengths[k]);
      }
    }
    result.springs = chosen_springs(springs_, result.contacts);
    return result;
  }

  const Assembly& assembly_;
  const ContactSprings& springs_;
  bool rotation_;
  const std::vector<std::uint8_t>& held_;
  bool anchored_;    ///< the period or held discs can load the network
  bool only_loose_;  ///< LeaveOut::loose
  bool turns_rigidly_;
  bool cut_at_discs_;  ///< what a single disc joins to the rest can follow it
  ContactGraph graph_;
  std::vector<Fate> fate_;
  std::vector<std::int32_t> contacts_left_;  ///< per disc
  std::vector<std::int32_t> open_;           ///< discs that have lost a contact
  std::vector<std::int32_t> step_of_;        ///< per disc, within its piece; -1: not met yet
  std::vector<Step> steps_;                  ///< of one piece
  std::int64_t pieces_ = 0;
  Span span_;
};

}  // namespace

LoadBearingNetwork load_bearing_network(const Assembly& assembly, const ContactSprings& springs, const Effects& effects,
                                        const std::vector<std::uint8_t>& held, LeaveOut which) {
  return Pruning(assembly, springs, effects, held, which).prune();
}

}  // namespace equidem
