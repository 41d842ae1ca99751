// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The strength of a sample between two ends that move apart or together: tension, unconfined compression, and tension
/// with a notch in the middle.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "equidem/assembly/assembly.hpp"
#include "equidem/breakage/breakage_run.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/core/names.hpp"
#include "equidem/linear/linear_solver.hpp"

namespace equidem {

/// The direction in which a sample is loaded, between the groups left and right or bottom and top.
enum class LoadAxis { x, y };

template <>
struct EnumNames<LoadAxis> {
  using enum LoadAxis;
  static constexpr const char* what = "axis of loading";
  static constexpr NamedValue<LoadAxis> list[] = {{x, "x"}, {y, "y"}};
};

/// The motion of the discs of the ends across the axis. Rotations are free.
enum class EndPlates {
  frictionless,  ///< free; one disc in the middle of the end that stays is held, so that the sample does not drift
  glued,         ///< held
};

template <>
struct EnumNames<EndPlates> {
  using enum EndPlates;
  static constexpr const char* what = "kind of end plates";
  static constexpr NamedValue<EndPlates> list[] = {{frictionless, "frictionless"}, {glued, "glued"}};
};

struct StrengthTestOptions {
  LoadAxis axis = LoadAxis::y;
  EndPlates ends = EndPlates::frictionless;
  /// In (0, 1): a test is over where the load has fallen to this share of its peak.
  double fallen_to = 0.5;
  Rotation rotation = Rotation::from_scene;
  SolverOptions solver = {};
};

enum class StrengthTestKind { tension, compression };

template <>
struct EnumNames<StrengthTestKind> {
  using enum StrengthTestKind;
  static constexpr const char* what = "test of strength";
  static constexpr NamedValue<StrengthTestKind> list[] = {{tension, "tension"}, {compression, "compression"}};
};

/// The peak of the load under control of the motion, which is that of the envelope under it.
struct SampleStrength {
  double stress = 0;  ///< Pa > 0, the largest load over the width of the sample; infinite: the load never falls
  std::int64_t events = 0, in_shear = 0;  ///< contacts that broke until the test was over
  double energy_error = 0;                ///< BreakageRun::energy_error
};

/// A free sample that is tested again and again, with any strengths.
class StrengthSample {
 public:
  /// \throws Error (bad_input) where the assembly is periodic, lacks the groups of its ends, or these are one; where
  ///         `fallen_to` is no share
  StrengthSample(Assembly assembly, ContactSprings springs, const StrengthTestOptions& options);

  /// \param notch m: the length 2a of a straight cut in the middle of the sample, across the axis; none: no notch
  /// \throws Error (bad_input) as make_load_path, BreakageRun and contacts_across; where the notch is as long as the
  ///         sample is wide; (interrupted)
  [[nodiscard]] SampleStrength strength(StrengthTestKind kind, const ContactStrengths& strengths,
                                        std::optional<double> notch = {}) const;
  [[nodiscard]] const Assembly& assembly() const { return assembly_; }
  /// Across the axis, m: what the discs of the end that moves stand for, else the extent of the cells.
  [[nodiscard]] double width() const { return width_; }

 private:
  Assembly assembly_;
  ContactSprings springs_;
  StrengthTestOptions options_;
  double width_ = 0;
};

/// Mode I toughness of a plate of width W with a notch of length 2a in its middle, which bears the stress sigma, Pa
/// sqrt(m): K = sigma sqrt(pi a sec(pi a/W)) (Feddersen 1966), with the secant for the finite width.
double notch_toughness(double stress, double notch, double width);
inline constexpr double longest_notch = 0.7;  ///< of the width: beyond, the ends of the notch are near the sides

}  // namespace equidem
