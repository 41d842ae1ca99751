// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/delaunay.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "equidem/assembly/assembly.hpp"
#include "equidem/assembly/space_filling_curve.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

double aspect_of(const DelaunayOptions& options) {
  return options.box ? options.box->x / options.box->y : options.aspect;
}

void check_box(Vec2 box) {
  if (!measurable(box.x) || !measurable(box.y))
    bad_input(fmt::format("the box is {} m wide and {} m high", box.x, box.y), length_limits(), "Correct it");
}

void check(const DelaunayOptions& options) {
  const std::int64_t least = options.periodic ? 1 : 3;
  constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max() / 2;
  if (options.discs < least || options.discs > most) {
    bad_input(
        fmt::format("discs = {}", options.discs),
        fmt::format("a {} triangulation needs {} to {} discs", options.periodic ? "periodic" : "free", least, most),
        "Correct the count");
  }
  if (!(options.disorder >= 0 && options.disorder < 0.5)) {
    bad_input(fmt::format("disorder = {}", options.disorder),
              "it must lie in [0, 0.5), or neighbours could change places",
              "Correct it, or ask for poisson_disc points");
  }
  const RadiusDistribution& radii = options.radii;
  if (!is_positive(radii.smallest)) {
    bad_input(fmt::format("the smallest radius is {} m", radii.smallest), "radii must be positive and finite",
              "Correct it");
  }
  if (!(radii.largest >= radii.smallest) || !std::isfinite(radii.largest)) {
    bad_input(fmt::format("the largest radius is {} m", radii.largest),
              fmt::format("it must be finite and at least the smallest, {} m", radii.smallest), "Correct it");
  }
  for (const double radius : {radii.smallest, radii.largest}) {
    if (!measurable(radius))
      bad_input(fmt::format("the radius of a disc is {} m", radius), length_limits(), "Choose other units");
  }
  if (options.box) check_box(*options.box);
  if (const double aspect = aspect_of(options); !(aspect >= 1e-3 && aspect <= 1e3))
    bad_input(fmt::format("aspect = {}", aspect), "width over height must lie in [0.001, 1000]", "Correct it");
}

PointSet points_of(const DelaunayOptions& options, Random& random) {
  const PointOptions wanted = {.count = options.discs,
                               .spacing = options.radii.smallest + options.radii.largest,
                               .aspect = aspect_of(options),
                               .periodic = options.periodic};
  switch (options.points) {
    case PointProcess::poisson_disc:
      return poisson_disc_points(wanted, random);
    case PointProcess::perturbed_hexagonal:
      return perturbed_hexagonal_points(wanted, options.disorder, random);
    case PointProcess::uniform:
      break;
  }
  return uniform_points(wanted, random);
}

/// The points in a rectangle of that size.
void stretch(PointSet& set, Vec2 extent, bool periodic) {
  const auto last = [&](double length) { return periodic ? std::nextafter(length, 0.0) : length; };
  for (Vec2& point : set.points)
    point = {std::min(point.x * (extent.x / set.extent.x), last(extent.x)),
             std::min(point.y * (extent.y / set.extent.y), last(extent.y))};
  set.extent = extent;
}

/// Contacts at the midpoint of the branch as the assembly measures it; unequal discs keep the radical axis.
void set_midpoints(Assembly& assembly) {
  const bool equal =
      std::all_of(assembly.radii.begin(), assembly.radii.end(), [&](double r) { return r == assembly.radii.front(); });
  if (!equal) return;
  parallel_ranges(assembly.contacts.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Contact& contact = assembly.contacts[k];
      contact.lever_i = contact.lever_j = 0.5 * norm(assembly.branch(contact));
    }
  });
}

void take_sides(Assembly& assembly, PowerCells& cells) {
  for (auto& [name, discs] : cells.sides) assembly.groups.emplace(name, std::move(discs));
}

/// The region stays that of these discs, also where some of them are left out later.
std::optional<TurnedRectangle> region_to_fill(const Assembly& assembly) {
  if (assembly.periodic()) return {};
  return region_of_cells(assembly);
}

void take_network(Assembly& assembly, PowerCells&& cells) {
  assembly.contacts = std::move(cells.neighbours);
  assembly.facet_lengths = std::move(cells.facet_lengths);
  assembly.cell_areas = std::move(cells.areas);
  assembly.contact_arms.clear();
  for (const ContactNumbers& numbers : contact_numbers) numbers.clear(assembly);
  set_midpoints(assembly);
  take_sides(assembly, cells);
}

