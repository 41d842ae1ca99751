// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Vector width of the vectorized loops. All widths give bit-identical results.
#pragma once

/// Attributes of functions that are part of every function that calls them, and of functions compiled for vectors of
/// 256 and of 512 bits, without fused multiply-add: results are bit-identical on every machine.
#define EQUIDEM_ALWAYS_INLINE inline __attribute__((always_inline))
#define EQUIDEM_BY_FOURS __attribute__((target("avx2")))
#if defined(__clang__)
#define EQUIDEM_BY_EIGHTS __attribute__((target("avx2,avx512f,avx512vl,avx512dq")))
#else
#define EQUIDEM_BY_EIGHTS __attribute__((target("avx2,avx512f,avx512vl,avx512dq,prefer-vector-width=512")))
#endif

namespace equidem {

enum class VectorWidth { bits_128, bits_256, bits_512 };

/// The widest allowed vectors of the processor (AVX-512 F, VL and DQ; AVX2).
VectorWidth vector_width();

/// Limit the width from the next simulation on, so that widths can be compared.
void allow_vectors_up_to(VectorWidth widest);

namespace eight {

// Numbers in one vector of the processor.
using Two = double __attribute__((vector_size(16)));
using Four = double __attribute__((vector_size(32)));
using Eight = double __attribute__((vector_size(64)));

/// Twice as many numbers: compilers make slow code of vectors wider than those of the processor.
template <class Half>
struct Twice {
  Half low, high;
};

}  // namespace eight

/// Kernel::run<Lanes> for vectors of the three widths, Lanes being the eight numbers (pair_lanes.hpp); it is a static
/// function that is EQUIDEM_ALWAYS_INLINE.
template <class Kernel, class... Arguments>
void run_plain(Arguments... arguments) {
  Kernel::template run<eight::Twice<eight::Twice<eight::Two>>>(arguments...);
}
#if defined(__x86_64__)
template <class Kernel, class... Arguments>
EQUIDEM_BY_FOURS void run_by_fours(Arguments... arguments) {
  Kernel::template run<eight::Twice<eight::Four>>(arguments...);
}
template <class Kernel, class... Arguments>
EQUIDEM_BY_EIGHTS void run_by_eights(Arguments... arguments) {
  Kernel::template run<eight::Eight>(arguments...);
}
#endif

/// Kernel::run compiled for the widest allowed vectors.
template <class Kernel, class... Arguments>
auto by_vector_width() -> void (*)(Arguments...) {
#if defined(__x86_64__)
  if (vector_width() == VectorWidth::bits_512) return run_by_eights<Kernel, Arguments...>;
  if (vector_width() == VectorWidth::bits_256) return run_by_fours<Kernel, Arguments...>;
#endif
  return run_plain<Kernel, Arguments...>;
}

}  // namespace equidem
