// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The parts of a model that each discrete-element code carries, as one table.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "equidem/core/names.hpp"

namespace equidem {

enum class Engine { lammps, yade, pfc };

template <>
struct EnumNames<Engine> {
  using enum Engine;
  static constexpr const char* what = "engine";
  static constexpr NamedValue<Engine> list[] = {{lammps, "LAMMPS"}, {yade, "YADE"}, {pfc, "PFC"}};
};

/// Parts of a model that some engine does not carry.
enum class EngineFeature {
  levers_by_radii,
  levers_of_no_radii,
  levers_with_gaps,
  off_line_contacts,
  sections,
  double_contacts,
  negative_tangential,
  bending_bonds,
  spheres,
  other_inertia,
  unequal_springs,
  bonds_by_no_gap,
  periodic_cell,
  small_cell,
  given_displacements,
  given_at_start,
  schedules,
  turning_schedules,
  schedules_to_rest,
  long_tables,
  load_moments,
  mass_damping,
  bond_dashpots,
  walls_of_bonds,
  oblique_walls,
  shaped_walls,
  moving_walls,
  servo_walls,
  cell_of_grains,
  shapes,
  grain_bonds,
  other_laws,
  stiffness_by_mass,
  unequal_dashpots,
  dashpots_by_pair,
  pulling_dashpots,
  strong_dashpots,
  tangential_dashpots,
  dashpots_along_alone,
  unequal_pairs,
  friction_levers,
  breakage,
};

/// A row of the table.
struct EngineFeatureRow {
  EngineFeature value;
  const char* name;  ///< a plural noun
  bool lammps = false, yade = false, pfc = false;
  const char* why;     ///< of what is not carried
  const char* remedy;  ///< a sentence without its full stop
  /// The word of --accept that exports a model all the same, approximated as `why` says; null: nothing does.
  const char* accept = nullptr;

