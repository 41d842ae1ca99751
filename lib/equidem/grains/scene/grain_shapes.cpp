// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/grain_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/scene/clump.hpp"

namespace equidem {
namespace {

void check_length(const char* what, double length) {
  if (length > 0 && std::isfinite(length)) return;
  bad_input(fmt::format("the {} {} m is not positive", what, length), "a body has a size", "Give a number > 0");
}

}  // namespace

void GrainShapes::check_body(const char* shape) const {
  if (body_ == Body::disc) return;
  bad_input(fmt::format("{} among spheres", shape),
            "ellipses and clumps are cylinders, their mass is per metre of depth", "Write body = \"disc\" in [grains]");
}

void GrainShapes::make_disc(Grain& grain, double radius, double density) const {
  check_length("radius", radius);
  grain.radius = radius;
  grain.inertia = inertia_of(radius, density, body_);
}

void GrainShapes::make_ellipse(Grain& grain, double long_half_axis, double short_half_axis, double density) const {
  check_body("an ellipse");
  check_length("long half-axis", long_half_axis);
  check_length("short half-axis", short_half_axis);
  if (short_half_axis > long_half_axis) {
    bad_input(
        fmt::format("the short half-axis {} m is longer than the long one, {} m", short_half_axis, long_half_axis),
        "at angle 0 the long one lies along x", "Exchange them, and add a quarter turn (1.5708) to the angle");
  }
  grain.radius = long_half_axis;
  grain.short_half_axis = short_half_axis;
  grain.inertia = inertia_of_ellipse(long_half_axis, short_half_axis, density);
}

void GrainShapes::make_clump(Grain& grain, std::vector<Clump::Disc> discs, double density) {
  check_body("a clump");
  std::vector<std::array<double, 3>> key;
  for (const Clump::Disc& disc : discs) key.push_back({disc.offset.x, disc.offset.y, disc.radius});
  const auto [at, is_new] = known_.try_emplace(std::move(key), static_cast<int>(clumps_.size()));
  if (is_new) {
    constexpr double rounding = 1e-12;
    Clump centred = centred_clump(discs);
    const double shift = norm(centred.discs[0].offset - discs[0].offset);
    if (shift <= rounding * radius_of(centred)) centred.discs = std::move(discs);  // read back: the same bits
    clumps_.push_back(std::move(centred));
    inertias_.push_back(inertia_of_clump(clumps_.back(), 1));
  }
  const auto c = static_cast<std::size_t>(at->second);
  grain.clump = at->second;
  grain.radius = radius_of(clumps_[c]);
  grain.inertia = {density * inertias_[c].mass, density * inertias_[c].moment};
}

}  // namespace equidem
