// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The methods of packing. A method is one file of the folder methods that defines its function, and its lines in
/// PackingMethod and the list below.
#pragma once

#include "equidem/core/names.hpp"

namespace equidem {

struct PackingOptions;
struct GrainPacking;

/// Fills grains, clumps, bonds, radii and work of a packing.
using FillBox = void(const PackingOptions& options, GrainPacking& packing);
FillBox fill_by_rejection, fill_by_local_moves, fill_by_insertion, fill_by_growth, fill_by_falling;

enum class PackingMethod { rejection, local_moves, insertion, growth, falling };

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

}  // namespace equidem
