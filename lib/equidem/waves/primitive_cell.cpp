// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/primitive_cell.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "equidem/core/error.hpp"

namespace equidem {
namespace {

constexpr double tolerance = 1e-9;

void require_period(const Assembly& assembly) {
  if (assembly.periodic()) return;
  bad_input("the assembly is not periodic", "waves of an infinite assembly need a cell that repeats",
            "Set assembly.periodic = true, or give the assembly file a cell");
}

std::array<Vec2, 2> reduced(Vec2 a, Vec2 b) {
  constexpr double half = 0.5 + tolerance;  // ties stay as they are
  for (;;) {
    if (dot(b, b) < dot(a, a) * (1 - tolerance)) std::swap(a, b);
    const double share = dot(a, b) / dot(a, a);
    if (std::abs(share) <= half) break;
    b -= std::round(share) * a;
  }
  if (dot(a, b) < -tolerance * dot(a, a)) b = -b;  // an angle of 60 to 90 degrees
  if (cross(a, b) < 0) std::swap(a, b);
  if (a.x < -tolerance * norm(a)) a = -a, b = -b;
  const auto clean = [](Vec2 v) {  // of round-off and -0
    const double least = 1e-13 * norm(v);
    return Vec2{std::abs(v.x) < least ? 0 : v.x, std::abs(v.y) < least ? 0 : v.y};
  };
  return {clean(a), clean(b)};
}

CellContact contact_of(const Assembly& assembly, const ContactSprings& springs, std::size_t number) {
  const Contact& contact = assembly.contacts[number];
  CellContact all{contact.i,
                  contact.j,
                  assembly.branch(contact),
                  frame_of(assembly, number),
                  springs[number],
                  springs.bending(number)};
  if (const ContactPrestress* const prestress = springs.prestress(number)) all.prestress = *prestress;
  return all;
}

/// The contact with its bodies in the other order: stretch and slip stay, rotations change places.
CellContact seen_from_j(const CellContact& c) {
  const ContactFrame& f = c.frame;
  CellContact other{c.j, c.i, -c.branch, {-f.normal, f.lever_j, f.lever_i, f.offset_j, f.offset_i}, c.springs, c.kM};
  if (c.prestress) {
    const ContactPrestress& g = *c.prestress;
    other.prestress = {
        .ns = g.ns, .ni = g.nj, .nj = g.ni, .ss = g.ss, .si = g.sj, .sj = g.si, .ii = g.jj, .ij = g.ij, .jj = g.ii};
  }
  return other;
}

/// Finds the disc at a place of a periodic assembly.
class DiscFinder {
 public:
  DiscFinder(const Assembly& assembly, double distance)
      : assembly_(assembly), period_(*assembly.period), distance_(distance) {
    const double side = std::sqrt(period_.x * period_.y / static_cast<double>(assembly.size()));
    columns_ = count_of(period_.x / side), rows_ = count_of(period_.y / side);
    first_.assign(columns_ * rows_ + 1, 0);
    for (const Vec2 x : assembly.centres) ++first_[bin_of(x) + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    discs_.resize(assembly.size());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t d = 0; d < assembly.size(); ++d)
      discs_[next[bin_of(assembly.centres[d])]++] = static_cast<std::int32_t>(d);
  }

  /// The disc with its centre there, or -1.
  [[nodiscard]] std::int32_t at(Vec2 x) const {
    for (const double dx : {-distance_, distance_}) {
      for (const double dy : {-distance_, distance_}) {
        const std::size_t bin = bin_of({x.x + dx, x.y + dy});
        for (std::size_t k = first_[bin]; k < first_[bin + 1]; ++k)
          if (norm(nearest_image(assembly_.centres[discs_[k]] - x)) <= distance_) return discs_[k];
      }
    }
    return -1;
  }

 private:
  static std::size_t count_of(double bins) { return static_cast<std::size_t>(std::clamp(bins, 1.0, 1e6)); }
  static std::size_t wrapped(double share, std::size_t bins) {
    const double within = share - std::floor(share);
    return std::min(bins - 1, static_cast<std::size_t>(within * static_cast<double>(bins)));
  }
  [[nodiscard]] std::size_t bin_of(Vec2 x) const {
    return wrapped(x.y / period_.y, rows_) * columns_ + wrapped(x.x / period_.x, columns_);
  }
  [[nodiscard]] Vec2 nearest_image(Vec2 d) const {
    return {d.x - period_.x * std::round(d.x / period_.x), d.y - period_.y * std::round(d.y / period_.y)};
  }

