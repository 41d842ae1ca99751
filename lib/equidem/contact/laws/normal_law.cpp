// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/laws/normal_law.hpp"

#include <array>
#include <string_view>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

template <class Law>
constexpr LawDescription description_of(NormalLaw law) {
  LawDescription description{Law::facts, law};
  if constexpr (Law::facts.kind == LawKind::force)
    description.dashpot = [](double c, double depth) { return Law::dashpot(c, depth); };
  return description;
}

#define EQUIDEM_CHECK_NAME(listed, Law) static_assert(std::string_view(#listed) == laws::Law::facts.name);
EQUIDEM_LAWS(EQUIDEM_CHECK_NAME)

#define EQUIDEM_ENTRY(listed, Law) description_of<laws::Law>(NormalLaw::listed),
constexpr std::array descriptions{EQUIDEM_LAWS(EQUIDEM_ENTRY)};

}  // namespace

std::vector<NamedValue<NormalLaw>> named_laws() {
  std::vector<NamedValue<NormalLaw>> names;
  names.reserve(descriptions.size());
  for (const LawDescription& law : descriptions) names.push_back({law.law, law.name});
  return names;
}

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
