// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Statements of sections 8.5, 8.9 and 9.2, judged by the runs and their scatter over seeds.
#include <algorithm>
#include <cmath>
#include <optional>

#include "equidem/core/text.hpp"

#include "sukegawa2010/sukegawa2010.hpp"
#include "text_table.hpp"

namespace equidem::sukegawa2010 {
namespace {

constexpr double confidence = 0.95;

/// A number of each seed, by ascending seed.
using OfSeeds = std::vector<std::pair<std::uint64_t, double>>;
using Value = std::function<double(const Outcome&)>;

OfSeeds select(const std::vector<Done>& runs, Shape shape, const std::optional<Shaking>& shaking, const Value& value) {
  OfSeeds values;
  for (const Done& done : runs) {
    const Run& run = done.run;
    if (run.fill.shape != shape || !run.fill.variant.empty() || run.shaking.has_value() != shaking.has_value())
      continue;
    if (shaking && (run.shaking->gal != shaking->gal || run.shaking->frequency != shaking->frequency ||
                    run.shaking->cycles > std::max<double>(2, std::round(shaking->frequency))))
      continue;
    const double number = value(done.outcome);
    if (std::isfinite(number)) values.emplace_back(run.fill.seed, number);
  }
  std::sort(values.begin(), values.end());
  return values;
}

/// f(a, b) of the seeds that both have.
template <class Function>
OfSeeds combined(const OfSeeds& a, const OfSeeds& b, const Function& function) {
  OfSeeds values;
  for (const auto& [seed, x] : a) {
    for (const auto& [other, y] : b)
      if (other == seed) values.emplace_back(seed, function(x, y));
  }
  return values;
}

MeanEstimate estimate_of(const OfSeeds& values) {
  std::vector<double> numbers;
  for (const auto& [seed, value] : values) numbers.push_back(value);
  return estimate_mean(numbers, confidence);
}

enum class Verdict { holds, open, fails };

std::string name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds:
      return "holds";
    case Verdict::fails:
      return "does not hold";
    case Verdict::open:
      break;
  }
  return "not decided";
}

/// A difference that a statement says is positive.
Verdict judge(const MeanEstimate& difference) {
  if (difference.samples < 2) return Verdict::open;
  if (difference.low() > 0) return Verdict::holds;
  return difference.high() < 0 ? Verdict::fails : Verdict::open;
}

std::string interval(const MeanEstimate& estimate) {
  if (estimate.samples == 0) return "-";
  if (estimate.samples == 1) return fmt::format("{:.3g}, one seed", estimate.mean);
  return fmt::format("{:.3g} ± {:.1g}", estimate.mean, estimate.half_width);
}

/// "The second is larger", by the differences of runs of one seed.
struct Comparison {
  std::string text;
  OfSeeds smaller, larger;
};

