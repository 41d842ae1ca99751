// SPDX-License-Identifier: GPL-3.0-or-later
#include "abe1996_random/mean_field.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/homogenize/bounds.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem::mean_field {
namespace {

constexpr double confidence = 0.95;  // of the intervals, which the report shows as standard errors

/// What one cell says at one weighting and ratio.
struct CellPoint {
  MeanFieldModuli exact, mean_field, voigt, uniform_stress;
  double anisotropy = 0;
};

struct Cell {
  double branch_scatter = 0, coordination_scatter = 0, contact_anisotropy = 0, solid_fraction = 0, coordination = 0;
  std::vector<CellPoint> points;  ///< weighting by weighting, ratio by ratio
};

Assembly build_cell(const Family& family, std::int64_t discs, std::uint64_t seed) {
  Assembly cell = delaunay_assembly(
      {.discs = discs, .points = family.points, .disorder = family.disorder, .seed = seed, .periodic = true});
  if (family.stretch == 1) return cell;
  const auto stretched = [&](Vec2 v) { return Vec2{family.stretch * v.x, v.y / family.stretch}; };
  for (Vec2& centre : cell.centres) centre = stretched(centre);
  cell.period = stretched(*cell.period);
  triangulate(cell);
  return cell;
}

/// Standard deviation over mean.
double relative_scatter(const std::vector<double>& values) {
  const MeanEstimate e = estimate_mean(values, confidence);
  return e.standard_deviation / e.mean;
}

MeanFieldModuli moduli_of_tensor(const Matrix3& stiffness) {
  const EffectiveModuli m = effective_moduli(stiffness);
  return {m.bulk_modulus_2d, m.shear_modulus, m.poisson_strain};
}

Cell compute_cell(const Plan& plan, const Family& family, std::uint64_t seed) {
  const Assembly assembly = build_cell(family, plan.discs, seed);
  Cell cell;
  std::vector<double> branches, contacts(assembly.size());
  for (const Contact& c : assembly.contacts) {
    branches.push_back(norm(assembly.branch(c)));
    contacts[c.i] += 1;
    contacts[c.j] += 1;
  }
  cell.coordination = assembly.coordination_number();
  cell.solid_fraction = assembly.solid_fraction();
  cell.branch_scatter = relative_scatter(branches);
  cell.coordination_scatter = cell.coordination * relative_scatter(contacts);
  const ContactHarmonics psi = contact_harmonics(assembly);
  cell.contact_anisotropy = std::hypot(std::hypot(psi.a2, psi.b2), std::hypot(psi.a4, psi.b4));
  for (const SpringWeighting weighting : weightings) {
    for (const double ratio : plan.ratios) {
      const ContactSprings springs = contact_springs(assembly, {1, ratio}, weighting);
      const EffectiveStiffness effective = effective_stiffness(assembly, springs);
      CellPoint point;
      point.exact = moduli_of_tensor(effective.stiffness);
      point.anisotropy = effective_moduli(effective.stiffness).anisotropy;
      point.voigt = moduli_of_tensor(voigt_stiffness(assembly, springs));
      point.uniform_stress = moduli_of_tensor(uniform_stress_estimate(assembly, springs));
      point.mean_field = mean_field_moduli(ratio, weighting, cell.solid_fraction, cell.coordination);
      cell.points.push_back(point);
    }
  }
  return cell;
}

template <typename Item>
MeanEstimate mean_over(const std::vector<const Cell*>& cells, const Item& item) {
  std::vector<double> values;
  for (const Cell* cell : cells) values.push_back(item(*cell));
  return estimate_mean(values, confidence);
}

Moduli moduli_over(const std::vector<const Cell*>& cells, std::size_t point, MeanFieldModuli CellPoint::*answer) {
  const auto mean = [&](double MeanFieldModuli::*modulus) {
    return mean_over(cells, [&](const Cell& cell) { return cell.points[point].*answer.*modulus; });
  };
  return {mean(&MeanFieldModuli::bulk), mean(&MeanFieldModuli::shear), mean(&MeanFieldModuli::poisson)};
}

Point point_over(const std::vector<const Cell*>& cells, std::size_t index) {
  const auto mean = [&](const auto& of) {
    return mean_over(cells, [&](const Cell& cell) { return of(cell.points[index]); });
  };
  Point point;
  point.exact = moduli_over(cells, index, &CellPoint::exact);
  point.mean_field = moduli_over(cells, index, &CellPoint::mean_field);
  point.voigt = moduli_over(cells, index, &CellPoint::voigt);
  point.uniform_stress = moduli_over(cells, index, &CellPoint::uniform_stress);
  point.shear_error = mean([](const CellPoint& p) { return p.mean_field.shear / p.exact.shear - 1; });
  point.bulk_error = mean([](const CellPoint& p) { return p.mean_field.bulk / p.exact.bulk - 1; });
  point.poisson_error = mean([](const CellPoint& p) { return p.mean_field.poisson - p.exact.poisson; });
  point.anisotropy = mean([](const CellPoint& p) { return p.anisotropy; });
  return point;
}

void evaluate_family(Result& result, std::size_t family, const std::vector<const Cell*>& cells) {
  Disorder disorder;
  disorder.branch_scatter = mean_over(cells, [](const Cell& c) { return c.branch_scatter; });
  disorder.coordination_scatter = mean_over(cells, [](const Cell& c) { return c.coordination_scatter; });
  disorder.contact_anisotropy = mean_over(cells, [](const Cell& c) { return c.contact_anisotropy; });
  disorder.solid_fraction = mean_over(cells, [](const Cell& c) { return c.solid_fraction; }).mean;
  disorder.coordination_number = mean_over(cells, [](const Cell& c) { return c.coordination; }).mean;
  result.disorder.push_back(disorder);
  for (std::size_t w = 0; w < weightings.size(); ++w) {
    for (std::size_t r = 0; r < result.plan.ratios.size(); ++r) {
      Point point = point_over(cells, w * result.plan.ratios.size() + r);
      point.family = family;
      point.weighting = weightings[w];
      point.ratio = result.plan.ratios[r];
      result.points.push_back(point);
    }
  }
}

std::vector<Family> families(const std::vector<double>& disorders) {
  std::vector<Family> all;
  for (const double disorder : disorders)
    all.push_back({.name = fmt::format("hexagonal, disorder {:g}", disorder), .disorder = disorder});
  all.push_back({.name = "Poisson-disc", .points = PointProcess::poisson_disc});
  all.push_back({.name = "random", .points = PointProcess::uniform});
  all.push_back({.name = "Poisson-disc, stretched", .points = PointProcess::poisson_disc, .stretch = 1.2});
  return all;
}

}  // namespace

