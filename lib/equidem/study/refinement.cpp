// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/refinement.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/study/order.hpp"

namespace equidem {
namespace {

using Values = std::vector<double>;

constexpr double order_off = 0.3;  // beyond, errors are not yet, or no longer, those of theory
constexpr double rounding = 1e-13;

double largest_difference(const Values& a, const Values& b) {
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

class Levels {
 public:
  Levels(const std::function<Values(std::int64_t)>& evaluate, const RefinementOptions& options)
      : evaluate_(evaluate), options_(options), distance_(options.distance) {
    if (!distance_) distance_ = largest_difference;
  }

  [[nodiscard]] std::int64_t admissible(double n) const {
    const auto whole = std::max(options_.first, static_cast<std::int64_t>(std::ceil(std::min(n, 1e15))));
    return options_.admissible ? options_.admissible(whole) : whole;
  }

  void compute(std::int64_t n) {
    if (values_.contains(n)) return;
    values_[n] = evaluate_(n);
    tried_.push_back(n);
  }

  /// How three levels differ by n, as a power of it.
  [[nodiscard]] double observed_order() const {
    const auto [fine, middle, coarse] = last_three();
    const double first = distance_(coarse->second, middle->second), second = distance_(middle->second, fine->second);
    if (second <= rounding && first <= rounding) return options_.order;
    const std::array h{1.0 / static_cast<double>(coarse->first), 1.0 / static_cast<double>(middle->first),
                       1.0 / static_cast<double>(fine->first)};
    const std::array along{first + second, second, 0.0};
    return order_of_three(h, along).value_or(0);
  }

  /// The limit by the two finest of the three, and how far it moved from that of the two before.
  void extrapolate() {
    const auto [fine, middle, coarse] = last_three();
    limit_ = limit_of(*middle, *fine);
    const Values before = limit_of(*coarse, *middle);
    // The next term of the series falls one order faster.
    const double ratio = static_cast<double>(fine->first) / static_cast<double>(middle->first);
    doubt_ = distance_(before, limit_) / (std::pow(ratio, options_.order + 1) - 1);
  }

  [[nodiscard]] double error(std::int64_t n) const { return distance_(values_.at(n), limit_) + doubt_; }

  /// The coarsest level that should do: one that was computed, or one as far below or above its neighbours as the order says.
  [[nodiscard]] std::int64_t wanted(double accuracy) const {
    const auto above = [&](auto level) { return error(level->first) > accuracy; };
    auto level = values_.begin();
    while (level != values_.end() && above(level)) ++level;
    if (level == values_.begin()) return level->first;
    const auto coarse = std::prev(level);
    const double n =
        static_cast<double>(coarse->first) *
        std::pow((error(coarse->first) - doubt_) / std::max(accuracy - doubt_, accuracy / 10), 1 / options_.order);
    const std::int64_t between = std::max(admissible(n), admissible(static_cast<double>(coarse->first) + 1));
    if (level != values_.end()) return std::min(between, level->first);
    // Where the limit is not known well enough, the next level is there to tell it.
    return doubt_ > accuracy / 3 ? std::min(between, admissible(2.0 * static_cast<double>(coarse->first))) : between;
  }

  [[nodiscard]] const std::map<std::int64_t, Values>& values() const { return values_; }
  [[nodiscard]] const std::vector<std::int64_t>& tried() const { return tried_; }

 private:
  using Level = std::map<std::int64_t, Values>::const_iterator;

  /// The finest level, the finest that is well below it, and the finest well below that one: neighbours would tell rounding.
  [[nodiscard]] std::array<Level, 3> last_three() const {
    constexpr double apart = 1.4;
    std::array<Level, 3> three;
    three[0] = std::prev(values_.end());
    for (std::size_t k = 1; k < three.size(); ++k) {
      three[k] = std::prev(three[k - 1]);
      while (three[k] != values_.begin() &&
             apart * static_cast<double>(three[k]->first) > static_cast<double>(three[k - 1]->first))
        --three[k];
    }
    return three;
  }

  [[nodiscard]] Values limit_of(const std::pair<const std::int64_t, Values>& coarse,
                                const std::pair<const std::int64_t, Values>& fine) const {
    Values limit(fine.second.size());
    for (std::size_t k = 0; k < limit.size(); ++k) {
      limit[k] = richardson_limit(1.0 / static_cast<double>(coarse.first), coarse.second[k],
                                  1.0 / static_cast<double>(fine.first), fine.second[k], options_.order);
    }
    return limit;
  }

  const std::function<Values(std::int64_t)>& evaluate_;
  const RefinementOptions& options_;
  std::function<double(const Values&, const Values&)> distance_;
  std::map<std::int64_t, Values> values_;
  std::vector<std::int64_t> tried_;
  Values limit_;
  double doubt_ = 0;
};

}  // namespace

std::int64_t Refinement::level_for(double accuracy) const {
  const double n = static_cast<double>(level) * std::pow(estimated / accuracy, 1 / theory);
  return static_cast<std::int64_t>(std::ceil(std::clamp(n, 1.0, 1e15)));
}

Refinement refine_to(const std::function<Values(std::int64_t)>& evaluate, const RefinementOptions& options) {
  assert(options.accuracy > 0 && options.order > 0 && options.first >= 1);
  Levels levels(evaluate, options);
  const auto go_on = [&](std::int64_t n, const std::string& why) {
    if (n > options.most) {
      computation_failed(format("an accuracy of {:.3g} cannot be reached", options.accuracy), why,
                         "Ask for less, or compute finer levels one by one");
    }
    levels.compute(n);
  };
  std::int64_t n = options.first;
  for (int k = 0; k < 3; ++k) {
    go_on(n,
          format("three levels are needed to tell how errors fall, and the finest that is tried is {}", options.most));
    n = levels.admissible(2.0 * static_cast<double>(n));
  }
  double order = levels.observed_order();
  while (std::abs(order - options.order) > order_off) {
    go_on(n, format("its errors fall as level^-{:.2g} up to level {} and not as level^-{:g}: the distance from the "
                    "limit is not known",
                    order, levels.values().rbegin()->first, options.order));
    order = levels.observed_order();
    n = levels.admissible(2.0 * static_cast<double>(n));
  }
  levels.extrapolate();
  constexpr double aim = 0.97;
  for (;;) {
    n = levels.wanted(aim * options.accuracy);
    if (!levels.values().contains(n)) {
      const std::int64_t finest = levels.values().rbegin()->first;
      const double best = levels.error(finest) *
                          std::pow(static_cast<double>(finest) / static_cast<double>(options.most), options.order);
      go_on(n, format("it takes level {}, and the finest that is tried is {}, which reaches about {:.2g}", n,
                      options.most, best));
      levels.extrapolate();
    }
    if (levels.error(n) <= options.accuracy) break;
  }
  return {.level = n,
          .values = levels.values().at(n),
          .estimated = levels.error(n),
          .order = order,
          .theory = options.order,
          .levels = levels.tried()};
}

}  // namespace equidem
