// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies that no contact holds in place, left out before an assembly is solved.
#pragma once

#include "problem.hpp"

namespace equidem {

/// Leave out of a packing, or of an assembly from a file, the bodies that no contact holds in place (LeaveOut::loose)
/// and that have no support or load of their own; on a side of the assembly they are left out even so. The cells and
/// sides of the rest are measured again. Bodies and contacts are then numbered anew.
/// \param problem its assembly, springs and left_out are changed
void leave_out_loose(Problem& problem);

}  // namespace equidem
