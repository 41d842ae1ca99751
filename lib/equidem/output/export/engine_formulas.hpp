// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Numbers and schedules as text that other engines read.
#pragma once

#include <string>

#include "equidem/motion/schedule.hpp"

namespace equidem {

/// A number in the shortest form that reads back to the same bits.
std::string exact(double value);

/// A schedule as a formula that LAMMPS and Python read, with abs, sin and cos.
/// \param time the name of the time in it, s
std::string formula_of(const Schedule& schedule, const std::string& time);

}  // namespace equidem
