// SPDX-License-Identifier: GPL-3.0-or-later
#include <numbers>

#include "equidem/packing/packing_shape.hpp"

namespace equidem {

/// Two equal discs that touch.
UnitBody unit_pair(const PackingShape&) {
  return body_of_discs({{{-1, 0}, 1}, {{1, 0}, 1}}, 2 * std::numbers::pi);
}

}  // namespace equidem
