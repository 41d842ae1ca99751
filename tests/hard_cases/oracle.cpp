// SPDX-License-Identifier: GPL-3.0-or-later
#include "hard_cases/oracle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>

namespace equidem::test {
namespace {

Quad magnitude(Quad x) {
  return x < 0 ? -x : x;
}

/// From the root of the double, two steps of Newton.
Quad square_root(Quad x) {
  Quad root = std::sqrt(static_cast<double>(x));
  for (int step = 0; step < 2; ++step) root = (root + x / root) / 2;
  return root;
}

/// Derivatives of stretch and slip of one contact by the components of its two discs.
struct Row {
  std::array<std::size_t, 6> component{};
  std::array<Quad, 6> stretch{}, slip{};
  Quad length = 0, nx = 0, ny = 0;
};

class Network {
 public:
  Network(const Assembly& assembly, const ContactSprings& springs, const DegreesOfFreedom& unknowns)
      : springs_(springs), unknowns_(unknowns), b_(static_cast<std::size_t>(unknowns.per_disc)) {
    for (const Contact& contact : assembly.contacts) rows_.push_back(row_of(assembly, contact));
    number(assembly);
    factorize();
  }

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  [[nodiscard]] std::size_t size() const { return b_; }

  /// x := K^-1 x over the unknowns; what is held must be zero on entry.
  void solve(std::vector<Quad>& x) const {
    const std::size_t n = component_.size();
    std::vector<Quad> y(n);
    for (std::size_t r = 0; r < n; ++r) {
      y[r] = x[component_[r]];
      for (std::size_t c = first_[r]; c < r; ++c) y[r] -= at(r, c) * y[c];
    }
    for (std::size_t r = 0; r < n; ++r) y[r] = pivot_[r] != 0 ? y[r] / pivot_[r] : 0;
    for (std::size_t r = n; r-- > 0;) {
      for (std::size_t c = first_[r]; c < r; ++c) y[c] -= at(r, c) * y[r];
    }
    std::fill(x.begin(), x.end(), 0);
    for (std::size_t r = 0; r < n; ++r) x[component_[r]] = y[r];
  }

  /// force -= K u, or the forces of stretches and slips imposed beside those of u.
  void subtract_internal(const std::vector<Quad>& u, std::span<const std::array<Quad, 2>> imposed,
                         std::vector<Quad>& force) const {
    for (std::size_t c = 0; c < rows_.size(); ++c) {
      auto [dn, ds] = deformation(c, u);
      if (!imposed.empty()) dn += imposed[c][0], ds += imposed[c][1];
      for (std::size_t k = 0; k < 6; ++k) {
        if (k % 3 >= b_) continue;
        force[rows_[c].component[k]] -=
            springs_[c].kN * dn * rows_[c].stretch[k] + springs_[c].kT * ds * rows_[c].slip[k];
      }
    }
    for (std::size_t k = 0; k < force.size(); ++k) {
      if (unknowns_.held[k] != 0) force[k] = 0;
    }
  }

  [[nodiscard]] std::array<Quad, 2> deformation(std::size_t c, const std::vector<Quad>& u) const {
    std::array<Quad, 2> d{};
    for (std::size_t k = 0; k < 6; ++k) {
      if (k % 3 >= b_) continue;
      d[0] += rows_[c].stretch[k] * u[rows_[c].component[k]];
      d[1] += rows_[c].slip[k] * u[rows_[c].component[k]];
    }
    return d;
  }

 private:
  [[nodiscard]] Row row_of(const Assembly& assembly, const Contact& contact) const {
    Row row;
    Quad x = static_cast<Quad>(assembly.centres[contact.j].x) - assembly.centres[contact.i].x;
    Quad y = static_cast<Quad>(assembly.centres[contact.j].y) - assembly.centres[contact.i].y;
    if (assembly.period) {
      x += static_cast<Quad>(contact.shift_x) * assembly.period->x;
      y += static_cast<Quad>(contact.shift_y) * assembly.period->y;
    }
    row.length = square_root(x * x + y * y);
    row.nx = x / row.length, row.ny = y / row.length;
    for (std::size_t k = 0; k < 3; ++k) {
      row.component[k] = contact.i * b_ + k;
      row.component[3 + k] = contact.j * b_ + k;
    }
    const Quad a = unknowns_.rotation_scale;
    row.stretch = {-row.nx, -row.ny, 0, row.nx, row.ny, 0};
    row.slip = {row.ny, -row.nx, -contact.lever_i / a, -row.ny, row.nx, -contact.lever_j / a};
    return row;
  }

  void number(const Assembly& assembly) {
    std::vector<std::size_t> discs(assembly.size());
    std::iota(discs.begin(), discs.end(), 0);
    std::stable_sort(discs.begin(), discs.end(),
                     [&](std::size_t p, std::size_t q) { return assembly.centres[p].x < assembly.centres[q].x; });
    position_.assign(unknowns_.held.size(), -1);
    for (const std::size_t d : discs) {
      for (std::size_t k = d * b_; k < (d + 1) * b_; ++k) {
        if (unknowns_.held[k] != 0) continue;
        position_[k] = static_cast<std::ptrdiff_t>(component_.size());
        component_.push_back(k);
      }
    }
  }

  Quad& at(std::size_t r, std::size_t c) { return entries_[start_[r] + c - first_[r]]; }
  [[nodiscard]] Quad at(std::size_t r, std::size_t c) const { return entries_[start_[r] + c - first_[r]]; }

