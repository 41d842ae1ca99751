// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/pair_energies.hpp"

#include <array>

#include "equidem/homogenize/contact_sums.hpp"

namespace equidem {

PairEnergies pair_energies(const ContactSprings& springs, const std::vector<std::vector<ContactDeformation>>& d) {
  const auto sums = contact_sums<12>(d[0].size(), [&](std::size_t c, std::array<double, 12>& total) {
    const SpringConstants k = springs[c];
    std::size_t entry = 0;
    for (int a = 0; a < 3; ++a) {
      for (int b = a; b < 3; ++b, ++entry) {
        total[entry] += k.kN * d[a][c].normal * d[b][c].normal;
        total[6 + entry] += k.kT * d[a][c].tangential * d[b][c].tangential;
      }
    }
  });
  PairEnergies result;
  std::size_t entry = 0;
  for (int a = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b, ++entry) {
      result.normal[a][b] = result.normal[b][a] = sums[entry];
      result.tangential[a][b] = result.tangential[b][a] = sums[6 + entry];
    }
  }
  return result;
}

}  // namespace equidem
