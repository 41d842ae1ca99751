// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Filling a box with discs, ellipses, pairs or clumps (Sukegawa 2010, section 2.7).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/geometry/neighbours.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/packing/packing_shape.hpp"
#include "equidem/packing/settling.hpp"

namespace equidem {

/// The rectangle from the origin to `size`.
struct PackingBox {
  Vec2 size;  ///< m
  enum class Sides {
    walls,     ///< four rigid walls
    open_top,  ///< as high as need be, for what falls into it; size.y is not used
    periodic,  ///< opposite sides are joined
  } sides = Sides::walls;

  [[nodiscard]] bool periodic() const { return sides == Sides::periodic; }
  /// None where nothing repeats.
  [[nodiscard]] std::optional<Periods> periods() const {
    return periodic() ? std::optional<Periods>({{size.x, 0}, {0, size.y}}) : std::nullopt;
  }
  [[nodiscard]] double area() const { return size.x * size.y; }
};

template <>
struct EnumNames<PackingBox::Sides> {
  using enum PackingBox::Sides;
  static constexpr const char* what = "kind of sides";
  static constexpr NamedValue<PackingBox::Sides> list[] = {
      {walls, "walls"}, {periodic, "periodic"}, {open_top, "open_top"}};
};

/// The walls of a box: floor, left, right and, where the top is not open, the lid; none of a periodic box.
std::vector<Wall> walls_of(const PackingBox& box);

/// A method is one function fill_by_NAME, of the folder methods or settling.cpp, and its lines here and in the list
/// below.
enum class PackingMethod { rejection, local_moves, insertion, growth, falling };

struct PackingOptions {
  PackingMethod method = PackingMethod::growth;
  PackingBox box;
  PackingShape shape;
  std::vector<double> radii;  ///< of each body (PackingShape), m
  std::uint64_t seed = 1;
  /// Not all bodies need to fit: rejection and insertion leave out what does not (they take the bodies in the order
  /// given), growth scales the radii until the bodies jam.
  bool as_dense_as_possible = false;
  double overlap = 1e-6;           ///< largest allowed, of the smaller radius; of jammed bodies the mean wanted
  std::int64_t attempts = 100000;  ///< to place a body by rejection or insertion; sweeps of local moves
  SettlingOptions settling;        ///< falling
};

/// Bodies in a box.
struct GrainPacking {
  PackingBox box;
  PackingShape::Kind shape = PackingShape::Kind::disc;
  /// In the box; their masses are those of the density of the settling. A bonded pair is two of them, 2k and 2k + 1.
  std::vector<Grain> grains;
  std::vector<Clump> clumps;
  std::vector<GrainBond> bonds;  ///< with their dashpots where they fell
  std::vector<double> radii;     ///< of each body (PackingShape), m
  std::optional<Error> failure;  ///< why it is not what was wanted, but what there was when packing ended
  bool jammed = false;           ///< the overlaps, with equal springs, hold the bodies in balance
  double seconds = 0;
  std::int64_t work = 0;  ///< attempts, sweeps, evaluations of all contacts or time steps: as the method counts
  // falling
  std::vector<GrainContact> contacts;  ///< with their forces
  SettlingReport settling;

  [[nodiscard]] std::size_t size() const { return radii.size(); }
  /// The body that a grain belongs to.
  [[nodiscard]] std::size_t body_of(std::size_t grain) const { return bonds.empty() ? grain : grain / 2; }
};

/// Fills grains, clumps, bonds, radii and work of a packing.
using FillBox = void(const PackingOptions& options, GrainPacking& packing);
FillBox fill_by_rejection, fill_by_local_moves, fill_by_insertion, fill_by_growth, fill_by_falling;

struct PackingMethodEntry {
  PackingMethod value;
  const char* name;
  const char* help;
  const char* unit_of_work;  ///< of GrainPacking::work
  FillBox* fill;
  bool open_top = false;             ///< bodies come from above; otherwise the box is closed or periodic
  bool as_dense_as_possible = true;  ///< ends without a wanted solid fraction
  double bytes_of_body = 700;        ///< at the peak, with its contacts: measured of discs
};

template <>
struct EnumNames<PackingMethod> {
  static constexpr const char* what = "method of packing";
  static constexpr PackingMethodEntry list[] = {
      {.value = PackingMethod::rejection,
       .name = "rejection",
       .help = "random places, tried again where bodies overlap, up to about 0.5",
       .unit_of_work = "attempts",
       .fill = fill_by_rejection,
       .bytes_of_body = 500},
      {.value = PackingMethod::local_moves,
       .name = "local_moves",
       .help = "overlapping bodies moved at random, to 0.78",
       .unit_of_work = "sweeps",
       .fill = fill_by_local_moves,
       .as_dense_as_possible = false},
      {.value = PackingMethod::insertion,
       .name = "insertion",
       .help = "into gaps, in contact with two others, discs to 0.7, others to 0.6",
       .unit_of_work = "attempts",
       .fill = fill_by_insertion,
       .bytes_of_body = 500},
      {.value = PackingMethod::growth,
       .name = "growth",
       .help = "bodies grow and push each other apart, to jamming",
       .unit_of_work = "evaluations of all overlaps",
       .fill = fill_by_growth},
      {.value = PackingMethod::falling,
       .name = "falling",
       .help = "under gravity from a staggered grid, to rest",
       .unit_of_work = "time steps, relaxation included",
       .fill = fill_by_falling,
       .open_top = true,
       .bytes_of_body = 1200},
  };
};

/// The packing depends on the options only, not on the number of threads.
/// \throws Error whose place is the name of the option at fault, or empty. (bad_input): no bodies, a shape that is none
///         (unit_body_of), a box or radii that are not positive, bodies wider than the box, more area than the box has,
///         falling into a box without an open top and the reverse; (computation_failed): the bodies do not fit, naming
///         how dense they came to lie, and as settle
GrainPacking pack(const PackingOptions& options);

/// As pack, but where packing fails or is interrupted the bodies come back as they lie then, with the failure.
/// \throws Error (bad_input) as pack; any failure before a body has a place
GrainPacking try_to_pack(const PackingOptions& options);

/// Does a part of a packing; its failure or interruption is noted in the packing, which keeps what it has.
template <typename Work>
void keep_failure(GrainPacking& packing, const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::bad_input) throw;
    packing.failure = error;
  }
}

/// Radii are only ratios: what counts is the size to which the bodies have grown.
bool grows_to_any_size(const PackingOptions& options);

/// \throws Error (bad_input) as pack
void check(const PackingOptions& options);

/// Bodies as grains of a scene: `grains`, `clumps`, `bonds` (without dashpots) and `radii` of a packing.
void make_grains(const PackingShape& shape, const Bodies& bodies, double density, GrainPacking& packing);

}  // namespace equidem
