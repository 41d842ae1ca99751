// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/bloch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace equidem {
BlochWaves::BlochWaves(PrimitiveCell cell, const std::vector<Inertia>& inertia, bool rotation)
    : cell_(std::move(cell)),
      per_disc_(rotation ? 3 : 2),
      any_tangential_(
          std::any_of(cell_.contacts.begin(), cell_.contacts.end(), [](const auto& c) { return c.springs.kT != 0; })),
      row_(cell_.size() * per_disc_, -1) {
  std::vector<char> touches(cell_.size(), 0), turned(cell_.size(), 0);
  for (const CellContact& contact : cell_.contacts) {
    touches[contact.i] = touches[contact.j] = 1;
    const double kT = any_tangential_ ? contact.springs.kT : 1;  // the critical ratio gives all of them one
    if (turns_against(contact.frame.lever_i, contact.frame.offset_i, kT)) turned[contact.i] = 1;
    if (turns_against(contact.frame.lever_j, contact.frame.offset_j, kT)) turned[contact.j] = 1;
    if (contact.kM > 0) turned[contact.i] = turned[contact.j] = 1;
    if (contact.prestress && turns_i(*contact.prestress, contact.frame)) turned[contact.i] = 1;
    if (contact.prestress && turns_j(*contact.prestress, contact.frame)) turned[contact.j] = 1;
  }
  for (std::size_t d = 0; d < cell_.size(); ++d) {
    const Inertia& body = inertia[cell_.discs[d]];
    mass_ += body.mass;
    for (int k = 0; k < per_disc_; ++k) {
      if ((k == 2 ? turned[d] : touches[d]) == 0) continue;
      row_[d * per_disc_ + k] = static_cast<std::int32_t>(components_.size());
      components_.push_back(static_cast<std::int32_t>(d * per_disc_ + k));
      const double scale = cell_.rotation_scale;
      inverse_root_mass_.push_back(1 / std::sqrt(k == 2 ? body.moment / (scale * scale) : body.mass));
    }
  }
}

ComplexMatrix BlochWaves::assemble(Springs springs, Order order, Vec2 q) const {
  ComplexMatrix matrix(size());
  const auto add = [&](std::int32_t d, std::int32_t e, const std::array<double, 9>& block, Complex factor,
                       bool turned) {
    for (int r = 0; r < per_disc_; ++r) {
      const std::int32_t row = row_[d * per_disc_ + r];
      for (int c = 0; c < per_disc_; ++c) {
        const std::int32_t column = row_[e * per_disc_ + c];
        if (row < 0 || column < 0) continue;
        matrix(row, column) += factor * (turned ? block[c * 3 + r] : block[r * 3 + c]);
      }
    }
  };
  for (const CellContact& contact : cell_.contacts) {
    ContactStiffness k = contact.stiffness(cell_.rotation_scale);
    if (springs == Springs::normal) k = k.normal_part();
    if (springs == Springs::tangential) {
      k = k.tangential_part();
      k.kT = any_tangential_ && k.kT == 0 ? 0 : contact.springs.kN;
    }
    std::array<double, 9> ii{}, jj{}, ij{};
    k.add<3>(k.ends.i, k.ends.i, ii.data());
    k.add<3>(k.ends.j, k.ends.j, jj.data());
    k.add<3>(k.ends.i, k.ends.j, ij.data());
    const double phase = dot(q, contact.branch);
    // exp(i s phase) = 1 + i s phase - s² phase²/2 for a wave vector s q
    Complex factor = {std::cos(phase), std::sin(phase)};
    if (order == Order::first) factor = {0, phase};
    if (order == Order::second) factor = {-0.5 * phase * phase, 0};
    const double own = order == Order::all ? 1 : 0;
    add(contact.i, contact.i, ii, own, false);
    add(contact.j, contact.j, jj, own, false);
    add(contact.i, contact.j, ij, factor, false);
    add(contact.j, contact.i, ij, std::conj(factor), true);
  }
  return matrix;
}

void BlochWaves::scale_by_mass(ComplexMatrix& matrix) const {
  for (std::size_t c = 0; c < size(); ++c)
    for (std::size_t r = 0; r < size(); ++r) matrix(r, c) *= inverse_root_mass_[r] * inverse_root_mass_[c];
}

ComplexMatrix BlochWaves::stiffness(Vec2 q) const {
  return assemble(Springs::given, Order::all, q);
}

ComplexMatrix BlochWaves::dynamic_matrix(Vec2 q) const {
  ComplexMatrix matrix = stiffness(q);
  scale_by_mass(matrix);
  return matrix;
}

std::vector<double> BlochWaves::squared_frequencies(Vec2 q) const {
  return eigenvalues(dynamic_matrix(q));
}