  const Assembly& assembly_;
  Vec2 period_;
  double distance_;
  std::size_t columns_ = 1, rows_ = 1;
  std::vector<std::size_t> first_;
  std::vector<std::int32_t> discs_;
};

/// The group of translations that map a periodic network onto itself.
class TranslationGroup {
 public:
  TranslationGroup(const Assembly& assembly, const ContactSprings& springs)
      : assembly_(assembly),
        length_(assembly.mean_radius()),
        distance_(std::max(tolerance * length_, 8 * std::numeric_limits<double>::epsilon() *
                                                    std::max(assembly.period->x, assembly.period->y))),
        stiffness_(springs.largest()),
        finder_(assembly, distance_),
        contacts_(assembly.size()),
        orbit_(assembly.size()) {
    for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
      const CellContact contact = contact_of(assembly, springs, c);
      contacts_[contact.i].push_back(contact);
      contacts_[contact.j].push_back(seen_from_j(contact));
    }
    std::iota(orbit_.begin(), orbit_.end(), 0);
    find();
  }

  /// The smallest cell; none where only the given period maps the network onto itself.
  [[nodiscard]] std::optional<PrimitiveCell> cell() const {
    const auto n = static_cast<std::int64_t>(assembly_.size());
    std::int64_t copies = 0;
    PrimitiveCell cell;
    std::vector<std::int32_t> index(assembly_.size(), -1);
    for (std::int32_t d = 0; d < n; ++d) {
      if (root(d) == root(0)) ++copies;
      if (root(d) != d) continue;
      index[d] = static_cast<std::int32_t>(cell.discs.size());
      cell.discs.push_back(d);
    }
    if (copies == 1 || copies * static_cast<std::int64_t>(cell.size()) != n) return {};
    cell.copies = copies;
    cell.rotation_scale = length_;
    for (const std::int32_t d : cell.discs) {
      for (const CellContact& contact : contacts_[d]) {
        if (!points_up(contact.branch)) continue;  // else it is seen from its other end
        cell.contacts.push_back(contact);
        cell.contacts.back().i = index[d];
        cell.contacts.back().j = index[root(contact.j)];
      }
    }
    const auto lattice = lattice_of(copies);
    if (!lattice || cell.contacts.size() * static_cast<std::size_t>(copies) != assembly_.contacts.size()) return {};
    cell.period = *lattice;
    return cell;
  }

 private:
  [[nodiscard]] std::int32_t root(std::int32_t d) const {
    while (orbit_[d] != d) d = orbit_[d];
    return d;
  }
  void join(std::int32_t d, std::int32_t e) {
    d = root(d), e = root(e);
    if (d == e) return;
    orbit_[std::max(d, e)] = std::min(d, e);
  }
  [[nodiscard]] bool points_up(Vec2 l) const { return std::abs(l.y) > tolerance * norm(l) ? l.y > 0 : l.x > 0; }
  [[nodiscard]] bool alike(double a, double b, double scale) const { return std::abs(a - b) <= 2 * tolerance * scale; }
  [[nodiscard]] bool alike(const ContactFrame& a, const ContactFrame& b) const {
    return alike(a.lever_i, b.lever_i, length_) && alike(a.lever_j, b.lever_j, length_) &&
           alike(a.offset_i, b.offset_i, length_) && alike(a.offset_j, b.offset_j, length_) &&
           (assembly_.contact_arms.empty() || norm(a.normal - b.normal) <= 2 * tolerance);
  }
  [[nodiscard]] bool alike(const std::optional<ContactPrestress>& a, const std::optional<ContactPrestress>& b) const {
    const auto all_alike = [&](std::initializer_list<double ContactPrestress::*> entries, double unit) {
      return std::all_of(entries.begin(), entries.end(), [&](auto e) { return alike(*a.*e, *b.*e, unit); });
    };
    using P = ContactPrestress;
    return !a || !b ||
           (all_alike({&P::ns, &P::ss}, stiffness_) &&
            all_alike({&P::ni, &P::nj, &P::si, &P::sj}, stiffness_ * length_) &&
            all_alike({&P::ii, &P::ij, &P::jj}, stiffness_ * length_ * length_));
  }
  [[nodiscard]] bool alike(const CellContact& a, const CellContact& b) const {
    return norm(a.branch - b.branch) <= 2 * distance_ && alike(a.frame, b.frame) &&
           alike(a.springs.kN, b.springs.kN, stiffness_) && alike(a.springs.kT, b.springs.kT, stiffness_) &&
           alike(a.kM, b.kM, std::max(a.kM, b.kM)) && alike(a.prestress, b.prestress);
  }
  /// Whether two bodies have equal radius, area and polar moment.
  [[nodiscard]] bool alike_bodies(std::int32_t d, std::int32_t e) const {
    if (!alike(assembly_.radii[d], assembly_.radii[e], length_)) return false;
    if (assembly_.sections.empty()) return true;
    const BodySection &of_d = assembly_.sections[d], &of_e = assembly_.sections[e];
    return alike(of_d.area, of_e.area, of_d.area) && alike(of_d.polar_moment, of_e.polar_moment, of_d.polar_moment);
  }
  [[nodiscard]] bool alike(std::int32_t d, std::int32_t e) const {
    const auto &of_d = contacts_[d], &of_e = contacts_[e];
    if (!alike_bodies(d, e) || of_d.size() != of_e.size()) return false;
    std::vector<char> used(of_e.size(), 0);
    return std::all_of(of_d.begin(), of_d.end(), [&](const CellContact& contact) {
      for (std::size_t k = 0; k < of_e.size(); ++k) {
        if (used[k] != 0 || !alike(contact, of_e[k])) continue;
        used[k] = 1;
        return true;
      }
      return false;
    });
  }

