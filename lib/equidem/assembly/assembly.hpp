// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs, the contacts that join them, and their cell.
/// The numbers that contacts may have of their own, two of each kind, as assemblies hold and files name them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/geometry/shapes.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

/// A bond between disc i and an image of disc j. The contact point lies at the distance lever_i from the centre of i
/// and lever_j from the centre of j, along the normal n from i to j.
struct Contact {
  std::int32_t i = 0;
  std::int32_t j = 0;
  std::int32_t shift_x = 0;  ///< i touches j at x_j + (shift_x Lx, shift_y Ly); 0 with a free boundary
  std::int32_t shift_y = 0;
  /// m; levers that do not add up to the distance leave a gap or an overlap under a contact that rolls: solve takes
  /// them, homogenize refuses them, since turning all of such an assembly costs energy.
  double lever_i = 0;
  double lever_j = 0;  ///< m
};

/// The place of a contact off the line of centres. With the normal n and s = (-n_y, n_x) the contact point is
///
///   x_i + lever_i n + offset_i s   and, the same point,   x_j - lever_j n - offset_j s,
///
/// so that (lever_i + lever_j) n + (offset_i + offset_j) s is the branch vector. Here levers may be negative.
struct ContactArms {
  Vec2 normal;          ///< unit, from i to j
  double offset_i = 0;  ///< m
  double offset_j = 0;  ///< m
};

/// The cross-section of a body that is no disc.
struct BodySection {
  double area = 0;          ///< m²
  double polar_moment = 0;  ///< m⁴: the integral of r² over the area, about its own centre
};

/// A rectangle with its lower side along a unit vector; low and high are the corners that are the lower left and the
/// upper right one, seen with that side level.
struct TurnedRectangle : Rectangle {
  Vec2 along = {1, 0};

  TurnedRectangle() = default;
  TurnedRectangle(const Rectangle& upright) : Rectangle(upright) {}
  explicit TurnedRectangle(const Rectangle& corners, Vec2 lower_side) : Rectangle(corners), along(lower_side) {}
  /// A vector by its components along the lower side and across it: the same bits where that side is level.
  [[nodiscard]] Vec2 seen(Vec2 v) const { return {dot(along, v), cross(along, v)}; }
  [[nodiscard]] Vec2 size() const { return seen(high - low); }
  [[nodiscard]] double area() const { return size().x * size().y; }
  [[nodiscard]] bool upright() const { return along == Vec2{1, 0}; }
  bool operator==(const TurnedRectangle& other) const {
    return low == other.low && high == other.high && along == other.along;
  }
};

/// Discs chosen by name, for supports and loads. On the sides of a free assembly every disc also stands for a stretch
/// of the side, over which a traction is spread.
struct DiscGroup {
  std::vector<std::int32_t> discs;        ///< ascending, without repetition
  std::vector<double> tributary_lengths;  ///< m, one per disc; empty where the group is not a side
};

/// A contact network of discs, or of other bodies, each then with its centre of mass and the radius of the disc of
/// equal area; SI units, per metre of depth. Two bodies may touch in several places.
struct Assembly {
  std::string kind;           ///< "hexagonal", "square", "delaunay", "file", ...
  std::vector<Vec2> centres;  ///< m
  std::vector<double> radii;  ///< m
  std::vector<Contact> contacts;
  std::optional<double> gap_tolerance;  ///< by which the contacts were found (touching_discs); none: they were given
  std::optional<Vec2> period;           ///< (Lx, Ly) in m of a periodic cell; none: free boundary
  std::optional<TurnedRectangle> box;   ///< free: the region that the cells fill; none: they are not measured yet
  std::vector<double> cell_areas;       ///< m², the Voronoi (power) cell of each disc, clipped to the sides where free
  std::vector<double> facet_lengths;    ///< m, per contact: the edge its two cells share; empty where unknown
  std::vector<ContactArms> contact_arms;  ///< per contact; empty: all lie on the lines of centres, n = l/|l|
  std::vector<BodySection> sections;      ///< per body; empty: discs of these radii
  std::vector<double> contact_kN;         ///< Pa, per contact: overrides the springs of the case; empty: none given
  std::vector<double> contact_kT;         ///< Pa, likewise
  std::vector<double> contact_tension;    ///< N/m, per contact: its strength in tension; empty: none given
  std::vector<double> contact_shear;      ///< N/m, likewise in shear
  /// N/m, per contact: the force that it carries at rest, before any motion, on i along n (tension positive) and along
  /// s = (-n_y, n_x); empty: contacts are unstressed
  std::vector<double> contact_normal_force, contact_tangential_force;
  /// 1/m, per contact: curvature of the surfaces of i and j, the inverse of the distance from the contact point to the
  /// centre of curvature (0: flat); empty: discs about their centres. It counts with forces at rest only.
  std::vector<double> contact_curvature_i, contact_curvature_j;
  std::map<std::string, DiscGroup> groups;  ///< left, right, bottom, top, bottom_left, ... and the user's own

