// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Mass and moment of inertia of discs and ellipses.
#pragma once

#include <vector>

#include "equidem/core/names.hpp"

namespace equidem {

/// The body that a disc of the model stands for.
enum class Body {
  disc,    ///< a cylinder per metre of depth: m = rho pi r², I = m r²/2
  sphere,  ///< m = rho 4/3 pi r³ (kg), I = 2 m r²/5
};

template <>
struct EnumNames<Body> {
  static constexpr const char* what = "body";
  static constexpr NamedValue<Body> list[] = {{Body::disc, "disc"}, {Body::sphere, "sphere"}};
};

/// I/(m r²): 1/2 of a disc, 2/5 of a sphere (beta of F9, F10).
double inertia_factor(Body body);

struct Inertia {
  double mass = 0;    ///< kg per metre of depth (disc), kg (sphere)
  double moment = 0;  ///< mass times m²
};

/// \param radius m, > 0
/// \param density of the disc itself, kg/m³
/// \throws Error (bad_input) where the density is not positive and finite
Inertia inertia_of(double radius, double density, Body body);
/// One Inertia for every disc.
std::vector<Inertia> inertia_of(const std::vector<double>& radii, double density, Body body);

/// An elliptic cylinder per metre of depth: m = rho pi a b, I = m (a² + b²)/4 (Sukegawa 2010, eq. 4.54).
/// \param a, b half-axes, m, > 0
/// \param density kg/m³
/// \throws Error (bad_input) where the density is not positive and finite
Inertia inertia_of_ellipse(double a, double b, double density);

}  // namespace equidem