Plan full_plan() {
  return {.families = families({0, 0.05, 0.1, 0.2, 0.3, 0.45}),
          .ratios = {0, 0.05, 0.1, 0.25, 0.5, 0.75, 1},
          .discs = 1600,
          .samples = 32};
}

Plan quick_plan() {
  return {.families = families({0, 0.1, 0.2, 0.45}), .ratios = {0, 0.25, 1}, .discs = 120, .samples = 4};
}

MeanFieldModuli mean_field_moduli(double ratio, SpringWeighting weighting, double solid_fraction,
                                  double coordination_number) {
  IsotropicMeasures measures{.solid_fraction = solid_fraction,
                             .contact_density = coordination_number / (2 * std::numbers::pi)};
  if (weighting == SpringWeighting::contact_density) measures.contact_density = 1;  // k / psi on psi contacts
  if (weighting == SpringWeighting::voronoi) measures = {.solid_fraction = 0.5, .contact_density = 1};
  const ElasticModuli moduli = moduli_of({1, ratio}, Packing::isotropic, measures);
  return {moduli.bulk_modulus_2d(), moduli.shear_modulus, moduli.poisson_ratio};
}

Result compute(const Plan& plan) {
  Result result;
  result.plan = plan;
  Stopwatch watch;
  Progress progress("homogenizing random cells:");
  const auto samples = static_cast<std::size_t>(plan.samples);
  const auto at_once = static_cast<std::size_t>(thread_count());
  for (std::size_t f = 0; f < plan.families.size(); ++f) {
    std::vector<std::optional<Cell>> cells(samples);
    std::vector<std::string> refusals(samples);
    for (std::size_t begin = 0; begin < samples; begin += at_once) {
      parallel_tasks(std::min(at_once, samples - begin), [&](std::size_t k, int) {
        const std::size_t s = begin + k;
        try {
          cells[s] = compute_cell(plan, plan.families[f], plan.first_seed + s);
        } catch (const Error& error) {
          if (error.kind() == ErrorKind::interrupted) throw;
          refusals[s] = fmt::format("{}, seed {}: {}", plan.families[f].name, plan.first_seed + s, error.what());
        }
      });
      const auto done = static_cast<double>(f * samples + std::min(begin + at_once, samples));
      progress.update(done / static_cast<double>(plan.families.size() * samples));
    }
    std::vector<const Cell*> accepted;
    for (std::size_t s = 0; s < samples; ++s) {
      if (cells[s])
        accepted.push_back(&*cells[s]);
      else
        result.refusals.push_back(refusals[s]);
    }
    if (accepted.empty())
      computation_failed(fmt::format("none of the cells of '{}' has moduli", plan.families[f].name),
                         "the first: " + result.refusals.back(), "");
    evaluate_family(result, f, accepted);
  }
  result.times.add("homogenizing", watch.lap());
  return result;
}

}  // namespace equidem::mean_field
