// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/contact_operator.hpp"

#include <Eigen/SparseCore>
#include <utility>

namespace equidem {
ContactOperator::ContactOperator(const Assembly& assembly, const DegreesOfFreedom& unknowns)
    : assembly_(assembly), unknowns_(unknowns) {
  const auto b = static_cast<std::size_t>(unknowns_.per_disc);
  rows_.reserve(assembly_.contacts.size());
  for (std::size_t c = 0; c < assembly_.contacts.size(); ++c) {
    const Contact& contact = assembly_.contacts[c];
    rows_.push_back({static_cast<std::size_t>(contact.i) * b, static_cast<std::size_t>(contact.j) * b,
                     end_gradients(frame_of(assembly_, c), unknowns_.rotation_scale)});
  }
  for (const std::uint8_t held : unknowns_.held) column_.push_back(held != 0 ? -1 : columns_++);
}

ContactDeformation ContactOperator::deformation(std::size_t contact, std::span<const double> motion) const {
  const Rows& rows = rows_[contact];
  const auto b = static_cast<std::size_t>(unknowns_.per_disc);
  ContactDeformation d;
  for (std::size_t k = 0; k < b; ++k) {
    const double at_i = motion[rows.i + k], at_j = motion[rows.j + k];
    d.normal += rows.ends.i.normal[k] * at_i + rows.ends.j.normal[k] * at_j;
    d.tangential += rows.ends.i.tangential[k] * at_i + rows.ends.j.tangential[k] * at_j;
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
    internal[rows.i + k] += rows.ends.i.normal[k] * force.normal + rows.ends.i.tangential[k] * force.tangential;
    internal[rows.j + k] += rows.ends.j.normal[k] * force.normal + rows.ends.j.tangential[k] * force.tangential;
  }
}

CompressedColumns ContactOperator::matrix(std::span<const ContactTangent> tangents, double ground) const {
  const auto b = static_cast<std::size_t>(unknowns_.per_disc);
  std::vector<Eigen::Triplet<double, std::int64_t>> entries;
  entries.reserve(static_cast<std::size_t>(columns_) + rows_.size() * 4 * b * b);
  for (std::int64_t c = 0; c < columns_; ++c) entries.emplace_back(c, c, ground);
  for (std::size_t c = 0; c < rows_.size(); ++c) {
    const Rows& rows = rows_[c];
    const ContactStiffness k{.ends = rows.ends, .kN = tangents[c].nn, .kT = tangents[c].tt, .tn = tangents[c].tn};
    const std::pair<std::size_t, const EndGradient&> ends[] = {{rows.i, k.ends.i}, {rows.j, k.ends.j}};
    for (const auto& [first_column, q] : ends) {
      for (const auto& [first_row, p] : ends) {
        std::array<double, 9> block{};
        k.add<3>(p, q, block.data());
        for (std::size_t e = 0; e < b * b; ++e) {
          const std::int64_t row = column_[first_row + e % b], column = column_[first_column + e / b];
          if (row >= 0 && column >= 0) entries.emplace_back(row, column, block[3 * (e % b) + e / b]);
        }
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
