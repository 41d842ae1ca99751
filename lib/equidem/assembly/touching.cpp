// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/touching.hpp"

#include <algorithm>
#include <optional>
#include <tuple>

#include "equidem/assembly/sites.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/geometry/neighbours.hpp"

namespace equidem {
namespace {

/// Gaps up to this share of the smaller radius are rounding of the centres.
constexpr double rounding_gap = 1e-9;
/// Discs wider than this many periods are taken for a mistake.
constexpr int most_periods = 16;

/// Periods by which a centre lies outside the cell.
struct Moved {
  std::int64_t x = 0, y = 0;
};

void check_periods(Vec2 period, double diameter) {
  const double narrow = std::min(period.x, period.y);
  if (diameter <= most_periods * narrow) return;
  bad_input(fmt::format("the largest disc, of diameter {:.6g} m, spans more than {} periods of {:.6g} m", diameter,
                        most_periods, narrow),
            "it would touch itself that many times", "Correct the radii or the cell");
}

}  // namespace

std::vector<Contact> touching_discs(const Assembly& assembly, double gap_tolerance) {
  stop_if_interrupted();
  const double share = std::max(gap_tolerance, rounding_gap);
  if (assembly.period)
    check_periods(*assembly.period, 2 * (1 + share) * *std::max_element(assembly.radii.begin(), assembly.radii.end()));
  std::vector<Circle> circles;  // in the cell, larger by the gap
  std::vector<Moved> moved(assembly.size());
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    Vec2 centre = assembly.centres[disc];
    if (const auto& period = assembly.period) {
      moved[disc] = {periods_below(centre.x, period->x, disc), periods_below(centre.y, period->y, disc)};
      centre -= Vec2{static_cast<double>(moved[disc].x) * period->x, static_cast<double>(moved[disc].y) * period->y};
    }
    circles.push_back({centre, assembly.radii[disc] * (1 + share) * (1 + rounding_gap)});
  }
  std::optional<Periods> periods;
  if (assembly.period) periods = {{assembly.period->x, 0}, {0, assembly.period->y}};
  std::vector<Contact> contacts;
  for (const auto& [i, image, shift] : pairs_within(circles, periods, 0)) {
    const std::int32_t j = image.body;
    Contact contact{.i = i,
                    .j = j,
                    .shift_x = static_cast<std::int32_t>(image.a + moved[i].x - moved[j].x),
                    .shift_y = static_cast<std::int32_t>(image.b + moved[i].y - moved[j].y)};
    const double distance = norm(assembly.branch(contact));
    const double ri = assembly.radii[i], rj = assembly.radii[j];
    if (distance - ri - rj > std::max(rounding_gap * std::min(ri, rj), gap_tolerance * (ri + rj))) continue;
    contact.lever_i = distance * (ri / (ri + rj));
    contact.lever_j = distance - contact.lever_i;
    contacts.push_back(contact);
  }
  std::sort(contacts.begin(), contacts.end(), [](const Contact& a, const Contact& b) {
    return std::tie(a.i, a.j, a.shift_x, a.shift_y) < std::tie(b.i, b.j, b.shift_x, b.shift_y);
  });
  return contacts;
}

std::vector<BondCount> bond_counts(std::span<const double> gaps, std::size_t bodies) {
  std::vector<BondCount> counts;
  for (const double tolerance : {0.0, 0.01, 0.02, 0.05, 0.1, 0.2, largest_counted_gap}) {
    const std::int64_t found = std::ranges::count_if(gaps, [&](double gap) { return gap <= tolerance; });
    counts.push_back({tolerance, found, 2 * static_cast<double>(found) / static_cast<double>(bodies)});
  }
  return counts;
}

std::vector<BondCount> bond_counts(const Assembly& discs) {
  std::vector<double> gaps;
  for (const Contact& c : touching_discs(discs, largest_counted_gap)) {
    const double sum = discs.radii[static_cast<std::size_t>(c.i)] + discs.radii[static_cast<std::size_t>(c.j)];
    const double gap = norm(discs.branch(c)) / sum - 1;
    gaps.push_back(gap <= rounding_gap ? std::min(gap, 0.0) : gap);
  }
  return bond_counts(gaps, discs.size());
}

std::string suggested_tolerance(std::span<const BondCount> counts, double tolerance) {
  constexpr double wanted = 4;
  const BondCount* best = nullptr;
  std::int64_t now = 0;
  for (const BondCount& count : counts) {
    if (count.gap_tolerance <= tolerance) {
      now = count.contacts;
    } else if (best == nullptr || best->coordination < wanted) {
      best = &count;
    }
  }
  if (best == nullptr || best->contacts <= now) return {};
  return fmt::format("gap_tolerance = {} would find {} (z = {:.3g})", best->gap_tolerance,
                     counted(best->contacts, "contact"), best->coordination);
}

std::string by_larger_tolerance(const Assembly& assembly) {
  return assembly.gap_tolerance ? fmt::format(" by a gap_tolerance above {:g}", *assembly.gap_tolerance) : "";
}

void check_found_contacts(const Assembly& assembly) {
  if (!assembly.gap_tolerance) return;
  // The edges of a triangulation of many points in the plane: six of each.
  constexpr double most = 6;
  const double tolerance = *assembly.gap_tolerance, coordination = assembly.coordination_number();
  if (assembly.contacts.empty()) {
    const std::string larger = suggested_tolerance(bond_counts(assembly), tolerance);
    bad_input(fmt::format("gap_tolerance = {} joins none of the {}", tolerance,
                          counted(std::ssize(assembly.centres), "body", "bodies")),
              "without contacts nothing resists a deformation",
              larger.empty() ? "Pack them denser, or correct the radii" : "Take a larger one: " + larger);
  }
  if (tolerance == 0 || coordination <= most) return;
  std::string smaller = "Take a smaller one";
  for (const BondCount& count : bond_counts(assembly))
    if (count.coordination <= most && count.gap_tolerance < tolerance)
      smaller = fmt::format("Take a smaller one: gap_tolerance = {} finds {} (z = {:.3g})", count.gap_tolerance,
                            counted(count.contacts, "contact"), count.coordination);
  bad_input(fmt::format("gap_tolerance = {} finds {}, {:.3g} of each body", tolerance,
                        counted(std::ssize(assembly.contacts), "contact"), coordination),
            "above six contacts cross: they join bodies with others between them", smaller);
}

}  // namespace equidem
