// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What one core of this machine can do.
#pragma once

namespace equidem::bench {

/// Bytes per second of a_i = b_i + s c_i on arrays far larger than the caches, 24 bytes per i.
double triad_bandwidth();

/// Double-precision operations per second of multiply-adds on four numbers at once, a multiply-add counting two.
double peak_arithmetic();

}  // namespace equidem::bench
