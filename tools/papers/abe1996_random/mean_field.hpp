// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What Abe (1996) leaves open: how far his mean field, eqs. (21) and (22), and the correction (11) are from the exact
/// moduli of random assemblies.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/point_process.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/json.hpp"
#include "equidem/output/plots/plot.hpp"

namespace equidem::mean_field {

/// Random assemblies of one kind: periodic Delaunay cells of equal discs.
struct Family {
  std::string name;
  PointProcess points = PointProcess::perturbed_hexagonal;
  double disorder = 0;  ///< of perturbed_hexagonal
  double stretch = 1;   ///< points moved to (stretch x, y/stretch) before they are triangulated: anisotropic if not 1

  [[nodiscard]] bool disordered() const { return points != PointProcess::perturbed_hexagonal || disorder > 0; }
  [[nodiscard]] bool isotropic() const { return stretch == 1; }
};

struct Plan {
  std::vector<Family> families;
  std::vector<double> ratios;  ///< kT/kN, ascending
  std::int64_t discs = 0;      ///< in a cell
  int samples = 0;             ///< cells of each family
  std::uint64_t first_seed = 1;
};
Plan full_plan();
/// Seconds instead of minutes.
Plan quick_plan();

inline constexpr std::array weightings{SpringWeighting::uniform, SpringWeighting::contact_density,
                                       SpringWeighting::voronoi};

/// The isotropic moduli of one answer; K and G in kN, nu in plane strain.
struct Moduli {
  MeanEstimate bulk, shear, poisson;
};

/// One family, weighting and ratio: means over the cells.
struct Point {
  std::size_t family = 0;
  SpringWeighting weighting = SpringWeighting::uniform;
  double ratio = 0;            ///< kT/kN
  Moduli exact;                ///< homogenized
  Moduli mean_field;           ///< Abe's, with phi, z (and psi) measured on the same cell
  Moduli voigt;                ///< every disc follows the field on its true place
  Moduli uniform_stress;       ///< every contact carries its share of a uniform stress
  MeanEstimate shear_error;    ///< G of the mean field over the exact one, less 1
  MeanEstimate bulk_error;     ///< K likewise
  MeanEstimate poisson_error;  ///< nu of the mean field less the exact one
  MeanEstimate anisotropy;     ///< of the exact tensor
};

/// How disordered the cells of a family are.
struct Disorder {
  MeanEstimate branch_scatter;        ///< standard deviation of branch lengths over their mean
  MeanEstimate coordination_scatter;  ///< standard deviation of the number of contacts of a disc
  MeanEstimate contact_anisotropy;    ///< sqrt(a_2² + b_2² + a_4² + b_4²) of psi(theta)
  double solid_fraction = 0;          ///< phi, mean
  double coordination_number = 0;     ///< z, mean
};

struct Result {
  Plan plan;
  std::vector<Disorder> disorder;     ///< per family
  std::vector<Point> points;          ///< family by family, weighting by weighting, ratio by ratio
  std::vector<std::string> refusals;  ///< cells that have no moduli, with the reason
  StageTimes times;

  [[nodiscard]] const Point& at(std::size_t family, std::size_t weighting, std::size_t ratio) const {
    return points[(family * weightings.size() + weighting) * plan.ratios.size() + ratio];
  }
};

/// Compute everything; shows progress.
Result compute(const Plan& plan);

/// K and G in kN of Abe's mean field, nu = (1 - kT/kN)/4 (eq. 22): K = phi z/(2 pi) for equal springs (eq. 21); with
/// the correction (11), springs k/psi(theta), K = phi; with springs k h/l, whose facets obey sum h l = 2 A, K = 1/2.
struct MeanFieldModuli {
  double bulk = 0, shear = 0, poisson = 0;
};
MeanFieldModuli mean_field_moduli(double ratio, SpringWeighting weighting, double solid_fraction,
                                  double coordination_number);

std::string report(const Result& result);
/// One row per point.
Table table(const Result& result);
void add_result(JsonObject& object, const Result& result);
/// Names and plots, of each weighting: nu against kT/kN, errors of nu and G against the scatter of branch lengths.
std::vector<std::pair<std::string, Plot>> plots(const Result& result);

}  // namespace equidem::mean_field
