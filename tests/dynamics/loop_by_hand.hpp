// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The compiled loop of one kind on an assembly, without a Simulation around it.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/dynamics/kernels/step_kernel.hpp"
#include "equidem/dynamics/layout.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem::test {

class LoopByHand {
 public:
  /// \param dashpots c_N and c_T of every contact, Pa s
  /// \param bending_dashpot c_M of every contact, N m s
  LoopByHand(const Assembly& assembly, const ContactSprings& springs, const Inertia& inertia, const LoopKind& kind,
             SpringConstants dashpots = {}, double bending_dashpot = 0)
      : kind_(kind), layout_(lay_out(assembly)), slots_(list_slots(assembly, layout_)), step_(step_function(kind)) {
    const int doubles = kind.slot_doubles();
    geometry_.assign(slots_.contact.size() * static_cast<std::size_t>(doubles), 0.0);
    for (std::size_t k = 0; k < slots_.contact.size(); ++k) {
      const std::int32_t signed_contact = slots_.contact[k];
      if (signed_contact == 0) continue;
      const auto c = static_cast<std::size_t>(std::abs(signed_contact) - 1);
      const Contact& contact = assembly.contacts[c];
      const bool as_i = signed_contact > 0;
      double* slot = geometry_.data() + k / 4 * 4 * static_cast<std::size_t>(doubles);
      const auto lane = static_cast<int>(k % 4);
      fill_geometry(kind, as_i ? assembly.branch(contact) : -assembly.branch(contact),
                    as_i ? contact.lever_i : contact.lever_j, as_i ? contact.lever_j : contact.lever_i, springs[c],
                    springs.bending(c), slot, lane);
      if (kind.resistance == LoopKind::Resistance::dashpot && !kind.equal_contacts) {
        double* const constants = slot + 4 * (doubles - (kind.bending ? 3 : 2)) + lane;
        constants[0] = dashpots.kN;
        constants[4] = dashpots.kT;
        if (kind.bending) constants[8] = bending_dashpot;
      }
    }
    const std::size_t places = layout_.disc_at.size(), width = static_cast<std::size_t>(kind.width());
    for (int p = 0; p < 2; ++p) {
      motion_[p].assign(places * width, 0.0);
      velocity_at_[p].assign(places * width, 0.0);
      data_.motion[p] = motion_[p].data();
      data_.velocity_at[p] = velocity_at_[p].data();
    }
    velocity_.assign(places * static_cast<std::size_t>(kind.unknowns()), 0.0);
    inverse_inertia_.assign(places * 2, 0.0);
    for (std::size_t place = 0; place < places; ++place) {
      if (layout_.disc_at[place] < 0) continue;
      inverse_inertia_[place / 4 * 8 + place % 4] = 1 / inertia.mass;
      inverse_inertia_[place / 4 * 8 + 4 + place % 4] = 1 / inertia.moment;
    }
    data_.first = slots_.first.data();
    data_.neighbour = slots_.neighbour.data();
    data_.geometry = geometry_.data();
    data_.inverse_inertia = inverse_inertia_.data();
    dashpot_.assign(velocity_.size(), 0.0);
    data_.dashpot = dashpot_.data();
    data_.velocity = velocity_.data();
    data_.inverse_mass = 1 / inertia.mass;
    data_.inverse_moment = 1 / inertia.moment;
    if (!assembly.contacts.empty()) {
      data_.kN = springs[0].kN;
      data_.kT = springs[0].kT;
    }
    data_.cN = dashpots.kN;
    data_.cT = dashpots.kT;
  }

  void step(const Stage& stage) {
    Dissipation dissipation;
    step_(data_, stage, parity_, 0, layout_.groups(), dissipation);
    parity_ = 1 - parity_;
  }

  void set_motions(const std::vector<DiscMotion>& motions) { put(motions, motion_[parity_]); }
  [[nodiscard]] std::vector<DiscMotion> motions() const {
    std::vector<DiscMotion> result(layout_.place_of.size());
    for (std::size_t d = 0; d < result.size(); ++d) {
      const double* at = motion_[parity_].data() + layout_.place_of[d] * kind_.width();
      result[d] = {{at[0], at[1]}, kind_.width() == 4 ? at[2] : 0.0};
    }
    return result;
  }
  /// Velocities that the step goes on from.
  void set_velocities(const std::vector<DiscMotion>& velocities) {
    for (std::size_t d = 0; d < velocities.size(); ++d) {
      double* at = velocity_of(d);
      at[0] = velocities[d].u.x;
      at[4] = velocities[d].u.y;
      if (kind_.unknowns() == 3) at[8] = velocities[d].theta;
    }
  }
  [[nodiscard]] std::vector<DiscMotion> velocities() {
    std::vector<DiscMotion> result(layout_.place_of.size());
    for (std::size_t d = 0; d < result.size(); ++d) {
      const double* at = velocity_of(d);
      result[d] = {{at[0], at[4]}, kind_.unknowns() == 3 ? at[8] : 0.0};
    }
    return result;
  }
  /// Velocities that dashpots see.
  void set_dashpot_velocities(const std::vector<DiscMotion>& velocities) { put(velocities, velocity_at_[parity_]); }

  /// Forces (N/m) and moments (N) of the contacts on every disc, where mass and moment of inertia are 1.
  [[nodiscard]] std::vector<DiscMotion> forces() {
    set_velocities(std::vector<DiscMotion>(layout_.place_of.size()));
    step({.keep = 1, .kick = 1, .drift = 0, .drift_before = 0, .duration = 0});
    return velocities();
  }

 private:
  void put(const std::vector<DiscMotion>& discs, std::vector<double>& to) const {
    for (std::size_t d = 0; d < discs.size(); ++d) {
      double* at = to.data() + layout_.place_of[d] * kind_.width();
      at[0] = discs[d].u.x;
      at[1] = discs[d].u.y;
      if (kind_.width() == 4) at[2] = discs[d].theta;
    }
  }
  double* velocity_of(std::size_t disc) {
    const std::int32_t place = layout_.place_of[disc];
    return velocity_.data() + place / 4 * 4 * kind_.unknowns() + place % 4;
  }

  LoopKind kind_;
  DiscLayout layout_;
  ContactSlots slots_;
  StepFunction step_;
  std::vector<double> geometry_, inverse_inertia_, motion_[2], velocity_at_[2], velocity_, dashpot_;
  LoopData data_;
  int parity_ = 0;
};

}  // namespace equidem::test