double BlochWaves::largest_second_order(double unit) const {
  double largest = 0;
  for (const Vec2 q : {Vec2{1 / unit, 0}, Vec2{0, 1 / unit}}) {
    ComplexMatrix second = assemble(Springs::given, Order::second, q);
    scale_by_mass(second);
    for (const Complex& entry : second.entries) largest = std::max(largest, std::abs(entry));
  }
  return largest;
}

BlochWaves::SoundSpeeds BlochWaves::sound_speeds(Vec2 direction) const {
  const Vec2 n = direction / norm(direction);
  // Lengths in units of the cell, so that the three orders are of one size.
  const double unit = std::sqrt(cell_.area());
  ComplexMatrix first = assemble(Springs::given, Order::first, n / unit);
  ComplexMatrix second = assemble(Springs::given, Order::second, n / unit);
  scale_by_mass(first), scale_by_mass(second);
  const LongWaves waves = long_waves(dynamic_matrix({}), first, second);
  // Share of a uniform motion along e: |sum sqrt(m) v.e|.
  const auto mean_motion = [&](const std::vector<Complex>& v, Vec2 e) {
    Complex sum = 0;
    for (std::size_t r = 0; r < size(); ++r) {
      const int k = components_[r] % per_disc_;
      if (k < 2) sum += v[r] / inverse_root_mass_[r] * (k == 0 ? e.x : e.y);
    }
    return std::norm(sum);
  };
  const auto most = [&](Vec2 e, std::size_t except) {
    std::size_t best = waves.vectors.size();
    double largest = -1;
    for (std::size_t k = 0; k < waves.vectors.size(); ++k) {
      if (k == except) continue;
      const double share = mean_motion(waves.vectors[k], e);
      if (share > largest) largest = share, best = k;
    }
    return best;
  };
  SoundSpeeds result;
  const double slowest = 1e-13 * largest_second_order(unit);  // less is round-off
  const std::size_t along = most(n, waves.vectors.size()), across = most(perpendicular(n), along);
  for (std::size_t k = 0; k < waves.vectors.size(); ++k) {
    const double squared = std::abs(waves.squared_speeds[k]) > slowest ? waves.squared_speeds[k] * unit * unit : 0;
    if (k == along)
      result.longitudinal_squared = squared;
    else if (k == across)
      result.transverse_squared = squared;
    else
      result.others.push_back(squared);
  }
  return result;
}

std::optional<double> BlochWaves::squared_rotational_gap() const {
  if (per_disc_ != 3) return {};
  const HermitianSpectrum modes = spectrum(dynamic_matrix({}));
  double largest = 0;
  for (const double value : modes.values) largest = std::max(largest, std::abs(value));
  std::optional<double> gap;
  for (std::size_t m = 0; m < modes.values.size(); ++m) {
    if (std::abs(modes.values[m]) <= 1e-11 * largest) continue;
    double turning = 0;
    for (std::size_t r = 0; r < size(); ++r)
      if (components_[r] % 3 == 2) turning += std::norm(modes.vectors(r, m));
    if (turning > 0.5 && (!gap || std::abs(modes.values[m]) < std::abs(*gap))) gap = modes.values[m];
  }
  return gap;
}

std::vector<char> BlochWaves::rotations() const {
  std::vector<char> rotation(size());
  for (std::size_t r = 0; r < size(); ++r) rotation[r] = components_[r] % per_disc_ == 2 ? 1 : 0;
  return rotation;
}

double BlochWaves::critical_ratio(Vec2 q) const {
  const std::vector<char> rotation = rotations();
  const double share = largest_share(condense(assemble(Springs::normal, Order::all, q), rotation),
                                     condense(assemble(Springs::tangential, Order::all, q), rotation));
  if (share == 0) return -std::numeric_limits<double>::infinity();
  return (share - 1) / share;
}

StiffnessOrders BlochWaves::orders(Springs springs) const {
  const double one = 1 / std::sqrt(cell_.area());  // lengths in units of the cell, so that the orders are of one size
  const auto of = [&](Order order, double x, double y) { return assemble(springs, order, {x * one, y * one}); };
  StiffnessOrders k{of(Order::all, 0, 0),
                    {of(Order::first, 1, 0), of(Order::first, 0, 1)},
                    {of(Order::second, 1, 0), of(Order::second, 1, 1), of(Order::second, 0, 1)}};
  for (std::size_t e = 0; e < k.second[1].entries.size(); ++e)
    k.second[1].entries[e] -= k.second[0].entries[e] + k.second[2].entries[e];
  return k;
}

LongWaveLoss BlochWaves::long_wave_loss() const {
  return find_long_wave_loss(orders(Springs::normal), orders(Springs::tangential), rotations());
}

}  // namespace equidem
