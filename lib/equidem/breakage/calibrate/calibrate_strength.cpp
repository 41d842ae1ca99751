// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/calibrate/calibrate_strength.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr double unknown = MeanEstimate::unknown;
constexpr double confidence = 0.95;

/// Strengths of all samples for f_t = 1 and one value of the unknown. The stress of a notched test is a toughness.
struct Tried {
  double value = 0;
  std::vector<SampleStrength> tension, second;
  double ratio = 0;
};

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::vector<double> stresses(const std::vector<SampleStrength>& of) {
  std::vector<double> values;
  for (const SampleStrength& one : of) values.push_back(one.stress);
  return values;
}

class Search {
 public:
  Search(const std::vector<SeededSample>& samples, const StrengthTargets& wanted,
         const StrengthCalibrationOptions& options, const std::function<void(double)>& progress)
      : samples_(samples),
        wanted_(wanted),
        options_(options),
        progress_(progress),
        unsheared_(2 * samples.size()),
        target_(wanted.second() / wanted.tensile) {}

  StrengthCalibration run();
  [[nodiscard]] bool has_some() const { return !tried_.empty(); }
  /// Throws an error that ends the search, with the strengths at the nearest ratio of those tried.
  [[noreturn]] void end(const Error& error) const;

 private:
  [[nodiscard]] bool finds_friction() const { return options_.shear_over_tension.has_value(); }
  [[nodiscard]] double low() const { return finds_friction() ? 0 : least_shear_over_tension; }
  [[nodiscard]] double high() const { return finds_friction() ? most_friction : largest_shear_over_tension; }
  /// The variable of the search, in [0, 1), in which the ratio changes evenly.
  static double folded(double x) { return x / (1 + x); }
  static double unfolded(double s) { return s / (1 - s); }
  /// The logarithm of the ratio over the wanted one, infinite where the load never falls.
  [[nodiscard]] double off(const Tried& tried) const { return std::log(tried.ratio / target_); }
  const Tried& at(double value);
  const Tried& between();
  [[nodiscard]] const Tried& nearest() const;
  void scan();
  [[nodiscard]] StrengthOptions strengths_at(double value) const;
  [[nodiscard]] SampleStrength measure(std::size_t sample, bool second, const ContactStrengths& strengths) const;
  void refuse() const;
  [[nodiscard]] std::string unit() const;
  [[nodiscard]] std::string remedy(const Tried& least, const Tried& most) const;
  [[nodiscard]] StrengthCalibration result(const Tried& found) const;
  [[nodiscard]] double slope_at(const Tried& found) const;

  const std::vector<SeededSample>& samples_;
  const StrengthTargets& wanted_;
  const StrengthCalibrationOptions& options_;
  const std::function<void(double)>& progress_;
  std::vector<Tried> tried_;  ///< ascending in value
  /// A test in which no contact broke in shear is the same for all larger f_s/f_t.
  struct Unsheared {
    double from = std::numeric_limits<double>::infinity();
    SampleStrength strength;
  };
  std::vector<Unsheared> unsheared_;  ///< tension and the second test of every sample
  double target_;
  std::int64_t tests_ = 0;
  double energy_error_ = 0;
};

StrengthOptions Search::strengths_at(double value) const {
  StrengthOptions strengths = options_.strengths;
  strengths.tension = 1;
  strengths.shear = finds_friction() ? *options_.shear_over_tension : value;
  if (finds_friction()) strengths.friction = value;
  return strengths;
}

SampleStrength Search::measure(std::size_t sample, bool second, const ContactStrengths& strengths) const {
  const StrengthSample& tested = samples_[sample].sample;
  if (!second) return tested.strength(StrengthTestKind::tension, strengths);
  if (!wanted_.toughness) return tested.strength(StrengthTestKind::compression, strengths);
  SampleStrength all;
  for (const double notch : wanted_.notches) {
    const SampleStrength one = tested.strength(StrengthTestKind::tension, strengths, notch);
    all.stress += notch_toughness(one.stress, notch, tested.width()) / static_cast<double>(wanted_.notches.size());
    all.events += one.events;
    all.in_shear += one.in_shear;
    all.energy_error = std::max(all.energy_error, one.energy_error);
  }
  return all;
}

