// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Moduli of jammed packings without friction: forces at rest make ellipses rigid, and what homogenization finds is
/// what cells that are strained and relaxed anew show.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/error.hpp"
#include "equidem/geometry/shape_contact.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/statics/load_bearing.hpp"

#include "packing/packings.hpp"
#include "support/catch.hpp"
#include "support/dense_oracle.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr SpringConstants smooth{1, 0};

GrainPacking jammed(double aspect, std::int64_t bodies, double overlap) {
  PackingOptions options = square_box(PackingMethod::growth, PackingBox::Sides::periodic, bodies, 0.5);
  if (aspect > 1) options.shape = {.kind = PackingShape::Kind::ellipse, .aspect = aspect};
  const double side = std::sqrt(area_of(options.shape, options.radii) / 0.5);
  options.box.size = {side, side};
  options.as_dense_as_possible = true;
  options.overlap = overlap;
  return pack(options);
}

/// The cell as a system of its own: contacts along the common normals of the bodies as they lie, N = kN gap, and
/// derivatives by differences of single contacts. It shares the search for the common normal with the library, nothing
/// else.
class Cell {
 public:
  Cell(const GrainPacking& packing, const LoadBearingNetwork::Part& part) : size_(packing.box.size) {
    std::vector<std::size_t> number(packing.size(), packing.size());
    for (const std::int32_t disc : part.discs) {
      number[static_cast<std::size_t>(disc)] = bodies_.size();
      bodies_.push_back(packing.grains[static_cast<std::size_t>(disc)]);
      x_.insert(x_.end(), {bodies_.back().position.x, bodies_.back().position.y, bodies_.back().angle});
    }
    for (const Contact& c : part.assembly.contacts) pairs_.push_back(c);
  }

  /// Newton's method to the balance of all bodies at the mean strain h; the translation of body 0 is held.
  double relax(const Tensor2& h) {
    h_ = h;
    double residual = 0;
    for (int pass = 0; pass < 30; ++pass) {
      std::vector<double> f(x_.size());
      DenseMatrix k(x_.size());
      for (const Contact& pair : pairs_) add(pair, f, k);
      residual = 0;
      for (std::size_t p = 0; p < f.size(); ++p) residual = std::max(residual, std::abs(f[p]));
      for (std::size_t p = 0; p < f.size(); ++p) {
        const bool disc_turns = p % 3 == 2 && std::abs(k(p, p)) < 1e-10 * smooth.kN * squared(bodies_[p / 3].radius);
        if (p >= 2 && !disc_turns) continue;
        for (std::size_t q = 0; q < f.size(); ++q) k(p, q) = k(q, p) = 0;
        k(p, p) = 1, f[p] = 0;
      }
      if (residual < 1e-17) break;
      const std::vector<double> step = solve(k, f);
      for (std::size_t p = 0; p < f.size(); ++p) x_[p] += step[p];
    }
    return residual;
  }

  /// Cauchy stress, Pa.
  [[nodiscard]] Tensor2 stress() const {
    Tensor2 sum;
    for (const Contact& pair : pairs_) {
      const Vec2 l = branch(pair, x_);
      const EllipseContact contact = contact_at(pair, x_);
      const Vec2 on_i = smooth.kN * contact.gap * contact.normal;
      sum += Tensor2{on_i.x * l.x, on_i.x * l.y, on_i.y * l.x, on_i.y * l.y};
    }
    const double area = size_.x * size_.y * ((1 + h_.xx) * (1 + h_.yy) - h_.xy * h_.yx);
    return (1 / area) * sum;
  }

  /// The packing with its bodies as they lie here.
  [[nodiscard]] GrainPacking put_back(GrainPacking packing, const LoadBearingNetwork::Part& part) const {
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      Grain& grain = packing.grains[static_cast<std::size_t>(part.discs[k])];
      grain.position = {x_[3 * k], x_[3 * k + 1]};
      grain.angle = x_[3 * k + 2];
    }
    return packing;
  }

 private:
  [[nodiscard]] Vec2 branch(const Contact& pair, const std::vector<double>& x) const {
    const Vec2 shift{pair.shift_x * size_.x, pair.shift_y * size_.y};
    const std::size_t i = 3 * static_cast<std::size_t>(pair.i), j = 3 * static_cast<std::size_t>(pair.j);
    return Vec2{x[j] - x[i], x[j + 1] - x[i + 1]} + shift + h_ * shift;
  }
  [[nodiscard]] Ellipse ellipse(std::int32_t body, const std::vector<double>& x) const {
    const Grain& grain = bodies_[static_cast<std::size_t>(body)];
    const double b = grain.short_half_axis > 0 ? grain.short_half_axis : grain.radius;
    return Ellipse::at_angle(grain.radius, b, x[3 * static_cast<std::size_t>(body) + 2]);
  }
  [[nodiscard]] EllipseContact contact_at(const Contact& pair, const std::vector<double>& x) const {
    return contact_of_ellipses(ellipse(pair.i, x), ellipse(pair.j, x), branch(pair, x));
  }
  /// Forces and moments on i and j.
  [[nodiscard]] std::array<double, 6> forces(const Contact& pair, const std::vector<double>& x) const {
    const EllipseContact c = contact_at(pair, x);
    const Vec2 on_i = smooth.kN * c.gap * c.normal;
    return {on_i.x, on_i.y, cross(c.arm_i, on_i), -on_i.x, -on_i.y, -cross(c.arm_j, on_i)};
  }
  void add(const Contact& pair, std::vector<double>& f, DenseMatrix& k) {
    const auto place = [&](std::size_t c) {
      return c < 3 ? 3 * static_cast<std::size_t>(pair.i) + c : 3 * static_cast<std::size_t>(pair.j) + c - 3;
    };
    const std::array<double, 6> now = forces(pair, x_);
    for (std::size_t p = 0; p < 6; ++p) f[place(p)] += now[p];
    for (std::size_t q = 0; q < 6; ++q) {
      constexpr double width = 1e-7;
      std::vector<double> ahead = x_, behind = x_;
      ahead[place(q)] += width, behind[place(q)] -= width;
      const std::array<double, 6> after = forces(pair, ahead), before = forces(pair, behind);
      for (std::size_t p = 0; p < 6; ++p) k(place(p), place(q)) -= (after[p] - before[p]) / (2 * width);
    }
  }

  Vec2 size_;
  Tensor2 h_{};
  std::vector<Grain> bodies_;
  std::vector<Contact> pairs_;
  std::vector<double> x_;
};

