// SPDX-License-Identifier: GPL-3.0-or-later
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

#include "abe1996_random/abe1996_random.hpp"

namespace equidem::abe1996_random {
namespace {

constexpr double confidence = 0.95;  // of intervals, of which only the standard errors are reported

struct Cell {
  Disorder disorder;
  std::vector<Numbers<double>> points;  ///< weighting by weighting, ratio by ratio
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

std::array<double, 3> moduli_of_tensor(const Matrix3& stiffness) {
  const EffectiveModuli m = effective_moduli(stiffness);
  return {m.bulk_modulus_2d, m.shear_modulus, m.poisson_strain};
}

/// Abe's mean field: nu = (1 - kT/kN)/4 (eq. 22); K = phi z/(2 pi) kN for equal springs (eq. 21); with the correction
/// (11), springs k/psi, psi of all discs or of the two of a contact, K = phi kN; with springs k h/l, whose facets obey
/// sum h l = 2 A, K = kN/2.
std::array<double, 3> mean_field_moduli(double ratio, SpringWeighting weighting, const Disorder& cell) {
  IsotropicMeasures measures{.solid_fraction = cell.solid_fraction,
                             .contact_density = cell.coordination_number / (2 * std::numbers::pi)};
  if (weighting == SpringWeighting::contact_density || weighting == SpringWeighting::local_contact_density)
    measures.contact_density = 1;  // k / psi on psi contacts
  if (weighting == SpringWeighting::voronoi) measures = {.solid_fraction = 0.5, .contact_density = 1};
  const ElasticModuli moduli = moduli_of({1, ratio}, isotropic_relation, measures);
  return {moduli.bulk_modulus_2d(), moduli.shear_modulus, moduli.poisson_ratio};
}

Disorder disorder_of(const Assembly& assembly) {
  std::vector<double> branches, contacts(assembly.size());
  for (const Contact& c : assembly.contacts) {
    branches.push_back(norm(assembly.branch(c)));
    contacts[c.i] += 1;
    contacts[c.j] += 1;
  }
  const ContactHarmonics psi = contact_harmonics(assembly);
  const double z = assembly.coordination_number();
  return {.branch_scatter = relative_scatter(branches),
          .coordination_scatter = z * relative_scatter(contacts),
          .contact_anisotropy = std::hypot(std::hypot(psi.a2, psi.b2), std::hypot(psi.a4, psi.b4)),
          .solid_fraction = assembly.solid_fraction(),
          .coordination_number = z};
}

Cell compute_cell(const Plan& plan, const Family& family, std::uint64_t seed) {
  const Assembly assembly = build_cell(family, plan.discs, seed);
  Cell cell{.disorder = disorder_of(assembly), .points = {}};
  for (const SpringWeighting weighting : weightings) {
    for (const double ratio : plan.ratios) {
      const ContactSprings springs = contact_springs(assembly, {1, ratio}, weighting);
      const Matrix3 stiffness = effective_stiffness(assembly, springs).stiffness;
      Numbers<double> numbers{};
      const auto set = [&](Answer answer, const std::array<double, 3>& moduli) {
        std::copy(moduli.begin(), moduli.end(), numbers.begin() + number_of(answer, bulk));
      };
      set(exact, moduli_of_tensor(stiffness));
      set(mean_field, mean_field_moduli(ratio, weighting, cell.disorder));
      set(voigt, moduli_of_tensor(voigt_stiffness(assembly, springs)));
      set(uniform_stress, moduli_of_tensor(uniform_stress_estimate(assembly, springs)));
      for (const Modulus m : {bulk, shear})
        numbers[error_of(m)] = numbers[number_of(mean_field, m)] / numbers[number_of(exact, m)] - 1;
      numbers[error_of(poisson)] = numbers[number_of(mean_field, poisson)] - numbers[number_of(exact, poisson)];
      numbers[anisotropy] = effective_moduli(stiffness).anisotropy;
      cell.points.push_back(numbers);
    }
  }
  return cell;
}

/// Append the estimates over the cells of a family.
void evaluate_family(Result& result, std::size_t family, const std::vector<Cell>& cells) {
  const auto estimate = [&](const auto& number) {
    std::vector<double> values;
    for (const Cell& cell : cells) values.push_back(number(cell));
    return estimate_mean(values, confidence);
  };
  Disorder disorder;
  for (const auto member : {&Disorder::branch_scatter, &Disorder::coordination_scatter, &Disorder::contact_anisotropy,
                            &Disorder::solid_fraction, &Disorder::coordination_number})
    disorder.*member = estimate([&](const Cell& cell) { return cell.disorder.*member; }).mean;
  result.disorder.push_back(disorder);
  for (std::size_t k = 0; k < cells.front().points.size(); ++k) {
    const std::size_t ratios = result.plan.ratios.size();
    Point point{
        .family = family, .weighting = weightings[k / ratios], .ratio = result.plan.ratios[k % ratios], .numbers = {}};
    for (std::size_t n = 0; n < point.numbers.size(); ++n)
      point.numbers[n] = estimate([&](const Cell& cell) { return cell.points[k][n]; });
    result.points.push_back(point);
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

Plan plan_of(bool quick) {
  if (quick) return {.families = families({0, 0.1, 0.2, 0.45}), .ratios = {0, 0.25, 1}, .discs = 120, .samples = 4};
  return {.families = families({0, 0.05, 0.1, 0.2, 0.3, 0.45}),
          .ratios = {0, 0.05, 0.1, 0.25, 0.5, 0.75, 1},
          .discs = 1600,
          .samples = 32};
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
    std::vector<Cell> accepted;
    for (std::size_t s = 0; s < samples; ++s) {
      if (cells[s])
        accepted.push_back(std::move(*cells[s]));
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

}  // namespace equidem::abe1996_random
