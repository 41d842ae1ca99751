// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The struct of a law by its name. Few files include this: they are compiled anew for another list of laws
/// (tests/laws).
#pragma once

#include <cstdlib>
#include <type_traits>

#include "equidem/contact/laws/normal_law.hpp"

namespace equidem {

/// Calls visitor(std::type_identity<Law>()) with the struct of a law.
template <class Visitor>
auto visit_law(NormalLaw law, const Visitor& visitor) {
  switch (law) {
#define EQUIDEM_VISIT(listed, Law) \
  case NormalLaw::listed:          \
    return visitor(std::type_identity<laws::Law>());
    EQUIDEM_LAWS(EQUIDEM_VISIT)
#undef EQUIDEM_VISIT
  }
  std::abort();
}

}  // namespace equidem
