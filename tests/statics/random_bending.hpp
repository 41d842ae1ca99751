// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bending springs of contacts drawn at random.
#pragma once

#include <cstddef>
#include <vector>

#include "equidem/core/random.hpp"

namespace equidem::test {

/// A random share of the contacts has one, of the size of the other springs of 1 and levers of 0.5.
inline std::vector<double> random_bending(std::size_t contacts, Random& random) {
  const double bonded = random.uniform();
  std::vector<double> bending(contacts);
  for (double& kM : bending) kM = random.uniform() < bonded ? random.uniform(0.1, 0.5) : 0.0;
  return bending;
}

}  // namespace equidem::test
