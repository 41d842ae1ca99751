// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Survey of the waves of a periodic assembly: dispersion, sound, highest frequency, growth, and where it loses its
/// stiffness.
#pragma once

#include <optional>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/core/matrix.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/waves/bloch.hpp"
#include "equidem/waves/brillouin_zone.hpp"

namespace equidem {

/// A wave vector of the path along the points of symmetry.
struct PathPoint {
  double along = 0;  ///< rad/m, length of the path up to here
  ZonePoint at;
  std::vector<double> squared_frequencies;  ///< (rad/s)², ascending
  double critical_ratio = 0;                ///< NaN: not sought
};

/// Sound along one direction.
struct SoundAlong {
  double angle = 0;  ///< rad from the x axis
  BlochWaves::SoundSpeeds speeds;
};

struct WaveSurvey {
  PrimitiveCell cell;
  BrillouinZone zone;
  double mass_per_area = 0;  ///< kg/m²
  bool ratio_sought = true;  ///< false: contacts lie off the lines of centres, bend or carry forces that count
  int grid = 0;              ///< wave vectors along each reciprocal vector
  ZoneMaximum critical;      ///< of r_c: the wave that loses its stiffness first as kT/kN falls from 0
  ZoneMaximum highest;       ///< of omega²
  ZoneMaximum growing;       ///< of -omega²: positive where waves grow; not searched where K is no sum of squares
  /// On the grid and at the points of symmetry other than Gamma: wave vectors of waves that neither stretch nor slip
  /// any contact, kT of either sign counted by its size. Such waves are mechanisms of the infinite assembly; not
  /// searched where forces at rest count.
  std::vector<Vec2> free_waves;
  std::vector<PathPoint> path;
  std::vector<SoundAlong> sound;  ///< every 15 degrees from 0 to 165
  std::optional<double> squared_rotational_gap;
};

/// In place of the name of a point where the extremum lies at q -> 0, along the direction of its q.
constexpr const char* long_waves_name = "long waves";
/// Cells up to here are surveyed: K(q) is dense, 3 x 100 complex rows.
constexpr std::size_t most_discs_of_survey = 100;
/// Number of wave vectors of the survey, for estimates.
std::size_t survey_size(const PrimitiveCell& cell);

/// Grid and path are as fine as one disc in a cell of its own needs: a larger cell has a zone smaller by as much.
/// \param rotation restrained: rotations are unknowns of none of the waves; else of those of the critical ratio, and of
///         the others
///        where some kT is not 0
/// \throws Error (interrupted)
WaveSurvey survey_waves(const PrimitiveCell& cell, const std::vector<Inertia>& inertia, Rotation rotation);

/// c² in (m/s)²; negative where the continuum is unstable.
struct PlaneWaves {
  double longitudinal_squared = 0;  ///< of the wave whose motion is most along its direction
  double transverse_squared = 0;
  Vec2 longitudinal_motion;  ///< unit; that of the transverse wave is across it
};

/// Eigenvalues of A_ik = n_j n_l C_ijkl over the density: rho c² u = A u.
/// \param gradient_stiffness stress by displacement gradient, rows and columns (xx, yy, xy, yx), Pa
/// \param mass_per_area kg/m² (per metre of depth: of the assembly, not of its discs)
PlaneWaves plane_waves(const Matrix4& gradient_stiffness, double mass_per_area, Vec2 direction);

}  // namespace equidem
