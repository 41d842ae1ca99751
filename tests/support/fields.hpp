// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Random fields on assemblies.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/statics/number_unknowns.hpp"

#include "support/catch.hpp"
#include "support/refusal.hpp"

namespace equidem::test {

/// Errors near round-off are the evidence of these tests: by default Catch2 shows ten digits.
inline const int digits_shown = Catch::StringMaker<double>::precision = 20;

inline std::vector<double> random_vector(std::size_t size, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> x(size);
  for (double& value : x) value = random.uniform(-1, 1);
  return x;
}

inline double largest(std::span<const double> x) {
  double size = 0;
  for (const double value : x) size = std::max(size, std::abs(value));
  return size;
}

inline double product(std::span<const double> x, std::span<const double> y) {
  double sum = 0;
  for (std::size_t k = 0; k < x.size(); ++k) sum += x[k] * y[k];
  return sum;
}

/// x + c y.
inline std::vector<double> combined(std::vector<double> x, double c, std::span<const double> y) {
  for (std::size_t k = 0; k < x.size(); ++k) x[k] += c * y[k];
  return x;
}

/// Nothing held.
inline DegreesOfFreedom all_free(const Assembly& assembly, int per_disc) {
  DegreesOfFreedom unknowns;
  unknowns.per_disc = per_disc;
  unknowns.rotation_scale = assembly.mean_radius();
  unknowns.held.assign(assembly.size() * per_disc, 0);
  unknowns.prescribed.assign(unknowns.held.size(), 0.0);
  unknowns.unknowns = static_cast<std::int64_t>(unknowns.held.size());
  return unknowns;
}

/// Components (u_x, u_y[, a theta]) as motions of discs.
inline std::vector<DiscMotion> as_motions(const DegreesOfFreedom& unknowns, std::span<const double> x) {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  std::vector<DiscMotion> motions(x.size() / b);
  for (std::size_t d = 0; d < motions.size(); ++d) {
    motions[d] = {{x[d * b], x[d * b + 1]}, b == 3 ? x[d * b + 2] / unknowns.rotation_scale : 0.0};
  }
  return motions;
}

/// Sets the number of threads and puts the old one back.
class ThreadsFor {
 public:
  explicit ThreadsFor(int count) : before_(thread_count()) { set_thread_count(count); }
  ~ThreadsFor() { set_thread_count(before_); }
  ThreadsFor(const ThreadsFor&) = delete;
  ThreadsFor& operator=(const ThreadsFor&) = delete;

 private:
  int before_;
};

}  // namespace equidem::test
