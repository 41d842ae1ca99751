// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Choice of the loop for a scene, made once before the first step, and the memory layout of discs and contacts in it.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/dynamics/kernels/step_kernel.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/material/spring_relations.hpp"
#include "equidem/motion/lane_vector.hpp"

namespace equidem {

/// Discs are ordered in strips parallel to x, high enough that contacts connect a strip only to itself and its
/// neighbours, and within strips in groups of four whose lanes are computed at once. Strips are padded with empty
/// places.
///
/// Strips allow several steps while data are in the cache: strip l can be at step k + 1 as soon as its neighbours are
/// at step k. In an assembly periodic along y, a strip contains discs of the lower and of the upper half: the ring of
/// strips is folded flat.
struct DiscLayout {
  static constexpr int lanes = 4;

  std::vector<std::int32_t> disc_at;      ///< place -> disc, -1: none; places x lanes
  std::vector<std::int32_t> place_of;     ///< disc -> place
  std::vector<std::int32_t> strip_first;  ///< strips + 1, in groups

  [[nodiscard]] std::int32_t groups() const { return static_cast<std::int32_t>(disc_at.size() / lanes); }
  [[nodiscard]] std::int32_t strips() const { return static_cast<std::int32_t>(strip_first.size()) - 1; }
};

DiscLayout lay_out(const Assembly& assembly);

/// The contacts of every group: slot k of a group holds the k-th contact of each of its four discs, a disc with fewer
/// contacts is paired with itself at zero stiffness.
struct ContactSlots {
  LaneVector<std::int32_t> first;      ///< groups + 1
  LaneVector<std::int32_t> neighbour;  ///< slots x lanes: place of the other disc
  std::vector<std::int32_t> contact;   ///< slots x lanes: c + 1 for contact c, -(c + 1) if the disc is its j; 0: none
};

ContactSlots list_slots(const Assembly& assembly, const DiscLayout& layout);

/// Arrays by place, with conversion from and to discs.
class BodyArrays {
 public:
  /// All discs at rest in the reference position.
  BodyArrays(DiscLayout layout, const LoopKind& kind);

  LaneVector<double> motion[2];       ///< places x width
  LaneVector<double> velocity;        ///< groups x unknowns x lanes
  LaneVector<double> velocity_at[2];  ///< dashpots only: places x width
  LaneVector<double> dashpot;         ///< dashpots only: groups x unknowns x lanes

  [[nodiscard]] const DiscLayout& layout() const { return layout_; }
  [[nodiscard]] std::vector<DiscMotion> discs_of(const LaneVector<double>& motions) const { return read(motions, 1); }
  void put(const std::vector<DiscMotion>& discs, LaneVector<double>& motions) const { write(discs, 1, motions); }
  [[nodiscard]] std::vector<DiscMotion> disc_velocities(const LaneVector<double>& velocities) const {
    return read(velocities, DiscLayout::lanes);
  }
  /// Set `velocity` and, with dashpots, both `velocity_at`.
  void put_velocities(const std::vector<DiscMotion>& discs);
  /// Set the pointers of a loop to these arrays.
  void connect(LoopData& data);

 private:
  /// Number of the first component of a disc; the next ones follow at the stride: 1 in motions, lanes in velocities.
  [[nodiscard]] std::size_t first_of(std::size_t disc, std::size_t stride) const;
  [[nodiscard]] std::vector<DiscMotion> read(const LaneVector<double>& array, std::size_t stride) const;
  void write(const std::vector<DiscMotion>& discs, std::size_t stride, LaneVector<double>& array) const;

  DiscLayout layout_;
  int unknowns_, width_;
};

/// Write the contact of one lane into its slot, in the order that LoopData::geometry states; constants of
/// dashpots are not changed. A lane of zeros means no contact. \param branch from the disc of this lane to its
/// neighbour, at rest, m \param lever_own, lever_other of the disc and of its neighbour, m
/// \param k of this contact, Pa; equal contacts use those of LoopData
/// \param kM of this contact, N, where kind.bending
/// \param slot kind.slot_doubles() x 4 doubles
/// \param lane 0 .. 3
void fill_geometry(const LoopKind& kind, Vec2 branch, double lever_own, double lever_other, SpringConstants k,
                   double kM, double* slot, int lane);

/// \throws Error (bad_input) where something is given of another number of discs than the assembly has
void check_count(const Scene& scene, std::size_t discs, const char* which, const char* remedy);
/// \throws Error (bad_input) if contacts lie off the lines of centres, which no loop supports
void check_contacts(const Assembly& assembly);

/// \throws Error (bad_input) as check_contacts and check(scene, rotation) of scene_check.hpp; on a mass that is not
///         positive, a damping out of range, dampings that exclude one another
void check(const Scene& scene, const SimulationOptions& options);

/// The effects of a run, with the reason for each inactive one: those of statics, then damping, gravity, loads,
/// supports, walls, large motions, unequal contacts and discs.
Effects effects_of(const Scene& scene, const SimulationOptions& options);

/// The simplest loop that contains every active effect.
LoopKind loop_for(const Scene& scene, const SimulationOptions& options, const Effects& effects);

/// Dashpots of a contact, N s/m per m: beta k, tau k, or 2 zeta sqrt(m k) with the reduced mass m.
SpringConstants dashpots_of(const Damping& damping, const SpringConstants& k, double mass_i, double mass_j);
/// The dashpot c_M beside a bending spring kM, N m s, likewise, of moments of inertia in place of masses.
double bending_dashpot_of(const Damping& damping, double kM, double moment_i, double moment_j);

}  // namespace equidem
