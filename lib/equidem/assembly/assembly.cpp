// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/assembly.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

bool finite(Vec2 v) {
  return std::isfinite(v.x) && std::isfinite(v.y);
}

/// "contact 7, of discs 3 and 4"; where they touch across the period, with the shift.
std::string described(const Contact& c, std::size_t index) {
  if (c.shift_x == 0 && c.shift_y == 0) return fmt::format("contact {}, of discs {} and {}", index, c.i, c.j);
  return fmt::format("contact {}, of disc {} and the image of disc {} shifted by ({}, {}) periods", index, c.i, c.j,
                     c.shift_x, c.shift_y);
}

void check_count(const char* what, std::size_t count, const char* per, std::size_t expected) {
  if (count == expected) return;
  bad_input(fmt::format("{} {} are given for {} {}", count, what, expected, per), "there must be one for each",
            fmt::format("Give {} {}, or none", expected, what));
}

/// Call body(k) for k from 0 to count - 1 on all threads; the error is that of the lowest k.
template <typename Body>
void check_each(std::size_t count, const Body& body) {
  constexpr std::size_t piece = 16384;
  std::vector<std::exception_ptr> failures((count + piece - 1) / piece);
  parallel_ranges(count, piece, [&](std::size_t begin, std::size_t end) {
    try {
      for (std::size_t k = begin; k < end; ++k) body(k);
    } catch (const Error&) {
      failures[begin / piece] = std::current_exception();
    }
  });
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

void check_discs(const Assembly& assembly) {
  const std::size_t n = assembly.size();
  if (n == 0) bad_input("the assembly has no discs", "there is nothing to solve for", "Give it discs");
  check_count("radii", assembly.radii.size(), "discs", n);
  check_each(n, [&](std::size_t d) {
    const auto [x, y] = assembly.centres[d];
    if (!finite(assembly.centres[d])) {
      bad_input(fmt::format("disc {} has its centre at ({}, {})", d, x, y), "centres must be finite",
                "Correct its coordinates");
    }
    if (std::max(std::abs(x), std::abs(y)) > longest_length) {
      bad_input(fmt::format("disc {} has its centre at ({}, {})", d, x, y),
                fmt::format("centres must lie within {} m of the origin", longest_length), "Choose other units");
    }
    if (!is_positive(assembly.radii[d])) {
      bad_input(fmt::format("disc {} has the radius {}", d, assembly.radii[d]), "radii must be positive and finite",
                "Correct it");
    }
    if (!measurable(assembly.radii[d])) {
      bad_input(fmt::format("disc {} has the radius {} m", d, assembly.radii[d]), length_limits(),
                "Choose other units");
    }
  });
  if (assembly.cell_areas.empty()) return;
  check_count("cell areas", assembly.cell_areas.size(), "discs", n);
  check_each(n, [&](std::size_t d) {
    if (!(assembly.cell_areas[d] >= 0) || !std::isfinite(assembly.cell_areas[d])) {
      bad_input(fmt::format("disc {} has the cell area {}", d, assembly.cell_areas[d]),
                "cell areas must be finite and not negative", "Measure the cells anew");
    }
  });
}

void check_contact(const Assembly& assembly, std::size_t index) {
  const Contact& c = assembly.contacts[index];
  const auto n = static_cast<std::int64_t>(assembly.size());
  for (const std::int32_t disc : {c.i, c.j}) {
    if (disc < 0 || disc >= n) {
      bad_input(fmt::format("contact {} names disc {}", index, disc),
                fmt::format("the discs are numbered from 0 to {}", n - 1), "Correct the contact or add the disc");
    }
  }
  const bool shifted = c.shift_x != 0 || c.shift_y != 0;
  if (shifted && !assembly.periodic()) {
    bad_input(fmt::format("{}, reaches across a period", described(c, index)), "the assembly has no period",
              "Give the cell its period, or set the shift of the contact to 0");
  }
  if (c.i == c.j && !shifted) {
    bad_input(fmt::format("contact {} joins disc {} to itself", index, c.i),
              "a disc can only touch another disc or its own image across a period",
              "Remove the contact or give it a shift");
  }
  const Vec2 l = assembly.branch(c);
  if (!finite(l) || (l.x == 0 && l.y == 0)) {
    bad_input(fmt::format("{}, spans the branch ({}, {})", described(c, index), l.x, l.y),
              "its length must be finite and positive, or it has no direction", "Move one of the discs");
  }
  if (!measurable(norm(l))) {
    bad_input(fmt::format("{}, is {} m long", described(c, index), norm(l)), length_limits(), "Choose other units");
  }
  for (const double lever : {c.lever_i, c.lever_j}) {
    const bool on_line = assembly.contact_arms.empty();
    if ((on_line && !(lever >= 0)) || !std::isfinite(lever)) {
      bad_input(fmt::format("{}, has the lever arm {}", described(c, index), lever),
                on_line ? "lever arms must be finite and not negative" : "lever arms must be finite", "Correct it");
    }
    if (std::abs(lever) > longest_length) {
      bad_input(fmt::format("{}, has the lever arm {} m", described(c, index), lever),
                fmt::format("lever arms may be {} m long at most", longest_length), "Correct it");
    }
  }
}

void check_arms(const Assembly& assembly, std::size_t index) {
  const Contact& c = assembly.contacts[index];
  const ContactArms& given = assembly.contact_arms[index];
  constexpr double close = 1e-9, rounding = 8 * std::numeric_limits<double>::epsilon();  // of lengths, of coordinates
  if (!(std::abs(norm(given.normal) - 1) <= close)) {
    bad_input(fmt::format("{}, has the normal ({}, {})", described(c, index), given.normal.x, given.normal.y),
              "its length must be 1", "Divide it by its length");
  }
  for (const double offset : {given.offset_i, given.offset_j}) {
    if (std::abs(offset) <= longest_length) continue;
    bad_input(fmt::format("{}, has the offset {} m", described(c, index), offset),
              fmt::format("offsets must be finite and at most {} m", longest_length), "Correct it");
  }
  const Vec2 l = assembly.branch(c);
  const Vec2 arms =
      (c.lever_i + c.lever_j) * given.normal + (given.offset_i + given.offset_j) * perpendicular(given.normal);
  const double coordinates = norm(assembly.centres[c.i]) + norm(assembly.centres[c.i] + l);
  const double reach = std::abs(c.lever_i) + std::abs(c.lever_j) + std::abs(given.offset_i) + std::abs(given.offset_j);
  if (norm(arms - l) <= close * std::max(norm(l), reach) + rounding * coordinates) return;
  bad_input(fmt::format("{}, has arms that are {:.6g} m apart at their ends", described(c, index), norm(arms - l)),
            "levers along the normal and offsets across it must lead from both centres to the same point",
            "Give the contact point with all its digits");
}

void check_bodies(const Assembly& assembly) {
  if (assembly.sections.empty()) return;
  check_count("sections", assembly.sections.size(), "bodies", assembly.size());
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    const BodySection& section = assembly.sections[d];
    if (!(section.area > 0 && section.polar_moment > 0 && std::isfinite(section.area + section.polar_moment))) {
      bad_input(
          fmt::format("body {} has the area {} m² and the polar moment {} m⁴", d, section.area, section.polar_moment),
          "both must be positive and finite", "Correct its section");
    }
    constexpr double close = 1e-6;
    const double least = section.area * section.area / (2 * std::numbers::pi);
    if (section.polar_moment < (1 - close) * least) {
      bad_input(
          fmt::format("body {} has the area {} m² and the polar moment {} m⁴", d, section.area, section.polar_moment),
          fmt::format("no section of that area has a smaller one than the disc, {:.9g} m⁴", least),
          "Correct its section: the moment is about its own centre");
    }
    const double radius = std::sqrt(section.area / std::numbers::pi);
    if (std::abs(assembly.radii[d] - radius) > close * radius) {
      bad_input(fmt::format("body {} has the radius {} m and the area {} m²", d, assembly.radii[d], section.area),
                fmt::format("a body with a section has the radius of the disc of equal area, {:.9g} m", radius),
                "Correct one of the two");
    }
  }
}

