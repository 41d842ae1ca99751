// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/grains/grain_step.hpp"

#include <string>

#include "equidem/core/error.hpp"

namespace equidem {
namespace {

/// The error of the library with the line of the option that it names.
Error placed(const Error& error, const GrainCase& resolved) {
  const std::string& option = error.where();
  const std::string key = option == "law"     ? "collisions.law"
                          : option == "bonds" ? resolved.document.find("bonds") != nullptr ? "bonds" : "bond"
                                              : "run." + option;
  return {error.kind(), error.problem(), error.why(), error.remedy(), resolved.where(key)};
}

}  // namespace

GrainTimeStep choose_grain_step(const GrainCase& resolved) {
  try {
    return choose_time_step(resolved.scene, resolved.contacts, resolved.options, resolved.step);
  } catch (const Error& error) {
    throw placed(error, resolved);
  }
}

std::int64_t count_steps(const GrainCase& resolved, double step) {
  try {
    return count_steps(resolved.duration, step);
  } catch (const Error& error) {
    throw error.at(resolved.where("run.duration"));
  }
}

GrainScene build_grain_scene(const GrainCase& resolved, double step) {
  GrainScene scene = resolved.scene;
  scene.pairs = pairs_at(resolved.contacts, resolved.options.law, step);
  return scene;
}

GrainOptions grain_options(const GrainCase& resolved, double step) {
  GrainOptions options = resolved.options;
  options.time_step = step;
  return options;
}

}  // namespace equidem
