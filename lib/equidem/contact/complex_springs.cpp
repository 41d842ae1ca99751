// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/complex_springs.hpp"

#include <complex>

namespace equidem {

ComplexSprings complex_springs(const ContactSprings& elastic, const Viscoelasticity& viscoelasticity, double frequency,
                               double unit) {
  const std::complex<double> normal = unit * viscoelasticity.normal.factor(frequency);
  const std::complex<double> tangential = unit * viscoelasticity.tangential.factor(frequency);
  return {elastic.changed([&](const SpringConstants& k) {
            return SpringConstants{normal.real() * k.kN, tangential.real() * k.kT};
          }),
          elastic.changed([&](const SpringConstants& k) {
            return SpringConstants{normal.imag() * k.kN, tangential.imag() * k.kT};
          })};
}

}  // namespace equidem
