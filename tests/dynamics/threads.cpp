// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The same bits for every number of threads, however steps are cut, and after a state was saved and restored.

#include "dynamics/moving_scenes.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

bool same_bits(const Simulation& a, const Simulation& b) {
  const SavedState s = a.save(), t = b.save();
  return s == t && a.energy().error() == b.energy().error();
}

struct Given {
  std::string name;
  Assembly assembly;
  SimulationOptions options;
  Vec2 gravity = {};
};

/// Springs, gravity, loads, a moving support and a wall; enough strips for threads to meet.
class Moving {
 public:
  explicit Moving(const Given& given)
      : assembly_(given.assembly),
        springs_(SpringConstants{1, 0.4}),
        scene_(assembly_, springs_, inertia_of(assembly_.radii, 1, Body::disc)),
        options_(given.options) {
    scene_.gravity = given.gravity;
    options_.time_step = 0.2;
    options_.discs_per_thread = 1;
    if (!assembly_.periodic()) {
      TimedSupport bottom;
      bottom.group = "bottom";
      bottom.uy = always(0);
      bottom.uy->kind = Schedule::Kind::sine;
      bottom.uy->value = 0.01;
      bottom.uy->frequency = 0.05;
      scene_.supports = {bottom};
      scene_.loads = lasting({{"top", LoadKind::per_disc, {0.001, -0.002}, 0}});
    }
    start_with(scene_, random_motions(assembly_.size(), 5, 0.01, 0.01));
  }
  [[nodiscard]] Simulation start() const { return {scene_, options_}; }

 private:
  Assembly assembly_;
  ContactSprings springs_;
  Scene scene_;
  SimulationOptions options_;
};

std::vector<Given> all_kinds() {
  std::vector<Given> kinds;
  const std::vector<std::pair<std::string, Assembly>> assemblies = {{"hexagonal", hexagonal_block(30)},
                                                                    {"delaunay", delaunay_block(700, 1)},
                                                                    {"periodic", delaunay_block(700, 2, true)}};
  for (const auto& [name, assembly] : assemblies) {
    kinds.push_back({name + ", small", assembly, {}});
    kinds.push_back({name + ", finite", assembly, {.motion = LoopKind::Motion::finite, .damping = {.mass = 0.1}}});
    kinds.push_back({name + ", dashpots", assembly, {.damping = {.contact = 0.1}}, {0, -0.001}});
    kinds.push_back({name + ", local", assembly, {.damping = {.local = 0.5}}});
    kinds.push_back({name + ", fourth order", assembly, {.integrator = Integrator::fourth_order}});
    kinds.push_back({name + ", thesis", assembly, {.integrator = Integrator::thesis, .damping = {.stiffness = 0.2}}});
  }
  return kinds;
}

constexpr std::int64_t steps = 61;

}  // namespace

TEST_CASE("the_bits_of_a_run_do_not_depend_on_threads_or_on_how_it_is_cut") {
  for (const Given& given : all_kinds()) {
    const Moving moving(given);
    Simulation alone = moving.start();
    {
      const ThreadsFor one(1);
      alone.advance(steps);
    }
    CAPTURE(given.name);
    CHECK(alone.first_runaway() == -1);
    for (const int threads : {1, 2, 3, 7}) {
      const ThreadsFor here(threads);
      CAPTURE(threads);
      Simulation whole = moving.start(), cut = moving.start();
      whole.advance(steps);
      for (const std::int64_t piece : {1, 2, 25, 0, 33}) cut.advance(piece);
      CHECK(same_bits(alone, whole));
      CHECK(same_bits(alone, cut));
    }
  }
}

TEST_CASE("a_restored_run_goes_on_with_the_same_bits") {
  for (const Given& given : all_kinds()) {
    const Moving moving(given);
    Simulation whole = moving.start(), first = moving.start(), second = moving.start();
    whole.advance(steps);
    first.advance(24);
    second.advance(7);  // and is then told to forget it
    second.restore(first.save());
    CAPTURE(given.name);
    CHECK(same_bits(first, second));
    second.advance(steps - 24);
    CHECK(same_bits(whole, second));
  }
}
