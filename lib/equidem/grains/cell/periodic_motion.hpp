// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Steps of a periodic cell that deforms, and its state. Pairs carry the numbers of periods to the image that i meets.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/geometry/neighbours.hpp"
#include "equidem/motion/any_simulation.hpp"
#include "equidem/motion/wall.hpp"

namespace equidem {

struct GrainSystem;
struct GrainContact;
struct PeriodicCell;

Periods periods_of(const PeriodicCell& cell);

/// Steps after which bodies that have left the cell are taken as their images inside. That depends on the step alone: a
/// resumed run does the same.
constexpr std::int64_t steps_between_wraps = 256;

/// Take each body as its image in the cell, and the period along y as the one of least shift. Candidates are found
/// anew.
void wrap_bodies(GrainSystem& system);

/// The control of one component of the stress.
struct CellControl : ControlState {
  double stiffness = 0;  ///< Pa, if all discs followed the stretch
  double viscosity = 0;  ///< Pa s, likewise
};

/// Sum of the impulses on images times the numbers of periods to them, N s.
struct ImageImpulses {
  Vec2 a, b;

  ImageImpulses& operator+=(const ImageImpulses& other) {
    a += other.a;
    b += other.b;
    return *this;
  }
  /// Sum of impulse times shift, N s m.
  [[nodiscard]] Tensor2 moment(const Periods& periods) const { return outer(a, periods.a) + outer(b, periods.b); }
};

/// Sums over the bodies of a block.
struct CellSums {
  Tensor2 here, before;  ///< of impulse times place, after the step and before it, N s m
  Tensor2 flux;          ///< of m u u, J
  double work = 0;       ///< J
};

/// State from which the motion of a cell continues.
struct CellMotion {
  Periods now, before;                    ///< at the start of this step, of the last one
  Tensor2 gradient = {};                  ///< L in the step that is being made, 1/s
  Voigt strain = {};                      ///< as in CellState
  Tensor2 moment = {};                    ///< sum of impulse times branch of the last kick, N s m
  Tensor2 stress = {};                    ///< deforming cells: at the start of this step, Pa
  std::array<CellControl, 2> controls{};  ///< of xx and yy
};

/// The cell in the present step.
struct MovingCell : CellMotion {
  bool active = false, deforms = false;
  Vec2 centre;                 ///< it stays in place, m
  double largest_radius = 0;   ///< of the bodies, m
  Periods next;                ///< at the end of this step
  std::vector<CellSums> sums;  ///< of each block
  ImageImpulses on_images;     ///< of contacts and bonds in this step
  double solid = 0;            ///< area of the bodies, m²
  /// For each body the periods by which it has been moved into the cell, with the opposite sign: where it would be.
  std::vector<PeriodicImage> crossed;

  [[nodiscard]] double area() const { return now.a.x * now.b.y; }
};

/// Set the cell of the scene, and take bodies as their images inside it; before candidates are found for the first
/// time. \param before an earlier scene of the run, whose centre stays; null: there is none
void set_cell(GrainSystem& system, const GrainSystem* before);

/// Set stiffness and viscosity of the controls by the contacts of the last step.
void measure_resistance(GrainSystem& system);
/// Choose the velocity gradient of the step.
/// \throws Error (computation_failed) if the cell has become thinner than two of the largest diameters
void steer_cell(GrainSystem& system);
/// As drift_of_verlet.
void drift_in_cell(GrainSystem& system);
/// The cell at the end of the step.
void advance_cell(GrainSystem& system);
/// As kick_of_verlet, and the work of the cell in the step.
void kick_in_cell(GrainSystem& system);
/// Set moment and stress where a cell begins to deform, from the contacts of the last step or of the first kick.
void begin_cell_stress(GrainSystem& system, std::span<const GrainContact> contacts);

/// The cell as it is, its stress by the contacts of the last step.
CellState state_of_cell(const GrainSystem& system, std::span<const GrainContact> contacts);

}  // namespace equidem
