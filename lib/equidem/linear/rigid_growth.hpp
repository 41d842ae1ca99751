// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A proof, at the cost of one pass over the contacts, that a network has no motions without energy but rigid ones.
#pragma once

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/linear/contact_graph.hpp"

namespace equidem {

/// Three discs that touch one another are rigid: pinned together where kT > 0 and discs turn, joined by bars where
/// kT = 0. A disc that touches a rigid cluster in two directions belongs to it (Henneberg 1911). True where clusters
/// grow to whole pieces, as in triangulated networks; else nothing is known. Expects no negative spring.
/// \param per_disc unknowns of a disc (DegreesOfFreedom)
bool grows_rigid(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs, int per_disc);

}  // namespace equidem
