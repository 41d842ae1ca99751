// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The laws of normal contact by name. tests/laws compiles the files that call visit_law anew, for a longer list.
#pragma once

#include <cstdlib>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "equidem/contact/laws/laws.hpp"
#include "equidem/core/names.hpp"

namespace equidem {

#define EQUIDEM_ENUMERATOR(listed, Law) listed,
/// One for each line of the list in laws/laws.hpp.
enum class NormalLaw { EQUIDEM_LAWS(EQUIDEM_ENUMERATOR) };
#undef EQUIDEM_ENUMERATOR

/// Names of the laws, in the order of the list; made in one file, so that a program can link a longer list.
std::vector<NamedValue<NormalLaw>> named_laws();

template <>
struct EnumNames<NormalLaw> {
  static constexpr const char* what = "law of collision";
  static inline const std::vector<NamedValue<NormalLaw>> list = named_laws();
};

struct LawDescription : LawFacts {
  NormalLaw law = {};
  double (*dashpot)(double c, double d) = nullptr;  ///< of a force law
};

/// All laws, in the order of the list.
std::span<const LawDescription> normal_laws();
const LawDescription& describe(NormalLaw law);
std::string to_string(NormalLaw law);

inline LawKind kind_of(NormalLaw law) {
  return describe(law).kind;
}
inline bool gives_force(NormalLaw law) {
  return kind_of(law) == LawKind::force;
}
inline bool is_map(NormalLaw law) {
  return kind_of(law) == LawKind::map;
}
inline bool is_simultaneous(NormalLaw law) {
  return kind_of(law) == LawKind::simultaneous;
}

/// "linear_dashpot or hertz_dashpot": the laws of a kind.
std::string names_of_laws(LawKind kind);

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
