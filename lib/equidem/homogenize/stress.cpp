// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/stress.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/internal_force.hpp"

namespace equidem {
namespace {

void check_cells(const Assembly& assembly) {
  if (assembly.cell_areas.size() != assembly.size()) {
    bad_input("the discs have no cell areas", "the stress of a disc is a sum over its contacts divided by its cell",
              "Measure the cells first");
  }
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    if (!(assembly.cell_areas[disc] > 0)) {
      bad_input(fmt::format("disc {} has the cell area {} m²", disc, assembly.cell_areas[disc]),
                "its stress is divided by this area, which must be positive",
                "Remove the disc, or give radii whose power cells all hold some area");
    }
  }
}

}  // namespace

bool cells_hold_area(const Assembly& assembly) {
  return assembly.size() > 0 && assembly.cell_areas.size() == assembly.size() &&
         std::ranges::all_of(assembly.cell_areas, [](double area) { return area > 0; });
}

std::vector<Tensor2> disc_stresses(const Assembly& assembly, std::span<const ContactForce> forces) {
  assert(forces.size() == assembly.contacts.size());
  check_cells(assembly);
  std::vector<Tensor2> stresses(assembly.size());
  for (std::size_t c = 0; c < forces.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const ContactFrame frame = frame_of(assembly, c);
    // j feels -F at -r_j n: the same sign of F_i l_j at both ends.
    const Vec2 force = force_on_i(frame, forces[c]);
    if (frame.offset_i != 0 || frame.offset_j != 0) {
      stresses[contact.i] += outer(force, arm_of_i(frame));
      stresses[contact.j] += outer(force, arm_to_j(frame));
      continue;
    }
    const Tensor2 force_by_normal = outer(force, frame.normal);
    stresses[contact.i] += frame.lever_i * force_by_normal;
    stresses[contact.j] += frame.lever_j * force_by_normal;
  }
  for (std::size_t disc = 0; disc < stresses.size(); ++disc) stresses[disc] *= 1 / assembly.cell_areas[disc];
  return stresses;
}

Tensor2 force_by_branch(const ContactFrame& frame, const ContactForce& f) {
  const Vec2 force = force_on_i(frame, f);
  return frame.offset_i != 0 || frame.offset_j != 0 ? outer(force, arm_of_i(frame) + arm_to_j(frame))
                                                    : (frame.lever_i + frame.lever_j) * outer(force, frame.normal);
}

ScaledStress scaled_stress(const Assembly& assembly, std::span<const ContactForce> forces) {
  assert(forces.size() == assembly.contacts.size());
  const auto [xx, xy, yx, yy, size] = contact_sums<5>(forces.size(), [&](std::size_t c, auto& sums) {
    const Tensor2 work = force_by_branch(frame_of(assembly, c), forces[c]);
    sums[0] += work.xx, sums[1] += work.xy, sums[2] += work.yx, sums[3] += work.yy, sums[4] += frobenius_norm(work);
  });
  const double area = assembly.area();
  return {(1 / area) * Tensor2{xx, xy, yx, yy}, size / area};
}

Tensor2 macroscopic_stress(const Assembly& assembly, std::span<const ContactForce> forces) {
  return scaled_stress(assembly, forces).stress;
}

double outer_moment(const Assembly& assembly, const LoadCase& loads, const Equilibrium& equilibrium) {
  const std::vector<double>& restraining = equilibrium.rotation_moments;
  double sum = std::accumulate(restraining.begin(), restraining.end(), 0.0);
  for (const Reaction& reaction : equilibrium.reactions) sum += reaction.moment;
  for (const Load& load : loads) {
    const double times =
        load.kind == LoadKind::total ? 1.0 : static_cast<double>(group(assembly, load.group).discs.size());
    sum += times * load.moment;
  }
  return sum;
}

std::vector<ContactForce> affine_contact_forces(const Assembly& assembly, const ContactSprings& springs,
                                                const Tensor2& gradient, double rotation) {
  std::vector<ContactForce> forces(assembly.contacts.size());
  for (std::size_t c = 0; c < forces.size(); ++c) {
    const DiscMotion i{.u = {}, .theta = rotation};
    const DiscMotion j{.u = gradient * assembly.branch(assembly.contacts[c]), .theta = rotation};
    forces[c] = force_of(springs, c, {deformation(frame_of(assembly, c), i, j), rotation, rotation});
  }
  return forces;
}

}  // namespace equidem
