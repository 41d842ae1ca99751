// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A question that Abe (1996) leaves open: how far his mean field, eqs. (21) and (22), and the correction (11) are from
/// the exact moduli of random assemblies.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "equidem/assembly/point_process.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/stopwatch.hpp"

namespace equidem::abe1996_random {

/// Random assemblies of one kind: periodic Delaunay cells of equal discs.
struct Family {
  std::string name;
  PointProcess points = PointProcess::perturbed_hexagonal;
  double disorder = 0;  ///< of perturbed_hexagonal
  double stretch = 1;   ///< points are moved to (stretch x, y/stretch) before triangulation: anisotropic unless 1

  [[nodiscard]] bool disordered() const { return points != PointProcess::perturbed_hexagonal || disorder > 0; }
  [[nodiscard]] bool isotropic() const { return stretch == 1; }
};

struct Plan {
  std::vector<Family> families;
  std::vector<double> ratios;  ///< kT/kN, ascending
  std::int64_t discs = 0;      ///< per cell
  int samples = 0;             ///< cells per family
  std::uint64_t first_seed = 1;
};
/// \param quick seconds instead of minutes
Plan plan_of(bool quick);

inline constexpr std::array weightings{SpringWeighting::uniform, SpringWeighting::contact_density,
                                       SpringWeighting::voronoi, SpringWeighting::local_contact_density};

enum Modulus { bulk, shear, poisson };  ///< K and G in kN; nu of plane strain
enum Answer {
  exact,          ///< homogenized
  mean_field,     ///< Abe's, with phi, z and psi(theta) measured on the same cell
  voigt,          ///< every disc follows the uniform strain
  uniform_stress  ///< every contact carries its share of a uniform stress
};

/// Numbers of a cell or of a point by their place in an array.
constexpr std::size_t number_of(Answer answer, Modulus modulus) {
  return 3 * static_cast<std::size_t>(answer) + modulus;
}
/// Error of the mean field: nu less the exact one; G and K over the exact one, less 1.
constexpr std::size_t error_of(Modulus modulus) {
  return 12 + static_cast<std::size_t>(modulus);
}
inline constexpr std::size_t anisotropy = 15;  ///< of the exact tensor
template <class Number>
using Numbers = std::array<Number, 16>;

/// One family, weighting and ratio: estimates over the cells.
struct Point {
  std::size_t family = 0;
  SpringWeighting weighting = SpringWeighting::uniform;
  double ratio = 0;  ///< kT/kN
  Numbers<MeanEstimate> numbers;

  [[nodiscard]] double mean(std::size_t number) const { return numbers[number].mean; }
  [[nodiscard]] double mean(Answer answer, Modulus modulus) const { return mean(number_of(answer, modulus)); }
};

/// Geometry of the cells of a family, means over the cells.
struct Disorder {
  double branch_scatter = 0;        ///< standard deviation of branch lengths over their mean
  double coordination_scatter = 0;  ///< standard deviation of the number of contacts of a disc
  double contact_anisotropy = 0;    ///< sqrt(a_2² + b_2² + a_4² + b_4²) of psi(theta)
  double solid_fraction = 0;        ///< phi
  double coordination_number = 0;   ///< z
};

struct Result {
  Plan plan;
  std::vector<Disorder> disorder;     ///< per family
  std::vector<Point> points;          ///< family by family, weighting by weighting, ratio by ratio
  std::vector<std::string> refusals;  ///< cells without moduli, with the reason
  StageTimes times;

  [[nodiscard]] const Point& at(std::size_t family, std::size_t weighting, std::size_t ratio) const {
    return points[(family * weightings.size() + weighting) * plan.ratios.size() + ratio];
  }
  [[nodiscard]] const Family& family_of(const Point& point) const { return plan.families[point.family]; }
};

/// Compute everything; shows progress.
/// \throws Error (computation_failed) where no cell of a family has moduli
Result compute(const Plan& plan);

std::string report(const Result& result);

}  // namespace equidem::abe1996_random
