// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/number_unknowns.hpp"

#include <cmath>
#include <optional>
#include <string>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// Hold one component of a disc at a value.
void hold(DegreesOfFreedom& unknowns, std::int32_t disc, int k, double value, const std::string& group) {
  const std::size_t component = static_cast<std::size_t>(disc) * unknowns.per_disc + k;
  if (unknowns.held[component] != 0 && unknowns.prescribed[component] != value) {
    const char* names[] = {"ux", "uy", "rotation"};
    bad_input(fmt::format("the support of '{}' prescribes {} of disc {} a second time", group, names[k], disc),
              "another support gives it a different value", "Prescribe each component of a disc once");
  }
  unknowns.held[component] = DegreesOfFreedom::supported;
  unknowns.prescribed[component] = value;
}

void check_value(const std::optional<double>& value, const std::string& key, const std::string& group) {
  if (value && !std::isfinite(*value)) {
    bad_input(fmt::format("the support of '{}' prescribes {} = {}", group, key, *value),
              "a motion must be a finite number", "Give a number in metres or radians");
  }
}

void apply(const Assembly& assembly, const Effects& effects, const Support& support, DegreesOfFreedom& unknowns) {
  const DiscGroup& discs = group(assembly, support.group);
  if (discs.discs.empty()) {
    bad_input(fmt::format("the support acts on the group '{}', which is empty", support.group), "it would hold nothing",
              "Choose a group with discs or mend its definition");
  }
  hold_group(discs, support, effects, unknowns);
}

}  // namespace

std::vector<std::uint8_t> resisted_rotations(const Assembly& assembly, const ContactSprings& springs) {
  std::vector<std::uint8_t> resisted(assembly.size(), 0);
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const ContactFrame frame = frame_of(assembly, c);
    if (turns_against(frame.lever_i, frame.offset_i, springs[c].kT)) resisted[contact.i] = 1;
    if (turns_against(frame.lever_j, frame.offset_j, springs[c].kT)) resisted[contact.j] = 1;
    if (springs.bending(c) > 0 && contact.i != contact.j) resisted[contact.i] = resisted[contact.j] = 1;
    const ContactPrestress* const prestress = springs.prestress(c);
    if (prestress == nullptr) continue;
    if (turns_i(*prestress, frame)) resisted[contact.i] = 1;
    if (turns_j(*prestress, frame)) resisted[contact.j] = 1;
  }
  return resisted;
}

void hold_group(const DiscGroup& discs, const Support& support, const Effects& effects, DegreesOfFreedom& unknowns) {
  check_value(support.ux, "ux", support.group);
  check_value(support.uy, "uy", support.group);
  check_value(support.rotation, "rotation", support.group);
  if (support.rotation && *support.rotation != 0 && !effects.rotation) {
    bad_input(fmt::format("the support of '{}' prescribes a rotation of {} rad", support.group, *support.rotation),
              "rotations are no unknowns of this scene and stay at zero",
              "Remove it, or let rotation = \"free\" with tangential springs");
  }
  for (const std::int32_t disc : discs.discs) {
    if (support.ux) hold(unknowns, disc, 0, *support.ux, support.group);
    if (support.uy) hold(unknowns, disc, 1, *support.uy, support.group);
    if (support.rotation && effects.rotation) {
      hold(unknowns, disc, 2, unknowns.rotation_scale * *support.rotation, support.group);
    }
  }
}

DegreesOfFreedom number_unknowns(const Assembly& assembly, const ContactSprings& springs, const Effects& effects,
                                 std::span<const Support> supports) {
  DegreesOfFreedom unknowns;
  unknowns.per_disc = effects.unknowns_per_disc();
  unknowns.rotation_scale = assembly.mean_radius();
  unknowns.held.assign(assembly.size() * unknowns.per_disc, 0);
  unknowns.prescribed.assign(unknowns.held.size(), 0.0);
  for (const Support& support : supports) apply(assembly, effects, support, unknowns);
  if (effects.rotation) {
    const std::vector<std::uint8_t> resisted = resisted_rotations(assembly, springs);
    for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
      std::uint8_t& held = unknowns.held[3 * disc + 2];
      if (resisted[disc] != 0 || held != 0) continue;
      held = DegreesOfFreedom::without_stiffness;
      ++unknowns.rotations_without_stiffness;
    }
  }
  for (std::size_t component = 0; component < unknowns.held.size(); ++component) {
    if (unknowns.held[component] != 0) continue;
    ++unknowns.unknowns;
    if (unknowns.per_disc == 3 && component % 3 == 2) ++unknowns.free_rotations;
  }
  return unknowns;
}

std::vector<DiscMotion> disc_motions(const DegreesOfFreedom& unknowns, std::span<const double> components) {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  std::vector<DiscMotion> motions(components.size() / b);
  for (std::size_t d = 0; d < motions.size(); ++d) {
    const double turn = b == 3 ? components[d * b + 2] / unknowns.rotation_scale : 0.0;
    motions[d] = {{components[d * b], components[d * b + 1]}, turn};
  }
  return motions;
}

}  // namespace equidem
