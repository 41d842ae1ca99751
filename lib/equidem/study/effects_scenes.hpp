// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Scenes of the study of effects, each with an effect more than the one above it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/grains/grain_simulation.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/study/study.hpp"

namespace equidem {

/// Steps of all discs in one timing. 2500 discs make 400 steps: a cell takes its bodies back inside once.
constexpr double effects_disc_steps = 1e6;

inline std::int64_t effects_steps(std::size_t discs) {
  return static_cast<std::int64_t>(effects_disc_steps / static_cast<double>(discs));
}

/// Bytes of the loop per disc, unknowns of a disc, evaluations of a contact per disc and step.
template <class Run>
using EffectsValues = std::function<std::vector<double>(const Run&)>;

template <class Run>
EffectsValues<Run> effects_values(std::function<double(const Run&)> evaluations) {
  return [evaluations = std::move(evaluations)](const Run& run) {
    return std::vector{run.bytes_per_body(), run.effects().rotation ? 3.0 : 2.0, evaluations(run)};
  };
}

inline double evaluations_per_disc_step(const GrainSimulation& run) {
  return static_cast<double>(run.counters().evaluations) / static_cast<double>(run.step() * std::ssize(run.motions()));
}

/// A disc of the scenes of colliding bodies.
constexpr double effects_radius = 0.01, effects_density = 2480;

inline Grain effects_disc(Vec2 position) {
  return {.position = position,
          .radius = effects_radius,
          .inertia = inertia_of(effects_radius, effects_density, Body::disc)};
}

/// \param side square root of the number of discs, even
void add_bonded_effects(Study& study, int side);
void add_colliding_effects(Study& study, int side);
/// Discs pressed in a box, in a periodic cell, bonded to a rock.
void add_laboratory_effects(Study& study, int side);

}  // namespace equidem
