// SPDX-License-Identifier: GPL-3.0-or-later

#include "equidem/dynamics/layout.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numeric>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/scene_check.hpp"
#include "equidem/linear/contact_graph.hpp"

namespace equidem {

namespace {

/// Thickness of strips: no contact reaches past the next one.
double strip_height(const Assembly& assembly) {
  double longest = 0;
  for (const Contact& contact : assembly.contacts) longest = std::max(longest, std::abs(assembly.branch(contact).y));
  return longest > 0 ? longest * (1 + 1e-9) : 2 * assembly.mean_radius();
}

/// Strips across y. Where the assembly repeats along y they form a ring, which is laid flat: the lowest strip and the
/// highest are one, so are the next of either side, and so on.
std::vector<std::int32_t> strips_of(const Assembly& assembly) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const Vec2 x : assembly.centres) lowest = std::min(lowest, x.y), highest = std::max(highest, x.y);
  // Not many more strips than rows of a dense assembly, however short the longest contact is.
  const double least = (highest - lowest) / std::max(1.0, std::sqrt(static_cast<double>(assembly.size())) * 4);
  const double height = std::max(strip_height(assembly), least);
  std::vector<std::int32_t> strip(assembly.size());
  for (std::size_t d = 0; d < strip.size(); ++d) {
    strip[d] = height > 0 ? static_cast<std::int32_t>((assembly.centres[d].y - lowest) / height) : 0;
  }
  const bool ring = std::any_of(assembly.contacts.begin(), assembly.contacts.end(),
                                [](const Contact& contact) { return contact.shift_y != 0; });
  if (ring) {
    const std::int32_t last = *std::max_element(strip.begin(), strip.end());
    for (std::int32_t& own : strip) own = std::min(own, last - own);
  }
  return strip;
}

/// Within short windows discs with equally many contacts stand together: groups then have few empty slots.
void sort_windows(const std::vector<std::int32_t>& degree, std::vector<std::int32_t>& discs, std::size_t begin) {
  constexpr std::size_t window = 32;
  const auto contacts = [&](std::int32_t d) { return d < 0 ? 0 : degree[d]; };
  for (std::size_t at = begin; at < discs.size(); at += window) {
    const std::size_t end = std::min(at + window, discs.size());
    std::stable_sort(discs.begin() + static_cast<std::ptrdiff_t>(at), discs.begin() + static_cast<std::ptrdiff_t>(end),
                     [&](std::int32_t a, std::int32_t b) { return contacts(a) > contacts(b); });
  }
}

}  // namespace

DiscLayout lay_out(const Assembly& assembly) {
  const std::vector<std::int32_t> strip = strips_of(assembly);
  std::vector<std::int32_t> order(assembly.size()), degree(assembly.size(), 0);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    if (strip[a] != strip[b]) return strip[a] < strip[b];
    const double xa = assembly.centres[a].x, xb = assembly.centres[b].x;
    return xa != xb ? xa < xb : a < b;
  });
  DiscLayout layout;
  for (const Contact& contact : assembly.contacts) {
    ++degree[contact.i];
    ++degree[contact.j];
  }
  layout.strip_first.push_back(0);
  for (std::size_t k = 0; k < order.size();) {
    const std::int32_t here = strip[order[k]];
    const std::size_t begin = layout.disc_at.size();
    for (; k < order.size() && strip[order[k]] == here; ++k) layout.disc_at.push_back(order[k]);
    while (layout.disc_at.size() % DiscLayout::lanes != 0) layout.disc_at.push_back(-1);
    sort_windows(degree, layout.disc_at, begin);
    // Strips without discs join nothing: the next one may follow directly, contacts do not reach across.
    layout.strip_first.push_back(layout.groups());
  }
  layout.disc_at.shrink_to_fit();
  layout.place_of.assign(assembly.size(), -1);
  for (std::size_t place = 0; place < layout.disc_at.size(); ++place) {
    if (layout.disc_at[place] >= 0) layout.place_of[layout.disc_at[place]] = static_cast<std::int32_t>(place);
  }
  return layout;
}

