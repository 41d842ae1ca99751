// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The square lattice (section 2.2), waves with rotation restrained (section 4.3), discs of unequal radii (end of 4.2).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/material/spring_relations.hpp"
#include "equidem/waves/bloch.hpp"

#include "abe1996/abe1996.hpp"

namespace equidem::abe1996 {
namespace {

constexpr double confidence = 0.95;  // of intervals, of which only means and scatter are reported
constexpr double diagonal = std::numbers::pi / 4;

Assembly periodic_cell(const Lattice& lattice, double radius) {
  return lattice.make({.columns = 8, .rows = 8, .radius = radius, .periodic = true});
}

BlochWaves waves_of(const Assembly& cell, const SpringConstants& springs, bool rotation) {
  return {primitive_cell(cell, ContactSprings(springs)), inertia_of(cell, 1, Body::disc), rotation};
}

/// gamma c² of both waves, Pa.
SheetWaves moduli_along(const BlochWaves& waves, double angle) {
  const auto speeds = waves.sound_speeds({std::cos(angle), std::sin(angle)});
  return {waves.mass_per_area() * speeds.longitudinal_squared, waves.mass_per_area() * speeds.transverse_squared};
}

/// nu of plane strain of a uniaxial stress along x: with e22 = -(C12/C22) e11 in eq. (35).
double poisson_ratio_along_x(const Matrix3& c) {
  return c[0][1] / (c[1][1] + c[0][1]);
}

struct Scatter {
  Tensor2 mean, deviation;  ///< weighted by area
};

Scatter scatter_of(const std::vector<Tensor2>& stresses, const std::vector<double>& areas) {
  double total = 0;
  Scatter result{};
  for (std::size_t k = 0; k < stresses.size(); ++k) {
    total += areas[k];
    result.mean += areas[k] * stresses[k];
  }
  result.mean *= 1 / total;
  for (std::size_t k = 0; k < stresses.size(); ++k) {
    const Tensor2 d = stresses[k] + (-1.0) * result.mean;
    result.deviation += areas[k] / total * Tensor2{d.xx * d.xx, d.xy * d.xy, d.yx * d.yx, d.yy * d.yy};
  }
  for (const auto entry : {&Tensor2::xx, &Tensor2::xy, &Tensor2::yx, &Tensor2::yy})
    result.deviation.*entry = std::sqrt(result.deviation.*entry);
  return result;
}

/// One cell under the mean uniaxial stress of 1 Pa along x.
struct Sample {
  double solid_fraction = 0, coordination_number = 0;
  EffectiveModuli exact;
  ElasticModuli mean_field;
  Scatter in_cells, as_printed;
};

Sample measure(const Assembly& assembly, double ratio) {
  const ContactSprings springs(SpringConstants{1, ratio});
  const EffectiveStiffness found = effective_stiffness(assembly, springs);
  Sample sample;
  sample.solid_fraction = assembly.solid_fraction();
  sample.coordination_number = assembly.coordination_number();
  sample.exact = effective_moduli(found.stiffness);
  sample.mean_field = moduli_of({1, ratio}, isotropic_relation,
                                {.solid_fraction = sample.solid_fraction,
                                 .contact_density = sample.coordination_number / (2 * std::numbers::pi)});
  const Matrix3 compliance = inverse(found.stiffness);
  const auto states = strained_states(assembly, springs, found, 1);
  std::vector<ContactForce> forces(assembly.contacts.size());
  for (std::size_t k = 0; k < states.size(); ++k) {
    for (std::size_t c = 0; c < forces.size(); ++c) {
      forces[c].normal += compliance[k][0] * states[k].forces[c].normal;
      forces[c].tangential += compliance[k][0] * states[k].forces[c].tangential;
    }
  }
  std::vector<Tensor2> stresses = disc_stresses(assembly, forces);
  sample.in_cells = scatter_of(stresses, assembly.cell_areas);
  // (50) as printed, with the area of the disc over the solid fraction of the assembly in place of the cell
  std::vector<double> areas(assembly.size());
  for (std::size_t d = 0; d < areas.size(); ++d) {
    areas[d] = std::numbers::pi * assembly.radii[d] * assembly.radii[d] / sample.solid_fraction;
    stresses[d] *= assembly.cell_areas[d] / areas[d];
  }
  sample.as_printed = scatter_of(stresses, areas);
  return sample;
}

}  // namespace

std::vector<SquarePoint> measure_square_lattice(const Block& block) {
  const Assembly cell = periodic_cell(lattices::square, block.radius);
  std::vector<SquarePoint> points;
  for (const double ratio : {0.1, 0.25, 0.5, 1.0, 2.0}) {
    SquarePoint point;
    point.ratio = ratio;
    const SpringConstants springs{1, ratio};
    point.along_rows = effective_stiffness(cell, ContactSprings(springs)).stiffness;
    point.turned = rotated(point.along_rows, diagonal);
    point.anisotropy = effective_moduli(point.along_rows).anisotropy;
    point.nu_rows = poisson_ratio_along_x(point.along_rows);
    point.nu_diagonal = poisson_ratio_along_x(point.turned);
    const BlochWaves waves = waves_of(cell, springs, true);
    point.waves_rows = moduli_along(waves, 0);
    point.waves_diagonal = moduli_along(waves, diagonal);
    points.push_back(point);
  }
  return points;
}

std::vector<WavePoint> measure_restrained_waves(const Block& block) {
  const Assembly cell = periodic_cell(lattices::hexagonal, block.radius);
  std::vector<WavePoint> points;
  for (const double nu : {-0.5, 0.0, 0.1, 0.2, 0.25}) {
    WavePoint point;
    point.wanted = nu;
    const ElasticModuli wanted{.shear_modulus = 1, .poisson_ratio = nu};
    point.springs = springs_for(wanted, lattices::hexagonal_restrained);
    const BlochWaves waves = waves_of(cell, point.springs, false);
    for (int k = 0; k < 12; ++k) {
      const SheetWaves along = moduli_along(waves, k * std::numbers::pi / 12);
      const double shear = along.transverse, bulk = along.longitudinal - along.transverse;
      if (k == 0) {
        point.shear_modulus = shear;
        point.poisson_ratio = (bulk - shear) / (2 * bulk);
      }
      point.deviation = std::max(
          {point.deviation, std::abs(shear / wanted.shear_modulus - 1), std::abs(bulk / wanted.bulk_modulus_2d() - 1)});
    }
    const Matrix3 stress =
        effective_stiffness(cell, ContactSprings(point.springs), {.rotation = Rotation::restrained, .solver = {}})
            .stiffness;
    point.nu_of_tension = poisson_ratio_along_x(stress);
    points.push_back(point);
  }
  return points;
}

std::vector<UnequalPoint> measure_unequal_radii(const Block& block) {
  std::vector<UnequalPoint> points;
  for (const double spread : {1.0, 1.25, 1.5, 2.0}) {
    UnequalPoint point;
    point.spread = spread;
    std::vector<Sample> samples;
    for (int seed = 1; seed <= UnequalPoint::samples; ++seed) {
      samples.push_back(measure(delaunay_assembly({.discs = UnequalPoint::discs,
                                                   .points = PointProcess::poisson_disc,
                                                   .seed = static_cast<std::uint64_t>(seed),
                                                   .radii = {block.radius, spread * block.radius},
                                                   .periodic = true}),
                                UnequalPoint::ratio));
      stop_if_interrupted();
    }
    const auto estimate = [&](const auto& number) {
      std::vector<double> values;
      for (const Sample& sample : samples) values.push_back(number(sample));
      return estimate_mean(values, confidence);
    };
    point.solid_fraction = estimate([](const Sample& s) { return s.solid_fraction; });
    point.coordination_number = estimate([](const Sample& s) { return s.coordination_number; });
    point.nu = estimate([](const Sample& s) { return s.exact.poisson_strain; });
    point.shear_error =
        estimate([](const Sample& s) { return s.mean_field.shear_modulus / s.exact.shear_modulus - 1; });
    point.bulk_error =
        estimate([](const Sample& s) { return s.mean_field.bulk_modulus_2d() / s.exact.bulk_modulus_2d - 1; });
    point.scatter_xx = estimate([](const Sample& s) { return s.in_cells.deviation.xx; });
    point.scatter_yy = estimate([](const Sample& s) { return s.in_cells.deviation.yy; });
    point.scatter_xy = estimate([](const Sample& s) { return s.in_cells.deviation.xy; });
    point.printed_mean = estimate([](const Sample& s) { return s.as_printed.mean.xx; });
    point.printed_scatter = estimate([](const Sample& s) { return s.as_printed.deviation.xx; });
    points.push_back(point);
  }
  return points;
}

}  // namespace equidem::abe1996
