// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The springs file, schema "equidem-springs/1": the file that `springs = "springs.toml"` of a case file refers to.
#pragma once

#include <string>

#include "equidem/contact/contact_springs.hpp"
#include "equidem/material/spring_constants.hpp"

namespace equidem {

/// A springs file that reads back to the same bits.
/// \param comment lines for people at the top of the file, may be empty
std::string springs_file(const SpringConstants& springs, SpringWeighting weighting, const std::string& title,
                         const std::string& comment);

}  // namespace equidem
