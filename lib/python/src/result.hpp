// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Results of verbs as Python objects.
#pragma once

#include <vector>

#include "command.hpp"
#include "module.hpp"

namespace equidem::python {

/// {name: (array, unit)}, views of the memory that each array owns.
py::dict arrays_of(const std::vector<ResultArray>& arrays);

}  // namespace equidem::python
