// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"

#include "abe1996_random/abe1996_random.hpp"
#include "tables.hpp"

namespace equidem::abe1996_random {
namespace {

using Points = std::vector<const Point*>;

/// Round-off beside 1 is shown as 0.
double clean(double value) {
  return std::abs(value) < 1e-11 ? 0 : value;
}

std::string percent(double share) {
  return fmt::format("{:+.3g} %", 100 * clean(share));
}

/// Points of a weighting on isotropic random families; on all random ones where `anisotropic`.
Points random_points(const Result& result, SpringWeighting weighting, bool anisotropic = false) {
  Points chosen;
  for (const Point& p : result.points) {
    const Family& family = result.family_of(p);
    if (p.weighting == weighting && family.disordered() && (anisotropic || family.isotropic())) chosen.push_back(&p);
  }
  return chosen;
}

double root_mean_square(const Points& points, std::size_t number) {
  double squares = 0;
  for (const Point* p : points) squares += p->mean(number) * p->mean(number);
  return std::sqrt(squares / static_cast<double>(points.size()));
}

double largest(const Points& points, std::size_t number) {
  double size = 0;
  for (const Point* p : points) size = std::max(size, std::abs(p->mean(number)));
  return size;
}

std::string place(const Result& result, const Point& p) {
  return fmt::format("{}, kT/kN = {:g}", result.family_of(p).name, p.ratio);
}

std::string describe_families(const Result& result) {
  TextTable table("assemblies & branch lengths, sd/mean & contacts of a disc, sd & anisotropy of psi(theta) & phi & z");
  for (std::size_t f = 0; f < result.disorder.size(); ++f) {
    const Disorder& d = result.disorder[f];
    table.add("{} & {:.4f} & {:.3f} & {:.4f} & {:.4f} & {:.3f}", result.plan.families[f].name, d.branch_scatter,
              d.coordination_scatter, d.contact_anisotropy, d.solid_fraction, d.coordination_number);
  }
  return table.text();
}

std::string head_of_ratios(const Result& result, const std::string& first = "kT/kN") {
  std::string head = first;
  for (const double ratio : result.plan.ratios) head += fmt::format(" & {:g}", ratio);
  return head;
}

/// Families downwards, kT/kN to the right; means over the cells.
std::string grid(const Result& result, std::size_t weighting, const std::string& title, std::size_t number) {
  const bool shares = number == error_of(shear) || number == error_of(bulk);
  TextTable table(head_of_ratios(result));
  double error = 0;
  for (std::size_t f = 0; f < result.plan.families.size(); ++f) {
    std::string row = result.plan.families[f].name;
    for (std::size_t r = 0; r < result.plan.ratios.size(); ++r) {
      const MeanEstimate e = result.at(f, weighting, r).numbers[number];
      error = std::max(error, e.standard_error);
      constexpr double half_of_last_digit = 5e-5;
      const double value = std::abs(e.mean) < half_of_last_digit ? 0 : e.mean;  // without a sign
      row += shares ? fmt::format(" & {:+.2f} %", 100 * value) : fmt::format(" & {:.4f}", value);
    }
    table.add_row(row);
  }
  if (!shares) {
    std::string row = "mean field (1 - kT/kN)/4";
    for (std::size_t r = 0; r < result.plan.ratios.size(); ++r)
      row += fmt::format(" & {:.4f}", result.at(0, weighting, r).mean(mean_field, poisson));
    table.add_row(row);
  }
  return fmt::format("{} (standard errors up to {})\n{}\n", title,
                     shares ? fmt::format("{:.2g} %", 100 * error) : fmt::format("{:.2g}", error), table.text());
}

std::string describe_weighting(const Result& result, std::size_t weighting) {
  return fmt::format("Weighting \"{}\"\n", to_string(weightings[weighting])) +
         grid(result, weighting, "nu, exact", number_of(exact, poisson)) +
         grid(result, weighting, "G of the mean field over the exact one, less 1", error_of(shear)) +
         grid(result, weighting, "K of the mean field over the exact one, less 1", error_of(bulk));
}

std::string conclude_errors(const Result& result) {
  std::string text = "1. Errors of the mean field (mean field less exact) on isotropic random assemblies\n";
  for (const SpringWeighting weighting : weightings) {
    const Points points = random_points(result, weighting);
    text += fmt::format("  {}:\n", to_string(weighting));
    for (const auto& [modulus, name] : {std::pair{poisson, "nu"}, {shear, "G"}, {bulk, "K"}}) {
      const std::size_t error = error_of(modulus);
      const double size = largest(points, error);
      if (clean(size) == 0) {
        text += fmt::format("    {:<3} none: exact within {:.0e}\n", name, size);
        continue;
      }
      const auto shown = [&, m = modulus](const Point& p) {
        const std::string value = m == poisson ? fmt::format("{:+.4f}", p.mean(error)) : percent(p.mean(error));
        return fmt::format("{} ({})", value, place(result, p));
      };
      const auto [low, high] = std::minmax_element(points.begin(), points.end(), [&](const Point* a, const Point* b) {
        return a->mean(error) < b->mean(error);
      });
      text += fmt::format("    {:<3} from {} to {}\n", name, shown(**low), shown(**high));
    }
  }
  return text;
}

/// The exponent of |error| ~ disorder^p between the two least disordered lattices, and the errors against kT/kN.
std::string conclude_disorder(const Result& result) {
  std::vector<std::size_t> lattices;
  for (std::size_t f = 0; f < result.plan.families.size(); ++f) {
    const Family& family = result.plan.families[f];
    if (family.points == PointProcess::perturbed_hexagonal && family.disorder > 0) lattices.push_back(f);
  }
  if (lattices.size() < 2) return "";
  const double small = result.plan.families[lattices[0]].disorder, larger = result.plan.families[lattices[1]].disorder;
  Points regular;
  for (const Point& p : result.points)
    if (!result.family_of(p).disordered()) regular.push_back(&p);
  const double without = std::max(
      {largest(regular, error_of(poisson)), largest(regular, error_of(shear)), largest(regular, error_of(bulk))});
  std::string text = fmt::format(
      "2. Without disorder the error is {:.0e}. From disorder {:g} to {:g}, at kT/kN = {:g}, errors grow as "
      "disorder^p:\n",
      without, small, larger, result.plan.ratios.front());
  TextTable exponents(" & p of nu & p of G");
  TextTable against_ratio(head_of_ratios(result, "kT/kN, root mean square over isotropic random assemblies"));
  for (std::size_t w = 0; w < weightings.size(); ++w) {
    const std::string name = to_string(weightings[w]);
    const auto exponent = [&](Modulus m) {
      const double growth =
          result.at(lattices[1], w, 0).mean(error_of(m)) / result.at(lattices[0], w, 0).mean(error_of(m));
      return std::log(growth) / std::log(larger / small);
    };
    exponents.add("{} & {:.2f} & {:.2f}", name, exponent(poisson), exponent(shear));
    std::string nu = name + ": error of nu", g = name + ": error of G, %";
    for (const double ratio : result.plan.ratios) {
      Points points = random_points(result, weightings[w]);
      std::erase_if(points, [&](const Point* p) { return p->ratio != ratio; });
      nu += fmt::format(" & {:.4f}", root_mean_square(points, error_of(poisson)));
      g += fmt::format(" & {:.2f}", 100 * root_mean_square(points, error_of(shear)));
    }
    against_ratio.add_row(nu);
    against_ratio.add_row(g);
  }
  return text + exponents.text() + against_ratio.text();
}

/// Causes of the error of G, on the isotropic assembly with the widest scatter of branch lengths.
std::string conclude_causes(const Result& result) {
  std::size_t widest = 0;
  for (std::size_t f = 0; f < result.disorder.size(); ++f) {
    if (result.plan.families[f].isotropic() &&
        result.disorder[f].branch_scatter > result.disorder[widest].branch_scatter)
      widest = f;
  }
  const std::size_t r = result.plan.ratios.size() / 2;
  TextTable table(" & branch lengths & non-uniform strain & both");
  for (std::size_t w = 0; w < weightings.size(); ++w) {
    const Point& p = result.at(widest, w, r);
    const auto change = [&](Answer from, Answer to) { return percent(p.mean(to, shear) / p.mean(from, shear) - 1); };
    table.add("{} & {} & {} & {}", to_string(weightings[w]), change(mean_field, voigt), change(voigt, exact),
              change(mean_field, exact));
  }
  return fmt::format(
             "3. Two causes: branch lengths differ from 2a (Voigt against mean field), and discs depart from the "
             "uniform "
             "strain\n   (exact against Voigt). Change of G of '{}' at kT/kN = {:g}:\n",
             result.plan.families[widest].name, result.plan.ratios[r]) +
         table.text();
}

std::string conclude_correction(const Result& result) {
  const Points uniform = random_points(result, SpringWeighting::uniform);
  const Points corrected = random_points(result, SpringWeighting::contact_density);
  const double before = root_mean_square(uniform, error_of(poisson)),
               after = root_mean_square(corrected, error_of(poisson));
  std::size_t beyond = 0;
  for (std::size_t k = 0; k < uniform.size(); ++k) {
    const MeanEstimate &u = uniform[k]->numbers[number_of(exact, poisson)],
                       &c = corrected[k]->numbers[number_of(exact, poisson)];
    if (std::abs(c.mean - u.mean) > 2 * std::hypot(c.standard_error, u.standard_error)) ++beyond;
  }
  const Points local = random_points(result, SpringWeighting::local_contact_density);
  const double local_after = root_mean_square(local, error_of(poisson));
  std::size_t nearer = 0;
  for (std::size_t k = 0; k < uniform.size(); ++k)
    if (std::abs(local[k]->mean(error_of(poisson))) < std::abs(uniform[k]->mean(error_of(poisson)))) ++nearer;
  double uneven = 0;
  for (std::size_t f = 0; f < result.disorder.size(); ++f)
    if (result.plan.families[f].isotropic()) uneven = std::max(uneven, result.disorder[f].contact_anisotropy);
  std::string text = fmt::format(
      "4. The correction (11) on isotropic random assemblies: root mean square error of nu {:.4f} without it, {:.4f} "
      "with "
      "it\n   ({}); at {} of {} points nu changes by more than two standard errors. The correction {} there: the\n   "
      "anisotropy of psi(theta) is at most {:.3f}.\n",
      before, after, percent(after / before - 1), beyond, uniform.size(),
      after < 0.9 * before ? "helps" : "does not help", uneven);
  text += fmt::format(
      "   With a local psi, of the two discs of each contact alone (local_contact_density): {:.4f} ({}), smaller at {} "
      "of "
      "{}\n   points. Each disc then has the springs k times the angle that a contact has to itself, by which its sums "
      "over\n"
      "   contacts are the integrals (14) to the order of the trapezoidal rule.\n",
      local_after, percent(local_after / before - 1), nearer, uniform.size());
  for (std::size_t f = 0; f < result.plan.families.size(); ++f) {
    if (result.plan.families[f].isotropic()) continue;
    text += fmt::format("   '{}' (anisotropy of psi(theta) {:.3f}): anisotropy of the exact tensor, error of nu\n",
                        result.plan.families[f].name, result.disorder[f].contact_anisotropy);
    TextTable table("kT/kN & uniform & nu & contact_density & change & nu & voronoi & nu & local & nu");
    for (std::size_t r = 0; r < result.plan.ratios.size(); ++r) {
      const auto number = [&](std::size_t w, std::size_t n) { return result.at(f, w, r).mean(n); };
      const auto nu = [&](std::size_t w) { return number(w, error_of(poisson)); };
      table.add("{:g} & {:.4f} & {:+.4f} & {:.4f} & {} & {:+.4f} & {:.4f} & {:+.4f} & {:.4f} & {:+.4f}",
                result.plan.ratios[r], number(0, anisotropy), nu(0), number(1, anisotropy),
                percent(number(1, anisotropy) / number(0, anisotropy) - 1), nu(1), number(2, anisotropy), nu(2),
                number(3, anisotropy), nu(3));
    }
    text += table.text();
  }
  return text;
}

std::string conclude_weighting(const Result& result) {
  TextTable table("weighting & error of nu & error of G & error of K & scatter of G, one cell & anisotropy");
  std::array<std::array<double, 3>, weightings.size()> scores{};
  for (std::size_t w = 0; w < weightings.size(); ++w) {
    const Points points = random_points(result, weightings[w]);
    double squares = 0;
    for (const Point* p : points) {
      const MeanEstimate& g = p->numbers[number_of(exact, shear)];
      squares += std::pow(g.standard_deviation / g.mean, 2);
    }
    for (const Modulus m : {bulk, shear, poisson}) scores[w][m] = root_mean_square(points, error_of(m));
    table.add("{} & {:.4f} & {:.2f} % & {:.2f} % & {:.2f} % & {:.4f}", to_string(weightings[w]), scores[w][poisson],
              100 * scores[w][shear], 100 * scores[w][bulk],
              100 * std::sqrt(squares / static_cast<double>(points.size())), root_mean_square(points, anisotropy));
  }
  const auto best = [&](Modulus m) {
    const auto least =
        std::min_element(scores.begin(), scores.end(), [&](const auto& a, const auto& b) { return a[m] < b[m]; });
    return to_string(weightings[static_cast<std::size_t>(least - scores.begin())]);
  };
  double worst_bulk = 0;
  for (const Point& p : result.points)
    if (p.weighting == SpringWeighting::voronoi) worst_bulk = std::max(worst_bulk, std::abs(p.mean(error_of(bulk))));
  return "5. Weighting that the mean field describes best: root mean square over isotropic random assemblies and "
         "kT/kN\n" +
         table.text() +
         fmt::format(
             "   Best for nu: {}; for G: {}; for K: {}.\n"
             "   With springs k h/l, K = kN/2 within {:.0e} on all assemblies: under an isotropic strain the contact "
             "forces of a\n   disc are proportional to h n, their sum around the closed cell is zero, and every disc "
             "follows the uniform strain.\n",
             best(poisson), best(shear), best(bulk), worst_bulk);
}

std::string conclude_bounds(const Result& result) {
  std::size_t points = 0, below_voigt = 0, above_estimate = 0, between = 0;
  for (const SpringWeighting weighting : weightings) {
    for (const Point* p : random_points(result, weighting, true)) {
      ++points;
      constexpr double rounding = 1e-12;
      if (p->mean(exact, shear) <= p->mean(voigt, shear) * (1 + rounding)) ++below_voigt;
      if (p->mean(exact, shear) >= p->mean(uniform_stress, shear) * (1 - rounding)) ++above_estimate;
      const auto [low, high] = std::minmax({p->mean(voigt, poisson), p->mean(uniform_stress, poisson)});
      if (low - rounding <= p->mean(exact, poisson) && p->mean(exact, poisson) <= high + rounding) ++between;
    }
  }
  return fmt::format(
      "6. Of {} points, G is at most Voigt's in {} (a bound) and at least the uniform-stress estimate in {} (not a "
      "bound);\n   nu lies between those two in {}.\n",
      points, below_voigt, above_estimate, between);
}

std::string conclude_limit(const Result& result) {
  std::string text = "7. Largest nu of any of these assemblies with kT >= 0 (the mean field gives at most 1/4):\n";
  for (const SpringWeighting weighting : weightings) {
    const Points points = random_points(result, weighting, true);
    const Point& most = **std::max_element(points.begin(), points.end(), [](const Point* a, const Point* b) {
      return a->mean(exact, poisson) < b->mean(exact, poisson);
    });
    const MeanEstimate& nu = most.numbers[number_of(exact, poisson)];
    text += fmt::format("  {:<21} {:.4f} ± {:.4f} ({})\n", to_string(weighting), nu.mean, nu.standard_error,
                        place(result, most));
  }
  return text;
}

/// The answer to the paper's open question, from the numbers.
std::string answer(const Result& result) {
  const Points equal = random_points(result, SpringWeighting::uniform);
  const auto both = [&](const auto& measure) {
    return fmt::format("{:.3f} in nu, {:.2g} % in G and {:.2g} % in K", measure(equal, error_of(poisson)),
                       100 * measure(equal, error_of(shear)), 100 * measure(equal, error_of(bulk)));
  };
  std::string text = fmt::format(
      "On isotropic random assemblies of equal springs the error of Abe's mean field is at most {}\n"
      "(root mean square over disorder and kT/kN: {}).",
      both(largest), both(root_mean_square));
  const Points local = random_points(result, SpringWeighting::local_contact_density);
  const double before = root_mean_square(equal, error_of(poisson)), after = root_mean_square(local, error_of(poisson));
  text += fmt::format(
      "\nSprings by the local psi of the discs of each contact change the root mean square error of nu to {:.4f} ({}), "
      "and "
      "its\nlargest to {:.3f}; errors of G and K: {:.2g} % and {:.2g} % (root mean square).",
      after, percent(after / before - 1), largest(local, error_of(poisson)),
      100 * root_mean_square(local, error_of(shear)), 100 * root_mean_square(local, error_of(bulk)));
  for (std::size_t f = 0; f < result.plan.families.size(); ++f) {
    if (result.plan.families[f].isotropic()) continue;
    std::array<double, weightings.size()> sum{};
    for (std::size_t w = 0; w < weightings.size(); ++w)
      for (std::size_t r = 0; r < result.plan.ratios.size(); ++r) sum[w] += result.at(f, w, r).mean(anisotropy);
    text += fmt::format(
        "\nOn '{}', mean over kT/kN, the correction (11) changes the anisotropy by {}, springs k h/l by {}.",
        result.plan.families[f].name, percent(sum[1] / sum[0] - 1), percent(sum[2] / sum[0] - 1));
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
  return text + "Conclusions\n\n" + answer(result) + conclude_errors(result) + conclude_disorder(result) +
         conclude_causes(result) + conclude_correction(result) + conclude_weighting(result) + conclude_bounds(result) +
         conclude_limit(result);
}

}  // namespace equidem::abe1996_random
