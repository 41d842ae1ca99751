// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/boundary.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "equidem/assembly/assembly.hpp"
#include "equidem/assembly/power_cells.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/linear/contact_graph.hpp"

namespace equidem {
namespace {

bool crosses(const Contact& contact) {
  return contact.shift_x != 0 || contact.shift_y != 0;
}

/// The sides of a free sample: its groups, or, where its region is turned, those of the region, so that the answer
/// turns with the sample.
std::array<RegionSide, 4> sides_of(const Assembly& assembly) {
  if (assembly.box && !assembly.box->upright()) return region_sides(assembly);
  const auto side = [&](const char* name, Vec2 outward) {
    const auto found = assembly.groups.find(name);
    if (found == assembly.groups.end() || found->second.discs.empty()) {
      bad_input(fmt::format("the assembly has no discs in the group '{}'", name),
                "the boundary of a sample that is not periodic is made of left, right, bottom and top",
                "Define these groups, or use a periodic assembly");
    }
    return RegionSide{outward, found->second};
  };
  return {side("left", {-1, 0}), side("right", {1, 0}), side("bottom", {0, -1}), side("top", {0, 1})};
}

/// Add m x to every vector, m such that sum a x = area I.
void satisfy_mean_strain(std::vector<Vec2>& a, const std::vector<Vec2>& x, double area) {
  Tensor2 has, square;
  for (std::size_t k = 0; k < a.size(); ++k) {
    has += outer(a[k], x[k]);
    square += outer(x[k], x[k]);
  }
  const double trace = square.xx + square.yy;
  if (!(determinant(square) > 1e-12 * trace * trace)) {
    bad_input("no contact crosses the period one of the two ways", "the cell can be pulled along one direction only",
              "Use a network that is joined to its images both ways");
  }
  const Tensor2 m = (Tensor2{area, 0, 0, area} + (-1.0) * has) * inverse(square);
  for (std::size_t k = 0; k < a.size(); ++k) a[k] += m * x[k];
}

struct Shift {
  std::int32_t x = 0, y = 0;
  bool operator==(const Shift&) const = default;
};

/// The periodic network with every disc at that image that has the most contacts without crossing the period: a
/// boundary that is cut then leaves few discs hanging by a single contact. Each move lowers the number of crossing
/// contacts, so that this ends.
Assembly wrapped_compactly(const Assembly& assembly) {
  Assembly wrapped = assembly;
  std::vector<Contact>& contacts = wrapped.contacts;
  const ContactGraph graph(assembly);
  bool moved = true;
  while (moved) {
    moved = false;
    for (std::size_t d = 0; d < assembly.size(); ++d) {
      const auto disc = static_cast<std::int32_t>(d);
      std::vector<std::pair<Shift, int>> votes = {{{}, 0}};  // the move by which contacts come to lie inside
      for (const auto& edge : graph.of(d)) {
        const Contact& contact = contacts[edge.contact];
        if (contact.i == contact.j) continue;
        const int sign = contact.i == disc ? 1 : -1;
        const Shift step{sign * contact.shift_x, sign * contact.shift_y};
        const auto same =
            std::find_if(votes.begin(), votes.end(), [&](const auto& vote) { return vote.first == step; });
        same != votes.end() ? ++same->second : (votes.push_back({step, 1}), 1);
      }
      const auto best = std::max_element(votes.begin(), votes.end(),
                                         [](const auto& a, const auto& b) { return a.second < b.second; });
      if (best->second <= votes.front().second) continue;
      moved = true;
      const Shift step = best->first;
      wrapped.centres[d] -= Vec2{step.x * assembly.period->x, step.y * assembly.period->y};
      for (const auto& edge : graph.of(d)) {
        Contact& contact = contacts[edge.contact];
        if (contact.i == contact.j) continue;
        const int sign = contact.i == disc ? -1 : 1;
        contact.shift_x += sign * step.x;
        contact.shift_y += sign * step.y;
      }
    }
  }
  return wrapped;
}

TractionSample cut_open(const Assembly& assembly, const ContactSprings& springs) {
  std::vector<std::int32_t> kept;
  TractionSample sample{wrapped_compactly(assembly), ContactSprings(SpringConstants{}), {}, {}};
  Assembly& opened = sample.assembly;
  opened.period.reset();
  const std::vector<Contact> contacts = std::move(opened.contacts);
  opened.contacts.clear();
  const std::vector<ContactArms> arms = std::exchange(opened.contact_arms, {});
  opened.facet_lengths.clear();
  for (const ContactNumbers& numbers : contact_numbers) numbers.clear(opened);
  std::vector<Vec2> a, steps;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const Contact& contact = contacts[c];
    if (!crosses(contact)) {
      opened.contacts.push_back(contact);
      if (!arms.empty()) opened.contact_arms.push_back(arms[c]);
      kept.push_back(static_cast<std::int32_t>(c));
      continue;
    }
    if (springs[c].kT == 0) {
      bad_input(fmt::format("contact {} crosses the period and has kT = 0", c),
                "cut open, it could not carry the shear of a uniform stress",
                "Leave out the traction bound, or give the contacts kT > 0");
    }
    const Vec2 l = assembly.branch(contact);
    const double facet = assembly.facet_lengths.empty() ? norm(l) : assembly.facet_lengths[c];
    a.push_back(facet / norm(l) * l);
    steps.push_back({contact.shift_x * assembly.period->x, contact.shift_y * assembly.period->y});
    sample.cuts.push_back({c, {}});
  }
  satisfy_mean_strain(a, steps, assembly.area());
  for (std::size_t k = 0; k < a.size(); ++k) sample.cuts[k].a = a[k];
  // Where every contact is cut, none has springs of its own.
  sample.springs = kept.empty() ? ContactSprings(springs[0]) : chosen_springs(springs, kept);
  return sample;
}

TractionSample load_sides(const Assembly& assembly, const ContactSprings& springs) {
  TractionSample sample{assembly, springs, {}, {}};
  std::vector<Vec2> a, x;
  Vec2 sum, mean;
  for (const auto& [outward, discs] : sides_of(assembly)) {
    if (discs.tributary_lengths.empty()) {
      bad_input("the discs of a side have no lengths",
                "a stress is spread over the sides by the length that each disc stands for",
                "Use boundary = \"displacement\", or a lattice or Delaunay assembly");
    }
    for (std::size_t k = 0; k < discs.discs.size(); ++k) {
      sample.shares.push_back({discs.discs[k], {}});
      a.push_back(discs.tributary_lengths[k] * outward);
      x.push_back(assembly.centres[discs.discs[k]]);
      sum += a.back();
      mean += x.back();
    }
  }
  const double count = static_cast<double>(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    a[k] -= sum / count;
    x[k] -= mean / count;
  }
  satisfy_mean_strain(a, x, assembly.area());
  for (std::size_t k = 0; k < a.size(); ++k) sample.shares[k].a = a[k];
  return sample;
}

}  // namespace

std::vector<std::uint8_t> boundary_discs(const Assembly& assembly) {
  std::vector<std::uint8_t> at_boundary(assembly.size(), 0);
  if (assembly.periodic()) {
    for (const Contact& contact : assembly.contacts) {
      if (crosses(contact)) at_boundary[contact.i] = at_boundary[contact.j] = 1;
    }
  } else {
    for (const RegionSide& side : sides_of(assembly)) {
      for (const std::int32_t disc : side.discs.discs) at_boundary[disc] = 1;
    }
  }
  return at_boundary;
}

TractionSample traction_sample(const Assembly& assembly, const ContactSprings& springs) {
  return assembly.periodic() ? cut_open(assembly, springs) : load_sides(assembly, springs);
}

}  // namespace equidem
