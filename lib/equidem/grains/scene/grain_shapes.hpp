// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Shape, mass and moment of inertia of a body from its lengths and its density.
#pragma once

#include <array>
#include <map>
#include <vector>

#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

/// Sets the shapes of bodies and stores each distinct clump once (GrainScene::clumps).
class GrainShapes {
 public:
  explicit GrainShapes(Body body) : body_(body) {}

  /// Each function sets radius, half-axis or clump, and inertia of a grain.
  /// \param density kg/m³
  /// \throws Error (bad_input): lengths that are not positive, a short half-axis longer than the long one, no discs;
  ///         ellipses and clumps of spheres
  void make_disc(Grain& grain, double radius, double density) const;
  void make_ellipse(Grain& grain, double long_half_axis, double short_half_axis, double density) const;
  /// \param discs in the frame of the body, in any position; shifted so that the centroid of their union is the origin
  void make_clump(Grain& grain, std::vector<Clump::Disc> discs, double density);

  [[nodiscard]] const std::vector<Clump>& clumps() const { return clumps_; }

 private:
  void check_body(const char* shape) const;

  Body body_;
  std::vector<Clump> clumps_;
  std::vector<Inertia> inertias_;                                 ///< of clumps_, density 1
  std::map<std::vector<std::array<double, 3>>, int> known_ = {};  ///< discs as given
};

}  // namespace equidem