/// Two lists of numbers, each empty or as long as that of the contacts; check(c, first, second) for each contact.
template <typename Check>
void check_pairs(const Assembly& assembly, const char* first, const std::vector<double>& firsts, const char* second,
                 const std::vector<double>& seconds, const Check& check) {
  if (firsts.empty() && seconds.empty()) return;
  check_count(first, firsts.size(), "contacts", assembly.contacts.size());
  check_count(second, seconds.size(), "contacts", assembly.contacts.size());
  check_each(assembly.contacts.size(), [&](std::size_t c) { check(c, firsts[c], seconds[c]); });
}

void check_numbers_of_contacts(const Assembly& assembly) {
  const auto name = [&](std::size_t c) { return described(assembly.contacts[c], c); };
  check_pairs(assembly, "tensile strengths", assembly.contact_tension, "shear strengths", assembly.contact_shear,
              [&](std::size_t c, double tension, double shear) {
                if (tension >= 0 && shear >= 0 && std::isfinite(tension + shear)) return;
                bad_input(fmt::format("{}, has the strengths {} and {} N/m", name(c), tension, shear),
                          "a strength must be finite and not negative",
                          "Correct them; a contact that never breaks has large ones");
              });
  check_pairs(assembly, "normal forces", assembly.contact_normal_force, "tangential forces",
              assembly.contact_tangential_force, [&](std::size_t c, double normal, double tangential) {
                if (std::isfinite(normal + tangential)) return;
                bad_input(fmt::format("{}, carries the forces {} and {} N/m at rest", name(c), normal, tangential),
                          "they must be finite", "Correct them");
              });
  check_pairs(assembly, "curvatures of i", assembly.contact_curvature_i, "curvatures of j",
              assembly.contact_curvature_j, [&](std::size_t c, double i, double j) {
                if (std::isfinite(i + j) && i + j != 0) return;
                bad_input(fmt::format("{}, has the curvatures {} and {} 1/m", name(c), i, j),
                          "they must be finite, and two flat or two congruent surfaces have no normal of their own",
                          "Correct them");
              });
  check_pairs(assembly, "normal springs", assembly.contact_kN, "tangential springs", assembly.contact_kT,
              [&](std::size_t c, double kN, double kT) {
                if (!is_positive(kN))
                  bad_input(fmt::format("{}, has kN = {} Pa", name(c), kN),
                            "a normal spring must be positive and finite", "Correct it or remove the contact");
                if (!std::isfinite(kT))
                  bad_input(fmt::format("{}, has kT = {} Pa", name(c), kT), "a tangential spring must be finite",
                            "Correct it");
              });
}