  /// A number that discs share which a translation could map onto each other.
  [[nodiscard]] double fingerprint(std::int32_t d) const {
    double sum = assembly_.radii[d] / length_;
    for (const CellContact& contact : contacts_[d]) {
      const Vec2 l = contact.branch;
      sum += (norm(l) + 0.3 * (l.x * l.x - l.y * l.y) / norm(l) + 0.7 * contact.frame.lever_i) / length_ +
             (0.6 * contact.springs.kN + 0.9 * contact.springs.kT) / stiffness_;
    }
    return sum;
  }

  /// Discs that could be images of each other, as few as can be found: a translation maps the set onto itself.
  [[nodiscard]] std::vector<std::int32_t> rarest() const {
    const std::size_t n = assembly_.size();
    std::vector<std::pair<double, std::int32_t>> order(n);
    for (std::size_t d = 0; d < n; ++d)
      order[d] = {fingerprint(static_cast<std::int32_t>(d)), static_cast<std::int32_t>(d)};
    std::sort(order.begin(), order.end());
    std::pair<std::size_t, std::size_t> best{0, n};
    for (std::size_t begin = 0, end = 1; begin < n; begin = end++) {
      while (end < n && order[end].first - order[end - 1].first <= 100 * tolerance * (1 + order[end].first)) ++end;
      if (end - begin < best.second - best.first) best = {begin, end};
    }
    std::vector<std::int32_t> discs;
    for (std::size_t k = best.first; k < best.second; ++k) discs.push_back(order[k].second);
    std::sort(discs.begin(), discs.end());
    return discs;
  }

  /// The disc onto which the translation maps each; empty where it does not map the network onto itself.
  [[nodiscard]] std::vector<std::int32_t> image_under(Vec2 translation) const {
    std::vector<std::int32_t> image(assembly_.size());
    for (std::size_t d = 0; d < image.size(); ++d) {
      image[d] = finder_.at(assembly_.centres[d] + translation);
      if (image[d] < 0 || !alike(static_cast<std::int32_t>(d), image[d])) return {};
    }
    return image;
  }

  void find() {
    const std::vector<std::int32_t> discs = rarest();
    for (std::size_t k = 1; k < discs.size(); ++k) {
      if (root(discs[k]) == root(discs[0])) continue;  // a combination of those found
      const Vec2 translation = assembly_.centres[discs[k]] - assembly_.centres[discs[0]];
      const std::vector<std::int32_t> image = image_under(translation);
      if (image.empty()) continue;
      for (std::size_t d = 0; d < image.size(); ++d) join(static_cast<std::int32_t>(d), image[d]);
      translations_.push_back(translation);
    }
  }

  /// Translations are multiples of the period over the order of the group: exact in whole numbers. The lattice that
  /// they make with the period, as (p, q) and (0, s) in these units.
  [[nodiscard]] std::optional<std::array<Vec2, 2>> lattice_of(std::int64_t order) const {
    const Vec2 unit = *assembly_.period / static_cast<double>(order);
    std::int64_t p = order, q = 0, s = order;
    for (const Vec2 t : translations_) {
      auto a = static_cast<std::int64_t>(std::llround(t.x / unit.x));
      auto b = static_cast<std::int64_t>(std::llround(t.y / unit.y));
      while (a != 0) {
        const std::int64_t times = p / a;
        p -= times * a, q -= times * b;
        std::swap(p, a), std::swap(q, b);
      }
      s = std::gcd(s, b);
      q %= s;
    }
    if (std::abs(p) * s != order) return {};
    return reduced({static_cast<double>(p) * unit.x, static_cast<double>(q) * unit.y},
                   {0, static_cast<double>(s) * unit.y});
  }

  const Assembly& assembly_;
  double length_, distance_, stiffness_;
  DiscFinder finder_;
  std::vector<std::vector<CellContact>> contacts_;  // of each disc, which is i
  std::vector<std::int32_t> orbit_;                 // parent of each disc in the forest of orbits
  std::vector<Vec2> translations_;                  // that generate the group
};

}  // namespace

PrimitiveCell given_cell(const Assembly& assembly, const ContactSprings& springs) {
  require_period(assembly);
  PrimitiveCell cell;
  cell.period = reduced({assembly.period->x, 0}, {0, assembly.period->y});
  cell.discs.resize(assembly.size());
  std::iota(cell.discs.begin(), cell.discs.end(), 0);
  cell.rotation_scale = assembly.mean_radius();
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) cell.contacts.push_back(contact_of(assembly, springs, c));
  return cell;
}

PrimitiveCell primitive_cell(const Assembly& assembly, const ContactSprings& springs) {
  require_period(assembly);
  check(assembly);
  if (auto cell = TranslationGroup(assembly, springs).cell()) return *std::move(cell);
  return given_cell(assembly, springs);
}

}  // namespace equidem
