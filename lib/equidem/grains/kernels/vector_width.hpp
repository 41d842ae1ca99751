// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How wide the vectors of the processor are that the loops by eights use. All widths give the same bits.
#pragma once

/// Functions compiled for vectors of 256 and of 512 bits. Neither fuses products and sums: the same bits on every
/// machine.
#define EQUIDEM_BY_FOURS __attribute__((target("avx2")))
#if defined(__clang__)
#define EQUIDEM_BY_EIGHTS __attribute__((target("avx2,avx512f,avx512vl,avx512dq")))
#else
#define EQUIDEM_BY_EIGHTS __attribute__((target("avx2,avx512f,avx512vl,avx512dq,prefer-vector-width=512")))
#endif

namespace equidem {

enum class VectorWidth { bits_128, bits_256, bits_512 };

/// The widest that the processor has (AVX-512 F, VL and DQ; AVX2) and that is allowed.
VectorWidth vector_width();

/// Use no wider ones from the next simulation on, so that widths can be compared.
void allow_vectors_up_to(VectorWidth widest);

}  // namespace equidem
