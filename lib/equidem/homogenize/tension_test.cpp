// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/tension_test.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "equidem/assembly/lattices.hpp"
#include "equidem/assembly/least_rectangle.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {
namespace {

using Disc = std::int32_t;

double mean_branch_length(const Assembly& assembly) {
  double sum = 0;
  for (const Contact& contact : assembly.contacts) sum += norm(assembly.branch(contact));
  return sum / static_cast<double>(assembly.contacts.size());
}

[[noreturn]] void refuse_size(GaugePlacement placement, const std::string& present, const std::string& needed) {
  bad_input(fmt::format("the block has {}, too few for the gauges '{}'", present, to_string(placement)),
            fmt::format("they need at least {}", needed),
            placement == GaugePlacement::ends ? "Take a larger block" : "Take a larger block or another gauge");
}

/// Reach of a gauge from the middle of `count` discs (or rows) in line, in half spacings.
int half_reach(GaugePlacement placement, int count) {
  switch (placement) {
    case GaugePlacement::centre:
      return 4;
    case GaugePlacement::quarter:
      return std::max(1, count / 2);  // (count - 1)/4 spacings or a little more
    case GaugePlacement::ends:
      break;
  }
  return count - 1;
}

/// The nearest pair, symmetric about the middle of 0 ... count - 1, at least as far out as the placement demands;
/// negative where there is none.
std::pair<int, int> symmetric_pair(GaugePlacement placement, int count) {
  const int twice_first = count - 1 - half_reach(placement, count);
  const int first = twice_first < 0 ? -1 : twice_first / 2;
  return {first, count - 1 - first};
}

/// Gauges on a lattice, found by counting rows and discs, so that no ties between equally near discs occur.
class LatticeGauges {
 public:
  LatticeGauges(const Assembly& assembly, RowAlignment alignment, GaugePlacement placement)
      : placement_(placement),
        staggered_(alignment == RowAlignment::staggered),
        columns_(static_cast<int>(group(assembly, "bottom").discs.size())),
        first_(group(assembly, "left").discs),
        last_(group(assembly, "right").discs) {
    assert(first_.size() == last_.size());
  }

  void place(TensionSetup& setup) const {
    const int middle = middle_row();
    const auto [a, b] = symmetric_pair(placement_, count(middle));
    const auto [c, d] = rows_of_vertical_gauge(middle);
    if (a < 0 || a >= b || c < 0 || c >= d || d >= rows()) {
      refuse_size(placement_, fmt::format("{} and {}", counted(columns_, "column"), counted(rows(), "row")),
                  fmt::format("{} columns and {} rows", least_columns(), least_rows()));
    }
    setup.horizontal = {first_[middle] + a, first_[middle] + b};
    setup.vertical = {middle_disc(c), middle_disc(d)};
  }

 private:
  [[nodiscard]] int rows() const { return static_cast<int>(first_.size()); }
  [[nodiscard]] int count(int row) const { return last_[row] - first_[row] + 1; }
  [[nodiscard]] Disc middle_disc(int row) const { return first_[row] + (count(row) - 1) / 2; }
  /// The middle row; of the two middle rows of an even number, the one with a disc in its middle.
  [[nodiscard]] int middle_row() const {
    const int row = (rows() - 1) / 2;
    return rows() % 2 == 0 && count(row) % 2 == 0 && count(row + 1) % 2 != 0 ? row + 1 : row;
  }
  /// For blocks of as many rows as there are, or as many as there must be.
  [[nodiscard]] int least_columns() const {
    const int rows_then = std::max(rows(), least_rows());
    const bool centre = placement_ == GaugePlacement::centre;
    if (staggered_ && rows_then % 2 == 0) return centre ? 5 : 3;
    const int short_by = staggered_ ? (rows_then - 1) / 2 % 2 : 0;  // discs that the middle row lacks
    return (centre ? 5 : 2) + short_by;
  }
  [[nodiscard]] int least_rows() const { return placement_ == GaugePlacement::centre ? 5 : staggered_ ? 3 : 2; }
  [[nodiscard]] std::pair<int, int> rows_of_vertical_gauge(int middle) const {
    if (!staggered_) return symmetric_pair(placement_, rows());
    // Rows an even number apart have discs at the same x.
    if (placement_ == GaugePlacement::ends) return {0, (rows() - 1) / 2 * 2};
    const int reach = (half_reach(placement_, rows()) + 1) / 2;
    return {middle - reach, middle + reach};
  }