  void assemble() {
    const std::size_t n = component_.size();
    first_.resize(n);
    std::iota(first_.begin(), first_.end(), 0);
    const auto each = [&](auto visit) {
      for (std::size_t c = 0; c < rows_.size(); ++c) {
        for (std::size_t p = 0; p < 6; ++p) {
          for (std::size_t q = 0; q < 6; ++q) {
            if (p % 3 >= b_ || q % 3 >= b_) continue;
            const std::ptrdiff_t r = position_[rows_[c].component[p]], s = position_[rows_[c].component[q]];
            if (r >= 0 && s >= 0 && s <= r) visit(c, p, q, static_cast<std::size_t>(r), static_cast<std::size_t>(s));
          }
        }
      }
    };
    each([&](std::size_t, std::size_t, std::size_t, std::size_t r, std::size_t s) {
      first_[r] = std::min(first_[r], s);
    });
    start_.assign(n + 1, 0);
    for (std::size_t r = 0; r < n; ++r) start_[r + 1] = start_[r] + r + 1 - first_[r];
    entries_.assign(start_[n], 0);
    each([&](std::size_t c, std::size_t p, std::size_t q, std::size_t r, std::size_t s) {
      at(r, s) += springs_[c].kN * rows_[c].stretch[p] * rows_[c].stretch[q] +
                  springs_[c].kT * rows_[c].slip[p] * rows_[c].slip[q];
    });
  }

  /// Row by row: L_rc = (K_rc - sum L_rk D_k L_ck) / D_c.
  void factorize() {
    assemble();
    const Quad nothing = 1e-27;  // of the diagonal: round-off of zero
    pivot_.resize(component_.size());
    for (std::size_t r = 0; r < component_.size(); ++r) {
      const Quad diagonal = at(r, r);
      for (std::size_t c = first_[r]; c < r; ++c) {  // L_rc D_c for now
        for (std::size_t k = std::max(first_[r], first_[c]); k < c; ++k) at(r, c) -= at(r, k) * at(c, k);
      }
      for (std::size_t c = first_[r]; c < r; ++c) {
        const Quad scaled = at(r, c);
        at(r, c) = pivot_[c] != 0 ? scaled / pivot_[c] : 0;
        at(r, r) -= scaled * at(r, c);
      }
      pivot_[r] = magnitude(at(r, r)) > nothing * magnitude(diagonal) ? at(r, r) : 0;
    }
  }

  const ContactSprings& springs_;
  const DegreesOfFreedom& unknowns_;
  std::size_t b_;
  std::vector<Row> rows_;
  std::vector<std::ptrdiff_t> position_;  ///< per component; -1: held
  std::vector<std::size_t> component_, first_, start_;
  std::vector<Quad> entries_, pivot_;
};

}  // namespace

std::vector<Quad> exact_motion(const Assembly& assembly, const ContactSprings& springs,
                               const DegreesOfFreedom& unknowns, const std::vector<double>& force) {
  const Network network(assembly, springs, unknowns);
  std::vector<Quad> u(unknowns.prescribed.begin(), unknowns.prescribed.end());
  for (int pass = 0; pass < 2; ++pass) {  // the second refines
    std::vector<Quad> x(force.begin(), force.end());
    network.subtract_internal(u, {}, x);
    network.solve(x);
    for (std::size_t k = 0; k < u.size(); ++k) u[k] += x[k];
  }
  return u;
}

Matrix3 exact_stiffness(const Assembly& assembly, const ContactSprings& springs, Rotation rotation) {
  DegreesOfFreedom unknowns = number_unknowns(assembly, springs, derive_effects(springs, rotation), {});
  unknowns.held[0] = unknowns.held[1] = DegreesOfFreedom::supported;
  const Network network(assembly, springs, unknowns);
  std::vector<std::vector<std::array<Quad, 2>>> deformations;
  for (int k = 0; k < 3; ++k) {
    const Quad xx = k == 0, yy = k == 1, half = k == 2 ? 0.5 : 0;
    std::vector<std::array<Quad, 2>> imposed;
    for (const Row& row : network.rows()) {
      const Quad ux = (xx * row.nx + half * row.ny) * row.length, uy = (half * row.nx + yy * row.ny) * row.length;
      imposed.push_back({ux * row.nx + uy * row.ny, uy * row.nx - ux * row.ny});
    }
    std::vector<Quad> u(unknowns.held.size(), 0);
    for (int pass = 0; pass < 2; ++pass) {
      std::vector<Quad> x(u.size(), 0);
      network.subtract_internal(u, imposed, x);
      network.solve(x);
      for (std::size_t e = 0; e < u.size(); ++e) u[e] += x[e];
    }
    for (std::size_t c = 0; c < imposed.size(); ++c) {
      const auto d = network.deformation(c, u);
      imposed[c][0] += d[0], imposed[c][1] += d[1];
    }
    deformations.push_back(std::move(imposed));
  }
  Matrix3 stiffness{};
  for (int r = 0; r < 3; ++r) {
    for (int s = 0; s < 3; ++s) {
      Quad energy = 0;
      for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
        const auto &d = deformations[r][c], &e = deformations[s][c];
        energy += springs[c].kN * d[0] * e[0] + springs[c].kT * d[1] * e[1];
      }
      stiffness[r][s] = static_cast<double>(energy / assembly.area());
    }
  }
  return stiffness;
}

}  // namespace equidem::test