const Tried& Search::at(double value) {
  const std::size_t count = samples_.size();
  Tried made{value, std::vector<SampleStrength>(count), std::vector<SampleStrength>(count), 0};
  std::vector<std::uint8_t> measured(2 * count, 0);
  parallel_tasks(2 * count, [&](std::size_t task, int) {
    const std::size_t sample = task / 2;
    const bool second = task % 2 == 1;
    Unsheared& known = unsheared_[task];
    SampleStrength& into = second ? made.second[sample] : made.tension[sample];
    if (!finds_friction() && value >= known.from) {
      into = known.strength;
      return;
    }
    StrengthOptions drawn = strengths_at(value);
    drawn.seed = samples_[sample].seed;
    into = measure(sample, second, contact_strengths(samples_[sample].sample.assembly(), drawn));
    measured[task] = 1;
    if (into.in_shear == 0) known = {value, into};
  });
  tests_ += std::ranges::count(measured, 1);
  for (const SampleStrength& one : made.tension) {
    if (std::isfinite(one.stress)) continue;
    computation_failed("a sample under tension never breaks", "its strength is without bound",
                       "Correct friction, springs or the assembly");
  }
  for (const auto* all : {&made.tension, &made.second}) {
    for (const SampleStrength& one : *all) energy_error_ = std::max(energy_error_, one.energy_error);
  }
  made.ratio = mean(stresses(made.second)) / mean(stresses(made.tension));
  const auto place = tried_.insert(std::ranges::upper_bound(tried_, value, {}, &Tried::value), std::move(made));
  if (progress_) progress_(1 - std::pow(0.85, static_cast<double>(tried_.size())));
  return *place;
}

void Search::refuse() const {
  const auto by_ratio = [](const Tried& a, const Tried& b) { return a.ratio < b.ratio; };
  const auto [least, most] = std::minmax_element(tried_.begin(), tried_.end(), by_ratio);
  const auto& nearest = target_ < least->ratio ? *least : *most;
  const auto give_up = [&](const std::string& why, const std::string& remedy) {
    const std::string of =
        wanted_.compressive ? "compressive over tensile strength" : "toughness over tensile strength";
    const Error error(ErrorKind::computation_failed,
                      fmt::format("{} of {:.4g}{} is not feasible with this sample", of, target_, unit()), why, remedy);
    throw InfeasibleStrengths(error, result(nearest));
  };
  const std::string what = finds_friction() ? "friction" : "f_s/f_t";
  if (!std::isfinite(least->ratio))
    give_up("it has no compressive strength: the load never falls, whatever the " + what,
            "Load the sample along its other axis, or take one without straight rows of discs");
  const auto shown = [](double ratio) {
    return std::isfinite(ratio) ? fmt::format("{:.4g}", ratio) : std::string("no bound");
  };
  give_up(fmt::format("it has {} to {}{}, {} from {:g} to {:g}", shown(least->ratio), shown(most->ratio), unit(), what,
                      tried_.front().value, tried_.back().value),
          remedy(*least, *most));
}

std::string Search::unit() const {
  return wanted_.compressive ? "" : " sqrt(m)";
}

