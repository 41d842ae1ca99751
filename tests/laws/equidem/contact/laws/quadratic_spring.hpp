// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A law for tests: the quadratic spring F = k d², without dashpot.
#pragma once

#include <cmath>
#include <stdexcept>

#include "equidem/contact/laws/law.hpp"

namespace equidem::laws {

struct QuadraticSpring {
  using Tangential = CoulombSpring;
  static constexpr LawFacts facts = {
      .name = "quadratic_spring",
      .letter = "Q",
      .summary = "quadratic spring",
      .has_dashpot = false,
      .spring_power = 2,
      .stiffness_unit = "N/m^2",
      .length_factor = [](double length) { return length; },
      // W = k d³/3
      .energy = [](double k, double d) { return k * d * d * d / 3; },
      // Overlap (3 m v²/(2 k))^(1/3); duration 2 overlap/v times the integral of 1/sqrt(1 - x³) over 0..1.
      .elastic_impact =
          [](double k, double m, double v) {
            const double overlap = std::cbrt(1.5 * m * v * v / k);
            return ElasticImpact{overlap, k * overlap * overlap, 2 * 1.40218210532545426 * overlap / v};
          },
      .stiffness_from_overlap =
          [](double overlap, double speed, double m, double /*damping_ratio*/) {
            return 1.5 * m * speed * speed / (overlap * overlap * overlap);
          },
      .dissipation = [](double restitution, ContactEnd /*end*/) -> double {
        return restitution == 1 ? 0 : throw std::invalid_argument("quadratic_spring has no dashpot: restitution is 1");
      },
      .damping_ratio = [](double /*restitution*/, ContactEnd /*end*/) { return 0.0; },
      // By the tangent stiffness at the largest overlap.
      .stable_step = [](double /*damping_ratio*/) { return 2.0; }};

  template <class Number>
  [[gnu::always_inline]] static Number spring(const Number& k, const Number& d) {
    return k * d * d;
  }
  template <class Number>
  [[gnu::always_inline]] static Number dashpot(const Number& /*c*/, const Number& /*d*/) {
    return Number{};
  }
};

}  // namespace equidem::laws
