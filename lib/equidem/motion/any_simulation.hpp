// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Common interface of all simulations in time; run loops, files and reports use only this, and the values that it
/// returns: contacts with their forces, walls, the periodic cell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/motion/ledger.hpp"
#include "equidem/motion/saved_state.hpp"
#include "equidem/motion/wall.hpp"

namespace equidem {

/// Base of Scene (bonded discs) and GrainScene (colliding bodies).
struct AnyScene {
  std::vector<Wall> walls = {};
  Vec2 gravity = {};  ///< m/s²

  [[nodiscard]] bool weighs() const { return gravity != Vec2{}; }
};

/// A contact of two bodies, or of a body and a wall. Forces are per metre of depth, but for spheres: N/m or N.
struct BodyContact {
  std::int32_t i = 0;
  std::int32_t j = 0;           ///< negative: wall ~j
  Vec2 arm;                     ///< from the centre of i to the contact point, m
  Vec2 shift = {};              ///< i touches the image of j at the place of j + shift, m; {}: no period between them
  Vec2 force = {};              ///< on i; its negative acts on j
  double normal_force = 0;      ///< on i along the normal n from i: tension positive
  double tangential_force = 0;  ///< on i along s = (-n_y, n_x)
  double bending_moment = 0;    ///< N, of bonds with bending springs and of rolling, on i; its negative acts on j
};

/// A contact of an assembly by its number, at the places of before the motion.
inline BodyContact bonded_contact(const Assembly& assembly, std::size_t contact, const ContactForce& force) {
  const Contact& c = assembly.contacts[contact];
  const ContactFrame frame = frame_of(assembly, contact);
  const Vec2 period = assembly.period.value_or(Vec2{});
  return {.i = c.i,
          .j = c.j,
          .arm = arm_of_i(frame),
          .shift = {c.shift_x * period.x, c.shift_y * period.y},
          .force = force_on_i(frame, force),
          .normal_force = force.normal,
          .tangential_force = force.tangential};
}

/// The periodic cell of a simulation at its time.
struct CellState {
  double width = 0, height = 0;  ///< m
  double shift = 0;              ///< of the images above against the cell along x, m; within half a width either way
  Voigt strain;                  ///< integral of the rates since the start: ln of the stretches, and of the shear rate
  /// Mean stress, tension positive: -(1/area) times the sum of f_i l_j over the contacts and m u_i u_j over the bodies.
  Tensor2 stress;
  double void_ratio = 0;           ///< area of the cell over that of the discs, less 1
  double coordination_number = 0;  ///< mean contacts of a disc
  std::vector<CellServoReport> servos;

  [[nodiscard]] double area() const { return width * height; }
};

/// Stands for the motion of a body that is not there.
inline constexpr DiscMotion not_there{
    {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()},
    std::numeric_limits<double>::quiet_NaN()};
constexpr bool is_there(const DiscMotion& motion) {
  return motion.u.x == motion.u.x;
}

/// Simulation (bonded discs) and GrainSimulation (colliding bodies). Bodies are in the caller's order.
class AnySimulation {
 public:
  virtual ~AnySimulation() = default;

  [[nodiscard]] BodyFamily family() const { return family_; }
  /// Active effects, and the reason for each inactive one.
  [[nodiscard]] virtual const Effects& effects() const = 0;
  /// Advance by a number of steps, or to the next milestone before. Results are bit-identical for any division of the
  /// steps into calls.
  virtual void advance(std::int64_t steps) = 0;
  [[nodiscard]] virtual std::int64_t step() const = 0;
  /// The present step where something has ended at it that is to be recorded, such as a stage; else -1.
  [[nodiscard]] virtual std::int64_t milestone() const { return -1; }
  /// Whether there is nothing left to step.
  [[nodiscard]] virtual bool over() const { return false; }
  [[nodiscard]] double time_step() const { return time_step_; }                           ///< s
  [[nodiscard]] double time() const { return static_cast<double>(step()) * time_step_; }  ///< s
  /// Displacements and rotations of bonded discs, positions and angles of colliding bodies; m, rad. Their number does
  /// not change: bodies that a run adds or removes are not_there before or after.
  [[nodiscard]] virtual std::vector<DiscMotion> motions() const = 0;
  [[nodiscard]] virtual std::vector<DiscMotion> velocities() const = 0;  ///< m/s, rad/s
  /// Contacts with their forces. Bonded discs: all bonds, then walls that push; forces of springs at motions(), without
  /// dashpots. Colliding bodies: the contacts that were closed at the end of the last step, mean forces over it; then
  /// bonds.
  [[nodiscard]] virtual std::vector<BodyContact> body_contacts() const = 0;
  [[nodiscard]] virtual EnergyLedger energy() const = 0;
  /// In the caller's order. Works of colliding bodies add up to that of the ledger.
  [[nodiscard]] virtual std::vector<WallState> walls() const { return {}; }
  /// The cell in which bodies repeat along x and y; none: there is no such cell.
  [[nodiscard]] virtual std::optional<CellState> cell() const { return {}; }
  /// Bytes of all arrays of the loop, per body.
  [[nodiscard]] virtual double bytes_per_body() const = 0;

  [[nodiscard]] virtual SavedState save() const = 0;
  /// \throws Error (bad_input) if the state has a different number of bodies
  virtual void restore(const SavedState& state) = 0;

 protected:
  AnySimulation(BodyFamily family, double time_step) : family_(family), time_step_(time_step) {}
  AnySimulation(const AnySimulation&) = default;
  AnySimulation& operator=(const AnySimulation&) = default;
  /// The data of a simulation, of a type that its source files know.
  template <class Data>
  using Hidden = std::unique_ptr<Data, void (*)(Data*)>;
  template <class Data, class... Arguments>
  static Hidden<Data> hidden(Arguments&&... arguments) {
    return {new Data{std::forward<Arguments>(arguments)...}, [](Data* data) { delete data; }};
  }

 private:
  BodyFamily family_;
  double time_step_;
};

}  // namespace equidem