/// d(Cauchy stress)/d(strain) by central differences of relaxed cells.
Matrix3 measured(const Cell& at_rest, double width) {
  const Tensor2 strains[] = {{1, 0, 0, 0}, {0, 0, 0, 1}, {0, 0.5, 0.5, 0}};
  Matrix3 result{};
  for (std::size_t k = 0; k < 3; ++k) {
    Cell ahead = at_rest, behind = at_rest;
    ahead.relax(width * strains[k]);
    behind.relax(-width * strains[k]);
    const Voigt s = voigt_stress((1 / (2 * width)) * (ahead.stress() + (-1.0) * behind.stress()));
    result[0][k] = s.xx, result[1][k] = s.yy, result[2][k] = s.xy;
  }
  return result;
}

}  // namespace

TEST_CASE("moduli_of_a_prestressed_cell_are_those_of_strained_cells_that_relax") {
  const double aspect = GENERATE(1.0, 1.3, 2.0), overlap = GENERATE(1e-3, 1e-2);
  const GrainPacking packing = jammed(aspect, 30, overlap);
  const ContactSprings springs(smooth);
  const Assembly raw = network_of(packing, {.springs = smooth});
  const LoadBearingNetwork bearing =
      load_bearing_network(raw, springs, derive_effects(raw, springs, Rotation::from_scene));
  const LoadBearingNetwork::Part whole{raw,
                                       springs,
                                       [&] {
                                         std::vector<std::int32_t> all;
                                         for (std::size_t d = 0; d < raw.size(); ++d)
                                           all.push_back(static_cast<std::int32_t>(d));
                                         return all;
                                       }(),
                                       {}};
  const LoadBearingNetwork::Part& part = bearing.part ? *bearing.part : whole;
  Cell cell(packing, part);
  const double residual = cell.relax({});
  const Assembly assembly = network_of(cell.put_back(packing, part), {.springs = smooth});
  REQUIRE(assembly.contacts.size() == raw.contacts.size());
  const auto chosen = choose_prestress(assembly, springs, PrestressChoice::automatic);
  REQUIRE(chosen);
  CAPTURE(aspect, overlap, part.discs.size(), part.assembly.contacts.size(), residual, chosen->sentence);
  REQUIRE(chosen->springs.prestressed());
  CHECK(chosen->balance.relative < 1e-5);  // a body that rattles has the largest

  const EffectiveStiffness found = effective_stiffness(assembly, chosen->springs);

  const double size = largest_entry(found.cauchy);
  const Matrix3 coarse = measured(cell, 4e-3 * overlap), fine = measured(cell, 1e-3 * overlap);
  const double error_coarse = largest_entry(coarse - found.cauchy) / size,
               error_fine = largest_entry(fine - found.cauchy) / size;
  CAPTURE(found.cauchy, fine, error_coarse, error_fine, found.hill_mandel, found.stress_asymmetry,
          found.stress_at_rest.xx, found.stress_at_rest.yy, found.stress_at_rest.xy, found.unstable_modes.value_or(-1));
  CHECK(error_fine < 1e-4);
  CHECK(error_fine < 0.2 * error_coarse + 1e-7);
  CHECK(found.hill_mandel < 1e-7);
  CHECK(found.stress_asymmetry < 1e-7);
  // Cells that jam between fixed sides are stable in them; few bodies may still give way to a shear of the cell
  // (Dagois-Bohy and others 2012, Phys. Rev. Lett. 109, 095703).
  CHECK(found.unstable_modes == found.unstable_strains);
  // The stress at rest is that of the cell, but for what bodies that rattle carry, which the cell does not hold; the
  // moduli differ from those of the springs alone.
  CHECK(found.stress_at_rest.xx == Approx(cell.stress().xx).epsilon(1e-9 + chosen->balance.relative));
  CHECK(found.stress_at_rest.xx < 0);
  CHECK(largest_entry(found.prestress_part) > 0.1 * chosen->largest * size);
}

// Ellipses without friction have fewer contacts than their unknowns need (z < 6): springs alone leave motions free.
TEST_CASE("frictionless_ellipses_have_moduli_by_their_forces_at_rest_alone") {
  const Assembly assembly = network_of(jammed(1.5, 60, 1e-3), {.springs = smooth});
  const ContactSprings springs(smooth);
  CHECK_THROWS_AS(effective_stiffness(assembly, springs), Error);
  const auto chosen = choose_prestress(assembly, springs, PrestressChoice::automatic);
  const EffectiveStiffness found = effective_stiffness(assembly, chosen->springs);
  const EffectiveModuli moduli = effective_moduli(found.stiffness);
  CAPTURE(assembly.coordination_number(), moduli.bulk_modulus_2d, moduli.shear_modulus,
          found.unstable_modes.value_or(-1));
  CHECK(assembly.coordination_number() < 6);
  CHECK(moduli.bulk_modulus_2d > 0.05);
  CHECK(moduli.shear_modulus > 0);
  CHECK(found.unstable_modes == 0);
}
