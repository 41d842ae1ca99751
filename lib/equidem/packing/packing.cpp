// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/packing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/nearest.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr std::array table{
    PackingMethodEntry{PackingMethod::rejection, "rejection", "attempts", fill_by_rejection},
    PackingMethodEntry{PackingMethod::local_moves, "local_moves", "sweeps", fill_by_local_moves},
    PackingMethodEntry{PackingMethod::insertion, "insertion", "attempts", fill_by_insertion},
    PackingMethodEntry{PackingMethod::growth, "growth", "evaluations of all overlaps", fill_by_growth},
    PackingMethodEntry{PackingMethod::falling, "falling", "time steps, relaxation included", fill_by_falling},
};

const PackingMethodEntry& entry_of(PackingMethod method) {
  return *std::find_if(table.begin(), table.end(), [&](const auto& entry) { return entry.method == method; });
}

bool positive(double value) {
  return value > 0 && std::isfinite(value);
}

void check(const PackingOptions& options) {
  const bool falls = options.method == PackingMethod::falling;
  if (options.radii.empty()) bad_input("there are no discs to pack", "the box would stay empty", "Give their number");
  const PackingBox& box = options.box;
  if (!positive(box.size.x) || (!falls && !positive(box.size.y))) {
    bad_input(format("the box is {} m wide and {} m high", box.size.x, box.size.y), "it must have an area",
              "Correct it");
  }
  if (falls != (box.sides == PackingBox::Sides::open_top)) {
    bad_input(falls ? "discs shall fall into a closed box"
                    : format("{} into a box with an open top", to_string(options.method)),
              "what falls comes from above, the others need a box to fill",
              falls ? "Open its top" : "Close the box, or make it periodic");
  }
  double largest = 0;
  for (std::size_t k = 0; k < options.radii.size(); ++k) {
    if (!positive(options.radii[k])) {
      bad_input(format("disc {} has the radius {} m", k, options.radii[k]), "it must be positive and finite",
                "Correct the sizes");
    }
    largest = std::max(largest, options.radii[k]);
  }
  // A disc may not reach a second image of another one.
  const double room = (falls ? box.size.x : std::min(box.size.x, box.size.y)) / (box.periodic() ? 2 : 1);
  if (2 * largest > room) {
    bad_input(
        format("the largest disc is {:.4g} m wide, the box {:.4g} m by {:.4g} m", 2 * largest, box.size.x, box.size.y),
        box.periodic() ? "half a period must hold it" : "it does not fit in", "Make the box larger");
  }
  const double share = area_of_discs(options.radii) / box.area();
  if (!falls && !options.as_dense_as_possible && share >= 1) {
    bad_input(format("the discs have {:.3g} times the area of the box", share), "discs leave gaps between them",
              "Make the box larger, or take fewer discs");
  }
  if (!(options.overlap > 0 && options.overlap <= 0.1)) {
    bad_input(format("the overlap allowed is {} of the smaller radius", options.overlap),
              "it must be above 0, which nothing reaches, and at most 0.1", "Correct it");
  }
  if (options.attempts < 1) bad_input(format("{} attempts", options.attempts), "one is needed", "Give 1 or more");
}

}  // namespace

PackingMethod packing_method_from(const std::string& name) {
  std::vector<std::string> names;
  std::string list;
  for (const auto& entry : table) {
    if (name == entry.name) return entry.method;
    names.emplace_back(entry.name);
    list += (list.empty() ? "" : ", ") + names.back();
  }
  const auto meant = nearest(name, names);
  bad_input(format("there is no method of packing '{}'", name), "they are " + list,
            meant ? format("Did you mean '{}'?", *meant) : "Name one of them");
}

std::string to_string(PackingMethod method) {
  return entry_of(method).name;
}

std::span<const PackingMethodEntry> packing_methods() {
  return table;
}

double area_of_discs(std::span<const double> radii) {
  double squares = 0;
  for (const double radius : radii) squares += radius * radius;
  return std::numbers::pi * squares;
}

DiscPacking pack(const PackingOptions& options) {
  check(options);
  const Stopwatch watch;
  DiscPacking packing;
  packing.box = options.box;
  entry_of(options.method).fill(options, packing);
  packing.seconds = watch.seconds();
  return packing;
}

}  // namespace equidem
