// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Memory of the machine.
#pragma once

namespace equidem {

/// Bytes that this process can still take without swapping: what the system calls available, or what its limits
/// leave, whichever is less; 0 where neither can be found out.
double available_memory();

}  // namespace equidem