/// A statement holds where all its comparisons do, and does not hold where one of them does not.
class Judged {
 public:
  void statement(const std::string& section, const std::string& text, const std::vector<Comparison>& comparisons) {
    Verdict verdict = Verdict::holds;
    std::string rows;
    for (const Comparison& c : comparisons) {
      const MeanEstimate difference =
          estimate_of(combined(c.smaller, c.larger, [](double a, double b) { return b - a; }));
      if (difference.samples == 0) return;
      const auto common = [](const OfSeeds& a, const OfSeeds& b) {
        return estimate_of(combined(a, b, [](double x, double) { return x; })).mean;
      };
      const Verdict one = judge(difference);
      verdict = std::max(verdict, one);
      rows += fmt::format("      {:<66} {:>8.3g} < {:>8.3g}, by {:<20} {}\n", c.text, common(c.smaller, c.larger),
                          common(c.larger, c.smaller), interval(difference), name_of(one));
    }
    text_ += fmt::format("  {} {}: {}\n{}", section, text, upper(name_of(verdict)), rows);
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  static std::string upper(std::string name) {
    std::ranges::transform(name, name.begin(), [](char c) { return c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c; });
    return name;
  }
  std::string text_;
};

OfSeeds zeros_like(const OfSeeds& values) {
  OfSeeds zeros = values;
  for (auto& [seed, value] : zeros) value = 0;
  return zeros;
}

/// Sections 8.5.2 and 8.5.3: motion and paths, filling and 400 gal, 10 Hz.
void judge_motion(const Reproduction& result, Judged& judged) {
  const auto filled = [&](Shape shape, double Outcome::*value) { return select(result.fills, shape, {}, value); };
  const auto shaken = [&](Shape shape, double Outcome::*value) {
    return select(result.runs, shape, Shaking{.gal = 400, .frequency = 10}, value);
  };
  const auto rising = [](const std::string& what, const auto& of, double Outcome::*value) {
    return std::vector<Comparison>{
        {what + ", discs < ellipses", of(Shape::disc, value), of(Shape::ellipse, value)},
        {what + ", ellipses < bonded pairs", of(Shape::ellipse, value), of(Shape::bonded_pair, value)}};
  };
  const auto join = [](std::vector<Comparison> a, const std::vector<Comparison>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  };
  judged.statement("8.5.2", "while the box is filled, discs, ellipses, bonded pairs move ever more",
                   join(rising("path along x, m", filled, &Outcome::path_x),
                        rising("rotation to and fro, rad", filled, &Outcome::turn)));
  judged.statement(
      "8.5.2", "while it is shaken they do, too",
      join(rising("path, m", shaken, &Outcome::path), rising("rotation to and fro, rad", shaken, &Outcome::turn)));
  judged.statement("8.5.2", "ellipses and pairs move violently just after the shaking begins",
                   {{"path in the first 0.1 s, m, discs < ellipses", shaken(Shape::disc, &Outcome::first_path),
                     shaken(Shape::ellipse, &Outcome::first_path)},
                    {"path in the first 0.1 s, m, discs < bonded pairs", shaken(Shape::disc, &Outcome::first_path),
                     shaken(Shape::bonded_pair, &Outcome::first_path)}});
  const OfSeeds inward = shaken(Shape::disc, &Outcome::inward), sunk = shaken(Shape::disc, &Outcome::sunk);
  judged.statement(
      "8.5.3", "discs on the left and on the right move towards the middle and sink",
      {{"displacement inward, m", zeros_like(inward), inward}, {"displacement downward, m", zeros_like(sunk), sunk}});
  judged.statement("8.5.3", "ellipses move far along x, those of one height the same way",
                   {{"displacement along x, m, discs < ellipses", shaken(Shape::disc, &Outcome::displaced_x),
                     shaken(Shape::ellipse, &Outcome::displaced_x)},
                    {"common to a layer, discs < ellipses", shaken(Shape::disc, &Outcome::layered),
                     shaken(Shape::ellipse, &Outcome::layered)}});
  judged.statement("8.5.3", "bonded pairs move far along x, in various directions",
                   {{"displacement along x, m, discs < bonded pairs", shaken(Shape::disc, &Outcome::displaced_x),
                     shaken(Shape::bonded_pair, &Outcome::displaced_x)},
                    {"common to a layer, bonded pairs < ellipses", shaken(Shape::bonded_pair, &Outcome::layered),
                     shaken(Shape::ellipse, &Outcome::layered)}});
}

/// Sections 8.9.1 and 8.9.2: the nine shakings.
void judge_shakings(const Reproduction& result, Judged& judged) {
  const auto at = [&](Shape shape, double gal, double frequency, const Value& value) {
    return select(result.runs, shape, Shaking{.gal = gal, .frequency = frequency}, value);
  };
  const auto difference = [](const OfSeeds& a, const OfSeeds& b, double factor) {
    return combined(a, b, [factor](double x, double y) { return factor * std::abs(y - x); });
  };
  const std::vector<std::pair<const char*, Value>> measures{{"slope", &Outcome::slope},
                                                            {"void ratio", &Outcome::void_ratio}};
  constexpr double small = 0.2;
  for (const auto& [words_of_change, gal, frequency] :
       {std::tuple{"at 10 Hz a larger amplitude changes little", 1200.0, 10.0},
        std::tuple{"at 400 gal a lower frequency changes little", 400.0, 1.0}}) {
    std::vector<Comparison> comparisons;
    for (const Shape shape : {Shape::disc, Shape::bonded_pair}) {
      for (const auto& [name, value] : measures) {
        const OfSeeds mild = at(shape, 400, 10, value);
        comparisons.push_back(
            {fmt::format("{}, change of the {}, less than a fifth of that by both", words(plural_of(shape)), name),
             difference(mild, at(shape, gal, frequency, value), 1),
             difference(mild, at(shape, 1200, 1, value), small)});
      }
    }
    judged.statement("8.9.1", words_of_change, comparisons);
  }
  std::vector<Comparison> sloshing;
  for (const Shape shape : {Shape::disc, Shape::bonded_pair}) {
    for (const auto& [from, to] : {std::pair{10.0, 2.0}, std::pair{2.0, 1.0}}) {
      sloshing.push_back({fmt::format("{}, slope at 1200 gal, {:g} < {:g} Hz", words(plural_of(shape)), from, to),
                          at(shape, 1200, from, &Outcome::slope), at(shape, 1200, to, &Outcome::slope)});
    }
  }
  judged.statement("8.9.1", "large and slow shaking tilts the surface, most at 1200 gal, 1 Hz", sloshing);
  std::vector<Comparison> rough, thrown;
  for (const auto& [gal, frequency] : {std::pair{1200.0, 2.0}, std::pair{800.0, 1.0}, std::pair{1200.0, 1.0}}) {
    const std::string where = fmt::format("{:g} gal, {:g} Hz", gal, frequency);
    rough.push_back({"roughness at " + where + ", m, discs < pairs",
                     at(Shape::disc, gal, frequency, &Outcome::roughness),
                     at(Shape::bonded_pair, gal, frequency, &Outcome::roughness)});
    thrown.push_back({"thrown at " + where + ", pairs < discs",
                      at(Shape::bonded_pair, gal, frequency, &Outcome::thrown),
                      at(Shape::disc, gal, frequency, &Outcome::thrown)});
  }
  judged.statement("8.9.2", "the surface of bonded pairs is rougher", rough);
  judged.statement("8.9.2", "fewer of the bonded pairs are thrown", thrown);
}

/// Section 9.2: the shaking after which the void ratio is smallest, and those that the scatter does not tell from it.
std::string best_shakings(const Reproduction& result) {
  std::string text;
  for (const Shape shape : {Shape::disc, Shape::bonded_pair}) {
    struct Shaken {
      std::string name;
      OfSeeds void_ratios;
      double mean;
    };
    std::vector<Shaken> all;
    for (const Done& done : mapped(result, shape)) {
      const Shaking& shaking = *done.run.shaking;
      OfSeeds values = select(result.runs, shape, shaking, &Outcome::void_ratio);
      if (values.empty()) continue;
      const double mean = estimate_of(values).mean;
      all.push_back({fmt::format("{:g} gal, {:.3g} Hz", shaking.gal, shaking.frequency), std::move(values), mean});
    }
    if (all.size() < 2) continue;
    // Of the number of seeds that half of the shakings have.
    std::ranges::sort(all, {}, [](const Shaken& one) { return one.void_ratios.size(); });
    const std::size_t seeds = all[all.size() / 2].void_ratios.size();
    std::erase_if(all, [&](const Shaken& one) { return one.void_ratios.size() < seeds; });
    std::ranges::sort(all, {}, &Shaken::mean);
    text += fmt::format("  {}: densest after {}, e = {}, of {} shakings of {} filling{}", words(plural_of(shape)),
                        all[0].name, interval(estimate_of(all[0].void_ratios)), all.size(), seeds,
                        seeds == 1 ? ": no scatter is known\n" : "s; ");
    if (seeds == 1) continue;
    std::string rivals;
    for (std::size_t k = 1; k < all.size(); ++k) {
      const MeanEstimate more =
          estimate_of(combined(all[0].void_ratios, all[k].void_ratios, [](double a, double b) { return b - a; }));
      if (judge(more) == Verdict::holds) continue;
      rivals += fmt::format("    {:<16} by {}\n", all[k].name, interval(more));
    }
    text += rivals.empty() ? "no other is as good within the scatter\n"
                           : "NOT DECIDED within the scatter against\n" + rivals;
  }
  return text;
}

/// Section 9.2: whether shaking by the printed period resonates.
std::string resonance(const Reproduction& result) {
  const std::vector<Done> runs = resonance_runs(result);
  const auto nearest = std::ranges::min_element(
      runs, {}, [](const Done& done) { return std::abs(1 / done.run.shaking->frequency - printed_period); });
  if (nearest == runs.end() || std::abs(1 / nearest->run.shaking->frequency - printed_period) > 0.01) return "";
  if (nearest == runs.begin() || nearest + 1 == runs.end()) return "";
  const double here = amplification_of(*nearest), left = amplification_of(*(nearest - 1)),
               right = amplification_of(*(nearest + 1));
  const bool peak = here > left && here > right;
  return fmt::format(
      "  9.2 discs resonate at the period of {:g} s: {} (one filling): amplification {:.3f} there, {:.3f} at {:.3g} s, "
      "{:.3f} at {:.3g} s\n",
      printed_period, peak ? "HOLDS" : "DOES NOT HOLD", here, left, 1 / (nearest - 1)->run.shaking->frequency, right,
      1 / (nearest + 1)->run.shaking->frequency);
}

}  // namespace

std::string verdicts(const Reproduction& result) {
  Judged judged;
  judge_motion(result, judged);
  judge_shakings(result, judged);
  const std::string best = best_shakings(result);
  if (judged.text().empty() && best.empty()) return "";
  return fmt::format(
             "What the thesis concludes (8.5.2, 8.5.3, 8.9.1, 8.9.2, 9.2) and what these runs say. Numbers are means "
             "over all grains and over\nseeds; differences of runs of one seed with their interval of {:g} % over "
             "seeds. A statement holds where all its lines do, and\ndoes not where one does not; the rest is not "
             "decided within the scatter. Paths are in the box, sampled every 0.01 s.\n",
             100 * confidence) +
         judged.text() +
         (best.empty() ? "" : "  9.2 the shaking that compacts best (void ratio away from walls)\n" + best) +
         resonance(result) + "\n";
}

}  // namespace equidem::sukegawa2010
