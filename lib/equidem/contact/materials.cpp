// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/materials.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string_view>

#include <boost/geometry/algorithms/comparable_distance.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <boost/geometry/strategies/strategies.hpp>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr std::string_view cell_prefix = "cell_";

/// The discs of each Voronoi cell of random points, of which none is empty.
std::vector<std::vector<std::int32_t>> discs_of_cells(const Assembly& assembly, std::int64_t cells, Random& random) {
  using Point = boost::geometry::model::d2::point_xy<double>;
  using Numbered = std::pair<Point, std::size_t>;
  Vec2 low = assembly.centres.front(), high = low;
  for (const Vec2& x : assembly.centres) {
    low = {std::min(low.x, x.x), std::min(low.y, x.y)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y)};
  }
  if (assembly.period) high = low + *assembly.period;
  std::vector<Numbered> points;
  const int images = assembly.period ? 1 : 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(cells); ++k) {
    const double x = random.uniform(low.x, high.x), y = random.uniform(low.y, high.y);
    for (int right = -images; right <= images; ++right)
      for (int up = -images; up <= images; ++up)
        points.emplace_back(Point(x + right * (high.x - low.x), y + up * (high.y - low.y)), k);
  }
  constexpr std::size_t entries = 16;
  const boost::geometry::index::rtree<Numbered, boost::geometry::index::rstar<entries>> tree(points);
  std::vector<std::vector<std::int32_t>> discs(static_cast<std::size_t>(cells));
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    const Vec2 at = assembly.centres[disc];
    const Point x(at.x, at.y);
    // The first one is taken where several points are at the same distance.
    std::size_t first = std::numeric_limits<std::size_t>::max();
    double least = std::numeric_limits<double>::infinity();
    for (auto near = tree.qbegin(boost::geometry::index::nearest(x, static_cast<unsigned>(points.size())));
         near != tree.qend(); ++near) {
      const double distance = boost::geometry::comparable_distance(near->first, x);
      if (distance > least) break;
      least = distance;
      first = std::min(first, near->second);
    }
    discs[first].push_back(static_cast<std::int32_t>(disc));
  }
  std::erase_if(discs, [](const auto& cell) { return cell.empty(); });
  return discs;
}

/// The cell of each disc; none where the assembly has no cells.
std::vector<std::int32_t> cells_of(const Assembly& assembly) {
  std::vector<std::int32_t> cells;
  std::int32_t number = 0;
  for (const auto& [name, group] : assembly.groups) {
    if (!name.starts_with(cell_prefix)) continue;
    cells.resize(assembly.size(), -1);
    for (const std::int32_t disc : group.discs) cells[static_cast<std::size_t>(disc)] = number;
    ++number;
  }
  return cells;
}

}  // namespace

void draw_groups(Assembly& assembly, std::span<const GroupShare> shares, const GroupDraw& draw) {
  constexpr double rounding = 1e-9;
  const auto discs = static_cast<double>(assembly.size());
  const double all = std::accumulate(shares.begin(), shares.end(), 0.0,
                                     [](double sum, const auto& group) { return sum + group.share; });
  if (all > 1 + rounding)
    bad_input(fmt::format("the shares of {} are {:.6g} together",
                          joined(shares, [](const GroupShare& group) { return fmt::format("'{}'", group.name); }), all),
              "a disc is in one of these groups", "Give shares of at most 1 together");
  if (draw.cells && static_cast<double>(*draw.cells) > discs)
    bad_input(
        fmt::format("{} are wanted of {}", counted(*draw.cells, "cell"), counted(std::ssize(assembly.centres), "disc")),
        "a cell is some discs wide", "Give fewer cells");
  for (const GroupShare& group : shares) assembly.groups[group.name] = {};  // no cell is called so
  Random random(draw.seed);
  std::vector<std::vector<std::int32_t>> parts;
  if (draw.cells) {
    parts = discs_of_cells(assembly, *draw.cells, random);
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const std::string name = fmt::format("{}{}", cell_prefix, k);
      if (!assembly.groups.try_emplace(name, DiscGroup{parts[k], {}}).second)
        bad_input(fmt::format("the assembly has a group '{}'", name), "the cells of groups with a share are called so",
                  "Choose another name");
    }
  } else {
    for (std::size_t disc = 0; disc < assembly.size(); ++disc) parts.push_back({static_cast<std::int32_t>(disc)});
  }
  for (std::size_t left = parts.size(); left > 1; --left) std::swap(parts[left - 1], parts[random.below(left)]);
  std::size_t next = 0;
  double taken = 0, wanted = 0;
  for (const GroupShare& group : shares) {
    wanted += group.share * discs;
    DiscGroup& found = assembly.groups[group.name];
    // A part is taken where more than half of it is wanted.
    while (next < parts.size() && taken + 0.5 * static_cast<double>(parts[next].size()) <= wanted * (1 + rounding)) {
      found.discs.insert(found.discs.end(), parts[next].begin(), parts[next].end());
      taken += static_cast<double>(parts[next++].size());
    }
    if (found.discs.empty())
      bad_input(fmt::format("group '{}' gets no disc: {:.6g} of {}", group.name, group.share,
                            counted(std::ssize(assembly.centres), "disc")),
                draw.cells ? "a cell has more discs than that" : "that is less than half a disc",
                draw.cells ? "Give more cells, or a larger share" : "Give a larger share");
    std::ranges::sort(found.discs);
  }
}

