// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/kernels/step_kernel.hpp"

#include <array>
#include <cstddef>
#include <utility>

#include "equidem/dynamics/kernels/motion_step.hpp"

namespace equidem {
namespace {

constexpr std::size_t without_bending = 3 * 2 * 5, kinds = 2 * (without_bending + 4);

/// The kinds in one row: motion, then springs, equal contacts, and resistance, equal discs without a resistance; behind
/// them those of bending springs.
constexpr LoopKind kind_of(std::size_t number) {
  LoopKind kind;
  kind.motion = static_cast<LoopKind::Motion>(number / (kinds / 2));
  const std::size_t index = number % (kinds / 2);
  if (index >= without_bending) {
    kind.springs = LoopKind::Springs::rotation;
    kind.bending = true;
    kind.equal_contacts = kind.equal_discs = false;
    kind.resistance = static_cast<LoopKind::Resistance>(index - without_bending);
    return kind;
  }
  kind.equal_discs = index % 5 == 4;
  kind.resistance = kind.equal_discs ? LoopKind::Resistance::none : static_cast<LoopKind::Resistance>(index % 5);
  kind.equal_contacts = index / 5 % 2 == 1;
  kind.springs = static_cast<LoopKind::Springs>(index / 10);
  return kind;
}

template <LoopKind kind>
EQUIDEM_ALWAYS_INLINE void step(const LoopData& data, const Stage& stage, int parity, std::int32_t begin,
                                std::int32_t end, Dissipation& dissipation) {
  if constexpr (kind.motion == LoopKind::Motion::finite) {
    lanes::finite_motion_step<kind>(data, stage, parity, begin, end, dissipation);
  } else {
    lanes::small_motion_step<kind>(data, stage, parity, begin, end, dissipation);
  }
}

template <std::size_t Index>
void step_plain(const LoopData& data, const Stage& stage, int parity, std::int32_t begin, std::int32_t end,
                Dissipation& dissipation) {
  step<kind_of(Index)>(data, stage, parity, begin, end, dissipation);
}

#if defined(__x86_64__)
template <std::size_t Index>
__attribute__((target("avx2,fma"))) void step_wide(const LoopData& data, const Stage& stage, int parity,
                                                   std::int32_t begin, std::int32_t end, Dissipation& dissipation) {
  step<kind_of(Index)>(data, stage, parity, begin, end, dissipation);
}

/// The same vectors, and twice as many registers, which loops for finite motions have use for.
template <std::size_t Index>
__attribute__((target("avx2,fma,avx512f,avx512vl,avx512dq"))) void step_with_32_registers(
    const LoopData& data, const Stage& stage, int parity, std::int32_t begin, std::int32_t end,
    Dissipation& dissipation) {
  step<kind_of(Index)>(data, stage, parity, begin, end, dissipation);
}
#endif

template <std::size_t... Index>
constexpr std::array<StepFunction, kinds> plain_steps(std::index_sequence<Index...>) {
  return {&step_plain<Index>...};
}

#if defined(__x86_64__)
template <std::size_t... Index>
constexpr std::array<StepFunction, kinds> wide_steps(std::index_sequence<Index...>) {
  return {&step_wide<Index>...};
}

template <std::size_t... Index>
constexpr std::array<StepFunction, kinds / 2> finite_steps(std::index_sequence<Index...>) {
  return {&step_with_32_registers<kinds / 2 + Index>...};
}
#endif

}  // namespace

StepFunction step_function(const LoopKind& kind) {
  std::size_t index = 0;
  while (!(kind_of(index) == kind)) ++index;
  constexpr auto all = std::make_index_sequence<kinds>{};
#if defined(__x86_64__)
  static constexpr auto wide = wide_steps(all);
  static constexpr auto finite = finite_steps(std::make_index_sequence<kinds / 2>{});
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    const bool registers =
        __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
    return registers && kind.motion == LoopKind::Motion::finite ? finite[index - kinds / 2] : wide[index];
  }
#endif
  static constexpr auto plain = plain_steps(all);
  return plain[index];
}

}  // namespace equidem
