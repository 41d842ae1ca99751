// SPDX-License-Identifier: GPL-3.0-or-later
#include <numbers>

#include "equidem/packing/packing_shape.hpp"

namespace equidem {

UnitBody unit_clump(const PackingShape& shape) {
  return body_of_discs(shape.discs, std::numbers::pi);
}

}  // namespace equidem
