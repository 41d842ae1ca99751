// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Paths of breakage with all that they refer to.
#pragma once

#include <memory>
#include <utility>

#include "equidem/breakage/breakage_run.hpp"
#include "equidem/contact/effects.hpp"

namespace equidem::test {

using Factor = BreakableSystem::Factor;

/// Everything that a run refers to.
class OwnedScene {
 public:
  OwnedScene(Assembly assembly, ContactSprings springs, ContactStrengths strengths, const LoadPathOptions& options,
             Rotation rotation)
      : assembly_(std::move(assembly)),
        springs_(std::move(springs)),
        strengths_(std::move(strengths)),
        effects_(derive_effects(assembly_, springs_, rotation)),
        path_(make_load_path(assembly_, springs_, effects_, options)),
        supports_(options.supports) {}

  const Assembly& assembly() const { return assembly_; }
  const ContactSprings& springs() const { return springs_; }
  const ContactStrengths& strengths() const { return strengths_; }
  const Effects& effects() const { return effects_; }
  const LoadPath& path() const { return path_; }
  const std::vector<Support>& supports() const { return supports_; }
  BreakageScene scene() const { return {assembly_, springs_, strengths_, path_}; }

 private:
  Assembly assembly_;
  ContactSprings springs_;
  ContactStrengths strengths_;
  Effects effects_;
  LoadPath path_;
  std::vector<Support> supports_;
};

/// A run that owns its scene.
class Broken : public OwnedScene {
 public:
  Broken(Assembly assembly, ContactSprings springs, ContactStrengths strengths, const LoadPathOptions& options,
         Rotation rotation = Rotation::from_scene, Factor factor = Factor::updated)
      : OwnedScene(std::move(assembly), std::move(springs), std::move(strengths), options, rotation), factor_(factor) {
    begin();
  }

  /// Anew, unbroken.
  void begin() {
    run_.reset();
    system_ = std::make_unique<BreakableSystem>(breakable_network(scene(), effects(), supports()), factor_);
    run_ = std::make_unique<BreakageRun>(scene(), *system_);
  }

  BreakageRun& run() { return *run_; }
  BreakableSystem& system() { return *system_; }
  const std::vector<BreakEvent>& events() const { return run_->events(); }
  const BreakEvent& event(std::size_t k) const { return run_->events().at(k); }

  Broken& all() {
    while (run_->advance()) {
    }
    return *this;
  }

 private:
  Factor factor_;
  std::unique_ptr<BreakableSystem> system_;
  std::unique_ptr<BreakageRun> run_;
};

/// Equal strengths of all contacts.
inline ContactStrengths equal_strengths(const Assembly& assembly, double tension, double shear, double friction = 0) {
  ContactStrengths strengths;
  strengths.tension.assign(assembly.contacts.size(), tension);
  strengths.shear.assign(assembly.contacts.size(), shear);
  strengths.friction = friction;
  return strengths;
}

}  // namespace equidem::test
