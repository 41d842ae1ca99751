// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/refinement.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/study/evaluate.hpp"

namespace equidem {
namespace {

constexpr double order_off = 0.3;  // relative; beyond, errors are not yet, or no longer, those of theory
constexpr double aim = 0.95;       // of the accuracy, since what is proposed is not known yet
constexpr double least_growth = 1.05;
constexpr std::int64_t patience = 64;  // times the first level, up to which errors may fall by another order
constexpr double rounding = 1e-13;

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

double real(std::int64_t level) {
  return static_cast<double>(level);
}

}  // namespace

Refinement::Refinement(std::function<Values(std::int64_t)> pilot, RefinementOptions options)
    : pilot_(std::move(pilot)), options_(std::move(options)) {
  assert(options_.accuracy > 0 && options_.order > 0 && options_.first >= 1 && options_.apart > 1);
  if (!options_.distance) options_.distance = largest_difference;
}

std::int64_t Refinement::propose() {
  std::int64_t n = options_.first;
  for (; pilots_.size() < 3; n = admissible(std::max(options_.apart * real(n), real(n) + 1))) try_pilot(n);
  const auto finest = [&] { return values_.rbegin()->first; };
  while (std::abs(order_ / options_.order - 1) > order_off) {
    n = admissible(2 * real(finest()));
    if (n > std::min(options_.most, patience * options_.first))
      refuse(fmt::format(
          "its errors fall as {0}^-{1:.2g} up to {2} {0} and not as {0}^-{3:g}: the distance from the limit is "
          "not known",
          options_.unit, order_, finest(), options_.order));
    try_pilot(n);
  }
  for (;;) {
    n = wanted();
    if (values_.contains(n)) return n;
    const auto reached = [&](double order) { return error_at(real(options_.most), order); };
    // Even if errors fell faster than they do.
    if (reached((1 + order_off) * options_.order) > options_.accuracy) refuse_beyond(reached(options_.order));
    // Where the limit is too uncertain, the next level improves it.
    const std::int64_t next = admissible(2 * real(finest()));
    if (doubt_ <= options_.accuracy / 3 || n <= next || next > options_.most) {
      if (n > options_.most) refuse_beyond(reached(options_.order) + doubt_);
      return n;
    }
    try_pilot(next);
  }
}

bool Refinement::accepts(std::int64_t level, Values values) {
  values_[level] = std::move(values);
  find_limit();
  return error(level) <= options_.accuracy;
}

double Refinement::error(std::int64_t level) const {
  return options_.distance(values_.at(level), limit_) + doubt_;
}

std::int64_t Refinement::level_for(double accuracy, std::int64_t level) const {
  const double n = real(level) * std::pow(error(level) / accuracy, 1 / options_.order);
  return static_cast<std::int64_t>(std::ceil(std::clamp(n, 1.0, 1e15)));
}

void Refinement::refuse(const std::string& why) const {
  computation_failed(fmt::format("an accuracy of {:.3g} cannot be reached", options_.accuracy), why, "Ask for less");
}

void Refinement::refuse_beyond(double reached) const {
  refuse(fmt::format("it takes about {:.2g} {}, and the most that are tried are {}, which reach about {:.2g}",
                     real(options_.most) * std::pow(reached / options_.accuracy, 1 / options_.order), options_.unit,
                     options_.most, reached));
}

std::int64_t Refinement::admissible(double n) const {
  const auto whole = std::max(options_.first, static_cast<std::int64_t>(std::ceil(std::min(n, 1e15))));
  return options_.admissible ? options_.admissible(whole) : whole;
}

void Refinement::try_pilot(std::int64_t level) {
  if (level > options_.most)
    refuse(fmt::format(
        "an estimate of the order takes three computations, the finest of {} {}, and the most that are tried are {}",
        level, options_.unit, options_.most));
  values_[level] = pilot_(level);
  pilots_.push_back(level);
  if (values_.size() >= 3) find_limit();
}

std::array<Refinement::Level, 3> Refinement::last_three() const {
  std::array<Level, 3> three;
  three[0] = std::prev(values_.end());
  for (std::size_t k = 1; k < three.size(); ++k) {
    three[k] = std::prev(three[k - 1]);
    // neighbours would measure rounding
    while (three[k] != values_.begin() && 0.99 * options_.apart * real(three[k]->first) > real(three[k - 1]->first))
      --three[k];
  }
  return three;
}

void Refinement::find_limit() {
  const auto [fine, middle, coarse] = last_three();
  const double first = options_.distance(coarse->second, middle->second),
               second = options_.distance(middle->second, fine->second);
  const std::array h{1 / real(coarse->first), 1 / real(middle->first), 1 / real(fine->first)};
  const std::array along{first + second, second, 0.0};
  order_ = first <= rounding && second <= rounding ? options_.order : order_of_three(h, along).value_or(0);
  const double p = std::clamp(order_, (1 - order_off) * options_.order, options_.order);
  const auto limit_of = [&](Level coarser, Level finer) {
    Values limit(finer->second.size());
    for (std::size_t k = 0; k < limit.size(); ++k)
      limit[k] =
          richardson_limit(1 / real(coarser->first), coarser->second[k], 1 / real(finer->first), finer->second[k], p);
    return limit;
  };
  limit_ = limit_of(middle, fine);
  // The next term of the series falls one order faster.
  doubt_ = options_.distance(limit_of(coarse, middle), limit_) /
           (std::pow(real(fine->first) / real(middle->first), options_.order + 1) - 1);
}

double Refinement::error_at(double level, double order) const {
  const auto& [finest, values] = *values_.rbegin();
  return options_.distance(values, limit_) * std::pow(real(finest) / level, order);
}

std::int64_t Refinement::wanted() const {
  const double accuracy = aim * options_.accuracy;
  auto level = values_.begin();
  while (level != values_.end() && error(level->first) > options_.accuracy) ++level;
  if (level == values_.begin()) return level->first;
  const std::int64_t coarse = std::prev(level)->first;
  const double n = real(coarse) *
                   std::pow((error(coarse) - doubt_) / std::max(accuracy - doubt_, accuracy / 10), 1 / options_.order);
  const std::int64_t between = admissible(std::max(n, least_growth * real(coarse)));
  return level == values_.end() ? between : std::min(between, level->first);
}

}  // namespace equidem