void check_contacts(const Assembly& assembly) {
  const std::size_t m = assembly.contacts.size();
  if (!assembly.contact_arms.empty()) check_count("arms", assembly.contact_arms.size(), "contacts", m);
  check_each(m, [&](std::size_t c) {
    check_contact(assembly, c);
    if (!assembly.contact_arms.empty()) check_arms(assembly, c);
  });
  if (!assembly.facet_lengths.empty()) {
    check_count("facet lengths", assembly.facet_lengths.size(), "contacts", m);
    check_each(m, [&](std::size_t c) {
      if (!(assembly.facet_lengths[c] >= 0) || !std::isfinite(assembly.facet_lengths[c])) {
        bad_input(
            fmt::format("{}, has the facet length {}", described(assembly.contacts[c], c), assembly.facet_lengths[c]),
            "facet lengths must be finite and not negative", "Measure the cells anew");
      }
    });
  }
  check_numbers_of_contacts(assembly);
}

void check_group(const Assembly& assembly, const std::string& name, const DiscGroup& discs) {
  const auto n = static_cast<std::int64_t>(assembly.size());
  for (std::size_t k = 0; k < discs.discs.size(); ++k) {
    if (discs.discs[k] < 0 || discs.discs[k] >= n) {
      bad_input(fmt::format("group '{}' names disc {}", name, discs.discs[k]),
                fmt::format("the discs are numbered from 0 to {}", n - 1), "Correct the group or add the disc");
    }
    if (k > 0 && discs.discs[k] <= discs.discs[k - 1]) {
      bad_input(fmt::format("group '{}' names disc {} after disc {}", name, discs.discs[k], discs.discs[k - 1]),
                "the discs of a group must ascend, each once", "Sort them and drop repetitions");
    }
  }
  if (discs.tributary_lengths.empty()) return;
  check_count(fmt::format("tributary lengths of group '{}'", name).c_str(), discs.tributary_lengths.size(),
              "discs of it", discs.discs.size());
  for (std::size_t k = 0; k < discs.discs.size(); ++k) {
    if (!(discs.tributary_lengths[k] >= 0) || !std::isfinite(discs.tributary_lengths[k])) {
      bad_input(fmt::format("disc {} of group '{}' has the tributary length {}", discs.discs[k], name,
                            discs.tributary_lengths[k]),
                "tributary lengths must be finite and not negative", "Correct it");
    }
  }
}

