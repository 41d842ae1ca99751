// SPDX-License-Identifier: GPL-3.0-or-later
// Does not compile: the law lacks its energy and its dashpot.
#include "equidem/contact/laws/linear_dashpot.hpp"

namespace equidem::laws {
struct Lacking : LinearDashpot {
  void energy() = delete;
  void dashpot() = delete;
};
}  // namespace equidem::laws

static_assert(equidem::check_law<equidem::laws::Lacking>());
