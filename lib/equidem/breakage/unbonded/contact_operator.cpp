// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/contact_operator.hpp"

#include <Eigen/SparseCore>

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
  for (const std::uint8_t held : unknowns_.held) column_.push_back(held != 0 ? -1 : columns_++);
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
  std::vector<Eigen::Triplet<double, std::int64_t>> entries;
  entries.reserve(static_cast<std::size_t>(columns_) + rows_.size() * 4 * b * b);
  for (std::int64_t c = 0; c < columns_; ++c) entries.emplace_back(c, c, ground);
  for (std::size_t c = 0; c < rows_.size(); ++c) {
    const FlatRows rows(rows_[c].by, b);
    const auto column = [&](std::size_t k) { return column_[k < b ? rows_[c].i + k : rows_[c].j + k - b]; };
    for (std::size_t q = 0; q < 2 * b; ++q) {
      const auto [n, t] = tangents[c].rate({rows.normal[q], rows.tangential[q]});
      for (std::size_t p = 0; p < 2 * b; ++p) {
        if (column(p) >= 0 && column(q) >= 0)
          entries.emplace_back(column(p), column(q), rows.normal[p] * n + rows.tangential[p] * t);
      }
    }
  }
  Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t> sum(columns_, columns_);
  sum.setFromTriplets(entries.begin(), entries.end());
  CompressedColumns k{.size = columns_,
                      .first = {sum.outerIndexPtr(), sum.outerIndexPtr() + columns_ + 1},
                      .rows = {sum.innerIndexPtr(), sum.innerIndexPtr() + sum.nonZeros()},
                      .values = {sum.valuePtr(), sum.valuePtr() + sum.nonZeros()},
                      .component = {}};
  for (std::size_t c = 0; c < column_.size(); ++c) {
    if (column_[c] >= 0) k.component.push_back(static_cast<std::int64_t>(c));
  }
  return k;
}

}  // namespace equidem
