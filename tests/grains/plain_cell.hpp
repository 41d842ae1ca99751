// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies of a sheared periodic cell, all images compared with all; nothing is ever taken back into the cell.
#pragma once

#include <algorithm>
#include <tuple>
#include <vector>

#include "equidem/contact/finite_bond.hpp"
#include "equidem/geometry/shape_contact.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"

#include "grains/cell_scenes.hpp"

namespace equidem::test {

/// Contact of two parts of bodies: overlap > 0, normal from i to j, arms from the centres of the bodies.
struct PlainContact {
  std::int32_t i = 0, j = 0;
  double overlap = 0;
  Vec2 normal, arm_i, arm_j;
};

/// All contacts of bodies with all images of others.
/// \param a, b the periods; \param images periods to every side
inline std::vector<PlainContact> contacts_of_all_images(const std::vector<Grain>& grains,
                                                        const std::vector<Clump>& clumps, Vec2 a, Vec2 b, int images) {
  std::vector<PlainContact> found;
  const auto meet = [&](std::size_t i, std::size_t j, Vec2 branch) {
    const Vec2 axis_i = axis_at(grains[i].angle), axis_j = axis_at(grains[j].angle);
    for (const GrainPart& p : parts_of(grains[i], clumps)) {
      for (const GrainPart& q : parts_of(grains[j], clumps)) {
        const Vec2 to_i = offset_of(p, axis_i), to_j = offset_of(q, axis_j), way = branch + to_j - to_i;
        const double share = p.size / (p.size + q.size);
        PlainContact contact{static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), 0, {}, {}, {}};
        if (p.is_round() && q.is_round()) {
          const double distance = norm(way);
          contact.overlap = p.a + q.a - distance;
          contact.normal = way / distance;
          contact.arm_i = to_i + share * distance * contact.normal;
          contact.arm_j = to_j - (1 - share) * distance * contact.normal;
        } else {
          const EllipseContact met = contact_of_ellipses({p.a, p.b, axis_i}, {q.a, q.b, axis_j}, way);
          contact.overlap = -met.gap;
          contact.normal = met.normal;
          contact.arm_i = to_i + met.arm_i - share * contact.overlap * met.normal;
          contact.arm_j = to_j + met.arm_j + (1 - share) * contact.overlap * met.normal;
        }
        if (contact.overlap > 0) found.push_back(contact);
      }
    }
  };
  for (std::size_t i = 0; i < grains.size(); ++i)
    for (std::size_t j = i + 1; j < grains.size(); ++j)
      for (int m = -images; m <= images; ++m)
        for (int n = -images; n <= images; ++n) {
          const Vec2 branch =
              grains[j].position + static_cast<double>(m) * a + static_cast<double>(n) * b - grains[i].position;
          if (norm(branch) < grains[i].radius + grains[j].radius) meet(i, j, branch);
        }
  return found;
}

/// Elastic bodies without friction, and bonds with springs, in a cell of constant shear rate.
class PlainCell {
 public:
  PlainCell(const GrainScene& scene, double dt)
      : scene_(scene), grains_(scene.grains), forces_(scene.grains.size()), dt_(dt) {
    rate_ = scene.cell->rate_xy.value;
    shift_ = scene.cell->shift;
    for (const GrainBond& bond : scene.bonds) {
      const auto nearest = [&](const Vec2& shift) {
        return norm(grains_[bond.j].position + shift - grains_[bond.i].position);
      };
      std::vector<std::pair<int, int>> images;
      for (int m = -2; m <= 2; ++m)
        for (int n = -2; n <= 2; ++n) images.emplace_back(m, n);
      const auto [m, n] = *std::ranges::min_element(
          images, {}, [&](const auto& image) { return nearest(shift_of(image.first, image.second)); });
      const Vec2 branch = grains_[bond.j].position + shift_of(m, n) - grains_[bond.i].position;
      const double share = grains_[bond.i].radius / (grains_[bond.i].radius + grains_[bond.j].radius);
      bonds_.push_back({{branch,
                         share * norm(branch),
                         (1 - share) * norm(branch),
                         {.kN = bond.normal_spring, .kT = bond.tangential_spring},
                         bond.bending_spring},
                        m,
                        n,
                        grains_[bond.i].angle,
                        grains_[bond.j].angle});
    }
    find_forces();
  }
  void step() {
    const double middle = scene_.cell->corner.y + 0.5 * scene_.cell->height;
    const auto kick = [&] {
      for (std::size_t k = 0; k < grains_.size(); ++k) {
        grains_[k].velocity += 0.5 * dt_ / grains_[k].inertia.mass * forces_[k].u;
        grains_[k].spin += 0.5 * dt_ / grains_[k].inertia.moment * forces_[k].theta;
      }
    };
    const auto turn = [&] {
      for (Grain& grain : grains_) grain.velocity.x -= 0.5 * dt_ * rate_ * grain.velocity.y;
    };
    kick();
    turn();
    for (Grain& grain : grains_) {
      grain.position += dt_ * (grain.velocity + Vec2{rate_ * (grain.position.y - middle), 0});
      grain.angle += dt_ * grain.spin;
    }
    shift_ += dt_ * rate_ * scene_.cell->height;
    find_forces();
    turn();
    kick();
  }
  [[nodiscard]] const std::vector<Grain>& grains() const { return grains_; }
  [[nodiscard]] double shift() const { return shift_; }
  [[nodiscard]] std::size_t contacts_met() const { return contacts_met_; }

