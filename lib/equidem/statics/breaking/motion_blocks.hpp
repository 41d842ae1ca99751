// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Parts of the elimination tree in which motions are brought up to date together, and a bound on what the motion of
/// their boundary does to the contact forces inside.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"

namespace equidem {

/// Fronts [first, root] of the elimination tree: a whole small subtree, or a single front of a larger one. Contacts
/// belong to the block that eliminates the first of their discs.
struct MotionBlock {
  std::int32_t root = 0, first = 0;
  std::int32_t parent = -1;            ///< index into the blocks; -1: none
  std::vector<std::int32_t> children;  ///< blocks
  std::int64_t contacts_begin = 0, contacts_end = 0;
  std::int64_t boundary = 0;  ///< first of symbolic.rows[root] among those of all blocks

  // The rest is about the subtree of `root`, the interior: discs [interior_begin, interior_end) of the order of
  // elimination.
  std::int32_t interior_begin = 0, interior_end = 0;
  /// Motions of the interior that follow its boundary at the cost of no, or of a known energy.
  enum class Fit : std::uint8_t {
    none,         ///< supports hold it
    translation,  ///< it meets images of itself or has a boundary on one line
    affine
  } fit = Fit::affine;
  Vec2 centre;                      ///< m, of the boundary
  std::array<double, 3> moments{};  ///< inverse of sum x x^T over the boundary, 1/m²: xx, xy, yy
  /// x.A x with x = (e_xx, e_yy, e_xy, spin), N: twice the energy of a homogeneous motion, lower triangle by rows.
  std::array<double, 10> affine{};

  /// Rigid motions of the interior with its boundary that no contact resists.
  enum class Rigid : std::uint8_t {
    none,         ///< a component of a disc, or of one that it touches, is held
    translation,  ///< it meets images of itself, or levers do not add up to branches
    any
  } rigid = Rigid::any;
};

/// A translation, m, and a rotation, rad, about MotionBlock::centre.
struct RigidBlockMotion {
  Vec2 translation;
  double spin = 0;
};

class MotionBlocks {
 public:
  MotionBlocks(const SpringNetwork& network, const SymbolicFactor& symbolic);

  [[nodiscard]] std::span<const MotionBlock> all() const { return blocks_; }
  [[nodiscard]] const MotionBlock& operator[](std::size_t block) const { return blocks_[block]; }
  [[nodiscard]] std::int32_t of_front(std::size_t front) const { return block_of_front_[front]; }
  /// Discs in the boundaries of all blocks.
  [[nodiscard]] std::size_t boundaries() const { return resistance_.size(); }
  /// Contacts in the order of their blocks.
  [[nodiscard]] std::span<const std::int32_t> contacts() const { return contacts_; }

  /// A rigid motion near that of a boundary (its discs one after another) that no contact of the interior resists.
  [[nodiscard]] RigidBlockMotion rigid_motion(std::size_t block, std::span<const double> motion) const;
  /// Motion of the disc at a place of the order of elimination, m.
  [[nodiscard]] std::array<double, 3> motion_at(const RigidBlockMotion& rigid, std::size_t block,
                                                std::int32_t place) const;
  /// Extent of the sample, m: larger than the distance of any two centres.
  [[nodiscard]] double extent() const { return extent_; }

  /// A spring that holds one component, beside the contacts.
  void hold(std::int64_t component, double stiffness);

  /// The boundary of a block moves by `motion` (its discs one after another) and nothing acts on its interior: at most
  /// the root of sum N²/kN + T²/kT over the forces of its contacts, square root of N. The motion takes the least energy
  /// of all that follow the boundary, so the energy of any other one is a bound: here a homogeneous motion of the
  /// interior, chosen by least squares. It also holds after springs were removed or weakened.
  [[nodiscard]] double force_bound(std::size_t block, std::span<const double> motion) const;
  [[nodiscard]] double bytes() const;

 private:
  struct Hold {
    std::int32_t position;  // place of the disc in the order of elimination
    int component;
    double stiffness;
  };

  /// A homogeneous motion, by least squares: its gradient is 0 where the boundary does not tell one.
  struct Homogeneous {
    Vec2 translation;
    double xx = 0, xy = 0, yx = 0, yy = 0;
  };
  [[nodiscard]] Homogeneous translation_of(const MotionBlock& block, std::span<const double> motion) const;
  void add_gradient(const MotionBlock& block, std::span<const double> motion, Homogeneous& to) const;
  void divide();
  void sort_contacts(const SpringNetwork& network);
  void add_energies(const SpringNetwork& network);
  void find_rigid_motions(const SpringNetwork& network);
  void describe_boundary(const SpringNetwork& network, MotionBlock& block);

  const SymbolicFactor& symbolic_;
  double rotation_scale_, extent_ = 0;
  std::vector<Vec2> centres_;  // m, in the order of elimination
  std::vector<MotionBlock> blocks_;
  std::vector<std::int32_t> block_of_front_;
  std::vector<std::int32_t> contacts_;
  /// Per disc of a boundary, Pa: sum of kN |g|² + kT |h|² over its contacts with the interior, g and h the derivatives
  /// of stretch and slip by its motion.
  std::vector<double> resistance_;
  std::vector<Hold> holds_;
};

}  // namespace equidem
