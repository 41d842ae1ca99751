// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <functional>

#include "equidem/core/text.hpp"

#include "abe1996_random/mean_field.hpp"

namespace equidem::mean_field {
namespace {

using Value = std::function<double(const Point&)>;

double error_of_poisson(const Point& p) {
  return p.poisson_error.mean;
}
double error_of_shear(const Point& p) {
  return p.shear_error.mean;
}
double error_of_bulk(const Point& p) {
  return p.bulk_error.mean;
}

/// What is round-off beside 1 reads as 0.
double clean(double value) {
  return std::abs(value) < 1e-11 ? 0 : value;
}

std::string percent(double share) {
  return fmt::format("{:+.3g} %", 100 * clean(share));
}

bool random_and_isotropic(const Family& family) {
  return family.disordered() && family.isotropic();
}

/// Points of a weighting on isotropic random families.
std::vector<const Point*> isotropic_points(const Result& result, SpringWeighting weighting) {
  std::vector<const Point*> chosen;
  for (const Point& p : result.points)
    if (p.weighting == weighting && random_and_isotropic(result.plan.families[p.family])) chosen.push_back(&p);
  return chosen;
}

double root_mean_square(const std::vector<const Point*>& points, const Value& value) {
  double squares = 0;
  for (const Point* p : points) squares += value(*p) * value(*p);
  return std::sqrt(squares / static_cast<double>(points.size()));
}

std::string place(const Result& result, const Point& p) {
  return fmt::format("{}, kT/kN = {:g}", result.plan.families[p.family].name, p.ratio);
}

std::string describe_families(const Result& result) {
  std::string text = fmt::format("{:<26} {:>16} {:>12} {:>12} {:>9} {:>6}\n", "assemblies", "branch lengths",
                                 "contacts", "psi(theta)", "phi", "z");
  text += fmt::format("{:<26} {:>16} {:>12} {:>12}\n", "", "sd/mean", "sd", "anisotropy");
  for (std::size_t f = 0; f < result.disorder.size(); ++f) {
    const Disorder& d = result.disorder[f];
    text += fmt::format("{:<26} {:>16.4f} {:>12.3f} {:>12.4f} {:>9.4f} {:>6.3f}\n", result.plan.families[f].name,
                        d.branch_scatter.mean, d.coordination_scatter.mean, d.contact_anisotropy.mean, d.solid_fraction,
                        d.coordination_number);
  }
  return text;
}

using Estimate = std::function<MeanEstimate(const Point&)>;

/// Families downwards, kT/kN to the right; means over the cells, in percent where they are shares.
std::string grid(const Result& result, std::size_t weighting, const std::string& title, const Estimate& estimate,
                 bool shares) {
  const auto cell = [&](double value) {
    return shares ? fmt::format(" {:>+9.2f} %", 100 * value) : fmt::format(" {:>11.4f}", value);
  };
  std::string rows = fmt::format("{:<26}", "kT/kN");
  for (const double ratio : result.plan.ratios) rows += fmt::format(" {:>11g}", ratio);
  rows += "\n";
  double error = 0;
  for (std::size_t f = 0; f < result.plan.families.size(); ++f) {
    rows += fmt::format("{:<26}", result.plan.families[f].name);
    for (std::size_t r = 0; r < result.plan.ratios.size(); ++r) {
      const MeanEstimate e = estimate(result.at(f, weighting, r));
      error = std::max(error, e.standard_error);
      // What the last digit rounds away reads as 0, without a sign.
      constexpr double half_of_last_digit = 5e-5;
      rows += cell(std::abs(e.mean) < half_of_last_digit ? 0 : e.mean);
    }
    rows += "\n";
  }
  return fmt::format("{} (standard errors up to {})\n", title,
                     shares ? fmt::format("{:.2g} %", 100 * error) : fmt::format("{:.2g}", error)) +
         rows;
}

std::string describe_weighting(const Result& result, std::size_t weighting) {
  std::string text = fmt::format("Weighting \"{}\"\n", to_string(weightings[weighting]));
  text += grid(
      result, weighting, "nu, exact", [](const Point& p) { return p.exact.poisson; }, false);
  text += fmt::format("{:<26}", "mean field (1 - kT/kN)/4");
  for (std::size_t r = 0; r < result.plan.ratios.size(); ++r)
    text += fmt::format(" {:>11.4f}", result.at(0, weighting, r).mean_field.poisson.mean);
  text += "\n\n" + grid(
                       result, weighting, "G of the mean field over the exact one, less 1",
                       [](const Point& p) { return p.shear_error; }, true);
  text += "\n" + grid(
                     result, weighting, "K of the mean field over the exact one, less 1",
                     [](const Point& p) { return p.bulk_error; }, true);
  return text + "\n";
}

/// "the error of nu lies between a (where) and b (where)".
std::string range_of(const Result& result, const std::vector<const Point*>& points, const std::string& name,
                     const Value& value, const std::function<std::string(double)>& shown) {
  const auto [low, high] = std::minmax_element(points.begin(), points.end(),
                                               [&](const Point* a, const Point* b) { return value(*a) < value(*b); });
  const double largest = std::max(std::abs(value(**low)), std::abs(value(**high)));
  if (clean(largest) == 0) return fmt::format("  {:<3} none: exact within {:.0e}\n", name, largest);
  return fmt::format("  {:<3} from {} ({}) to {} ({})\n", name, shown(value(**low)), place(result, **low),
                     shown(value(**high)), place(result, **high));
}

std::string conclude_errors(const Result& result) {
  std::string text = "1. By how much the mean field errs (mean field less exact) on isotropic random assemblies\n";
  const auto number = [](double v) { return fmt::format("{:+.4f}", v); };
  for (const SpringWeighting weighting : weightings) {
    const auto points = isotropic_points(result, weighting);
    text += fmt::format(" {}:\n", to_string(weighting));
    text += range_of(result, points, "nu", error_of_poisson, number);
    text += range_of(result, points, "G", error_of_shear, percent);
    text += range_of(result, points, "K", error_of_bulk, percent);
  }
  return text;
}

/// The exponent of |error| ~ disorder^p between the two least disordered lattices.
std::string conclude_disorder(const Result& result) {
  std::vector<std::size_t> lattices;
  for (std::size_t f = 0; f < result.plan.families.size(); ++f) {
    const Family& family = result.plan.families[f];
    if (family.points == PointProcess::perturbed_hexagonal && family.disorder > 0) lattices.push_back(f);
  }
  if (lattices.size() < 2) return "";
  const double small = result.plan.families[lattices[0]].disorder, larger = result.plan.families[lattices[1]].disorder;
  double without = 0;
  for (const Point& p : result.points) {
    if (result.plan.families[p.family].disordered()) continue;
    for (const Value& error : {Value(error_of_poisson), Value(error_of_shear), Value(error_of_bulk)})
      without = std::max(without, std::abs(error(p)));
  }
  std::string text = fmt::format(
      "2. Without disorder the mean field errs by {:.0e}. From disorder {:g} to {:g}, at kT/kN = {:g}, its errors grow "
      "as "
      "disorder^p:\n",
      without, small, larger, result.plan.ratios.front());
  for (std::size_t w = 0; w < weightings.size(); ++w) {
    const Point &first = result.at(lattices[0], w, 0), &second = result.at(lattices[1], w, 0);
    const auto exponent = [&](const Value& value) {
      return std::log(value(second) / value(first)) / std::log(larger / small);
    };
    text += fmt::format("  {:<16} p = {:.2f} for nu, {:.2f} for G\n", to_string(weightings[w]),
                        exponent(error_of_poisson), exponent(error_of_shear));
  }
  text += "   Against kT/kN, root mean square over isotropic random assemblies:\n" + fmt::format("  {:<22}", "kT/kN");
  for (const double ratio : result.plan.ratios) text += fmt::format(" {:>8g}", ratio);
  text += "\n";
  for (const SpringWeighting weighting : weightings) {
    std::string nu = fmt::format("  {:<16} nu   ", to_string(weighting)), shear = fmt::format("  {:<16} G, % ", "");
    for (const double ratio : result.plan.ratios) {
      auto points = isotropic_points(result, weighting);
      std::erase_if(points, [&](const Point* p) { return p->ratio != ratio; });
      nu += fmt::format(" {:>8.4f}", root_mean_square(points, error_of_poisson));
      shear += fmt::format(" {:>8.2f}", 100 * root_mean_square(points, error_of_shear));
    }
    text += nu + "\n" + shear + "\n";
  }
  return text;
}

/// Where the error of G comes from, on the assembly with the widest scatter of branch lengths.
std::string conclude_causes(const Result& result) {
  std::size_t widest = 0;
  for (std::size_t f = 0; f < result.disorder.size(); ++f) {
    if (result.plan.families[f].isotropic() &&
        result.disorder[f].branch_scatter.mean > result.disorder[widest].branch_scatter.mean)
      widest = f;
  }
  const std::size_t r = result.plan.ratios.size() / 2;
  std::string text = fmt::format(
      "3. Two causes: branches are not all 2a long (Voigt against mean field), and discs leave the smooth field (exact "
      "against\n   Voigt). For G of '{}' at kT/kN = {:g}:\n",
      result.plan.families[widest].name, result.plan.ratios[r]);
  for (std::size_t w = 0; w < weightings.size(); ++w) {
    const Point& p = result.at(widest, w, r);
    text += fmt::format("  {:<16} true branches {}, discs free to leave the field {}, both together {}\n",
                        to_string(weightings[w]), percent(p.voigt.shear.mean / p.mean_field.shear.mean - 1),
                        percent(p.exact.shear.mean / p.voigt.shear.mean - 1),
                        percent(p.exact.shear.mean / p.mean_field.shear.mean - 1));
  }
  return text;
}

std::string conclude_correction(const Result& result) {
  const auto uniform = isotropic_points(result, SpringWeighting::uniform);
  const auto corrected = isotropic_points(result, SpringWeighting::contact_density);
  const double before = root_mean_square(uniform, error_of_poisson),
               after = root_mean_square(corrected, error_of_poisson);
  std::size_t beyond = 0;
  for (std::size_t k = 0; k < uniform.size(); ++k) {
    const double change = corrected[k]->exact.poisson.mean - uniform[k]->exact.poisson.mean;
    const double error =
        std::hypot(corrected[k]->exact.poisson.standard_error, uniform[k]->exact.poisson.standard_error);
    if (std::abs(change) > 2 * error) ++beyond;
  }
  double uneven = 0;
  for (std::size_t f = 0; f < result.disorder.size(); ++f)
    if (result.plan.families[f].isotropic()) uneven = std::max(uneven, result.disorder[f].contact_anisotropy.mean);
  std::string text = fmt::format(
      "4. The correction (11) on isotropic random assemblies: root mean square error of nu {:.4f} without, {:.4f} with "
      "it ({});\n   in {} of {} points nu changes by more than two standard errors. It {} there: psi(theta) is uneven "
      "by at most {:.3f}.\n",
      before, after, percent(after / before - 1), beyond, uniform.size(),
      after < 0.9 * before ? "helps" : "does not help", uneven);
  for (std::size_t f = 0; f < result.plan.families.size(); ++f) {
    if (result.plan.families[f].isotropic()) continue;
    text += fmt::format("   '{}' (psi uneven by {:.3f}), anisotropy of the exact tensor and error of nu:\n",
                        result.plan.families[f].name, result.disorder[f].contact_anisotropy.mean);
    for (std::size_t r = 0; r < result.plan.ratios.size(); ++r) {
      const Point &u = result.at(f, 0, r), &c = result.at(f, 1, r), &v = result.at(f, 2, r);
      text += fmt::format(
          "    kT/kN = {:<5g} uniform {:.4f}, {:+.4f};  contact_density {:.4f}, {:+.4f} (anisotropy {});  voronoi "
          "{:.4f}, {:+.4f}\n",
          u.ratio, u.anisotropy.mean, u.poisson_error.mean, c.anisotropy.mean, c.poisson_error.mean,
          percent(c.anisotropy.mean / u.anisotropy.mean - 1), v.anisotropy.mean, v.poisson_error.mean);
    }
  }
  return text;
}

std::string conclude_weighting(const Result& result) {
  std::string text =
      "5. Which weighting the mean field describes best: root mean square over isotropic random assemblies and kT/kN\n";
  text += fmt::format("  {:<16} {:>12} {:>12} {:>12} {:>26} {:>14}\n", "weighting", "error of nu", "error of G",
                      "error of K", "scatter of G, one cell", "anisotropy");
  struct Score {
    double nu, shear, bulk;
  };
  std::vector<Score> scores;
  for (const SpringWeighting weighting : weightings) {
    const auto points = isotropic_points(result, weighting);
    scores.push_back({root_mean_square(points, error_of_poisson), root_mean_square(points, error_of_shear),
                      root_mean_square(points, error_of_bulk)});
    text += fmt::format(
        "  {:<16} {:>12.4f} {:>10.2f} % {:>10.2f} % {:>24.2f} % {:>14.4f}\n", to_string(weighting), scores.back().nu,
        100 * scores.back().shear, 100 * scores.back().bulk,
        100 * root_mean_square(points,
                               [](const Point& p) { return p.exact.shear.standard_deviation / p.exact.shear.mean; }),
        root_mean_square(points, [](const Point& p) { return p.anisotropy.mean; }));
  }
  const auto best = [&](double Score::*score) {
    const auto least = std::min_element(scores.begin(), scores.end(),
                                        [&](const Score& a, const Score& b) { return a.*score < b.*score; });
    return to_string(weightings[static_cast<std::size_t>(least - scores.begin())]);
  };
  text += fmt::format("   Best for nu: {}; for G: {}; for K: {}.\n", best(&Score::nu), best(&Score::shear),
                      best(&Score::bulk));
  double worst_bulk = 0;
  for (const Point& p : result.points)
    if (p.weighting == SpringWeighting::voronoi) worst_bulk = std::max(worst_bulk, std::abs(p.bulk_error.mean));
  text += fmt::format(
      "   With springs k h/l, K = kN/2 within {:.0e} on all assemblies: an even strain pulls each disc along its "
      "facets "
      "with forces\n   ~ h n, which add up to zero around a closed cell, so that no disc leaves the smooth field.\n",
      worst_bulk);
  return text;
}

std::string conclude_bounds(const Result& result) {
  std::size_t points = 0, below_voigt = 0, above_estimate = 0, between = 0;
  for (const Point& p : result.points) {
    if (!result.plan.families[p.family].disordered()) continue;
    ++points;
    constexpr double rounding = 1e-12;
    if (p.exact.shear.mean <= p.voigt.shear.mean * (1 + rounding)) ++below_voigt;
    if (p.exact.shear.mean >= p.uniform_stress.shear.mean * (1 - rounding)) ++above_estimate;
    const double low = std::min(p.voigt.poisson.mean, p.uniform_stress.poisson.mean);
    const double high = std::max(p.voigt.poisson.mean, p.uniform_stress.poisson.mean);
    if (low - rounding <= p.exact.poisson.mean && p.exact.poisson.mean <= high + rounding) ++between;
  }
  return fmt::format(
      "6. Of {} points, G is at most Voigt's in {} (a bound) and at least the uniform-stress estimate in {} (no "
      "bound);\n"
      "   nu lies between those of the two in {}.\n",
      points, below_voigt, above_estimate, between);
}

std::string conclude_limit(const Result& result) {
  std::string text = "7. Largest nu of any of these assemblies with kT >= 0 (the mean field says at most 1/4):\n";
  for (const SpringWeighting weighting : weightings) {
    const Point* largest = nullptr;
    for (const Point& p : result.points) {
      if (p.weighting != weighting || !result.plan.families[p.family].disordered()) continue;
      if (largest == nullptr || p.exact.poisson.mean > largest->exact.poisson.mean) largest = &p;
    }
    text += fmt::format("  {:<16} {:.4f} ± {:.4f} ({})\n", to_string(weighting), largest->exact.poisson.mean,
                        largest->exact.poisson.standard_error, place(result, *largest));
  }
  return text;
}

/// The answer to the paper's open question, from the numbers.
std::string answer(const Result& result) {
  const auto equal = isotropic_points(result, SpringWeighting::uniform);
  const auto worst = [&](const Value& value) {
    double largest = 0;
    for (const Point* p : equal) largest = std::max(largest, std::abs(value(*p)));
    return largest;
  };
  std::string text = fmt::format(
      "On isotropic random assemblies of equal springs Abe's mean field errs by at most {:.3f} in nu, {:.2g} % in G "
      "and "
      "{:.2g} % in K\n(root mean square over disorder and kT/kN: {:.3f}, {:.2g} %, {:.2g} %).",
      worst(error_of_poisson), 100 * worst(error_of_shear), 100 * worst(error_of_bulk),
      root_mean_square(equal, error_of_poisson), 100 * root_mean_square(equal, error_of_shear),
      100 * root_mean_square(equal, error_of_bulk));
  for (std::size_t f = 0; f < result.plan.families.size(); ++f) {
    if (result.plan.families[f].isotropic()) continue;
    std::array<double, weightings.size()> anisotropy{};
    for (std::size_t w = 0; w < weightings.size(); ++w)
      for (std::size_t r = 0; r < result.plan.ratios.size(); ++r) anisotropy[w] += result.at(f, w, r).anisotropy.mean;
    text += fmt::format(
        "\nOn '{}', mean over kT/kN, the correction (11) changes the anisotropy by {}, springs k h/l by {}.",
        result.plan.families[f].name, percent(anisotropy[1] / anisotropy[0] - 1),
        percent(anisotropy[2] / anisotropy[0] - 1));
  }
  return text + "\n\n";
}

}  // namespace

std::string report(const Result& result) {
  const Plan& plan = result.plan;
  std::string text =
      "Abe (1996) on random assemblies: the mean field (21), (22) and the correction (11) beside the exact moduli\n\n";
  text += fmt::format(
      "{} periodic Delaunay cells of about {} equal discs of each kind, seeds {} to {}; rotation free; nu of plane "
      "strain.\n"
      "Exact: homogenized, mean over the cells. Mean field: phi, z and psi(theta) measured on the same cell.\n\n",
      plan.samples, plan.discs, plan.first_seed, plan.first_seed + static_cast<std::uint64_t>(plan.samples) - 1);
  if (!result.refusals.empty()) {
    text += fmt::format("{} without moduli, left out; the first: {}\n\n",
                        counted(static_cast<long long>(result.refusals.size()), "cell"), result.refusals.front());
  }
  text += describe_families(result) + "\n";
  for (std::size_t w = 0; w < weightings.size(); ++w) text += describe_weighting(result, w);
  text += "What it says\n\n" + answer(result) + conclude_errors(result) + conclude_disorder(result) +
          conclude_causes(result) + conclude_correction(result) + conclude_weighting(result) + conclude_bounds(result) +
          conclude_limit(result);
  return text;
}

}  // namespace equidem::mean_field
