// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The laws of normal contact by name, with all functions used outside the loops over contacts.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "equidem/contact/laws/list.hpp"
#include "equidem/core/names.hpp"

namespace equidem {

#define EQUIDEM_ENUMERATOR(listed, Law) listed,
/// One for each line of laws/list.hpp.
enum class NormalLaw { EQUIDEM_LAWS(EQUIDEM_ENUMERATOR) };
#undef EQUIDEM_ENUMERATOR

/// Names of the laws, in the order of the list; made in one file, so that a program can link a longer list.
std::vector<NamedValue<NormalLaw>> named_laws();
template <>
struct EnumNames<NormalLaw> {
  static constexpr const char* what = "law of collision";
  static inline const std::vector<NamedValue<NormalLaw>> list = named_laws();
};

/// The members of a law's struct (laws/law.hpp). Functions that only some kinds have are null for the others.
struct LawDescription {
  NormalLaw law = {};
  const char *name = "", *letter = "", *source = "", *summary = "";
  LawKind kind = LawKind::force;
  bool has_dashpot = false;
  ContactEnd usual_end = ContactEnd::at_zero_force;
  double spring_power = 1;
  const char* stiffness_unit = "";
  bool hertz_spring = false;
  double steps_per_contact = 0;
  double (*length_factor)(double length) = nullptr;
  double (*energy)(double k, double d) = nullptr;
  ElasticImpact (*elastic_impact)(double k, double m, double v) = nullptr;
  double (*stiffness_from_overlap)(double overlap, double speed, double m, double damping_ratio) = nullptr;
  double (*dissipation)(double restitution, ContactEnd end) = nullptr;
  double (*damping_ratio)(double restitution, ContactEnd end) = nullptr;
  double (*stable_step)(double damping_ratio) = nullptr;
  void (*check_range)(double a, double restitution) = nullptr;
  double (*dashpot)(double c, double d) = nullptr;                                                    ///< force
  ExactPair (*prepare)(double m, double k, double dissipation, ContactEnd end, double dt) = nullptr;  ///< simultaneous
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

}  // namespace equidem