/// Leave out discs that hang loose: those without contacts, whose power cell their neighbours have taken, and those in
/// a corner with a single neighbour, which would roll about it without energy. Where many have a single neighbour the
/// rectangle is a strip one disc wide, and they stay. Returns how many are left out.
/// \param contacts per disc: how many it has, exact below 2
std::size_t drop_loose_discs(Assembly& assembly, const std::vector<std::int32_t>& contacts) {
  const auto single = static_cast<std::size_t>(std::count(contacts.begin(), contacts.end(), 1));
  const int least = 20 * single <= assembly.size() ? 2 : 1;
  std::size_t kept = 0;
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    if (contacts[d] < least) continue;
    assembly.centres[kept] = assembly.centres[d];
    assembly.radii[kept] = assembly.radii[d];
    ++kept;
  }
  const std::size_t dropped = assembly.size() - kept;
  assembly.centres.resize(kept);
  assembly.radii.resize(kept);
  return dropped;
}

std::size_t drop_loose_discs(Assembly& assembly, const PowerCells& cells) {
  std::vector<std::int32_t> contacts(assembly.size(), 0);
  for (const Contact& c : cells.neighbours) ++contacts[c.i], ++contacts[c.j];
  return drop_loose_discs(assembly, contacts);
}

[[noreturn]] void refuse_collinear(const Assembly& assembly) {
  const auto furthest = [&](Vec2 from) {
    std::size_t best = 0;
    for (std::size_t k = 0; k < assembly.size(); ++k) {
      if (norm(assembly.centres[k] - from) > norm(assembly.centres[best] - from)) best = k;
    }
    return best;
  };
  const std::size_t one = furthest(assembly.centres[0]);
  const std::size_t other = furthest(assembly.centres[one]);
  bad_input(fmt::format("all {} discs lie on the line through discs {} and {}", assembly.size(), std::min(one, other),
                        std::max(one, other)),
            "points on one line have no triangles", "Move some of them, or list the contacts");
}

}  // namespace

std::int64_t discs_that_fill(Vec2 box, const RadiusDistribution& radii) {
  check_box(box);
  const double a = (radii.smallest + radii.largest) / 2;
  const double discs = std::round(box.x * box.y / (2 * std::numbers::sqrt3 * a * a));
  if (!(discs >= 1 && discs <= 1e9))
    bad_input(fmt::format("{:.3g} discs would fill the box of {:.6g} m by {:.6g} m", discs, box.x, box.y),
              "they are 1 to 1e9", "Change the box or the radius");
  return static_cast<std::int64_t>(discs);
}

/// The discs and the rectangle that their cells fill.
static Assembly delaunay_discs(const DelaunayOptions& options, Rectangle& rectangle) {
  check(options);
  Random random(options.seed);
  PointSet set = points_of(options, random);
  if (options.box) stretch(set, *options.box, options.periodic);
  Assembly assembly;
  assembly.kind = "delaunay";
  assembly.centres.reserve(set.points.size());
  for (const std::int32_t k : hilbert_order(set.points)) assembly.centres.push_back(set.points[k]);
  set.points = {};
  assembly.radii.resize(assembly.size(), options.radii.smallest);
  if (options.radii.largest > options.radii.smallest) {
    for (double& radius : assembly.radii) radius = random.uniform(options.radii.smallest, options.radii.largest);
  }
  if (options.periodic) assembly.period = set.extent;
  rectangle = {.low = {0, 0}, .high = set.extent};
  return assembly;
}

Assembly delaunay_assembly(const DelaunayOptions& options) {
  constexpr double bytes_per_disc = 300;  // measured at 10⁶ and 10⁷ discs: the triangulation beside the assembly
  check(options);
  require_memory(bytes_per_disc * static_cast<double>(options.discs),
                 fmt::format("the triangulation of {} discs needs about", grouped(options.discs)));
  Rectangle rectangle;
  Assembly assembly = delaunay_discs(options, rectangle);
  PowerCells cells = power_cells(assembly, rectangle);
  while (!cells.collinear && drop_loose_discs(assembly, cells) > 0) {
    cells = {};  // before the next take their memory
    cells = power_cells(assembly, rectangle);
  }
  if (cells.collinear && !assembly.periodic()) refuse_collinear(assembly);
  take_network(assembly, std::move(cells));
  if (!assembly.periodic()) assembly.box = rectangle;
  return assembly;
}