/// Names changes that move the range of ratios towards the wanted one, as measured on packings
/// (docs/explanation/breakage.md).
std::string Search::remedy(const Tried& least, const Tried& most) const {
  if (!wanted_.compressive) {
    // Strength of a contact f, radius r: stresses are f/r, toughnesses f/sqrt(r).
    return fmt::format("Discs and notches {:.3g} to {:.3g} times as large have it", squared(target_ / most.ratio),
                       squared(target_ / least.ratio));
  }
  const bool above = target_ > most.ratio;
  const std::string network = above ? "more bonds of each disc (a larger gap_tolerance), a smaller Weibull modulus or "
                                      "a larger kT"
                                    : "fewer bonds of each disc, a larger Weibull modulus or a softer kT";
  if (finds_friction()) return fmt::format("Take another strength_target.shear_over_tension, or {}", network);
  const bool no_shear = std::ranges::all_of(most.second, [](const SampleStrength& one) { return one.in_shear == 0; });
  if (above && no_shear)
    return fmt::format("Take {}; friction does not raise it, because no contact breaks in shear there", network);
  return fmt::format("Take {} friction, or {}", above ? "a larger" : "a smaller", network);
}

/// Values between the ends, where both lie on one side of the target: the ratio may turn round.
void Search::scan() {
  for (const double s : {0.2, 0.35, 0.5, 0.65, 0.8, 0.9}) {
    const Tried& last = at(unfolded(s));
    if ((off(last) > 0) != (off(tried_.front()) > 0)) return;
  }
  refuse();
}

/// Between the first two neighbours with the target between them.
const Tried& Search::between() {
  constexpr double narrow = 1e-5;  // of the folded variable: the ratio jumps there
  constexpr int most_steps = 40;
  const auto second = std::adjacent_find(tried_.begin(), tried_.end(),
                                         [&](const Tried& a, const Tried& b) { return (off(a) > 0) != (off(b) > 0); });
  double a = folded(second->value), b = folded((second + 1)->value);
  double off_a = off(*second), off_b = off(*(second + 1));
  const bool rising = off_b > 0;
  for (int step = 0; step < most_steps && b - a > narrow; ++step) {
    const bool finite = std::isfinite(off_a) && std::isfinite(off_b);
    const double s = finite && step % 4 != 3 ? a - off_a * (b - a) / (off_b - off_a) : 0.5 * (a + b);
    const Tried& last = at(unfolded(s));
    const double off_s = off(last);
    if (std::abs(off_s) <= options_.accuracy) return last;
    // Illinois: an end that stays twice counts half, so that both come nearer.
    if ((off_s > 0) == rising) {
      b = s, off_b = off_s, off_a *= 0.5;
    } else {
      a = s, off_a = off_s, off_b *= 0.5;
    }
  }
  return nearest();
}

const Tried& Search::nearest() const {
  return *std::ranges::min_element(tried_, {}, [&](const Tried& one) { return std::abs(off(one)); });
}

void Search::end(const Error& error) const {
  throw ErrorWith(error,
                  fmt::format("not converged: the nearest ratio of {} is {:.4g} in place of {:.4g}{}",
                              counted(std::ssize(tried_), "trial"), nearest().ratio, target_, unit()),
                  result(nearest()));
}

/// d ln(ratio)/d(folded value), over the neighbours of the value that was found.
double Search::slope_at(const Tried& found) const {
  const auto place = std::ranges::find(tried_, found.value, &Tried::value);
  const Tried& a = place == tried_.begin() ? *place : *(place - 1);
  const Tried& b = place + 1 == tried_.end() ? *place : *(place + 1);
  if (!std::isfinite(a.ratio) || !std::isfinite(b.ratio)) return unknown;
  return std::log(b.ratio / a.ratio) / (folded(b.value) - folded(a.value));
}