ContactSlots list_slots(const Assembly& assembly, const DiscLayout& layout) {
  const ContactGraph graph(assembly);
  ContactSlots slots;
  slots.first.push_back(0);
  std::vector<std::int32_t> ends[DiscLayout::lanes], contacts[DiscLayout::lanes];
  for (std::int32_t group = 0; group < layout.groups(); ++group) {
    std::size_t most = 0;
    for (int lane = 0; lane < DiscLayout::lanes; ++lane) {
      ends[lane].clear();
      contacts[lane].clear();
      const std::int32_t disc = layout.disc_at[static_cast<std::size_t>(group) * DiscLayout::lanes + lane];
      if (disc < 0) continue;
      for (const auto& edge : graph.of(disc)) {
        const Contact& contact = assembly.contacts[edge.contact];
        const auto add = [&](std::int32_t signed_contact) {
          ends[lane].push_back(layout.place_of[edge.other]);
          contacts[lane].push_back(signed_contact);
        };
        if (contact.i == disc) add(edge.contact + 1);
        if (contact.j == disc) add(-(edge.contact + 1));
      }
      most = std::max(most, ends[lane].size());
    }
    for (std::size_t k = 0; k < most; ++k) {
      for (int lane = 0; lane < DiscLayout::lanes; ++lane) {
        const bool filled = k < ends[lane].size();
        slots.neighbour.push_back(filled ? ends[lane][k] : group * DiscLayout::lanes + lane);
        slots.contact.push_back(filled ? contacts[lane][k] : 0);
      }
    }
    slots.first.push_back(slots.first.back() + static_cast<std::int32_t>(most));
  }
  // These are kept for a whole run.
  slots.first.shrink_to_fit();
  slots.neighbour.shrink_to_fit();
  return slots;
}

BodyArrays::BodyArrays(DiscLayout layout, const LoopKind& kind)
    : layout_(std::move(layout)), unknowns_(kind.unknowns()), width_(kind.width()) {
  const std::size_t places = layout_.disc_at.size();
  for (auto& one : motion) one.assign(places * static_cast<std::size_t>(width_), 0.0);
  velocity.assign(places * static_cast<std::size_t>(unknowns_), 0.0);
  if (kind.resistance != LoopKind::Resistance::dashpot) return;
  for (auto& one : velocity_at) one.assign(motion[0].size(), 0.0);
  dashpot.assign(velocity.size(), 0.0);
}

void BodyArrays::connect(LoopData& data) {
  for (int k = 0; k < 2; ++k) {
    data.motion[k] = motion[k].data();
    data.velocity_at[k] = velocity_at[k].empty() ? nullptr : velocity_at[k].data();
  }
  data.velocity = velocity.data();
  data.dashpot = dashpot.empty() ? nullptr : dashpot.data();
}

std::size_t BodyArrays::first_of(std::size_t disc, std::size_t stride) const {
  constexpr std::size_t lanes = DiscLayout::lanes;
  const auto place = static_cast<std::size_t>(layout_.place_of[disc]);
  return stride == 1 ? place * width_ : place / lanes * lanes * unknowns_ + place % lanes;
}

std::vector<DiscMotion> BodyArrays::read(const LaneVector<double>& array, std::size_t stride) const {
  std::vector<DiscMotion> discs(layout_.place_of.size());
  for (std::size_t d = 0; d < discs.size(); ++d) {
    const double* at = array.data() + first_of(d, stride);
    discs[d] = {{at[0], at[stride]}, unknowns_ == 3 ? at[2 * stride] : 0.0};
  }
  return discs;
}

void BodyArrays::write(const std::vector<DiscMotion>& discs, std::size_t stride, LaneVector<double>& array) const {
  for (std::size_t d = 0; d < discs.size(); ++d) {
    double* at = array.data() + first_of(d, stride);
    at[0] = discs[d].u.x;
    at[stride] = discs[d].u.y;
    if (unknowns_ == 3) at[2 * stride] = discs[d].theta;
  }
}

void BodyArrays::put_velocities(const std::vector<DiscMotion>& discs) {
  write(discs, DiscLayout::lanes, velocity);
  for (auto& one : velocity_at) {
    if (!one.empty()) put(discs, one);
  }
}

