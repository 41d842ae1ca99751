// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What a law costs at equal accuracy.
///
/// The dimensionless stiffness is held as the step falls (the paper's way), so all laws tend to rigid bodies and
/// impacts without duration. The truth is known for these: a bouncing ball in closed form, the stacked spheres by eq.
/// (28), a gas of discs from impact to impact.
#pragma once

#include <string>

namespace equidem::bench {

/// Error against processor time for every law and step; `finest` halvings of the coarsest step at most.
std::string compare_accuracy(const std::string& scene, int finest, int rounds);

}  // namespace equidem::bench
