// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/simd.hpp"

#include <algorithm>
#include <atomic>

namespace equidem {
namespace {

VectorWidth width_of_processor() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq"))
    return VectorWidth::bits_512;
  if (__builtin_cpu_supports("avx2")) return VectorWidth::bits_256;
#endif
  return VectorWidth::bits_128;
}

std::atomic<VectorWidth>& allowed() {
  static std::atomic<VectorWidth> width{VectorWidth::bits_512};
  return width;
}

}  // namespace

VectorWidth vector_width() {
  static const VectorWidth own = width_of_processor();
  return std::min(own, allowed().load(std::memory_order_relaxed));
}

void allow_vectors_up_to(VectorWidth widest) {
  allowed() = widest;
}

}  // namespace equidem
