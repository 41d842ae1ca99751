// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/break_search.hpp"

#include <vector>

#include "equidem/core/threads.hpp"

namespace equidem {

std::optional<NextBreak> next_break_of(const FirstToBreak& first, const LoadFactorSearch& search) {
  if (first.contact < 0) return {};
  return NextBreak{search.from + search.direction * first.moment.t, static_cast<std::size_t>(first.contact),
                   first.moment.in_shear ? BreakMode::shear : BreakMode::tension, first.ties, first.gap};
}

std::optional<NextBreak> next_break(std::span<const ContactForce> pattern, std::span<const ContactForce> dead,
                                    const ContactStrengths& strengths, const LoadFactorSearch& search) {
  std::vector<BreakingMoment> moments(pattern.size());
  parallel_ranges(moments.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const ProportionalForce force{dead.empty() ? ContactForce{} : dead[c], pattern[c]};
      moments[c] = breaking_moment(force, {strengths.tension[c], strengths.shear[c]}, strengths.friction, search);
    }
  });
  const auto first = FirstToBreak::among(
      moments.size(), [&](std::size_t c) { return moments[c]; },
      [](std::size_t c) { return static_cast<std::int64_t>(c); }, search);
  return next_break_of(first, search);
}

}  // namespace equidem
