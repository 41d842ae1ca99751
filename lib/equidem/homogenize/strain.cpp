// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/strain.hpp"

#include <cassert>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

double gauge_length(const Assembly& assembly, const StrainGauge& gauge) {
  return norm(assembly.centres[gauge.second] - assembly.centres[gauge.first]);
}

double gauge_strain(const Assembly& assembly, std::span<const DiscMotion> motions, const StrainGauge& gauge) {
  assert(motions.size() == assembly.size());
  const Vec2 l = assembly.centres[gauge.second] - assembly.centres[gauge.first];
  assert(dot(l, l) > 0);
  return dot(motions[gauge.second].u - motions[gauge.first].u, l) / dot(l, l);
}

Tensor2 fitted_displacement_gradient(const Assembly& assembly, std::span<const DiscMotion> motions,
                                     const std::function<bool(std::size_t disc)>& inside) {
  assert(motions.size() == assembly.size());
  std::vector<std::size_t> chosen;
  for (std::size_t disc = 0; disc < assembly.size(); ++disc)
    if (inside(disc)) chosen.push_back(disc);
  const auto weight = [&](std::size_t disc) { return assembly.cell_areas.empty() ? 1.0 : assembly.cell_areas[disc]; };

  double total = 0;
  Vec2 centre;
  Vec2 mean;
  for (const std::size_t disc : chosen) {
    total += weight(disc);
    centre += weight(disc) * assembly.centres[disc];
    mean += weight(disc) * motions[disc].u;
  }
  // Sums about the centroid: no digits are lost far from the origin or by a large rigid motion.
  // h = (sum w du dx^T) (sum w dx dx^T)^-1.
  Tensor2 second_moment;
  Tensor2 covariance;
  if (total > 0) {
    centre *= 1 / total;
    mean *= 1 / total;
    for (const std::size_t disc : chosen) {
      const Vec2 dx = assembly.centres[disc] - centre;
      second_moment += weight(disc) * outer(dx, dx);
      covariance += weight(disc) * outer(motions[disc].u - mean, dx);
    }
  }
  const Tensor2& s = second_moment;
  const double determinant = s.xx * s.yy - s.xy * s.yx;
  const double trace = s.xx + s.yy;
  // The ratio of the principal second moments, about determinant/trace²: rounding makes 1e-16 of it for discs
  // on a line, while two rows of 4e6 discs still have 1e-13.
  if (!(determinant > 1e-13 * trace * trace)) {
    bad_input(fmt::format("a displacement gradient cannot be fitted to {}",
                          counted(static_cast<long long>(chosen.size()), "disc")),
              "it takes three discs or more that are not on one line", "Choose a larger region");
  }
  const Tensor2 inverse = (1 / determinant) * Tensor2{s.yy, -s.xy, -s.yx, s.xx};
  return {
      covariance.xx * inverse.xx + covariance.xy * inverse.yx, covariance.xx * inverse.xy + covariance.xy * inverse.yy,
      covariance.yx * inverse.xx + covariance.yy * inverse.yx, covariance.yx * inverse.xy + covariance.yy * inverse.yy};
}

}  // namespace equidem