void check_box(const Assembly& assembly) {
  if (!assembly.box) return;
  const TurnedRectangle& rectangle = *assembly.box;
  const auto [low, high] = static_cast<Rectangle>(rectangle);
  std::string box = fmt::format("the box from ({:g}, {:g}) to ({:g}, {:g}) m", low.x, low.y, high.x, high.y);
  if (!rectangle.upright()) box += fmt::format(" with a side along ({:g}, {:g})", rectangle.along.x, rectangle.along.y);
  if (assembly.period)
    bad_input(box + " stands beside a period", "a periodic cell fills its period", "Remove one of the two");
  constexpr double close = 1e-9;
  if (!(std::abs(norm(rectangle.along) - 1) <= close))
    bad_input(box + " has no direction", "that of its side is a vector of length 1", "Divide it by its length");
  const Vec2 size = rectangle.size();
  if (!(measurable(size.x) && measurable(size.y))) {
    bad_input(fmt::format("{} is {:g} m wide and {:g} m high", box, size.x, size.y), length_limits(),
              "Give its lower left corner, then its upper right one");
  }
}

}  // namespace

double Assembly::area() const {
  if (period) return period->x * period->y;
  if (cell_areas.empty()) {
    bad_input("the assembly has no cell areas", "with a free boundary its area is the sum of its cells",
              "Measure the cells first");
  }
  return std::accumulate(cell_areas.begin(), cell_areas.end(), 0.0);
}

double Assembly::solid_fraction() const {
  if (!sections.empty()) {
    double covered = 0;
    for (const BodySection& section : sections) covered += section.area;
    return covered / area();
  }
  double squares = 0;
  for (const double r : radii) squares += r * r;
  return std::numbers::pi * squares / area();
}

double Assembly::coordination_number() const {
  return centres.empty() ? 0 : 2 * static_cast<double>(contacts.size()) / static_cast<double>(size());
}

double Assembly::mean_radius() const {
  return radii.empty() ? 0 : std::accumulate(radii.begin(), radii.end(), 0.0) / static_cast<double>(radii.size());
}

GapRange gaps_at_contacts(const Assembly& assembly) {
  if (!assembly.sections.empty() || assembly.contacts.empty()) return {};
  GapRange range{.smallest = std::numeric_limits<double>::infinity(), .largest = -1};
  for (const Contact& contact : assembly.contacts) {
    const double reach = assembly.radii[contact.i] + assembly.radii[contact.j];
    const double gap = norm(assembly.branch(contact)) / reach - 1;
    range = {.smallest = std::min(range.smallest, gap), .largest = std::max(range.largest, gap)};
  }
  return range;
}

bool on_lines_of_centres(const Assembly& assembly) {
  return std::all_of(assembly.contact_arms.begin(), assembly.contact_arms.end(),
                     [](const ContactArms& arms) { return arms.offset_i == 0 && arms.offset_j == 0; });
}

