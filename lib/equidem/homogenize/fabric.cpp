// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/fabric.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/error.hpp"
#include "equidem/homogenize/contact_sums.hpp"

namespace equidem {
namespace {

/// Direction of the largest value of a cos k theta + b sin k theta, in [0, 2 pi/k).
double direction(double a, double b, int k) {
  const double angle = std::atan2(b, a) / k;
  const double period = 2 * std::numbers::pi / k;
  const double positive = angle < 0 ? angle + period : angle;
  return positive < period ? positive : 0;  // -1e-17 rounds up to the period
}

}  // namespace

Fabric fabric(const Assembly& assembly) {
  const std::size_t count = assembly.contacts.size();
  if (count == 0) {
    bad_input("the assembly has no contacts", "fabric is the distribution of their directions",
              "Give discs that touch, or contacts");
  }
  const auto [ll_xx, ll_xy, ll_yy, length] = contact_sums<4>(count, [&](std::size_t c, std::array<double, 4>& sums) {
    const Vec2 l = assembly.branch(assembly.contacts[c]);
    sums[0] += l.x * l.x;
    sums[1] += l.x * l.y;
    sums[2] += l.y * l.y;
    sums[3] += norm(l);
  });
  const ContactHarmonics h = contact_harmonics(assembly);
  // n_x² = (1 + cos 2 theta)/2, n_x n_y = sin 2 theta/2, and <cos 2 theta> = a_2/2.
  return {.normal = {0.5 + h.a2 / 4, h.b2 / 4, h.b2 / 4, 0.5 - h.a2 / 4},
          .branch = (1 / assembly.area()) * Tensor2{ll_xx, ll_xy, ll_xy, ll_yy},
          .anisotropy_2 = std::hypot(h.a2, h.b2),
          .direction_2 = direction(h.a2, h.b2, 2),
          .anisotropy_4 = std::hypot(h.a4, h.b4),
          .direction_4 = direction(h.a4, h.b4, 4),
          .mean_branch = length / static_cast<double>(count)};
}

}  // namespace equidem
