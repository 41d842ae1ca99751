// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The numbers that contacts may have of their own, two of each kind, as assemblies hold and files name them.
#pragma once

#include <vector>

#include "equidem/assembly/assembly.hpp"

namespace equidem {

/// Two lists of an assembly with one number for each contact, or empty.
struct ContactNumbers {
  const char* key;  ///< in assembly files
  const char* symbols;
  const char* unit;
  std::vector<double> Assembly::*first;
  std::vector<double> Assembly::*second;

  [[nodiscard]] bool given(const Assembly& assembly) const { return !(assembly.*first).empty(); }
  void add(double first_number, double second_number, Assembly& assembly) const {
    (assembly.*first).push_back(first_number);
    (assembly.*second).push_back(second_number);
  }
  void clear(Assembly& assembly) const {
    (assembly.*first).clear();
    (assembly.*second).clear();
  }
};

inline constexpr ContactNumbers contact_numbers[] = {
    {"springs", "kN, kT", "Pa", &Assembly::contact_kN, &Assembly::contact_kT},
    {"strengths", "f_t, f_s", "N/m", &Assembly::contact_tension, &Assembly::contact_shear},
    {"forces", "N, T", "N/m", &Assembly::contact_normal_force, &Assembly::contact_tangential_force},
    {"curvatures", "kappa_i, kappa_j", "1/m", &Assembly::contact_curvature_i, &Assembly::contact_curvature_j}};

}  // namespace equidem