DelaunayStrip delaunay_strip(const DelaunayOptions& options, const StripShare& share) {
  Rectangle rectangle;
  DelaunayStrip result{.assembly = delaunay_discs(options, rectangle), .strips = {}};
  for (;;) {
    StripCells found = strip_cells(result.assembly, rectangle, share);
    if (found.cells.collinear) refuse_collinear(result.assembly);
    std::vector<std::int32_t> few[2];  // discs of all strips with one contact and with none
    for (std::size_t d = 0; d < result.assembly.size(); ++d) {
      if (found.strips[d] != static_cast<std::int32_t>(share.strip) || found.contacts[d] > 1) continue;
      few[found.contacts[d] == 0 ? 1 : 0].push_back(static_cast<std::int32_t>(d));
    }
    const std::vector<std::int32_t> single = share.joined(few[0]), none = share.joined(few[1]);
    std::vector<std::int32_t> contacts(result.assembly.size(), 2);
    for (const std::int32_t d : single) contacts[d] = 1;
    for (const std::int32_t d : none) contacts[d] = 0;
    if (drop_loose_discs(result.assembly, contacts) > 0) continue;
    result.strips = std::move(found.strips);
    take_network(result.assembly, std::move(found.cells));
    if (!result.assembly.periodic()) result.assembly.box = rectangle;
    return result;
  }
}

void triangulate(Assembly& assembly) {
  assembly.contacts.clear();
  assembly.facet_lengths.clear();
  assembly.cell_areas.clear();
  check(assembly);
  if (!assembly.periodic() && assembly.size() < 3) {
    bad_input(fmt::format("{} cannot be triangulated", counted(assembly.size(), "disc")),
              "a triangulation needs three or more", "Add discs, or list the contacts");
  }
  const std::optional<TurnedRectangle> region = region_to_fill(assembly);
  PowerCells cells = power_cells(assembly, region);
  if (cells.collinear) refuse_collinear(assembly);
  assembly.box = region;
  take_network(assembly, std::move(cells));
}

void measure_cells(Assembly& assembly) {
  const std::optional<TurnedRectangle> region = region_to_fill(assembly);
  PowerCells cells = power_cells(assembly, region);
  assembly.box = region;
  // Name every contact as the triangulation does and look it up: neighbours ascend by i, j and shift.
  const auto key = [](const Contact& c) { return std::tuple(c.i, c.j, c.shift_x, c.shift_y); };
  assembly.facet_lengths.assign(assembly.contacts.size(), 0);
  for (std::size_t k = 0; k < assembly.contacts.size(); ++k) {
    Contact contact = assembly.contacts[k];
    if (std::tuple(contact.i, 0, 0) > std::tuple(contact.j, contact.shift_x, contact.shift_y)) {
      std::swap(contact.i, contact.j);
      contact.shift_x = -contact.shift_x;
      contact.shift_y = -contact.shift_y;
    }
    const auto found = std::lower_bound(cells.neighbours.begin(), cells.neighbours.end(), contact,
                                        [&](const Contact& a, const Contact& b) { return key(a) < key(b); });
    if (found == cells.neighbours.end() || key(*found) != key(contact)) continue;
    assembly.facet_lengths[k] = cells.facet_lengths[static_cast<std::size_t>(found - cells.neighbours.begin())];
  }
  assembly.cell_areas = std::move(cells.areas);
  take_sides(assembly, cells);
}

void measure_missing_cells(Assembly& assembly) {
  const bool has_areas = !assembly.cell_areas.empty();
  const bool has_facets = !assembly.facet_lengths.empty() || (has_areas && assembly.contacts.empty());
  if (assembly.box) check_inside(assembly, *assembly.box);
  if (has_areas && (assembly.box || assembly.period)) {
    constexpr double close = 1e-6;
    const double region = assembly.period ? assembly.period->x * assembly.period->y : assembly.box->area();
    const double cells = std::accumulate(assembly.cell_areas.begin(), assembly.cell_areas.end(), 0.0);
    if (!(std::abs(cells - region) <= close * region)) {
      bad_input_at("cell_areas", fmt::format("the cells have {:.6g} m², and their region {:.6g} m²", cells, region),
                   "they fill it: one of the two is of other discs, or in other units",
                   "Remove the cell areas, to have them measured");
    }
  }
  if (!has_areas || !has_facets) {
    std::vector<double> areas = std::move(assembly.cell_areas), lengths = std::move(assembly.facet_lengths);
    measure_cells(assembly);
    if (has_areas) assembly.cell_areas = std::move(areas);
    if (has_facets) assembly.facet_lengths = std::move(lengths);
  } else if (!assembly.periodic()) {
    constexpr const char* sides[] = {"left",        "right",        "bottom",   "top",
                                     "bottom_left", "bottom_right", "top_left", "top_right"};
    if (std::ranges::all_of(sides, [&](const char* name) { return assembly.groups.contains(name); })) return;
    for (auto& [name, side] : measured_sides(assembly)) assembly.groups.emplace(name, std::move(side));
  }
}

}  // namespace equidem
