// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Filling a box with discs (Sukegawa 2010, section 2.7).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/grains/grain_simulation.hpp"
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
  [[nodiscard]] double area() const { return size.x * size.y; }
};

enum class PackingMethod {
  rejection,    ///< places at random, one disc after the other; where one would overlap another it is tried again
  local_moves,  ///< all at random, then small random moves of those that overlap
  insertion,    ///< one after the other, each into a gap where it touches two others
  growth,       ///< points at random that grow into discs, pushing each other apart
  falling,      ///< from a staggered grid under gravity
};

/// \throws Error (bad_input) naming the choices
PackingMethod packing_method_from(const std::string& name);
std::string to_string(PackingMethod method);

struct PackingOptions {
  PackingMethod method = PackingMethod::growth;
  PackingBox box;
  std::vector<double> radii;  ///< m
  std::uint64_t seed = 1;
  /// Not all discs need to fit: rejection and insertion leave out what does not (they take the discs in the order given), growth
  /// scales the radii until the discs jam.
  bool as_dense_as_possible = false;
  double overlap = 1e-6;           ///< largest allowed, of the smaller radius; of jammed discs the mean wanted
  std::int64_t attempts = 100000;  ///< to place a disc by rejection or insertion; sweeps of local moves
  SettlingOptions settling;        ///< falling
};

/// Discs in a box.
struct DiscPacking {
  PackingBox box;
  std::vector<Vec2> centres;  ///< m, in the box
  std::vector<double> radii;  ///< m
  bool complete = true;       ///< all discs asked for are there, as large as asked for
  double seconds = 0;
  std::int64_t work = 0;  ///< attempts, sweeps, evaluations of all contacts or time steps: as the method counts
  // falling
  std::vector<Grain> grains;           ///< as they came to rest, with angles and velocities
  std::vector<GrainContact> contacts;  ///< with their forces
  SettlingReport settling;

  [[nodiscard]] std::size_t size() const { return centres.size(); }
};

/// A row of the table of methods.
struct PackingMethodEntry {
  PackingMethod method;
  const char* name;
  const char* unit_of_work;
  void (*fill)(const PackingOptions& options, DiscPacking& packing);  ///< centres, radii
};
std::span<const PackingMethodEntry> packing_methods();

/// Same options, same packing, whatever the number of threads.
/// \throws Error (bad_input): no discs, a box or radii that are not positive, discs wider than the box, more disc than box, falling
///         into a box without an open top and the reverse; (computation_failed): the discs do not fit, naming how dense they
///         came to lie, and as settle
DiscPacking pack(const PackingOptions& options);

/// The area of all discs, m².
double area_of_discs(std::span<const double> radii);

// The methods, one file each.
void fill_by_rejection(const PackingOptions& options, DiscPacking& packing);
void fill_by_local_moves(const PackingOptions& options, DiscPacking& packing);
void fill_by_insertion(const PackingOptions& options, DiscPacking& packing);
void fill_by_growth(const PackingOptions& options, DiscPacking& packing);
void fill_by_falling(const PackingOptions& options, DiscPacking& packing);

}  // namespace equidem
