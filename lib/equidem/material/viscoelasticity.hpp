// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Viscoelastic springs: complex stiffness over frequency, of models with springs and dashpots or of a table.
#pragma once

#include <complex>
#include <string>
#include <vector>

#include "equidem/core/names.hpp"

namespace equidem {

/// Model of a spring k; with x = omega tau its complex stiffness is k m(omega).
enum class SpringModel {
  elastic,         ///< m = 1
  kelvin_voigt,    ///< a dashpot tau k beside it: m = 1 + i x
  maxwell,         ///< a dashpot tau k behind it: m = i x/(1 + i x)
  standard_solid,  ///< a Maxwell arm of spring arm k and dashpot tau arm k beside it: m = 1 + arm i x/(1 + i x)
  table,           ///< m at given frequencies
};

template <>
struct EnumNames<SpringModel> {
  static constexpr const char* what = "model of a spring";
  static constexpr NamedValue<SpringModel> list[] = {{SpringModel::elastic, "elastic"},
                                                     {SpringModel::kelvin_voigt, "kelvin_voigt"},
                                                     {SpringModel::maxwell, "maxwell"},
                                                     {SpringModel::standard_solid, "standard_solid"},
                                                     {SpringModel::table, "table"}};
};

/// A measured complex stiffness over the elastic one, m, at one frequency.
struct MeasuredSpring {
  double frequency = 0;  ///< Hz
  std::complex<double> factor;
};

/// The complex stiffness of one spring k over k, for motions as exp(i omega t).
struct ViscoelasticSpring {
  SpringModel model = SpringModel::elastic;
  double time = 0;                         ///< tau, s; of the Maxwell model > 0
  double arm = 1;                          ///< spring of the Maxwell arm over k, > 0
  std::vector<MeasuredSpring> table = {};  ///< at ascending frequencies

  /// m(omega); of a table straight between its frequencies over the logarithm of frequency.
  /// \param frequency Hz, > 0
  /// \throws Error (bad_input) outside the frequencies of the table
  [[nodiscard]] std::complex<double> factor(double frequency) const;
};

/// Both springs of every contact: the elastic springs of a contact times these two factors, wherever they come from, a
/// weighting, moduli, or springs of its own.
struct Viscoelasticity {
  ViscoelasticSpring normal, tangential;
};

/// Whether the spring carries at rest what the elastic one does, whatever has happened before.
inline bool keeps_forces(const ViscoelasticSpring& spring) {
  return spring.model != SpringModel::maxwell && spring.model != SpringModel::table;
}

/// \param of "normal", "tangential", for messages
/// \throws Error (bad_input) where a number is out of range, frequencies of the table do not ascend, or a factor has a
///         negative real part (unstable) or imaginary part (it would yield energy in every cycle)
void check(const ViscoelasticSpring& spring, const std::string& of);

/// "normal kelvin_voigt, tau = 0.001 s; tangential elastic".
std::string describe(const Viscoelasticity& springs);

/// Frequencies, Hz, that show how the springs change: `per_decade` of each decade from a thousandth of the lowest
/// 1/(2 pi tau) to a thousand times the highest; of tables their own.
/// \throws Error (bad_input) where both springs are elastic
std::vector<double> frequencies_of_interest(const Viscoelasticity& springs, int per_decade);

/// `per_decade` frequencies of each decade, evenly spaced over their logarithm, both ends included.
/// \throws Error (bad_input) where the ends are not positive and ascending, or more than 10000 would come out
std::vector<double> logarithmic_frequencies(double lowest, double highest, int per_decade);

}  // namespace equidem
