// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Vector width of the vectorized loops. All widths give bit-identical results.
#pragma once

/// Attributes of functions compiled for vectors of 256 and of 512 bits, without fused multiply-add: results are
/// bit-identical on every machine.
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

}  // namespace equidem