  GaugePlacement placement_;
  bool staggered_;
  int columns_;
  const std::vector<Disc>& first_;
  const std::vector<Disc>& last_;
};

/// The disc nearest to a point; of discs equally near (to 1e-9 of a spacing) the first.
Disc nearest_disc(const Assembly& assembly, Vec2 point, double spacing) {
  Disc nearest = 0;
  double least = norm(assembly.centres[0] - point);
  for (std::size_t disc = 1; disc < assembly.size(); ++disc) {
    const double distance = norm(assembly.centres[disc] - point);
    if (distance < least - 1e-9 * spacing) nearest = static_cast<Disc>(disc), least = distance;
  }
  return nearest;
}

/// The side by that name with its tributary lengths.
const DiscGroup& side(const Assembly& assembly, const std::string& name) {
  const DiscGroup& discs = group(assembly, name);
  if (discs.discs.empty() || discs.tributary_lengths.size() != discs.discs.size()) {
    bad_input(fmt::format("the group '{}' is not a side of the block", name),
              "the test spreads its traction over the side by the tributary length of each disc",
              fmt::format("Leave '{}' to be found from the cells of the discs", name));
  }
  return discs;
}

double total_length(const DiscGroup& side) {
  return std::accumulate(side.tributary_lengths.begin(), side.tributary_lengths.end(), 0.0);
}

double mean_normal_spring(const Assembly& assembly, const ContactSprings& springs) {
  if (springs.uniform()) return springs[0].kN;
  double sum = 0;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) sum += springs[c].kN;
  return sum / static_cast<double>(assembly.contacts.size());
}

}  // namespace

void place_nearest_gauges(const Rectangle& extents, double spacing, GaugePlacement placement,
                          const std::function<std::int32_t(Vec2 point)>& nearest, TensionSetup& setup) {
  const Vec2 middle = 0.5 * (extents.low + extents.high), size = extents.high - extents.low;
  const auto half_length = [&](double extent) {
    switch (placement) {
      case GaugePlacement::centre:
        return 2 * spacing;
      case GaugePlacement::quarter:
        return extent / 4;
      case GaugePlacement::ends:
        break;
    }
    return extent / 2;
  };
  const Vec2 half{half_length(size.x), half_length(size.y)};
  const auto pair_at = [&](Vec2 reach) {
    const std::int32_t first = nearest(middle - reach), second = nearest(middle + reach);
    return StrainGauge{first, second};
  };
  setup.horizontal = pair_at({half.x, 0});
  setup.vertical = pair_at({0, half.y});
  const double slack = 1e-9 * spacing;
  const bool inside = 2 * half.x <= size.x + slack && 2 * half.y <= size.y + slack;
  if (!inside || setup.horizontal.first == setup.horizontal.second || setup.vertical.first == setup.vertical.second) {
    refuse_size(placement, fmt::format("disc centres over {:.3g} m by {:.3g} m", size.x, size.y),
                fmt::format("{0:.3g} m by {0:.3g} m, {1} mean spacings each way",
                            (placement == GaugePlacement::centre ? 4 : 2) * spacing,
                            placement == GaugePlacement::centre ? 4 : 2));
  }
}

TensionSetup tension_loads(const TensionTest& test, double left_height, double right_height) {
  if (!std::isfinite(test.stress) || test.stress == 0) {
    bad_input(fmt::format("the tension test pulls with a stress of {} Pa", test.stress),
              "the ratios it measures need a finite stress other than zero", "Give a stress, 1e6 for example");
  }
  TensionSetup setup;
  setup.height = left_height;
  if (!(setup.height > 0) || std::abs(right_height - setup.height) > 1e-9 * setup.height) {
    bad_input(fmt::format("the left side is {} m high and the right side {} m", setup.height, right_height),
              "the two pulls of the test must balance", "Correct the tributary lengths of the two groups");
  }
  setup.supports = {{.group = "bottom", .ux = {}, .uy = 0.0, .rotation = {}},
                    {.group = "bottom_left", .ux = 0.0, .uy = 0.0, .rotation = {}}};
  setup.loads = {{.group = "left", .kind = LoadKind::traction, .force = {-test.stress, 0}},
                 {.group = "right", .kind = LoadKind::traction, .force = {test.stress, 0}}};
  return setup;
}

TensionSetup tension_setup(const Assembly& assembly, const TensionTest& test) {
  if (assembly.periodic()) {
    bad_input("the tension test is asked of a periodic cell", "a periodic cell has no sides to pull at",
              "Set periodic = false, or homogenize the cell");
  }
  if (assembly.contacts.empty()) {
    bad_input("the tension test is asked of discs without contacts", "nothing carries the load",
              "Give the assembly contacts");
  }
  TensionSetup setup = tension_loads(test, total_length(side(assembly, "left")), total_length(side(assembly, "right")));
  const Lattice* lattice = lattice_of(assembly);
  if (lattice != nullptr && lattice->alignment != RowAlignment::irregular) {
    LatticeGauges(assembly, lattice->alignment, test.gauge).place(setup);
    return setup;
  }
  const double spacing = mean_branch_length(assembly);
  const auto nearest = [&](Vec2 point) { return nearest_disc(assembly, point, spacing); };
  place_nearest_gauges(upright_rectangle(assembly.centres), spacing, test.gauge, nearest, setup);
  return setup;
}

Rectangle inner_half(const Rectangle& extents, double spacing) {
  const Vec2 middle = 0.5 * (extents.low + extents.high), size = extents.high - extents.low;
  const double slack = 1e-9 * spacing;  // rounding must not decide which discs on the rim of the region count
  const Vec2 half{std::max(size.x / 4, spacing) + slack, std::max(size.y / 4, spacing) + slack};
  return {middle - half, middle + half};
}

