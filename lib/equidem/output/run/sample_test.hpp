// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Laboratory tests of samples: stress against strain, strength, stiffness and dilatancy from the history of a run.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/output/plots/plot.hpp"
#include "equidem/output/results.hpp"

namespace equidem {

/// A sample of colliding discs, and the stages that load it.
struct LoadedSample {
  struct Stage {
    double start = 0;  ///< s; infinite: it has not begun
    const GrainScene* scene = nullptr;
  };
  std::vector<Stage> stages = {};     ///< their walls and cells count
  std::span<const Grain> discs = {};  ///< at the start: they give the section where no walls do
  double solid_area = 0;              ///< of the discs, m²; 0: not known
  bool bonded = false;
};

/// A sample between two or four straight walls, or a periodic cell. Stress and strain are those of the boundary,
/// compression positive: of walls the mean force on two opposite ones over the section that the others bound, from the
/// impulses between two rows of the history, and logarithmic strains.
///
/// p = (s1 + s2)/2 and q = s1 - s2 of the principal stresses in the plane. The mobilized angle of friction is
/// asin(q/(2 p)), in a shear box, where the stress along x is not known, atan(shear stress/normal stress). Its peak is
/// the largest, of means over 3 % of the rows while p exceeds 5 % of its largest; the residual angle is the mean over
/// the last fifth of the strain. The angle of dilatancy psi is that of Rowe (1962) and Bolton (1986), sin psi = -(rate
/// of volume strain)/(rate of the largest shear strain), by lines of least squares through 3 % of the rows on either
/// side of the peak. E50 = (q50 - q0)/strain where q50 = (q0 + largest q)/2, the secant modulus at half the strength of
/// triaxial tests (in plane strain, as discs are). The strength of a bonded sample is the largest stress along the axis
/// between two rows, that of a disc 2 P/(pi D) (Hondros 1959).
class SampleTest {
 public:
  enum class Kind { biaxial, shear_box, cell_compression, cell_shear, unconfined, brazilian };

  /// \param history text of history.csv
  /// \return none: no wall or cell loads a sample, or there are fewer than 4 rows since then
  static std::optional<SampleTest> read(const std::string& history, const LoadedSample& sample);
  /// Whether the scene has a test, for which a history would be needed.
  static bool loads(const LoadedSample& sample);

  /// sample {...}: named answers.
  [[nodiscard]] Results results() const;
  static constexpr const char* plot_names[] = {"stress_plot", "volume_plot", "friction_plot", "coordination_plot"};
  /// Some of plot_names: the last one of a cell alone.
  [[nodiscard]] std::vector<std::pair<std::string, Plot>> plots(const std::string& title) const;

 private:
  struct Reader;
  /// \param servo the test begins with the stage, not with the first motion
  void take_cell(Reader& read, bool shears, bool servo);
  /// Nothing where there are too few rows.
  void take_walls(Reader& read, const LoadedSample& sample, const GrainScene& scene, bool shears, bool servo);
  /// p and q, and the mobilized angle of friction, rad.
  struct Principal {
    double p = 0, q = 0, angle = 0;
  };
  [[nodiscard]] bool shears() const { return kind_ == Kind::shear_box || kind_ == Kind::cell_shear; }
  [[nodiscard]] bool breaks() const { return kind_ == Kind::unconfined || kind_ == Kind::brazilian; }
  [[nodiscard]] std::vector<double> strain() const;  ///< that of the plots: along the axis, or of shear
  [[nodiscard]] std::vector<Voigt> smooth_stress() const;
  [[nodiscard]] Principal principal(const Voigt& stress) const;
  [[nodiscard]] std::size_t window() const;  ///< rows on either side of a mean

  Kind kind_ = Kind::biaxial;
  bool along_y_ = true;  ///< the axis of loading, normal to the planes of shear
  bool extends_ = false;
  bool bonded_ = false;
  double start_ = 0;  ///< s
  std::vector<double> time_;
  std::vector<Voigt> strain_, stress_;             ///< since the start; yy is along the axis
  std::vector<double> void_ratio_, coordination_;  ///< empty: not known
};

}  // namespace equidem
