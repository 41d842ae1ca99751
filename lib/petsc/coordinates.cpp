// SPDX-License-Identifier: GPL-3.0-or-later
#include "petsc/coordinates.hpp"

#include <array>

#include "equidem/contact/linear_spring.hpp"

namespace equidem::petsc {
namespace {

/// Calls put(p, q) for every block in the order of Coordinates, p and q the discs of its rows and columns.
template <typename Put>
void for_each_block(const Network& network, const Put& put) {
  const auto owned = static_cast<std::int32_t>(network.part().owned);
  for (std::int32_t d = 0; d < owned; ++d) put(d, d);
  for (const Contact& contact : network.assembly().contacts) {
    if (contact.i == contact.j) continue;
    put(contact.i, contact.j);
    put(contact.j, contact.i);
    if (contact.j >= owned) put(contact.j, contact.j);
  }
}

/// Adds the tangent of a contact between two of its ends to a block.
template <int B>
class Tangent {
 public:
  Tangent(const Network& network, std::size_t contact)
      : springs_(network.springs()[contact]),
        gradient_(deformation_gradient(frame_of(network.assembly(), contact), network.unknowns().rotation_scale)) {}

  /// \param p, q 0: the end at disc i, 1: at j
  void add(int p, int q, double* block) const {
    const auto& n = std::array{&gradient_.normal_i, &gradient_.normal_j};
    const auto& t = std::array{&gradient_.tangential_i, &gradient_.tangential_j};
    add_linear_spring_tangent<B>(springs_, *n[static_cast<std::size_t>(p)], *n[static_cast<std::size_t>(q)],
                                 *t[static_cast<std::size_t>(p)], *t[static_cast<std::size_t>(q)], block);
  }

 private:
  SpringConstants springs_;
  DeformationGradient gradient_;
};

template <int B>
void fill_blocks(const Network& network, std::vector<double>& values) {
  constexpr std::size_t entries = std::size_t{B} * B;
  const auto owned = static_cast<std::int32_t>(network.part().owned);
  const auto block_at = [&](std::size_t block) { return &values[block * entries]; };
  auto next = static_cast<std::size_t>(owned);
  for (std::size_t c = 0; c < network.assembly().contacts.size(); ++c) {
    const Contact& contact = network.assembly().contacts[c];
    const Tangent<B> tangent(network, c);
    double* const diagonal = block_at(static_cast<std::size_t>(contact.i));
    tangent.add(0, 0, diagonal);
    if (contact.i == contact.j) {
      tangent.add(0, 1, diagonal);
      tangent.add(1, 0, diagonal);
      tangent.add(1, 1, diagonal);
      continue;
    }
    tangent.add(0, 1, block_at(next++));
    tangent.add(1, 0, block_at(next++));
    tangent.add(1, 1, block_at(contact.j >= owned ? next++ : static_cast<std::size_t>(contact.j)));
  }
}

}  // namespace

Coordinates::Coordinates(const Network& network) {
  const std::size_t b = network.block();
  std::size_t blocks = 0;
  for_each_block(network, [&](std::int32_t, std::int32_t) { ++blocks; });
  rows.reserve(blocks * b * b);
  columns.reserve(blocks * b * b);
  const auto& places = network.part().places;
  for_each_block(network, [&](std::int32_t p, std::int32_t q) {
    const auto row = static_cast<PetscInt>(b) * places[static_cast<std::size_t>(p)];
    const auto column = static_cast<PetscInt>(b) * places[static_cast<std::size_t>(q)];
    for (std::size_t r = 0; r < b; ++r) {
      for (std::size_t c = 0; c < b; ++c) {
        rows.push_back(row + static_cast<PetscInt>(r));
        columns.push_back(column + static_cast<PetscInt>(c));
      }
    }
  });
}

void Coordinates::fill(const Network& network) {
  const std::size_t b = network.block();
  std::size_t blocks = 0;
  for_each_block(network, [&](std::int32_t, std::int32_t) { ++blocks; });
  values.assign(blocks * b * b, 0.0);
  if (b == 3) {
    fill_blocks<3>(network, values);
  } else {
    fill_blocks<2>(network, values);
  }
  const auto& held = network.unknowns().held;
  const auto owned = static_cast<std::int32_t>(network.part().owned);
  double* block = values.data();
  std::int32_t diagonal = 0;  // blocks that have been visited
  for_each_block(network, [&](std::int32_t p, std::int32_t q) {
    const bool on_diagonal = diagonal++ < owned;
    for (std::size_t r = 0; r < b; ++r) {
      const bool row = held[static_cast<std::size_t>(p) * b + r] != 0;
      for (std::size_t c = 0; c < b; ++c, ++block) {
        if (!row && held[static_cast<std::size_t>(q) * b + c] == 0) continue;
        *block = on_diagonal && r == c ? network.stiffest() : 0.0;
      }
    }
  });
}

}  // namespace equidem::petsc
