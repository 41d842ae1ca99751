// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The graph of an assembly: which contacts each disc has.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"

namespace equidem {

/// Compressed lists of the contacts of every disc. A contact of a disc with an image of itself is listed once.
class ContactGraph {
 public:
  /// One contact seen from a disc.
  struct Incidence {
    std::int32_t other;    ///< the disc at the other end
    std::int32_t contact;  ///< index into Assembly::contacts
  };

  explicit ContactGraph(const Assembly& assembly);

  [[nodiscard]] std::size_t size() const { return first_.size() - 1; }
  /// In ascending order of the contact index.
  [[nodiscard]] std::span<const Incidence> of(std::size_t disc) const {
    return {incidences_.data() + first_[disc], incidences_.data() + first_[disc + 1]};
  }

  /// A number for every disc that is the same within one connected piece; pieces are numbered from 0 in the order of
  /// their first disc.
  [[nodiscard]] std::vector<std::int32_t> pieces() const;

 private:
  std::vector<std::int64_t> first_;
  std::vector<Incidence> incidences_;
};

}  // namespace equidem
