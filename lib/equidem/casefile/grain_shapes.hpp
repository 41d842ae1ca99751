// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs, ellipses, clumps: from what a case says of a body to its shape and mass.
#pragma once

#include <array>
#include <map>
#include <string_view>
#include <vector>

#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

/// Gives bodies their shapes; those of clumps, each once, are kept.
class GrainShapes {
 public:
  explicit GrainShapes(Body body) : body_(body) {}

  /// Each sets radius, half-axis or clump, and inertia of a grain.
  /// \param density kg/m³
  /// \throws Error (bad_input): lengths that are not positive, a short half-axis longer than the long one, no discs;
  ///         ellipses and clumps
  ///         of spheres
  void make_disc(Grain& grain, double radius, double density) const;
  void make_ellipse(Grain& grain, double long_half_axis, double short_half_axis, double density) const;
  /// \param discs anywhere, in the frame of the body: shifted so that the mass centre of their union is the origin
  void make_clump(Grain& grain, std::vector<Clump::Disc> discs, double density);

  [[nodiscard]] const std::vector<Clump>& clumps() const { return clumps_; }

 private:
  void check_body(const char* shape) const;

  Body body_;
  std::vector<Clump> clumps_;
  std::vector<Inertia> inertias_;                                 ///< of clumps_, density 1
  std::map<std::vector<std::array<double, 3>>, int> known_ = {};  ///< discs as given
};

/// "x y r; x y r": the discs of a clump in one cell of a table, m.
/// \throws Error (bad_input) where the text is something else
std::vector<Clump::Disc> clump_from(std::string_view text);

}  // namespace equidem
