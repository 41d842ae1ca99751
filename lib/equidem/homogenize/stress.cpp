// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/stress.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

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

Tensor2 average_stress(const Assembly& assembly, std::span<const Tensor2> stresses,
                       const std::function<bool(std::size_t disc)>& inside) {
  assert(stresses.size() == assembly.size() && assembly.cell_areas.size() == assembly.size());
  Tensor2 sum;
  double area = 0;
  for (std::size_t disc = 0; disc < stresses.size(); ++disc) {
    if (!inside(disc)) continue;
    sum += assembly.cell_areas[disc] * stresses[disc];
    area += assembly.cell_areas[disc];
  }
  if (!(area > 0)) {
    bad_input("the region holds no disc", "there is no stress to average", "Choose a region around some disc centres");
  }
  return (1 / area) * sum;
}

Tensor2 force_by_branch(const ContactFrame& frame, const ContactForce& f) {
  const Vec2 force = force_on_i(frame, f);
  return frame.offset_i != 0 || frame.offset_j != 0 ? outer(force, arm_of_i(frame) + arm_to_j(frame))
                                                    : (frame.lever_i + frame.lever_j) * outer(force, frame.normal);
}

Tensor2 macroscopic_stress(const Assembly& assembly, std::span<const ContactForce> forces) {
  assert(forces.size() == assembly.contacts.size());
  const double area = assembly.area();
  // Partial sums of a fixed length, added in order: the same bits for every number of threads, and rounding
  // errors that grow far slower than in one long sum.
  constexpr std::size_t block = 4096;
  std::vector<Tensor2> partial((forces.size() + block - 1) / block);
  parallel_tasks(partial.size(), [&](std::size_t task, int) {
    const std::size_t end = std::min(forces.size(), (task + 1) * block);
    for (std::size_t c = task * block; c < end; ++c) {
      partial[task] += force_by_branch(frame_of(assembly, c), forces[c]);
    }
  });
  return (1 / area) * std::accumulate(partial.begin(), partial.end(), Tensor2{});
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

StressAsymmetry stress_asymmetry(const Assembly& assembly, std::span<const ContactForce> forces,
                                 std::span<const double> moments) {
  assert(moments.empty() || moments.size() == assembly.size());
  return {.difference = asymmetry(macroscopic_stress(assembly, forces)),
          .moment_density = std::accumulate(moments.begin(), moments.end(), 0.0) / assembly.area()};
}

std::vector<ContactDeformation> affine_deformations(const Assembly& assembly, const Tensor2& gradient,
                                                    double rotation) {
  std::vector<ContactDeformation> result(assembly.contacts.size());
  for (std::size_t c = 0; c < result.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const DiscMotion i{.u = {}, .theta = rotation};
    const DiscMotion j{.u = gradient * assembly.branch(contact), .theta = rotation};
    result[c] = deformation(frame_of(assembly, c), i, j);
  }
  return result;
}

std::vector<ContactForce> affine_contact_forces(const Assembly& assembly, const ContactSprings& springs,
                                                const Tensor2& gradient, double rotation) {
  const std::vector<ContactDeformation> deformations = affine_deformations(assembly, gradient, rotation);
  std::vector<ContactForce> forces(deformations.size());
  for (std::size_t c = 0; c < forces.size(); ++c)
    forces[c] = force_of(springs, c, {deformations[c], rotation, rotation});
  return forces;
}

}  // namespace equidem
