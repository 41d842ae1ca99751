// SPDX-License-Identifier: GPL-3.0-or-later
#include <numbers>

#include "equidem/packing/packing_shape.hpp"

namespace equidem {

UnitBody unit_disc(const PackingShape&) {
  return {.area = std::numbers::pi, .gyration = 0.5};
}

}  // namespace equidem
