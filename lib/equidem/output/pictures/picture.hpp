// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Pictures of an assembly: discs in colours, force chains, cracks, supports, loads; and the page that all pictures
/// have.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/pictures/canvas.hpp"
#include "equidem/statics/loads.hpp"

namespace equidem {

/// Quantity shown by the colour of a disc.
enum class DiscColour { none, mean_stress, stress_xy };

/// An arrow at a disc.
struct DrawnLoad {
  std::int32_t disc = 0;
  Vec2 force;  ///< N/m; the longest is drawn a thirteenth of the assembly long, the others in proportion
};

/// A triangle at a disc: solid where both directions are held, on rollers where one is.
struct DrawnSupport {
  std::int32_t disc = 0;
  bool x = false;
  bool y = false;
};

/// A strain gauge: a line from disc to disc with a letter at either end.
struct DrawnGauge {
  std::int32_t first = 0;
  std::int32_t second = 0;
  std::string first_label = {};
  std::string second_label = {};
};

enum class CrackKind { tension, shear, cut };
/// A broken contact: a line across it, where its two bodies touched.
struct DrawnCrack {
  std::int64_t contact = 0;
  CrackKind kind = CrackKind::tension;
  double order = 1;  ///< from 0, the first to break, to 1
};

/// The force on each disc of a load case.
/// \throws Error (bad_input) where a load names no group
std::vector<DrawnLoad> drawn_loads(const Assembly& assembly, const LoadCase& loads);
/// The discs with a held displacement.
/// \throws Error (bad_input) where a support names no group
std::vector<DrawnSupport> drawn_supports(const Assembly& assembly, std::span<const Support> supports);

struct PictureOptions {
  std::string title = {};
  DiscColour colour = DiscColour::mean_stress;  ///< none is used if the state does not contain the quantity
  bool undeformed = false;                      ///< outlines of the discs at their initial positions
  /// Factor of the displacements; none: a factor 1, 2 or 5 times a power of ten, at least 1, with which the largest
  /// one is between 2 and 5 % of the larger side of the assembly.
  std::optional<double> displacement_scale = {};
  std::vector<DrawnLoad> loads = {};
  std::vector<DrawnSupport> supports = {};
  std::vector<DrawnGauge> gauges = {};
  std::vector<DrawnCrack> cracks = {};
  /// Legend of the lines, before the number of the widest one and its unit.
  std::string lines = "red: tension, blue: compression; widest line ";
  std::string unit_of_lines = "N/m";
};

/// The factor of displacements that makes the largest one visible: 1, 2 or 5 times a power of ten, at least 1, with
/// which it is between 2 and 5 % of the side.
/// \param largest, side both in m
double visible_scale(double largest, double side);

/// Memory that write_picture takes beside the state, about: mostly that of the image that many discs are painted in.
double bytes_of_picture(const Assembly& assembly);

/// Write NAME.svg and NAME.png, 1000 pixels wide. Positions are those of the discs moved by the scaled displacements;
/// lines along the branches show normal forces, where the mean radius is at least 5 pixels; a contact through the
/// period is drawn as two halves. Numbers of both signs are coloured on a diverging map, of one sign on a sequential
/// one (colour_scale).
/// \throws Error (bad_input) on an empty assembly, motions or radii that are not finite, and as write_file does
void write_picture(const std::filesystem::path& folder, const std::string& name, const AssemblyState& state,
                   const PictureOptions& options, bool overwrite);

struct PictureScene {
  const AssemblyState& state;
  const PictureOptions& options;
  PageFrame frame = {};
  std::vector<Vec2> centres = {};  ///< m, displaced
  double displacement_scale = 1;

  std::vector<double> values = {};  ///< per disc, in shown units; empty: not coloured
  ColourScale colours = {};         ///< of the values
  std::string colour_label = {};    ///< "mean stress"
  std::string colour_unit = {};     ///< "(MPa)"

  Vec2 middle = {};          ///< m, of the displaced centres
  double longest_arrow = 0;  ///< m

  bool as_image = false;      ///< more than most_drawn_discs
  bool force_chains = false;  ///< known and not too fine
  double widest_force = 0;    ///< N/m, |normal force| of the widest line; stronger ones are as wide
  double widest_line = 0;     ///< units
  std::string caption = {};
};

/// Everything that is decided before drawing.
/// \throws Error (bad_input) as write_picture does
PictureScene plan_scene(const AssemblyState& state, const PictureOptions& options);

}  // namespace equidem
