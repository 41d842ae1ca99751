// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How wide the vectors of the processor are that the loops by eights use. All widths give the same bits.
#pragma once

namespace equidem {

enum class VectorWidth { bits_128, bits_256, bits_512 };

/// The widest that the processor has (AVX-512 F, VL and DQ; AVX2) and that is allowed.
VectorWidth vector_width();

/// Use no wider ones from the next simulation on, so that widths can be compared.
void allow_vectors_up_to(VectorWidth widest);

}  // namespace equidem
