// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Paths of networks with unbonded contacts, with all that they refer to.
#pragma once

#include <memory>
#include <utility>

#include "equidem/breakage/unbonded/unbonded_run.hpp"

#include "breakage/scenes.hpp"

namespace equidem::test {

/// A run that owns its scene.
class Unbonded {
 public:
  Unbonded(Assembly assembly, ContactSprings springs, ContactStrengths strengths, LoadPathOptions options,
           UnbondedOptions unbonded, Rotation rotation = Rotation::from_scene)
      : assembly_(std::move(assembly)),
        springs_(std::move(springs)),
        strengths_(std::move(strengths)),
        effects_(derive_effects(assembly_, springs_, rotation)),
        options_(std::move(options)),
        path_(make_load_path(assembly_, springs_, effects_, options_)),
        run_(std::make_unique<UnbondedRun>(BreakageScene{assembly_, springs_, strengths_, path_}, effects_,
                                           options_.supports, std::move(unbonded))) {}
  /// No contact is a bond.
  Unbonded(const Assembly& assembly, ContactSprings springs, LoadPathOptions options, double friction)
      : Unbonded(assembly, std::move(springs), equal_strengths(assembly, 0, 0), std::move(options), {friction, {}}) {}

  UnbondedRun& run() { return *run_; }
  const std::vector<BreakEvent>& events() const { return run_->events(); }
  const BreakEvent& event(std::size_t k) const { return run_->events().at(k); }
  const Assembly& assembly() const { return assembly_; }
  const ContactSprings& springs() const { return springs_; }
  const ContactStrengths& strengths() const { return strengths_; }
  const Effects& effects() const { return effects_; }
  const LoadPath& path() const { return path_; }

  Unbonded& all() {
    while (run_->advance()) {
    }
    return *this;
  }

 private:
  Assembly assembly_;
  ContactSprings springs_;
  ContactStrengths strengths_;
  Effects effects_;
  LoadPathOptions options_;
  LoadPath path_;
  std::unique_ptr<UnbondedRun> run_;
};

}  // namespace equidem::test