TensionResult tension_result(const TensionTest& test, double e11, double e22, double mean_kN,
                             const Tensor2& fitted_gradient) {
  TensionResult result;
  // Total load / height: the traction itself, spread over that height.
  result.stress = {.xx = test.stress, .yy = 0, .xy = 0};
  result.poisson_ratio = poisson_ratio_of_strains(e11, e22);
  result.stiffness_ratio = test.stress / (mean_kN * e11);
  result.fitted_gradient = fitted_gradient;
  result.fitted_poisson_ratio = poisson_ratio_of_strains(fitted_gradient.xx, fitted_gradient.yy);
  result.strain = {.xx = e11, .yy = e22, .xy = voigt_strain(fitted_gradient).xy};
  return result;
}

TensionResult evaluate_tension(const Assembly& assembly, const ContactSprings& springs, const TensionTest& test,
                               const TensionSetup& setup, const Equilibrium& equilibrium) {
  const std::vector<DiscMotion>& motions = equilibrium.motions;
  const Rectangle inner = inner_half(upright_rectangle(assembly.centres), mean_branch_length(assembly));
  const Vec2 middle = 0.5 * (inner.low + inner.high), half = 0.5 * (inner.high - inner.low);
  const Tensor2 fitted = fitted_displacement_gradient(assembly, motions, [&](std::size_t disc) {
    const Vec2 d = assembly.centres[disc] - middle;
    return std::abs(d.x) <= half.x && std::abs(d.y) <= half.y;
  });
  return tension_result(test, gauge_strain(assembly, motions, setup.horizontal),
                        gauge_strain(assembly, motions, setup.vertical), mean_normal_spring(assembly, springs), fitted);
}

double gauge_strain(const Assembly& assembly, std::span<const DiscMotion> motions, const StrainGauge& gauge) {
  assert(motions.size() == assembly.size());
  const Vec2 l = assembly.centres[gauge.second] - assembly.centres[gauge.first];
  assert(dot(l, l) > 0);
  return dot(motions[gauge.second].u - motions[gauge.first].u, l) / dot(l, l);
}

Tensor2 fitted_displacement_gradient(const Assembly& assembly, std::span<const DiscMotion> motions,
                                     const std::function<bool(std::size_t disc)>& inside,
                                     const std::function<void(std::span<double>)>& sum_up) {
  assert(motions.size() == assembly.size());
  std::vector<std::size_t> chosen;
  for (std::size_t disc = 0; disc < assembly.size(); ++disc)
    if (inside(disc)) chosen.push_back(disc);
  const auto weight = [&](std::size_t disc) { return assembly.cell_areas.empty() ? 1.0 : assembly.cell_areas[disc]; };

  const auto of_all = [&](std::span<double> sums) {
    if (sum_up) sum_up(sums);
  };
  double first[6] = {0, 0, 0, 0, 0, static_cast<double>(chosen.size())};
  for (const std::size_t disc : chosen) {
    const double w = weight(disc);
    const Vec2 x = assembly.centres[disc], u = motions[disc].u;
    first[0] += w, first[1] += w * x.x, first[2] += w * x.y, first[3] += w * u.x, first[4] += w * u.y;
  }
  of_all(first);
  const double total = first[0];
  // Sums about the centroid: no digits are lost far from the origin or by a large rigid motion.
  // h = (sum w du dx^T) (sum w dx dx^T)^-1.
  Tensor2 second_moment;
  Tensor2 covariance;
  if (total > 0) {
    const Vec2 centre = (1 / total) * Vec2{first[1], first[2]}, mean = (1 / total) * Vec2{first[3], first[4]};
    for (const std::size_t disc : chosen) {
      const Vec2 dx = assembly.centres[disc] - centre;
      second_moment += (weight(disc) / total) * outer(dx, dx);
      covariance += (weight(disc) / total) * outer(motions[disc].u - mean, dx);
    }
    double second[8];
    Tensor2* const both[] = {&second_moment, &covariance};
    for (std::size_t k = 0; k < 2; ++k) {
      second[4 * k] = both[k]->xx, second[4 * k + 1] = both[k]->xy;
      second[4 * k + 2] = both[k]->yx, second[4 * k + 3] = both[k]->yy;
    }
    of_all(second);
    for (std::size_t k = 0; k < 2; ++k)
      *both[k] = {second[4 * k], second[4 * k + 1], second[4 * k + 2], second[4 * k + 3]};
  }
  const double trace = second_moment.xx + second_moment.yy;
  const Tensor2 s = (1 / trace) * second_moment;
  covariance = (1 / trace) * covariance;
  // The ratio of the principal second moments, about determinant/trace²: rounding makes 1e-16 of it for discs
  // on a line, while two rows of 4e6 discs still have 1e-13.
  if (!(determinant(s) > 1e-13)) {
    bad_input(fmt::format("a displacement gradient cannot be fitted to {}",
                          counted(static_cast<std::int64_t>(first[5]), "disc")),
              "it takes three discs or more that are not on one line", "Choose a larger region");
  }
  return covariance * inverse(s);
}

}  // namespace equidem