 private:
  struct Bond {
    FiniteBond springs;
    int m, n;
    double angle_i, angle_j;
  };
  [[nodiscard]] Vec2 shift_of(int m, int n) const {
    return {m * scene_.cell->width + n * shift_, n * scene_.cell->height};
  }
  void find_forces() {
    std::fill(forces_.begin(), forces_.end(), DiscMotion{});
    for (const PlainContact& c :
         contacts_of_all_images(grains_, scene_.clumps, {scene_.cell->width, 0}, {shift_, scene_.cell->height}, 9)) {
      const auto tied = [&](const GrainBond& bond) {
        return std::minmax(bond.i, bond.j) == std::minmax(static_cast<std::size_t>(c.i), static_cast<std::size_t>(c.j));
      };
      if (std::ranges::any_of(scene_.bonds, tied)) continue;
      ++contacts_met_;
      const Vec2 force = scene_.pairs[0].stiffness * c.overlap * c.normal;
      add(static_cast<std::size_t>(c.i), -force, -cross(c.arm_i, force));
      add(static_cast<std::size_t>(c.j), force, cross(c.arm_j, force));
    }
    for (std::size_t b = 0; b < bonds_.size(); ++b) {
      const Bond& bond = bonds_[b];
      const Grain &i = grains_[scene_.bonds[b].i], &j = grains_[scene_.bonds[b].j];
      const Vec2 way = j.position + shift_of(bond.m, bond.n) - i.position - bond.springs.branch;
      const BondMotion<double> motion{way.x, way.y, i.angle - bond.angle_i, j.angle - bond.angle_j};
      const BondForces<double> force = bond_forces(bond.springs, motion);
      add(scene_.bonds[b].i, {force.x, force.y}, force.moment_i);
      add(scene_.bonds[b].j, {-force.x, -force.y}, force.moment_j);
    }
  }
  void add(std::size_t grain, Vec2 force, double moment) {
    forces_[grain].u += force;
    forces_[grain].theta += moment;
  }

  GrainScene scene_;
  std::vector<Grain> grains_;
  std::vector<DiscMotion> forces_;
  std::vector<Bond> bonds_;
  double dt_, rate_ = 0, shift_ = 0;
  std::size_t contacts_met_ = 0;
};

/// How far the bodies of a cell are from those of another computation, in place (over all images) and velocity.
inline double distance_of_states(const std::vector<Grain>& grains, const std::vector<Grain>& others,
                                 const CellState& cell) {
  double apart = 0;
  for (std::size_t g = 0; g < grains.size(); ++g) {
    apart = std::max(apart, distance_in_cell(grains[g].position, others[g].position, cell));
    apart = std::max(apart, norm(grains[g].velocity - others[g].velocity));
    apart = std::max(apart, std::abs(grains[g].spin - others[g].spin));
    apart = std::max(apart, std::abs(grains[g].angle - others[g].angle));
  }
  return apart;
}

}  // namespace equidem::test