  [[nodiscard]] std::size_t size() const { return centres.size(); }
  [[nodiscard]] bool periodic() const { return period.has_value(); }
  /// The branch vector l from the centre of i to the centre of (the image of) j, m.
  [[nodiscard]] Vec2 branch(const Contact& c) const {
    Vec2 l = centres[c.j] - centres[c.i];
    if (period) l += Vec2{c.shift_x * period->x, c.shift_y * period->y};
    return l;
  }
  /// m²: of the periodic cell, else the sum of the cells of the discs.
  [[nodiscard]] double area() const;
  /// Share of the area that discs (or the sections of other bodies) cover: gamma/rho of Abe 1996.
  [[nodiscard]] double solid_fraction() const;
  /// Mean number of contacts of a disc, z.
  [[nodiscard]] double coordination_number() const;
  /// Mean radius, m: the length a by which rotations are scaled to a*theta.
  [[nodiscard]] double mean_radius() const;
};

/// Gaps at the contacts over the sum of the two radii; negative: overlap.
struct GapRange {
  double smallest = 0, largest = 0;
};
/// The gaps are 0 where bodies have sections of their own, or there are no contacts.
GapRange gaps_at_contacts(const Assembly& assembly);

/// Where the contact point of two discs lies on the line of their centres, at the distance d.
enum class ContactPoints { radii, middle, halfway };

template <>
struct EnumNames<ContactPoints> {
  using enum ContactPoints;
  struct Entry {
    ContactPoints value;
    const char *name, *help;
  };
  static constexpr const char* what = "place of contact points";
  static constexpr Entry list[] = {
      {radii, "radii", "the distance in the ratio of the radii, d r_i/(r_i + r_j) from i"},
      {middle, "middle", "the middle of the gap or overlap, (d + r_i - r_j)/2 from i, as in YADE"},
      {halfway, "halfway", "half-way between the centres, d/2, as in LAMMPS"}};
};

/// Sets the levers of all contacts.
/// \throws Error (bad_input) where a contact is off the line of centres, or would lie outside of it
void place_contact_points(Assembly& assembly, ContactPoints points);

/// Whether the normals of all contacts point through both centres, so that no normal force turns a body.
bool on_lines_of_centres(const Assembly& assembly);

/// Lengths between which areas, their squares and their inverses stay within a double, m.
inline constexpr double shortest_length = 1e-70, longest_length = 1e70;
/// Whether a length lies between them.
constexpr bool measurable(double length) {
  return length >= shortest_length && length <= longest_length;
}
/// "it must lie between ... m", the reason to give where one does not.
std::string length_limits();

/// Check everything that later parts rely on: counts agree, radii, periods and distances of discs in contact are
/// measurable, contacts join two existing discs (or a disc and another image of itself) with lever arms that are not
/// negative; where contacts have arms of their own: unit normals, and arms that meet in one point to 1e-9 of the
/// distance; forces at rest and curvatures are finite.
/// \throws Error (bad_input) naming the first disc or contact that breaks this
void check(const Assembly& assembly);

/// Bytes of an assembly of that many discs with three contacts a disc, the most that a planar network has.
double bytes_of_network(double discs);

/// The disc group of that name.
/// \throws Error (bad_input) where there is none, naming those that exist
const DiscGroup& group(const Assembly& assembly, const std::string& name);

/// The discs with their centre in a box or on its sides.
/// \throws Error (bad_input) if there is none, with the extent of the centres
DiscGroup discs_in(const Assembly& assembly, const Rectangle& box);

/// Inertia of every body: from its section where the assembly has sections, else that of the disc or sphere of its
/// radius. \throws Error (bad_input) as inertia_of a disc; on spheres where there are sections
std::vector<Inertia> inertia_of(const Assembly& assembly, double density, Body body);

/// Two lists of an assembly with one number for each contact, or empty.
struct ContactNumbers {
  const char* key;  ///< in assembly files
  const char* symbols;
  const char* unit;
  std::vector<double> Assembly::*first;
  std::vector<double> Assembly::*second;

  [[nodiscard]] bool given(const Assembly& assembly) const { return !(assembly.*first).empty(); }
  void add(double first_number, double second_number, Assembly& assembly) const {
    (assembly.*first).push_back(first_number);
    (assembly.*second).push_back(second_number);
  }
  void clear(Assembly& assembly) const {
    (assembly.*first).clear();
    (assembly.*second).clear();
  }
};

inline constexpr ContactNumbers contact_numbers[] = {
    {"springs", "kN, kT", "Pa", &Assembly::contact_kN, &Assembly::contact_kT},
    {"strengths", "f_t, f_s", "N/m", &Assembly::contact_tension, &Assembly::contact_shear},
    {"forces", "N, T", "N/m", &Assembly::contact_normal_force, &Assembly::contact_tangential_force},
    {"curvatures", "kappa_i, kappa_j", "1/m", &Assembly::contact_curvature_i, &Assembly::contact_curvature_j}};

}  // namespace equidem