Materials::Materials(const Assembly& assembly, const std::vector<Pair>& pairs) {
  std::vector<std::size_t> material(assembly.size(), 0);
  const auto number_of = [&](const std::string& name) {
    const auto known = std::ranges::find(names_, name);
    if (known != names_.end()) return static_cast<std::size_t>(known - names_.begin()) + 1;
    for (const std::int32_t disc : group(assembly, name).discs) {
      std::size_t& of_disc = material[static_cast<std::size_t>(disc)];
      if (of_disc != 0)
        bad_input(fmt::format("disc {} is in the groups '{}' and '{}'", disc, names_[of_disc - 1], name),
                  "its contacts would have the properties of two materials", "Give groups that do not overlap");
      of_disc = names_.size() + 1;
    }
    names_.push_back(name);
    return names_.size();
  };
  for (const Pair& pair : pairs) {
    const auto [low, high] = std::minmax({number_of(pair.groups[0]), number_of(pair.groups[1])});
    pairs_.push_back({low, high});
    across_.push_back(pair.across);
  }
  const std::vector<std::int32_t> cells = cells_of(assembly);
  if (cells.empty() && std::ranges::find(across_, true) != across_.end())
    bad_input("contacts across cells are meant", "the groups of the case are not drawn by cells",
              "Give cells to its [[group]] tables with a share");
  for (const Contact& contact : assembly.contacts) {
    const auto i = static_cast<std::size_t>(contact.i), j = static_cast<std::size_t>(contact.j);
    contacts_.push_back({material[i], material[j], !cells.empty() && cells[i] != cells[j]});
  }
}

std::optional<std::size_t> Materials::named(std::size_t a, std::size_t b, bool across) const {
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    if (pairs_[k][0] == std::min(a, b) && pairs_[k][1] == std::max(a, b) && across_[k] == across) return k;
  return {};
}

bool Materials::joined_across(const Place& place) const {
  return place.across && place.i != place.j && !named(place.i, place.j, true) && named(place.i, place.i, true) &&
         named(place.j, place.j, true);
}

std::optional<std::size_t> Materials::pair_at(const Place& place) const {
  if (joined_across(place)) return {};
  const auto across = place.across ? named(place.i, place.j, true) : std::nullopt;
  return across ? across : named(place.i, place.j, false);
}

SpringConstants in_series(const SpringConstants& a, const SpringConstants& b) {
  if (a.kT < 0 || b.kT < 0)
    bad_input("a tangential spring is negative", "springs of two groups that are not named are halves in series",
              "Name the pair of groups");
  const auto series = [](double of_a, double of_b) {
    return of_a == 0 || of_b == 0 ? 0 : 2 * of_a / (1 + of_a / of_b);
  };
  return {series(a.kN, b.kN), series(a.kT, b.kT)};
}

}  // namespace equidem
