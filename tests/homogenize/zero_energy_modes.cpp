// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Moduli of cells whose discs roll or slide without energy, against the least energy over all motions.
#include <Eigen/Dense>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "equidem/contact/frame.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/sample_solver.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

struct Cell {
  std::string name;
  Assembly assembly;
};

struct Pair {
  int i, j, x, y;
};

/// Copies of a small cell of equal discs, scaled.
Cell copies(const std::string& name, Vec2 period, const std::vector<Vec2>& centres, const std::vector<Pair>& contacts,
            double radius, int columns, int rows, double unit) {
  Assembly out;
  out.kind = name;
  out.period = unit * Vec2{columns * period.x, rows * period.y};
  const int each = static_cast<int>(centres.size());
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      for (const Vec2 c : centres) {
        out.centres.push_back(unit * Vec2{c.x + x * period.x, c.y + y * period.y});
        out.radii.push_back(unit * radius);
      }
      for (const Pair& p : contacts) {
        const int to_x = x + p.x, to_y = y + p.y, in_x = (to_x + columns) % columns, in_y = (to_y + rows) % rows;
        Contact c{.i = each * (y * columns + x) + p.i,
                  .j = each * (in_y * columns + in_x) + p.j,
                  .lever_i = unit * radius,
                  .lever_j = unit * radius};
        c.shift_x = static_cast<decltype(c.shift_x)>((to_x - in_x) / columns);
        c.shift_y = static_cast<decltype(c.shift_y)>((to_y - in_y) / rows);
        out.contacts.push_back(c);
      }
    }
  }
  return {name + ", " + std::to_string(columns) + " x " + std::to_string(rows), std::move(out)};
}

std::vector<Cell> cells(double unit) {
  const double s = std::sqrt(3.0);
  std::vector<Cell> all;
  for (const int n : unit == 1 ? std::vector{1, 2, 6} : std::vector{1, 2}) {
    all.push_back(copies("honeycomb", {s, 3}, {{0, 0}, {s / 2, 0.5}, {s / 2, 1.5}, {0, 2}},
                         {{0, 1, 0, 0}, {0, 1, -1, 0}, {1, 2, 0, 0}, {2, 3, 0, 0}, {2, 3, 1, 0}, {0, 3, 0, -1}}, 0.5, n,
                         n, unit));
    all.push_back(copies("square", {1, 1}, {{0, 0}}, {{0, 0, 1, 0}, {0, 0, 0, 1}}, 0.5, n, n, unit));
    all.push_back(copies("chain", {1, 1}, {{0, 0}}, {{0, 0, 1, 0}}, 0.5, n, n, unit));
    if (n > 2) continue;
    all.push_back(copies("triangular", {1, s}, {{0, 0}, {0.5, s / 2}},
                         {{0, 0, 1, 0}, {1, 1, 1, 0}, {0, 1, 0, 0}, {0, 1, -1, 0}, {1, 0, 0, 1}, {1, 0, 1, 1}}, 0.5, n,
                         n, unit));
    all.push_back(copies("kagome", {2, 2 * s}, {{0, 0}, {1, 0}, {0.5, s / 2}, {1, s}, {2, s}, {1.5, 1.5 * s}},
                         {{0, 1, 0, 0},
                          {1, 0, 1, 0},
                          {0, 2, 0, 0},
                          {1, 2, 0, 0},
                          {3, 4, 0, 0},
                          {4, 3, 1, 0},
                          {3, 5, 0, 0},
                          {4, 5, 0, 0},
                          {2, 3, 0, 0},
                          {2, 4, -1, 0},
                          {5, 0, 1, 1},
                          {5, 1, 0, 1}},
                         0.5, n, n, unit));
  }
  return all;
}