StrengthCalibration Search::result(const Tried& found) const {
  const std::vector<double> tension = stresses(found.tension), others = stresses(found.second);
  const double scale = wanted_.tensile / mean(tension);
  StrengthCalibration c;
  c.tension = scale;
  c.shear = scale * (finds_friction() ? *options_.shear_over_tension : found.value);
  c.friction = finds_friction() ? found.value : options_.strengths.friction;
  c.ratio = found.ratio;
  std::vector<double> tensile, second, apart;
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    tensile.push_back(scale * tension[k]);
    second.push_back(scale * others[k]);
    apart.push_back(others[k] / mean(others) - tension[k] / mean(tension));
    const SampleStrength &a = found.tension[k], &b = found.second[k];
    c.samples.push_back({samples_[k].seed, tensile[k], second[k], a.events + b.events, a.in_shear + b.in_shear});
  }
  c.tensile = estimate_mean(tensile, confidence);
  c.second = estimate_mean(second, confidence);
  for (const Tried& one : tried_) c.tried.push_back({one.value, one.ratio});
  c.tests = tests_;
  c.energy_error = energy_error_;

  // d(ln ratio) = slope ds, s = x/(1 + x), so that dx = (1 + x)² ds.
  const double of_ratio = estimate_mean(apart, confidence).standard_error, slope = slope_at(found);
  const double of_value = slope != 0 ? squared(1 + found.value) * of_ratio / std::abs(slope) : unknown;
  const double of_tension = c.tensile.standard_error / c.tensile.mean;
  c.tension_error = c.tension * of_tension;
  c.friction_error = finds_friction() ? of_value : 0;
  c.shear_error = c.shear * (finds_friction() ? of_tension : std::hypot(of_tension, of_value / found.value));
  return c;
}

StrengthCalibration Search::run() {
  for (const double end : {high(), low()}) {
    const Tried& tried = at(end);
    if (std::abs(off(tried)) <= options_.accuracy) return result(tried);
  }
  if ((off(tried_.front()) > 0) == (off(tried_.back()) > 0)) scan();
  return result(between());
}

void check_targets(const StrengthTargets& wanted, const StrengthCalibrationOptions& options) {
  check_positive(wanted.tensile, "wanted tensile strength", "Pa");
  if (wanted.compressive.has_value() == wanted.toughness.has_value())
    bad_input("a compressive strength and a toughness are both given, or neither is", "one of them goes with tension",
              "Give one");
  check_positive(wanted.second(), wanted.compressive ? "wanted compressive strength" : "wanted toughness");
  if (wanted.toughness.has_value() == wanted.notches.empty())
    bad_input("a toughness needs notches, and nothing else does", "it is read off notched samples",
              "Give toughness and notches together");
  for (const double notch : wanted.notches) check_positive(notch, "length of the notch", "m");
  if (options.strengths.tension || options.strengths.shear)
    bad_input("strengths of contacts are given", "they are what is looked for", "Remove tension and shear");
  if (options.shear_over_tension) check_positive(*options.shear_over_tension, "ratio of shear to tension");
}

}  // namespace

double StrengthCalibration::lowest_ratio() const {
  return std::ranges::min_element(tried, {}, &TriedValue::ratio)->ratio;
}

double StrengthCalibration::highest_ratio() const {
  return std::ranges::max_element(tried, {}, &TriedValue::ratio)->ratio;
}

StrengthCalibration calibrate_strength(const std::vector<SeededSample>& samples, const StrengthTargets& wanted,
                                       const StrengthCalibrationOptions& options,
                                       const std::function<void(double)>& progress) {
  check_targets(wanted, options);
  if (samples.empty()) bad_input("there are no samples", "strengths are those of samples", "Give one at least");
  for (const SeededSample& sample : samples) {
    for (const double notch : wanted.notches) {
      const double width = sample.sample.width();
      if (notch <= longest_notch * width) continue;
      bad_input(fmt::format("a notch of {:g} m in a sample of {:g} m", notch, width),
                fmt::format("the toughness is read off notches up to {:g} of the width", longest_notch),
                "Give shorter notches, or larger samples");
    }
  }
  Search search(samples, wanted, options, progress);
  try {
    return search.run();
  } catch (const InfeasibleStrengths&) {
    throw;
  } catch (const Error& error) {
    if (search.has_some() && error.kind() != ErrorKind::bad_input) search.end(error);
    throw;
  }
}

}  // namespace equidem