  [[nodiscard]] bool carried_by(Engine engine) const {
    switch (engine) {
      case Engine::lammps:
        return lammps;
      case Engine::yade:
        return yade;
      case Engine::pfc:
        return pfc;
    }
    return false;
  }
};

template <>
struct EnumNames<EngineFeature> {
  using enum EngineFeature;
  static constexpr const char* what = "part of a model";
  static constexpr EngineFeatureRow list[] = {
      {levers_by_radii, "contact points off the middle between two centres", false, true, true,
       "a bond of bpm/rotational acts half-way between the centres",
       "Export to yade or pfc, unequal discs with assembly.levers = \"middle\"; or set assembly.levers = \"halfway\""},
      {levers_of_no_radii, "levers that no radii of the bodies give", false, false, false,
       "its contact points follow from one radius a body",
       "Set assembly.levers = \"middle\", that is (d + r_i - r_j)/2, or \"halfway\", d/2, which LAMMPS needs"},
      {levers_with_gaps, "levers that do not add up to the distance of the centres", false, false, false,
       "both bodies touch in one point there", "Give levers that do"},
      {off_line_contacts, "contact points off the line of centres", false, false, false, "its bodies are round",
       "Take discs, or 'equidem run'"},
      {sections, "bodies that are no discs", false, false, false, "their contacts and inertia are others",
       "Take discs, or 'equidem run'"},
      {double_contacts, "two contacts of the same two bodies", false, false, false, "a pair has one bond there",
       "Add their springs up, or take a larger cell"},
      {negative_tangential, "negative kT", false, false, false,
       "its contacts store energy, and motion with kT < 0 grows without limit", "Use 'equidem solve'"},
      {spheres, "spheres (body = \"sphere\")", true, true, false, "PFC 2D has discs", "Take body = \"disc\""},
      {other_inertia, "moments of inertia other than m r²/2 of the radius that places the contact points", true, true,
       false, "its moments follow from those radii", "Export to yade or lammps"},
      {bending_bonds, "bonds that resist bending", false, false, false,
       "its bonds are written without resistance to relative rotation", "Take kM or bond_width out"},
      {unequal_springs, "springs that differ from bond to bond", true, true, false,
       "its commands give one kn and ks to all", "Export to yade or lammps"},
      {bonds_by_no_gap, "bonds that are not all pairs up to one gap", true, true, false,
       "its commands choose bonds by their gap", "Export to yade or lammps"},
      {periodic_cell, "periodic cells of bonded discs", true, true, false, "the bonds across its sides are not written",
       "Export to lammps or yade"},
      {small_cell, "periodic cells shorter than twice the longest bond", false, false, false,
       "a bond joins the nearest images there", "Take a larger cell"},
      {given_displacements, "prescribed displacements that are reached at rest", true, true, true, "", ""},
      {given_at_start, "prescribed displacements that a run begins with", true, false, false,
       "its tangential forces follow velocities, not positions", "Export to lammps, or run until_rest"},
      {schedules, "displacements and loads that follow a schedule", true, true, false,
       "they would need its programming", "Export to lammps or yade, or take the schedule out"},
      {turning_schedules, "rotations that follow a schedule", false, true, false,
       "LAMMPS has no command for the torque on single atoms, PFC would need its programming",
       "Export to yade, or take the schedule out"},
      {schedules_to_rest, "schedules in a run until rest", false, false, false,
       "its script would end at a rest before the schedule does", "Give run.duration in place of run.until_rest"},
      {long_tables, "schedules of more than 50 points", false, false, false, "a schedule is one formula there",
       "Give a ramp, a sine or a shorter table"},
      {load_moments, "moments as loads", false, true, true, "it has no command for the torque on single atoms",
       "Export to yade or pfc"},
      {mass_damping, "damping proportional to mass", false, false, false, "it has no such damping of rotations",
       "Take local damping"},
      {bond_dashpots, "dashpots in bonds (damping by stiffness or contact)", true, false, false,
       "YADE has none in the law of its bonds, PFC takes them as shares of the critical ones",
       "Export to lammps, or take local damping"},
      {walls_of_bonds, "walls that push bonded discs", true, false, false, "they are written for LAMMPS alone",
       "Export to lammps, or hold discs by supports"},
      {oblique_walls, "walls that are not parallel to an axis", true, false, true, "its walls are parallel to one",
       "Export to lammps"},
      {shaped_walls, "segments as walls", false, false, false, "its walls are planes", "Take lines, or 'equidem run'"},
      {moving_walls, "walls that move", true, true, false, "they would need its programming",
       "Export to lammps or yade, or take the motion out"},
      {servo_walls, "walls that follow a force or a stress", false, false, false, "their control is not written",
       "Take [wall.servo] out"},
      {cell_of_grains, "periodic cells of bodies that collide", false, false, false,
       "their sides and their motion are not written", "Take [cell] out, or let walls bound the bodies"},
      {shapes, "ellipses and clumps", false, false, false, "their contact laws are others",
       "Take discs, or 'equidem run'"},
      {grain_bonds, "bonds of bodies that collide", false, false, false, "their bonds are not written",
       "Take [bonds], [[bond]] and [stage.bonds] out"},
      {other_laws, "laws of collision other than linear_dashpot", false, false, false,
       "it computes a linear spring and dashpot", "Set collisions.law = \"linear_dashpot\""},
      {stiffness_by_mass, "stiffness that follows from the masses of unequal bodies", false, false, false,
       "its stiffness is one number", "Give collisions.stiffness"},
      {unequal_dashpots, "restitution below 1 of bodies of unequal masses", true, false, true,
       "its dashpots follow from one number for each body", "Export to lammps or pfc, or set restitution = 1"},
      {dashpots_by_pair, "restitution below 1 with properties that differ from pair to pair", true, false, false,
       "its dashpots follow from one number for each body", "Export to lammps, or give all the same"},
      {pulling_dashpots, "restitution below 1 of contacts that may pull", true, false, true,
       "its dashpots end where they would pull", "Set restitution = 1"},
      {strong_dashpots, "dashpots at or above the critical one, of bodies of unequal masses", false, false, true,
       "LAMMPS takes a restitution above 0 there", "Raise restitution"},
      {tangential_dashpots, "tangential dashpots", true, false, true, "its law of this export has none",
       "Set tangential_damping = 0"},
      {dashpots_along_alone, "tangential dashpots without normal ones, of bodies of unequal masses", false, false, true,
       "its tangential dashpot is a multiple of the normal one", "Set tangential_damping = 0, or restitution below 1"},
      {unequal_pairs, "contact properties that differ from pair to pair of groups", true, true, false,
       "one table holds for all contacts", "Give all the same"},
      {friction_levers, "friction of bodies that overlap", false, false, false,
       "its levers differ by parts of the overlap (LAMMPS: the radii, YADE: to the middle, walls otherwise; here: "
       "parts of the distance), and which contacts slide follows: overlaps of a settled box differ by 0.7 per cent "
       "(data/interop.md)",
       "Give --accept friction to export it with these levers, or set friction = 0", "friction"},
      {breakage, "strengths, notches and dead loads of quasistatic", false, false, false,
       "its bonds are written without strength", "Take [strength], [[notch]] and [[dead_load]] out"},
  };
};

/// The features of a model with an instance of each, such as "contact 3".
using FoundFeatures = std::map<EngineFeature, std::string>;

/// \param accepted words of EngineFeatureRow::accept
/// \throws Error (bad_input) on a word that no feature has; on the first feature that the engine does not carry and
///         that is not accepted: name, instance, why, what to do
void require_carried(const FoundFeatures& found, Engine engine, const std::vector<std::string>& accepted);

/// The words of --accept, with the features that they are about.
std::vector<std::string> acceptable_features();

/// The table in Markdown: a row for each feature, a column for each engine, and the reason of its refusals.
std::string engine_features_table();

}  // namespace equidem