void fill_geometry(const LoopKind& kind, Vec2 branch, double lever_own, double lever_other, SpringConstants k,
                   double kM, double* slot, int lane) {
  double* to = slot + lane;
  const auto write = [&to](std::initializer_list<double> numbers) {
    for (const double number : numbers) {
      *to = number;
      to += DiscLayout::lanes;
    }
  };
  const double square = dot(branch, branch);
  if (kind.motion == LoopKind::Motion::finite) {
    const double levers = lever_own + lever_other;
    write({branch.x, branch.y, square});
    if (kind.equal_contacts) return;
    write({levers / norm(branch), levers > 0 ? lever_own / levers : 0.5, k.kN, k.kT});
  } else if (kind.equal_contacts) {
    write({branch.x, branch.y, 1 / square});
  } else {
    const Vec2 n = branch / norm(branch);
    write({n.x, n.y, lever_own, lever_other, k.kN, k.kT});
  }
  if (kind.bending) write({kM});
}

namespace {

void check_inertia(const Scene& scene) {
  constexpr Bound<Inertia> bounds[] = {{"mass", &Inertia::mass, Range::positive()},
                                       {"moment of inertia", &Inertia::moment, Range::positive()}};
  for (std::size_t d = 0; d < scene.inertia.size(); ++d)
    check_bounds(scene.inertia[d], bounds, [d] { return fmt::format(" of disc {}", d); });
}

void check_damping(const SimulationOptions& options) {
  const Damping& damping = options.damping;
  constexpr Bound<Damping> bounds[] = {
      {"mass", &Damping::mass, Range::not_negative(), "1/s"},
      {"stiffness", &Damping::stiffness, Range::not_negative(), "s"},
      {"contact", &Damping::contact, Range::not_negative()},
      {"local", &Damping::local, {.low = 0, .high = 1, .high_open = true}},
      {"viscoelastic normal", &Damping::normal_time, Range::not_negative(), "s"},
      {"viscoelastic tangential", &Damping::tangential_time, Range::not_negative(), "s"}};
  check_bounds(damping, bounds, [] { return " damping"; });
  const bool dashpots = damping.dashpots(), viscoelastic = damping.normal_time > 0 || damping.tangential_time > 0;
  const bool kinds[] = {damping.stiffness > 0, damping.contact > 0, damping.local > 0, viscoelastic};
  if (std::ranges::count(kinds, true) > 1) {
    bad_input("several kinds of damping at contacts are asked for",
              "stiffness, contact and local damping and viscoelastic springs each say which dampers there are",
              "Keep one of them");
  }
  if (!scheme_of(options.integrator).takes_dashpots && (dashpots || damping.local > 0)) {
    bad_input(
        fmt::format("the integrator \"{}\" is asked for with dashpots or local damping", to_string(options.integrator)),
        "its forces depend on positions only, or on velocities by mass-proportional damping",
        "Use leapfrog, or damp by mass");
  }
}

bool in_the_middle(const Assembly& assembly, const Contact& contact) {
  const double half = 0.5 * norm(assembly.branch(contact));
  return std::abs(contact.lever_i - half) <= 1e-12 * half && std::abs(contact.lever_j - half) <= 1e-12 * half;
}

}  // namespace

void check_count(const Scene& scene, std::size_t discs, const char* which, const char* remedy) {
  if (discs == scene.assembly.size()) return;
  bad_input(fmt::format("there are {} {}", counted(static_cast<std::int64_t>(discs), "disc"), which),
            fmt::format("the assembly has {}", scene.assembly.size()), remedy);
}

void check_contacts(const Assembly& assembly) {
  if (assembly.contact_arms.empty()) return;
  bad_input(
      "the contacts of the assembly lie off the lines of centres",
      "the motion of a contact network is that of discs, whose normal forces pass through both centres",
      "Run the grains themselves ([grains], as pack writes them), or solve, homogenize or judge the network at rest");
}

void check(const Scene& scene, const SimulationOptions& options) {
  check_positive(options.time_step, "time step", "s");
  check_count(scene, scene.inertia.size(), "with a mass", "Give the inertia of every disc");
  check_contacts(scene.assembly);
  check_inertia(scene);
  check_damping(options);
  if (scene.springs.bends() && (options.damping.normal_time > 0 || options.damping.tangential_time > 0)) {
    bad_input("viscoelastic springs are asked for beside bending springs",
              "the relaxation of the normal and the tangential spring does not determine that of bending",
              "Remove [viscoelastic], or the bending springs");
  }
  check(scene, options.rotation);
}

