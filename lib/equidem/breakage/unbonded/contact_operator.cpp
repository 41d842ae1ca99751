// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/contact_operator.hpp"

#include <algorithm>
#include <cmath>

namespace equidem {
namespace {

/// Derivatives of stretch and slip by the components of both discs, those of the second from index b on.
struct FlatRows {
  std::array<double, 6> normal{}, tangential{};

  FlatRows(const DeformationGradient& by, std::size_t b) {
    for (std::size_t k = 0; k < b; ++k) {
      normal[k] = by.normal_i[k], normal[b + k] = by.normal_j[k];
      tangential[k] = by.tangential_i[k], tangential[b + k] = by.tangential_j[k];
    }
  }
};

}  // namespace

ContactOperator::ContactOperator(const Assembly& assembly, const DegreesOfFreedom& unknowns)
    : assembly_(assembly), unknowns_(unknowns) {
  const auto b = static_cast<std::size_t>(unknowns_.per_disc);
  rows_.reserve(assembly_.contacts.size());
  for (std::size_t c = 0; c < assembly_.contacts.size(); ++c) {
    const Contact& contact = assembly_.contacts[c];
    rows_.push_back({static_cast<std::size_t>(contact.i) * b, static_cast<std::size_t>(contact.j) * b,
                     deformation_gradient(frame_of(assembly_, c), unknowns_.rotation_scale)});
  }
  lay_out();
}

void ContactOperator::lay_out() {
  const auto b = static_cast<std::size_t>(unknowns_.per_disc);
  std::vector<std::int64_t> column_of(components(), -1);
  for (std::size_t k = 0; k < components(); ++k) {
    if (unknowns_.held[k] != 0) continue;
    column_of[k] = pattern_.size++;
    pattern_.component.push_back(static_cast<std::int64_t>(k));
  }
  const auto at = [&](const Rows& rows, std::size_t k) { return column_of[k < b ? rows.i + k : rows.j + k - b]; };
  std::vector<std::vector<std::int64_t>> rows_of(static_cast<std::size_t>(pattern_.size));
  for (std::size_t c = 0; c < rows_of.size(); ++c) rows_of[c].push_back(static_cast<std::int64_t>(c));
  for (const Rows& rows : rows_) {
    for (std::size_t p = 0; p < 2 * b; ++p) {
      for (std::size_t q = 0; q < 2 * b; ++q) {
        if (at(rows, p) >= 0 && at(rows, q) >= 0) rows_of[static_cast<std::size_t>(at(rows, q))].push_back(at(rows, p));
      }
    }
  }
  pattern_.first.push_back(0);
  for (auto& rows : rows_of) {
    std::ranges::sort(rows);
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    pattern_.rows.insert(pattern_.rows.end(), rows.begin(), rows.end());
    pattern_.first.push_back(static_cast<std::int64_t>(pattern_.rows.size()));
  }
  const auto place = [&](std::int64_t row, std::int64_t column) {
    if (row < 0 || column < 0) return std::int64_t{-1};
    const auto begin = pattern_.rows.begin() + pattern_.first[static_cast<std::size_t>(column)];
    const auto end = pattern_.rows.begin() + pattern_.first[static_cast<std::size_t>(column) + 1];
    return std::lower_bound(begin, end, row) - pattern_.rows.begin();
  };
  for (std::int64_t c = 0; c < pattern_.size; ++c) diagonal_.push_back(place(c, c));
  places_.reserve(rows_.size() * 4 * b * b);
  for (const Rows& rows : rows_) {
    for (std::size_t q = 0; q < 2 * b; ++q) {
      for (std::size_t p = 0; p < 2 * b; ++p) places_.push_back(place(at(rows, p), at(rows, q)));
    }
  }
}

ContactDeformation ContactOperator::deformation(std::size_t contact, std::span<const double> motion) const {
  const Rows& rows = rows_[contact];
  const auto b = static_cast<std::size_t>(unknowns_.per_disc);
  ContactDeformation d;
  for (std::size_t k = 0; k < b; ++k) {
    const double at_i = motion[rows.i + k], at_j = motion[rows.j + k];
    d.normal += rows.by.normal_i[k] * at_i + rows.by.normal_j[k] * at_j;
    d.tangential += rows.by.tangential_i[k] * at_i + rows.by.tangential_j[k] * at_j;
  }
  return d;
}

std::vector<ContactDeformation> ContactOperator::affine(const std::optional<Tensor2>& gradient) const {
  std::vector<ContactDeformation> result;
  if (!gradient) return result;
  result.reserve(contacts());
  for (std::size_t c = 0; c < contacts(); ++c)
    result.push_back(affine_deformation(frame_of(assembly_, c), assembly_.branch(assembly_.contacts[c]), *gradient));
  return result;
}

void ContactOperator::add_internal(std::size_t contact, const ContactForce& force, std::span<double> internal) const {
  const Rows& rows = rows_[contact];
  const auto b = static_cast<std::size_t>(unknowns_.per_disc);
  for (std::size_t k = 0; k < b; ++k) {
    internal[rows.i + k] += rows.by.normal_i[k] * force.normal + rows.by.tangential_i[k] * force.tangential;
    internal[rows.j + k] += rows.by.normal_j[k] * force.normal + rows.by.tangential_j[k] * force.tangential;
  }
}

CompressedColumns ContactOperator::matrix(std::span<const ContactTangent> tangents, double ground) const {
  const auto b = static_cast<std::size_t>(unknowns_.per_disc);
  CompressedColumns k = pattern_;
  k.values.assign(k.rows.size(), 0.0);
  for (const std::int64_t place : diagonal_) k.values[static_cast<std::size_t>(place)] += ground;
  for (std::size_t c = 0; c < rows_.size(); ++c) {
    const ContactTangent& a = tangents[c];
    if (a == ContactTangent{}) continue;
    const FlatRows rows(rows_[c].by, b);
    const std::int64_t* place = &places_[c * 4 * b * b];
    for (std::size_t q = 0; q < 2 * b; ++q) {
      const auto [n, t] = a.rate({rows.normal[q], rows.tangential[q]});
      for (std::size_t p = 0; p < 2 * b; ++p, ++place) {
        if (*place >= 0) k.values[static_cast<std::size_t>(*place)] += rows.normal[p] * n + rows.tangential[p] * t;
      }
    }
  }
  return k;
}

}  // namespace equidem
