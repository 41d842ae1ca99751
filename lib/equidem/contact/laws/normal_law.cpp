// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/laws/normal_law.hpp"

#include <array>
#include <string_view>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

template <class Law>
constexpr LawDescription description_of(NormalLaw law) {
  LawDescription d;
  d.law = law;
  d.name = Law::name;
  d.letter = Law::letter;
  d.source = Law::source;
  d.summary = Law::summary;
  d.kind = Law::kind;
  d.has_dashpot = Law::has_dashpot;
  d.usual_end = Law::usual_end;
  d.spring_power = Law::spring_power;
  d.stiffness_unit = Law::stiffness_unit;
  d.hertz_spring = Law::hertz_spring;
  d.steps_per_contact = Law::steps_per_contact;
  d.length_factor = Law::length_factor;
  d.energy = Law::energy;
  d.elastic_impact = Law::elastic_impact;
  d.stiffness_from_overlap = Law::stiffness_from_overlap;
  d.dissipation = Law::dissipation;
  d.damping_ratio = Law::damping_ratio;
  d.stable_step = Law::stable_step;
  d.check_range = Law::check_range;
  if constexpr (Law::kind == LawKind::force) {
    d.dashpot = [](double c, double depth) { return Law::dashpot(c, depth); };
  }
  if constexpr (Law::kind == LawKind::simultaneous) d.prepare = Law::prepare;
  return d;
}

#define EQUIDEM_CHECK_NAME(listed, Law) static_assert(std::string_view(#listed) == laws::Law::name);
EQUIDEM_LAWS(EQUIDEM_CHECK_NAME)
#define EQUIDEM_ENTRY(listed, Law) description_of<laws::Law>(NormalLaw::listed),
constexpr std::array descriptions{EQUIDEM_LAWS(EQUIDEM_ENTRY)};

}  // namespace

#define EQUIDEM_NAMED(listed, Law) {NormalLaw::listed, #listed},
std::vector<NamedValue<NormalLaw>> named_laws() {
  return {EQUIDEM_LAWS(EQUIDEM_NAMED)};
}
#undef EQUIDEM_NAMED

std::span<const LawDescription> normal_laws() {
  return descriptions;
}

const LawDescription& describe(NormalLaw law) {
  return descriptions[static_cast<std::size_t>(law)];
}

std::string to_string(NormalLaw law) {
  return describe(law).name;
}

std::string names_of_laws(LawKind kind) {
  std::vector<std::string> names;
  for (const LawDescription& law : descriptions) {
    if (law.kind == kind) names.emplace_back(law.name);
  }
  return joined(names, " or ");
}

}  // namespace equidem
