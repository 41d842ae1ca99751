// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/notch.hpp"

#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// Whether the segments a + [0, 1] u and b + [0, 1] v meet; parallel ones do not.
bool meet(Vec2 a, Vec2 u, Vec2 b, Vec2 v) {
  const double area = cross(u, v);
  if (area == 0) return false;
  const double s = cross(b - a, v) / area, t = cross(b - a, u) / area;
  return s >= 0 && s <= 1 && t >= 0 && t <= 1;
}

}  // namespace

std::vector<std::size_t> contacts_across(const Assembly& assembly, std::span<const Notch> notches) {
  std::vector<std::size_t> crossed;
  std::vector<std::size_t> count(notches.size(), 0);
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const Vec2 branch = assembly.branch(contact);
    bool any = false;
    for (std::size_t k = 0; k < notches.size(); ++k) {
      const Vec2 along = notches[k].to - notches[k].from;
      if (!meet(assembly.centres[contact.i], branch, notches[k].from, along) &&
          !meet(assembly.centres[contact.j], -branch, notches[k].from, along)) {
        continue;
      }
      ++count[k];
      any = true;
    }
    if (any) crossed.push_back(c);
  }
  for (std::size_t k = 0; k < notches.size(); ++k) {
    if (count[k] > 0) continue;
    const auto& [from, to] = notches[k];
    bad_input(
        fmt::format("the notch from ({:g}, {:g}) to ({:g}, {:g}) m crosses no contact", from.x, from.y, to.x, to.y),
        "it would cut nothing", "Give its ends inside the assembly, more than a disc apart");
  }
  return crossed;
}

}  // namespace equidem