/// C by the least energy over all motions, in extended precision; none where some mean strain has no energy.
std::optional<Matrix3> least_energy(const Assembly& cell, SpringConstants k) {
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const int b = k.kT > 0 ? 3 : 2;
  const auto each = static_cast<Eigen::Index>(k.kT > 0 ? 2 : 1), contacts = std::ssize(cell.contacts);
  Matrix by_motion(each * contacts, std::ssize(cell.centres) * b), by_strain(each * contacts, 3);
  for (Eigen::Index column = 0; column < by_motion.cols() + 3; ++column) {
    std::vector<DiscMotion> motions(cell.size());
    const bool strain = column >= by_motion.cols();
    if (!strain) {
      DiscMotion& one = motions[column / b];
      if (column % b == 0) one.u.x = 1;
      if (column % b == 1) one.u.y = 1;
      if (column % b == 2) one.theta = 1 / cell.mean_radius();
    }
    for (Eigen::Index c = 0; c < contacts; ++c) {
      const Contact& contact = cell.contacts[c];
      const ContactFrame frame = frame_of(cell, c);
      const ContactDeformation d =
          strain ? affine_deformation(frame, cell.branch(contact), unit_gradients[column - by_motion.cols()])
                 : deformation(frame, motions[contact.i], motions[contact.j]);
      Matrix& to = strain ? by_strain : by_motion;
      const Eigen::Index at = strain ? column - by_motion.cols() : column;
      to(each * c, at) = std::sqrt(static_cast<long double>(k.kN)) * d.normal;
      if (each == 2) to(2 * c + 1, at) = std::sqrt(static_cast<long double>(k.kT)) * d.tangential;
    }
  }
  Eigen::CompleteOrthogonalDecomposition<Matrix> least;
  least.setThreshold(1e-13L);
  least.compute(by_motion);
  const Matrix left = by_strain - by_motion * least.solve(by_strain);
  const Matrix energy = left.transpose() * left / static_cast<long double>(cell.period->x * cell.period->y);
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(energy);
  if (eigen.eigenvalues()[0] < 1e-13L * eigen.eigenvalues()[2]) return {};
  Matrix3 c{};
  for (int r = 0; r < 3; ++r)
    for (int s = 0; s < 3; ++s) c[r][s] = static_cast<double>(energy(r, s));
  return c;
}

}  // namespace

TEST_CASE("moduli_exist_where_every_mean_strain_has_energy_whatever_rolls_or_slides_for_every_kT") {
  for (const double unit : {1e-6, 1.0, 1e3}) {
    for (const Cell& cell : cells(unit)) {
      for (const double kT : {0.0, 1e-4, 1e-2, 1.0, 10.0, 1e3, 1e5, 1e8}) {
        const SpringConstants k{1e8, kT};
        const std::optional<Matrix3> expected = least_energy(cell.assembly, k);
        CAPTURE(cell.name, unit, kT, expected.has_value());
        EffectiveStiffness found;
        const Refusal refused = refusal_of([&] { found = effective_stiffness(cell.assembly, ContactSprings(k), {}); });
        CAPTURE(refused.message);
        const bool far_apart = kT > 0 && kT < 1e-8 * k.kN;  // an answer, or the reason that there is none
        CHECK((refused.message.empty() == expected.has_value() || (far_apart && refused.says("differ by a factor"))));
        if (!expected || !refused.message.empty()) continue;
        double wrong = 0, largest = 0;
        for (int r = 0; r < 3; ++r) {
          for (int c = 0; c < 3; ++c) {
            wrong = std::max(wrong, std::abs(found.stiffness[r][c] - (*expected)[r][c]));
            largest = std::max(largest, std::abs((*expected)[r][c]));
          }
        }
        CAPTURE(wrong, largest, found.error_bound);
        CHECK(wrong <= 2 * found.error_bound);
        if (!far_apart) CHECK(found.error_bound < 1e-12 * largest);
      }
    }
  }
}

TEST_CASE("a_honeycomb_of_discs_that_roll_has_the_moduli_of_its_contacts_in_series") {
  const Cell cell = cells(0.03)[0];
  for (const double kT : {1.0, 10.0, 1e3, 1e8}) {
    const double kN = 4e8;
    const EffectiveModuli m =
        effective_moduli(effective_stiffness(cell.assembly, ContactSprings({kN, kT}), {}).stiffness);
    CAPTURE(kT, m.bulk_modulus_2d, m.shear_modulus);
    CHECK(std::abs(m.bulk_modulus_2d - kN / (2 * std::sqrt(3.0))) < 1e-12 * kN);
    CHECK(std::abs(m.shear_modulus - kN * kT / (kN + kT) / std::sqrt(3.0)) < 1e-12 * kN);
  }
}
