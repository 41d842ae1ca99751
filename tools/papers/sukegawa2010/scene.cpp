// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/random.hpp"
#include "equidem/material/wave_speed_springs.hpp"
#include "equidem/packing/packing.hpp"
#include "equidem/packing/size_distribution.hpp"

#include "sukegawa2010/sukegawa2010.hpp"

namespace equidem::sukegawa2010 {
namespace {

bool is_pair(Shape shape) {
  return shape == Shape::bonded_pair || shape == Shape::rigid_pair;
}

SettlingOptions material_of(const Fill& fill) {
  const WaveSpeeds speeds = wave_speeds_from_shear(shear_speed, poisson_ratio);
  SettlingOptions options{.density = density,
                          .springs = springs_of_wave_speeds(density, speeds),
                          .damping = fill.damping,
                          .gravity = gravity,
                          .friction = fill.friction,
                          .wall_friction = wall_friction};
  const double bulk = 1 + bulk_void_ratio;
  switch (fill.bulk_density) {
    case Fill::BulkDensity::unused:
      break;
    case Fill::BulkDensity::of_springs: {
      // From E and nu, (2.23) to (2.26): the speeds are those of the medium, the density that of the discs.
      const ElasticModuli moduli =
          moduli_from_young(2 * (1 + poisson_ratio) * density * squared(shear_speed), poisson_ratio, Plane::strain);
      options.springs = springs_of_wave_speeds(bulk * density, wave_speeds_of(moduli, density));
      break;
    }
    case Fill::BulkDensity::of_springs_and_masses:
      options.density = bulk * density;
      options.springs = springs_of_wave_speeds(options.density, speeds);
      break;
  }
  options.springs.kN /= fill.softness;
  options.springs.kT /= fill.softness;
  return options;
}

/// Positions, radii and turns of the bodies at the start; a pair takes two places of a row.
Bodies placed(const Fill& fill) {
  const StartGrid& grid = fill.grid;
  const bool pairs = is_pair(fill.shape);
  const std::int64_t columns = pairs ? grid.columns / 2 : grid.columns;
  const double wide = StartGrid::cell * (pairs ? 2 : 1), high = pairs ? StartGrid::pair_row : StartGrid::cell;
  // Even rows of pairs begin at the left wall, odd rows end at the right one.
  const double shift = pairs ? StartGrid::cell / 2 : wide / 2;
  Random random(fill.seed);
  Bodies bodies;
  bodies.radii = draw_radii({.smallest = smallest_radius, .largest = largest_radius}, columns * grid.rows, random);
  for (std::int64_t k = 0; k < columns * grid.rows; ++k) {
    const std::int64_t row = k / columns, column = k % columns;
    bodies.centres.push_back({(static_cast<double>(column) + 0.5) * wide + (row % 2 == 1 ? shift : 0),
                              (static_cast<double>(row) + 0.5) * high * fill.row_share});
    if (fill.shape != Shape::disc) bodies.turns.push_back(random.uniform());
  }
  return bodies;
}

}  // namespace

GrainScene start_of(const Fill& fill) {
  GrainPacking packing;
  const SettlingOptions material = material_of(fill);
  make_grains({.kind = fill.shape}, placed(fill), material.density, packing);
  GrainScene scene = scene_of_box(fill.grid.width(), material);
  for (PairProperties& pair : scene.pairs) pair.cap = fill.cap;
  scene.grains = std::move(packing.grains);
  scene.clumps = std::move(packing.clumps);
  scene.bonds = std::move(packing.bonds);
  for (GrainBond& bond : scene.bonds) {
    bond.normal_dashpot = 0.5 * scene.grains[bond.i].inertia.mass / fill.bond_step;
    bond.tangential_dashpot = bond.normal_dashpot / 3;  // a tangential force also turns the disc: a third of its mass
  }
  return scene;
}

double step_of(const GrainScene& scene, const Fill& fill) {
  return fill.step ? *fill.step : fill.step_share * contact_step_limit(scene, material_of(fill));
}

GrainOptions options_of(const GrainScene& scene, const Fill& fill) {
  return {.law = NormalLaw::linear_dashpot,
          .integrator = GrainOptions::Integrator::corrected_verlet,
          .time_step = step_of(scene, fill),
          .ellipse_law = fill.ellipse_law};
}

}  // namespace equidem::sukegawa2010
