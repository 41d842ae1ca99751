// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The moving picture of a run, for its page.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "equidem/assembly/assembly.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/output/run/run_loop.hpp"

namespace equidem {

/// The number of frames that a page has room for; 0 where the bodies are too many for any motion to be seen.
std::int64_t frames_of_film(std::size_t bodies);

/// Add the film to the figures of this thread (DrawnFigures), where it has two frames at least. Displacements of bonded
/// discs are enlarged where they are too small to be seen, as in write_picture.
void add_film(const std::string& title, const Assembly& assembly, std::span<const FilmFrame> frames);
/// \param colours of each grain \param started as GrainAnimation
void add_film(const GrainCase& resolved, std::span<const Wall> walls, std::span<const int> colours,
              std::span<const Grain> started, std::span<const FilmFrame> frames);

}  // namespace equidem