std::string length_limits() {
  return fmt::format("it must lie between {} and {} m, or squares of areas leave the range of a double",
                     shortest_length, longest_length);
}

void check(const Assembly& assembly) {
  if (assembly.period && !(finite(*assembly.period) && assembly.period->x > 0 && assembly.period->y > 0)) {
    bad_input(fmt::format("the period is ({}, {}) m", assembly.period->x, assembly.period->y),
              "both lengths of a periodic cell must be positive and finite", "Correct the cell");
  }
  if (assembly.period && !(measurable(assembly.period->x) && measurable(assembly.period->y))) {
    bad_input(fmt::format("the period is ({}, {}) m", assembly.period->x, assembly.period->y), length_limits(),
              "Choose other units");
  }
  check_discs(assembly);
  check_box(assembly);
  check_bodies(assembly);
  check_contacts(assembly);
  for (const auto& [name, discs] : assembly.groups) check_group(assembly, name, discs);
}

double bytes_of_network(double discs) {
  constexpr double disc = sizeof(Vec2) + 2 * sizeof(double), contact = sizeof(Contact) + sizeof(double);
  return discs * (disc + 3 * contact);
}

const DiscGroup& group(const Assembly& assembly, const std::string& name) {
  const auto found = assembly.groups.find(name);
  if (found != assembly.groups.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [other, discs] : assembly.groups) known.push_back(other);
  const std::string names = first_words(std::move(known));
  bad_input(fmt::format("the assembly has no group '{}'", name),
            names.empty() ? std::string("it has no groups at all") : "its groups are " + names,
            assembly.periodic() ? "Name one of them; a periodic cell has no sides of its own" : "Name one of them");
}

DiscGroup discs_in(const Assembly& assembly, const Rectangle& box) {
  const auto& [low, high] = box;
  DiscGroup found;
  Vec2 least = assembly.centres.front(), most = least;
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    const Vec2 x = assembly.centres[disc];
    least = {std::min(least.x, x.x), std::min(least.y, x.y)};
    most = {std::max(most.x, x.x), std::max(most.y, x.y)};
    if (x.x >= low.x && x.x <= high.x && x.y >= low.y && x.y <= high.y)
      found.discs.push_back(static_cast<std::int32_t>(disc));
  }
  if (found.discs.empty())
    bad_input("no disc has its centre in the box",
              fmt::format("the centres lie in [{:.6g}, {:.6g}, {:.6g}, {:.6g}]", least.x, least.y, most.x, most.y),
              "Move or widen the box");
  return found;
}

std::vector<Inertia> inertia_of(const Assembly& assembly, double density, Body body) {
  std::vector<Inertia> all = inertia_of(assembly.radii, density, body);
  if (!assembly.sections.empty() && body != Body::disc) {
    bad_input("the bodies of the assembly are set to be spheres", "its file gives their cross-sections",
              "Write body = \"disc\", or remove \"sections\" from the file");
  }
  for (std::size_t d = 0; d < assembly.sections.size(); ++d)
    all[d] = {density * assembly.sections[d].area, density * assembly.sections[d].polar_moment};
  return all;
}

void place_contact_points(Assembly& assembly, ContactPoints points) {
  if (!assembly.contact_arms.empty() || !assembly.sections.empty())
    bad_input("levers are chosen for bodies that are no discs", "their contact points are where their outlines meet",
              "Leave the choice out");
  for (Contact& c : assembly.contacts) {
    const double d = norm(assembly.branch(c)), r_i = assembly.radii[c.i], r_j = assembly.radii[c.j];
    c.lever_i = points == ContactPoints::radii    ? d * r_i / (r_i + r_j)
                : points == ContactPoints::middle ? 0.5 * (d + r_i - r_j)
                                                  : 0.5 * d;
    c.lever_j = d - c.lever_i;
    if (c.lever_i > 0 && c.lever_j > 0) continue;
    bad_input(fmt::format("discs {} and {} overlap so far that the middle of the overlap is beyond a centre", c.i, c.j),
              "a lever would be negative", "Choose levers by the radii or half-way");
  }
}

}  // namespace equidem
