// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Pictures of an assembly, deformed, coloured by stress, with its force chains: SVG and PNG.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/output/files/state.hpp"
#include "equidem/statics/supports.hpp"

namespace equidem {

/// Quantity shown by the colour of a disc.
enum class DiscColour { none, mean_stress, stress_xx, stress_yy, stress_xy, displacement };

template <>
struct EnumNames<DiscColour> {
  static constexpr const char* what = "colouring of discs";
  static constexpr NamedValue<DiscColour> list[] = {
      {DiscColour::none, "none"},           {DiscColour::mean_stress, "mean_stress"},
      {DiscColour::stress_xx, "stress_xx"}, {DiscColour::stress_yy, "stress_yy"},
      {DiscColour::stress_xy, "stress_xy"}, {DiscColour::displacement, "displacement"}};
};

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
  /// Lines along the branches, width in proportion to |normal force|; left out where the mean radius is below 5
  /// pixels (a wider picture shows them).
  bool force_chains = true;
  bool undeformed = false;  ///< outlines of the discs at their initial positions
  /// Factor of the displacements; none: a factor 1, 2 or 5 times a power of ten, at least 1, with which the largest
  /// one is between 2 and 5 % of the larger side of the assembly.
  std::optional<double> displacement_scale = {};
  int width = 1000;  ///< pixels, 400 to 5000; text and lines grow with it, the height follows from the assembly
  std::vector<DrawnLoad> loads = {};
  std::vector<DrawnSupport> supports = {};
  std::vector<DrawnGauge> gauges = {};
  std::vector<DrawnCrack> cracks = {};
};

/// Above this many discs they are drawn as an image in which each point has the colour of the nearest disc, in the SVG
/// too, and outlines and force chains, too fine to be seen, are omitted (stated in the caption).
inline constexpr std::size_t most_drawn_discs = 10000;

/// The factor of displacements that makes the largest one visible: 1, 2 or 5 times a power of ten, at least 1, with
/// which it is between 2 and 5 % of the side.
/// \param largest, side both in m
double visible_scale(double largest, double side);

struct PictureResult {
  int width = 0;  ///< pixels
  int height = 0;
  double displacement_scale = 1;
  std::string caption = {};  ///< the line under the picture
  std::vector<std::filesystem::path> files = {};
};

/// Write NAME.svg and NAME.png. Positions are those of the discs moved by the scaled displacements; a contact through
/// the period is drawn as two halves. Numbers of both signs are coloured on a diverging map, of one sign on a
/// sequential one (colour_map.hpp describes the choice of the range).
/// \throws Error (bad_input) on an empty assembly, motions or radii that are not finite, a width out of range, a load,
///         support or gauge at an absent disc, and as write_file does
PictureResult write_picture(const std::filesystem::path& folder, const std::string& name, const AssemblyState& state,
                            const PictureOptions& options, bool overwrite);

}  // namespace equidem
