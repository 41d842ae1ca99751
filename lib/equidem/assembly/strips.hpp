// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Triangulation of many sites strip by strip: on all threads, and with memory for a few strips at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "equidem/assembly/sites.hpp"
#include "equidem/assembly/triangulation.hpp"

namespace equidem {

/// The sites cut into strips across the longer side of the rectangle that holds them. Every strip is triangulated with
/// the sites of a margin on either side, and has the edges that start in it.
///
/// An edge is that of the whole triangulation where no site beyond the margins can take part of its facet, which
/// whoever measures the facet has to check (`known`).
class Strips {
 public:
  /// As many strips as are worth their margins; the number depends on the sites alone.
  explicit Strips(const Sites& sites);

  /// The edges of all strips that end at a disc of the cell, named as contacts are, in an order that does not depend on
  /// the triangulation: by a, then the disc of b, then its shift.
  /// \throws Error of kind interrupted where the user asked to stop
  [[nodiscard]] std::vector<TriangulationEdge> edges() const;

  [[nodiscard]] std::size_t count() const { return joined_ ? 1 : count_; }
  /// Triangulate all sites at once.
  void join() { joined_ = true; }

  /// From here on edges() has those of one of `count` strips alone: the edges that start or end at its discs.
  /// Cuts divide the longer side of `region`, which holds the discs.
  void choose(std::size_t strip, std::size_t count, const Rectangle& region);
  [[nodiscard]] bool chosen() const { return chosen_.has_value(); }
  /// Whether a site is a disc of the chosen strip.
  [[nodiscard]] bool holds(std::int32_t site) const {
    return sites_.in_cell(site) && cut_of(sites_.position(site)) == *chosen_;
  }
  /// The strip of a disc.
  [[nodiscard]] std::size_t strip_of_disc(std::int32_t disc) const { return cut_of(sites_.position(disc)); }
  /// Distance of a place from the nearest site that was left out where the edges of site a were found, at least; m.
  [[nodiscard]] double known(std::int32_t a, Vec2 place) const;

 private:
  [[nodiscard]] double along(Vec2 place) const { return upright_ ? place.y : place.x; }
  /// The strip that cuts make a place part of, and that in which it is triangulated.
  [[nodiscard]] std::size_t cut_of(Vec2 place) const;
  [[nodiscard]] std::size_t strip_of(Vec2 place) const { return joined_ ? 0 : cut_of(place); }
  [[nodiscard]] double cut(std::size_t strip) const { return low_ + width_ * static_cast<double>(strip); }
  [[nodiscard]] std::vector<std::vector<std::int32_t>> members() const;
  [[nodiscard]] std::vector<std::int32_t> members_of(std::size_t strip) const;
  [[nodiscard]] std::vector<TriangulationEdge> edges_of(std::size_t strip, std::vector<std::int32_t> members) const;

  const Sites& sites_;
  std::size_t count_ = 1;
  bool joined_ = false;
  std::optional<std::size_t> chosen_;
  bool upright_ = false;  ///< strips lie one above the other
  double low_ = 0;        ///< m, of the first strip
  double width_ = 0;      ///< m, of a strip
  double margin_ = 0;     ///< m
};

}  // namespace equidem
