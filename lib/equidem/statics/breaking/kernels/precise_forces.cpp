// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/breaking/kernels/precise_forces.hpp"

#include <algorithm>

#include "equidem/statics/breaking/kernels/twofold.hpp"

#define EQUIDEM_INLINE inline __attribute__((always_inline))

namespace equidem {
namespace {

using Lanes = double __attribute__((vector_size(32)));
constexpr std::size_t width = 4;

/// Gathers a number of each of `width` contacts.
template <typename Number>
struct Gathered {
  const BreakingContact* contacts;

  template <typename Get>
  EQUIDEM_INLINE Number of(const Get& get) const {
    if constexpr (sizeof(Number) == sizeof(double)) {
      return get(contacts[0]);
    } else {
      return Number{get(contacts[0]), get(contacts[1]), get(contacts[2]), get(contacts[3])};
    }
  }
  EQUIDEM_INLINE Twofold<Number> motion(const PreciseColumn& of_all, int block, int component,
                                        std::int32_t BreakingContact::*disc) const {
    const auto at = [&](const BreakingContact& c) {
      return static_cast<std::size_t>(c.*disc) * static_cast<std::size_t>(block) + static_cast<std::size_t>(component);
    };
    const Number high = of([&](const BreakingContact& c) { return of_all.high[at(c)]; });
    if (of_all.low == nullptr) return {high, Number{}};
    return {high, of([&](const BreakingContact& c) { return of_all.low[at(c)]; })};
  }
};

template <typename Number>
EQUIDEM_INLINE DeformationOf<Twofold<Number>> deformation_of(const BreakingContact* contacts, int block,
                                                             const Twofold<double>& per_scale,
                                                             const PreciseColumn& motion) {
  const Gathered<Number> g{contacts};
  const auto moved = [&](int component, std::int32_t BreakingContact::*disc) {
    return g.motion(motion, block, component, disc);
  };
  const Twofold<Number> x = moved(0, &BreakingContact::j) - moved(0, &BreakingContact::i);
  const Twofold<Number> y = moved(1, &BreakingContact::j) - moved(1, &BreakingContact::i);
  const Number nx = g.of([](const BreakingContact& c) { return c.normal.x; });
  const Number ny = g.of([](const BreakingContact& c) { return c.normal.y; });
  DeformationOf<Twofold<Number>> d{x * nx + y * ny, y * nx - x * ny};
  if (block == 3) {
    const Twofold<Number> scale{per_scale.high + Number{}, per_scale.low + Number{}};
    const auto turned = [&](std::int32_t BreakingContact::*disc, double BreakingContact::*lever) {
      return moved(2, disc) * scale * g.of([&](const BreakingContact& c) { return c.*lever; });
    };
    d.tangential = d.tangential - (turned(&BreakingContact::i, &BreakingContact::lever_i) +
                                   turned(&BreakingContact::j, &BreakingContact::lever_j));
  }
  return d;
}

/// The stretch by rotations of a contact whose point lies beside the line of centres.
Twofold<double> opened_by(const ContactOffsets& offsets, const BreakingContact& contact, const MotionLayout& layout,
                          const Twofold<double>& per_scale, const PreciseColumn& motion) {
  if (layout.block != 3) return {};
  const Gathered<double> g{&contact};
  return g.motion(motion, 3, 2, &BreakingContact::i) * per_scale * offsets.i +
         g.motion(motion, 3, 2, &BreakingContact::j) * per_scale * offsets.j;
}

EQUIDEM_INLINE void keep(const BreakingContact& c, const DeformationOf<Twofold<double>>& d, ContactForce& force,
                         ForceRemainder& remainder) {
  const Twofold<double> normal = d.normal * c.springs.kN, tangential = d.tangential * c.springs.kT;
  force = {normal.high, tangential.high};
  remainder = {static_cast<float>(normal.low), static_cast<float>(tangential.low)};
}

EQUIDEM_INLINE void evaluate_all(std::span<const BreakingContact> contacts, std::span<const ContactOffsets> offsets,
                                 const MotionLayout& layout, const PreciseColumn& motion,
                                 std::span<const ContactDeformation> affine, std::span<ContactForce> forces,
                                 std::span<ForceRemainder> remainders) {
  const Twofold<double> per_scale = inverse(layout.rotation_scale);
  const auto keep_of = [&](std::size_t k, DeformationOf<Twofold<double>> d) {
    const BreakingContact& c = contacts[k];
    if (!offsets.empty()) d.normal = d.normal + opened_by(offsets[k], c, layout, per_scale, motion);
    if (!affine.empty()) {
      d.normal = d.normal + Twofold<double>{affine[k].normal, 0};
      d.tangential = d.tangential + Twofold<double>{affine[k].tangential, 0};
    }
    keep(c, d, forces[k], remainders[k]);
  };
  std::size_t k = 0;
  for (; k + width <= contacts.size(); k += width) {
    const DeformationOf<Twofold<Lanes>> d = deformation_of<Lanes>(&contacts[k], layout.block, per_scale, motion);
    for (std::size_t e = 0; e < width; ++e)
      keep_of(k + e, {{d.normal.high[e], d.normal.low[e]}, {d.tangential.high[e], d.tangential.low[e]}});
  }
  for (; k < contacts.size(); ++k) keep_of(k, deformation_of<double>(&contacts[k], layout.block, per_scale, motion));
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void evaluate_wide(std::span<const BreakingContact> contacts,
                                                   std::span<const ContactOffsets> offsets, const MotionLayout& layout,
                                                   const PreciseColumn& motion,
                                                   std::span<const ContactDeformation> affine,
                                                   std::span<ContactForce> forces,
                                                   std::span<ForceRemainder> remainders) {
  evaluate_all(contacts, offsets, layout, motion, affine, forces, remainders);
}
#endif

}  // namespace

ContactDeformation opening_of(const BreakingContact& contact, const ContactOffsets& offsets, const MotionLayout& layout,
                              const PreciseColumn& motion) {
  const Twofold<double> per_scale = inverse(layout.rotation_scale);
  const auto d = deformation_of<double>(&contact, layout.block, per_scale, motion);
  return {(d.normal + opened_by(offsets, contact, layout, per_scale, motion)).high, d.tangential.high};
}

void evaluate_forces(std::span<const BreakingContact> contacts, std::span<const ContactOffsets> offsets,
                     const MotionLayout& layout, const PreciseColumn& motion,
                     std::span<const ContactDeformation> affine, std::span<ContactForce> forces,
                     std::span<ForceRemainder> remainders) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2"))
    return evaluate_wide(contacts, offsets, layout, motion, affine, forces, remainders);
#endif
  evaluate_all(contacts, offsets, layout, motion, affine, forces, remainders);
}

}  // namespace equidem
