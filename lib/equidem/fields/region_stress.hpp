// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Mean stress of a rectangle.
#pragma once

#include <span>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/body_contact.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// Love and Weber's mean stress s = (1/A) sum of F (x) l over a rectangle of area A, tension positive, Pa: F is the
/// force on a body, l the part inside of the way from its centre to the contact. Rectangles that make up a larger one
/// add up to its stress times its area. A force is spread along its way, so that a stress that changes over the
/// rectangle is read to about the diameter of a body. Motion adds nothing to it.
/// \param bodies whose ways count
/// \param places of all bodies
Tensor2 region_stress(const Rectangle& region, std::span<const std::int32_t> bodies, std::span<const DiscMotion> places,
                      std::span<const BodyContact> contacts);

}  // namespace equidem