Effects effects_of(const Scene& scene, const SimulationOptions& options) {
  Effects effects = derive_effects(scene.assembly, scene.springs, options.rotation);
  const auto add = [&](const char* name, bool active, const char* why) {
    effects.entries.push_back({name, active, active ? "" : why});
  };
  const LoopKind kind = loop_for(scene, options, effects);
  const Damping& damping = options.damping;
  const bool contacts = !scene.assembly.contacts.empty();
  constexpr const char* no_contacts = "there are no contacts";
  for (Effects::Entry& entry : effects.entries) {
    if (!contacts && entry.active && entry.name != "rotation") entry = {entry.name, false, no_contacts};
  }
  add("mass-proportional damping", damping.mass > 0, "none is asked for");
  add("dashpots at contacts", contacts && damping.dashpots(),
      contacts ? "no damping at contacts is asked for" : no_contacts);
  add("local damping", damping.local > 0, "none is asked for");
  add("gravity", scene.weighs(), "it is zero");
  add("loads", !scene.loads.empty(), "no load acts");
  add("supports", !scene.supports.empty(), "no disc is held");
  add("walls", !scene.walls.empty(), "there are none");
  add("finite motions", kind.motion == LoopKind::Motion::finite,
      "motions are taken as small: normals and contact points stay");
  add("springs and levers of each contact", !kind.equal_contacts,
      contacts ? "all contacts have the same springs and lie in the middle: three numbers each" : no_contacts);
  add("inertia of each disc", !kind.equal_discs, "all discs have the same");
  return effects;
}

LoopKind loop_for(const Scene& scene, const SimulationOptions& options, const Effects& effects) {
  LoopKind kind;
  kind.motion = options.motion;
  kind.springs = effects.rotation             ? LoopKind::Springs::rotation
                 : effects.tangential_springs ? LoopKind::Springs::tangential
                                              : LoopKind::Springs::normal;
  kind.bending = effects.bending;
  kind.equal_contacts = !kind.bending && scene.springs.uniform() &&
                        std::all_of(scene.assembly.contacts.begin(), scene.assembly.contacts.end(),
                                    [&](const Contact& c) { return in_the_middle(scene.assembly, c); });
  const Damping& damping = options.damping;
  kind.resistance = damping.dashpots()                   ? LoopKind::Resistance::dashpot
                    : damping.local > 0                  ? LoopKind::Resistance::local
                    : damping.mass > 0 || scene.weighs() ? LoopKind::Resistance::body
                                                         : LoopKind::Resistance::none;
  const auto same = [&](const Inertia& a) {
    return a.mass == scene.inertia[0].mass && a.moment == scene.inertia[0].moment;
  };
  kind.equal_discs = !kind.bending && kind.resistance == LoopKind::Resistance::none &&
                     std::all_of(scene.inertia.begin(), scene.inertia.end(), same);
  // Dashpots of a given damping ratio follow the masses at each contact.
  if (damping.contact > 0 && !std::all_of(scene.inertia.begin(), scene.inertia.end(), same))
    kind.equal_contacts = false;
  return kind;
}

SpringConstants dashpots_of(const Damping& damping, const SpringConstants& k, double mass_i, double mass_j) {
  if (damping.contact == 0) {
    return {(damping.stiffness + damping.normal_time) * k.kN, (damping.stiffness + damping.tangential_time) * k.kT};
  }
  const double reduced = mass_i * mass_j / (mass_i + mass_j);
  return {2 * damping.contact * std::sqrt(reduced * k.kN), 2 * damping.contact * std::sqrt(reduced * std::abs(k.kT))};
}

double bending_dashpot_of(const Damping& damping, double kM, double moment_i, double moment_j) {
  if (damping.contact == 0) return damping.stiffness * kM;
  return 2 * damping.contact * std::sqrt(moment_i * moment_j / (moment_i + moment_j) * kM);
}

}  // namespace equidem
