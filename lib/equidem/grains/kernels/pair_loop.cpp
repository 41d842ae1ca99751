// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/contact/laws/visit.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/lane_sums.hpp"
#include "equidem/grains/kernels/pair_lanes.hpp"
#include "equidem/grains/kernels/slide_lanes.hpp"
#include "equidem/grains/kernels/touch_lanes.hpp"
#include "equidem/grains/kernels/vector_width.hpp"

namespace equidem {
namespace {

using namespace eight;

constexpr Lanes all_one = {1, 1, 1, 1, 1, 1, 1, 1};
/// So many go through each part of the work before the next begins: a processor sees several of them at a time, and
/// does not wait for the roots and quotients of one.
constexpr std::size_t groups_at_once = 8;

/// Compile-time properties of a loop.
struct PairLoopKind {
  bool friction = false;
  bool equal = false;   ///< one law for all pairs, where the dashpot rests while contacts slide
  bool verlet = false;  ///< friction by the explicit step, else by the midpoint rule
  bool rigid = false;   ///< friction without springs
};

struct LoopNumbers {
  LawLanes law;  ///< where equal; made once, as compilers make eight instructions of each
  double dt = 0;
  std::int64_t now = 0;  ///< step before the one being made
  bool corrected = false;
  bool record = false;
  const GrainSystem* system = nullptr;
  BlockSums* block = nullptr;
};

template <PairLoopKind kind>
EQUIDEM_ALWAYS_INLINE LawLanes law_of(const LoopNumbers& numbers, const PairLaws* laws) {
  if constexpr (kind.equal) {
    return numbers.law;
  } else {
    const Lanes spring = load(laws->tangential_stiffness);
    return {load(laws->stiffness),  load(laws->least),
            load(laws->friction),   spring,
            load(laws->beyond_cap), 1 / (spring > 0 ? spring : all(1))};
  }
}

/// Relative positions and velocities of eight pairs: from i to j, along the normal and across it.
struct Geometry {
  Lanes square, distance, share, overlap, nx, ny, closing;
  Lanes inverse, along, rims;  ///< Verlet schemes; 1/distance
  /// With half of what the last step did; of the slip all but the rims.
  Lanes middle_closing, middle_slip, middle_rims;
};

/// Results of the contacts of a group.
struct Outcome {
  Lanes px, py, rim;  ///< impulse on j
  Lanes normal_loss, slip_loss, dashpot_loss, release;
  bool any;
};

template <PairLoopKind kind>
EQUIDEM_ALWAYS_INLINE void measure(const PairBody* bodies, const PairGroup& group, Geometry& found) {
  // differences j - i, sums of the speeds of the rims
  constexpr long long minus = std::numeric_limits<long long>::min();
  const Choice difference = {minus, minus, minus, minus, 0, minus, minus, 0};
  Lanes m[8];
  for (int k = 0; k < 8; ++k) {
    const Lanes i = load(&bodies[group.i[k]].position.x);
    const Lanes j = load(&bodies[group.j[k]].position.x);
    m[k] = j + reinterpret_cast<Lanes>(reinterpret_cast<Choice>(i) ^ difference);
  }
  transpose(m);
  const Lanes &bx = m[0], &by = m[1], &u = m[2], &v = m[3];
  const Lanes square = bx * bx + by * by;
  const Lanes distance = square_root(square);
  const Choice distinct = square > 0;
  const Lanes reach = load(group.reach);
  const Lanes quotient = 1 / (distinct ? distance * reach : all_one);
  const Lanes inverse = reach * quotient;
  const Lanes nx = distinct ? bx * inverse : all_one, ny = distinct ? by * inverse : Lanes{};
  found.square = square;
  found.distance = distance;
  if constexpr (kind.verlet) found.inverse = inverse;
  if constexpr (kind.friction) found.share = square * quotient;
  found.overlap = reach - distance;
  found.nx = nx;
  found.ny = ny;
  found.closing = -(u * nx + v * ny);
  if constexpr (kind.verlet) {
    found.along = v * nx - u * ny;
    if constexpr (kind.friction) found.rims = m[4];
  } else {
    found.middle_closing = -(m[5] * nx + m[6] * ny);
  }
  if constexpr (kind.friction && (kind.rigid || !kind.verlet)) {
    found.middle_slip = m[6] * nx - m[5] * ny;
    found.middle_rims = m[7];
  }
}

template <class Law, PairLoopKind kind>
EQUIDEM_ALWAYS_INLINE void respond(const LoopNumbers& numbers, const Geometry& geometry, PairGroup& group,
                                   PairSlips* slips, const PairLaws* laws, PairRecords* records, LaneSums& sums,
                                   Outcome& outcome) {
  const double dt = numbers.dt;
  const Lanes &square = geometry.square, &inverse = geometry.inverse, &overlap = geometry.overlap, &nx = geometry.nx,
              &ny = geometry.ny, &closing = geometry.closing;
  Choice since;
  std::memcpy(&since, group.since, sizeof since);
  const Lanes zero{};
  const Choice touch = negative(zero - overlap) & ~negative(since - PairGroup::apart);
  const Choice alive = ~negative(since - (PairGroup::apart + 1));
  const Choice begun = touch & ~alive, ended = alive & ~touch;
  const long long which = bits_of_all((touch & 1) | ((touch ^ alive) & 2));
  const bool changes = (which & 2) != 0;
  if (changes) {
    since = choose(begun, Choice{} + numbers.now,
                   choose(ended, Choice{} + static_cast<long long>(PairGroup::apart), since));
    std::memcpy(group.since, &since, sizeof since);
    sums.begun -= begun;
  } else if (which == 0) {
    outcome.any = false;
    return;
  }
  outcome.any = true;
  sums.evaluations -= touch;

  const LawLanes law = law_of<kind>(numbers, laws);
  const Lanes dashpot = load(group.dashpot);
  const Lanes deep = only(touch, overlap);
  const Lanes elastic = Law::spring(law.stiffness, deep), drag = Law::dashpot(dashpot, deep) * closing;
  const Lanes force = only(touch, larger(elastic + drag, law.least));
  const Lanes impulse = force * dt;
  const Lanes mass = load(group.mass), impulse_before = load(group.impulse);
  store(impulse, group.impulse);
  Lanes mean_closing, deep_before, elastic_before, normal_loss;
  if constexpr (kind.verlet) {
    // over the drift, in which the normal turns; the dashpot gives half of the kicks before and after it each
    mean_closing = closing + (0.5 * dt) * inverse * geometry.along * geometry.along;
    deep_before = larger(overlap - mean_closing * dt, zero);
    elastic_before = Law::spring(law.stiffness, deep_before);
    normal_loss =
        only(touch & alive, 0.5 * mean_closing * ((impulse_before - elastic_before * dt) + (force - elastic) * dt));
  } else {
    // of the mean over the step the part of this contact is known, not only that of the last step
    mean_closing = 0.5 * mass * (impulse_before - impulse) + geometry.middle_closing;
    normal_loss = only(touch, (force - elastic) * mean_closing * dt);
  }
  sums.deepest = larger(deep, sums.deepest);
  Lanes slip{}, tangential_kick{}, sticking_dashpot{}, kept{};
  Choice slides{};
  Lanes px = impulse * nx, py = impulse * ny;
  if constexpr (kind.friction) {
    Lanes stretch{}, slip_dashpot{};
    if constexpr (!kind.rigid) {
      stretch = load(slips->stretch);
      slip_dashpot = load(slips->dashpot);
    }
    const Lanes impulse_along_before = load(slips->impulse);
    const Lanes& share = geometry.share;
    Lanes velocity, mean_slip{}, half{};
    if constexpr (kind.rigid || !kind.verlet) {
      half = 0.5 * (mass + load(slips->turning) * square);
      // without this contact's own part in it
      velocity = geometry.middle_slip - share * geometry.middle_rims - half * impulse_along_before;
    }
    if constexpr (kind.verlet) {
      const Lanes rims = share * geometry.rims;
      const Lanes now = geometry.along - rims;
      velocity = kind.rigid ? 2 * velocity - now : now;
      mean_slip = now - ((0.5 * dt) * closing * inverse) * (geometry.along + rims);
      if (!kind.rigid && changes && numbers.corrected) [[unlikely]] {
        const Lanes way = mean_closing * dt;
        const Lanes before_touch = only(begun & negative(overlap - way), 1 - overlap / way);
        stretch -= before_touch * velocity * dt;
      }
    }
    const Lanes yield = law.friction * larger(force, zero);
    Tangent tangent;
    if constexpr (kind.rigid) {
      tangent = slide_without_spring<kind.verlet>(law, velocity, mean_slip, dt * half, impulse_along_before, yield, dt);
    } else {
      tangent = slide<kind.verlet, kind.equal>(law, slip_dashpot, stretch, velocity, mean_slip, dt * half,
                                               impulse_along_before, yield, dt);
    }
    const Lanes tangential = only(touch, -dt * tangent.force);
    if constexpr (!kind.rigid) store(only(touch, tangent.stretch), slips->stretch);
    store(tangential, slips->impulse);
    Choice lasting = touch;
    Lanes release{};
    if constexpr (kind.verlet) {
      lasting = touch & alive;
      slip = mean_slip;
      slides = tangent.slides;
      tangential_kick = choose(begun, tangential, impulse_along_before);
      sticking_dashpot = only(begun & ~slides, -dt * slip_dashpot * velocity);
      kept = choose(begun, tangent.stretch, stretch);
    } else {
      release = only(ended, 0.5 * law.tangential_stiffness * stretch * stretch);
    }
    outcome.slip_loss = only(lasting, tangent.slip_loss);
    outcome.dashpot_loss = only(lasting, tangent.dashpot_loss);
    outcome.release = release;
    px -= tangential * ny;
    py += tangential * nx;
    outcome.rim = share * tangential;
  }
  outcome.normal_loss = normal_loss;
  outcome.px = px;
  outcome.py = py;
  if constexpr (kind.verlet) {
    if (changes) [[unlikely]] {
      Lanes lever;
      for (int k = 0; k < 8; ++k)
        lever[k] = numbers.system->bodies.constants[static_cast<std::size_t>(group.i[k])].radius;
      lever = lever / load(group.reach) * geometry.distance;
      const Lanes other = lever - geometry.distance;
      count_instants(*numbers.system,
                     {begun,
                      ended,
                      slides,
                      group.i,
                      group.j,
                      nx,
                      ny,
                      lever * nx,
                      lever * ny,
                      other * nx,
                      other * ny,
                      mean_closing,
                      slip,
                      choose(begun, deep, deep_before),
                      choose(begun, elastic, elastic_before) * dt,
                      choose(begun, impulse, impulse_before),
                      dashpot,
                      mass,
                      law.least,
                      tangential_kick,
                      sticking_dashpot,
                      0.5 * law.tangential_stiffness * kept * kept},
                     *numbers.block);
    }
  }
  if (numbers.record) {
    store(overlap, records->overlap);
    store(closing, records->closing);
    store(nx, records->normal_x);
    store(ny, records->normal_y);
  }
}

/// Where the impulses of a group go.
struct Receivers {
  BodyImpulse* impulses = nullptr;
  BodyImpulse* outward = nullptr;  ///< next place for a body behind the block
  std::int32_t end = 0;            ///< of the bodies of the block
};

/// \tparam outward some bodies are behind the block
template <PairLoopKind kind, bool outward>
EQUIDEM_ALWAYS_INLINE void give(const PairGroup& group, const Outcome& outcome, Receivers& to, LaneSums& sums) {
  constexpr long long minus = std::numeric_limits<long long>::min();
  if (!outcome.any) {
    for (int k = 0; outward && k < 8; ++k) {
      if (group.j[k] >= to.end) *to.outward++ = {};
    }
    return;
  }
  Half row[8];
  if constexpr (kind.friction) {
    rows_of(outcome.normal_loss, outcome.slip_loss, outcome.dashpot_loss, outcome.release, row);
    for (const Half& lost : row) sums.lost += lost;
    rows_of(outcome.px, outcome.py, Lanes{}, outcome.rim, row);
  } else {
    for (int k = 0; k < 8; ++k) sums.lost[0] += outcome.normal_loss[k];
    rows_of(outcome.px, outcome.py, Lanes{}, Lanes{}, row);
  }
  // of both bodies the rim is pushed the same way round, and its lever is the radius
  const HalfChoice turned = {0, 0, 0, minus};
  for (int k = 0; k < 8; ++k) {
    subtract(&to.impulses[group.i[k]], row[k]);
    if constexpr (kind.friction) row[k] = reinterpret_cast<Half>(reinterpret_cast<HalfChoice>(row[k]) ^ turned);
    if (outward && group.j[k] >= to.end) {
      put(row[k], to.outward++);
    } else {
      add(&to.impulses[group.j[k]], row[k]);
    }
  }
}

template <class Law, PairLoopKind kind>
struct CollidePairs {
  EQUIDEM_ALWAYS_INLINE static void run(GrainSystem& system, std::size_t b);
};

template <class Law, PairLoopKind kind>
void CollidePairs<Law, kind>::run(GrainSystem& system, std::size_t b) {
  const NearPairs& near = system.contacts.near;
  PairBlock& block = system.contacts.near.blocks[b];
  const bool verlet = system.options.verlet();
  const PairLaw& law = near.law;
  const LoopNumbers numbers{{all(law.stiffness), all(law.least), all(law.friction), all(law.tangential_stiffness),
                             Lanes{}, all(1 / law.tangential_stiffness)},
                            system.dt(),
                            system.step - (verlet ? 1 : 0),
                            system.options.integrator == GrainOptions::Integrator::corrected_verlet,
                            near.record,
                            &system,
                            &system.bodies.sums[b]};
  block.records.resize(near.record ? block.groups.size() : 0);
  LaneSums sums;
  const PairBody* bodies = near.bodies.data();
  Receivers to{system.bodies.impulses.data(), block.outward.impulses.data(),
               static_cast<std::int32_t>(system.bodies.blocks.end(b))};
  Geometry geometry[groups_at_once];
  Outcome outcome[groups_at_once];
  const std::size_t count = block.groups.size();
  PairGroup* groups = block.groups.data();
  PairSlips* slips = block.slips.data();
  const PairLaws* laws = block.laws.data();
  PairRecords* records = block.records.data();
  for (std::size_t first = 0; first < count; first += groups_at_once) {
    const std::size_t here = std::min(groups_at_once, count - first);
    for (std::size_t g = 0; g < here; ++g) measure<kind>(bodies, groups[first + g], geometry[g]);
    for (std::size_t g = 0; g < here; ++g) {
      respond<Law, kind>(numbers, geometry[g], groups[first + g], kind.friction ? slips + (first + g) : nullptr,
                         kind.equal ? nullptr : laws + (first + g), near.record ? records + (first + g) : nullptr, sums,
                         outcome[g]);
    }
    if (first + here <= block.first_outward) {
      for (std::size_t g = 0; g < here; ++g) give<kind, false>(groups[first + g], outcome[g], to, sums);
    } else {
      for (std::size_t g = 0; g < here; ++g) give<kind, true>(groups[first + g], outcome[g], to, sums);
    }
  }
  add(sums, *numbers.block);
}

template <class Law, PairLoopKind kind>
NearPairs::Loop choose_pair_loop() {
  return by_vector_width<CollidePairs<Law, kind>, GrainSystem&, std::size_t>();
}

template <class Law, bool equal>
NearPairs::Loop choose_pair_loop(const GrainSystem& system) {
  if (system.contacts.near.rigid) {
    return system.options.verlet() ? choose_pair_loop<Law, PairLoopKind{true, equal, true, true}>()
                                   : choose_pair_loop<Law, PairLoopKind{true, equal, false, true}>();
  }
  if (system.options.verlet()) {
    return system.friction ? choose_pair_loop<Law, PairLoopKind{true, equal, true}>()
                           : choose_pair_loop<Law, PairLoopKind{false, equal, true}>();
  }
  return system.friction ? choose_pair_loop<Law, PairLoopKind{true, equal, false}>()
                         : choose_pair_loop<Law, PairLoopKind{false, equal, false}>();
}

}  // namespace

NearPairs::Loop near_pair_loop(const GrainSystem& system) {
  return visit_law(system.options.law, [&]<class Law>(std::type_identity<Law>) -> NearPairs::Loop {
    if constexpr (Law::kind == LawKind::force) {
      return system.contacts.near.equal ? choose_pair_loop<Law, true>(system) : choose_pair_loop<Law, false>(system);
    } else {
      return nullptr;
    }
  });
}

}  // namespace equidem
