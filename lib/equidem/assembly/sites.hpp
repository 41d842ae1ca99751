// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The points that are triangulated for an assembly: its discs and, where periodic, images of them around the cell.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/assembly/power_cells.hpp"

namespace equidem {

/// A disc, moved into the cell, and by how many periods from there.
struct Image {
  std::int32_t disc = 0;
  std::int32_t shift_x = 0;
  std::int32_t shift_y = 0;
};

/// Whole periods k by which x lies above the cell: x - k L is in [0, L).
/// \throws Error (bad_input) naming the disc where that is so far that its place in the cell is lost to rounding
std::int32_t periods_below(double x, double period, std::size_t disc);

/// Sites 0 to n - 1 are the discs, moved into the cell where periodic; images follow.
class Sites {
 public:
  /// With images in a margin of a few mean spacings around a periodic cell.
  /// \throws Error (bad_input) naming two discs with the same centre
  explicit Sites(const Assembly& assembly);

  /// Double the margin.
  /// \throws Error (bad_input) where that would make too many images
  void widen();

  [[nodiscard]] std::span<const Vec2> positions() const { return positions_; }
  /// Squared radii, m², or none where all radii are equal.
  [[nodiscard]] std::span<const double> weights() const { return weights_; }
  [[nodiscard]] std::span<const std::int32_t> insertion_order() const { return order_; }
  [[nodiscard]] std::size_t images() const { return images_.size(); }
  /// The rectangle of cell and margin: all images of discs in it are among the sites.
  [[nodiscard]] Rectangle region() const { return {{-margin_, -margin_}, {period_.x + margin_, period_.y + margin_}}; }

  [[nodiscard]] bool in_cell(std::int32_t site) const { return site < discs_; }
  [[nodiscard]] Image image(std::int32_t site) const {
    return in_cell(site) ? Image{.disc = site} : images_[static_cast<std::size_t>(site - discs_)];
  }
  [[nodiscard]] Vec2 position(std::int32_t site) const { return positions_[site]; }
  [[nodiscard]] bool weighted() const { return !weights_.empty(); }
  [[nodiscard]] double weight(std::int32_t site) const { return weights_.empty() ? 0 : weights_[site]; }
  [[nodiscard]] double largest_weight() const { return largest_weight_; }

  /// From site a to site b, the same to the last bit for every pair of images with the same shift between them.
  [[nodiscard]] Vec2 branch(std::int32_t a, std::int32_t b) const {
    if (images_.empty()) return positions_[b] - positions_[a];
    const Image p = image(a);
    const Image q = image(b);
    return (positions_[q.disc] - positions_[p.disc]) +
           Vec2{(q.shift_x - p.shift_x) * period_.x, (q.shift_y - p.shift_y) * period_.y};
  }
  /// The contact of a disc of the cell and a site, with the shift between the centres as the assembly gives them,
  /// which need not lie in the cell.
  [[nodiscard]] Contact contact(std::int32_t a, std::int32_t b) const;

 private:
  void surround();
  void sort();

  std::int32_t discs_ = 0;
  Vec2 period_;
  double margin_ = 0;
  std::vector<Vec2> positions_;
  std::vector<double> weights_;
  double largest_weight_ = 0;
  std::vector<Image> images_;
  std::vector<Image> moved_;  ///< periods by which each disc was moved into the cell; empty where free
  std::vector<std::int32_t> order_;
};

}  // namespace equidem
