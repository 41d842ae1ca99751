// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/size_distribution.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr double cut = 3;  // standard deviations of log_normal

/// e^x by its series, for |x| < 700; the one of the C library may differ in the last bit from machine to machine.
double exponential(double x) {
  const double halvings = std::nearbyint(x / std::numbers::ln2);
  const double rest = x - halvings * std::numbers::ln2;
  double sum = 1;
  for (int k = 22; k >= 1; --k) sum = 1 + sum * rest / k;
  return std::ldexp(sum, static_cast<int>(halvings));
}

/// ln x by Newton's method on it.
double logarithm(double x) {
  int power = 0;
  const double fraction = std::frexp(x, &power);
  double y = fraction - 1;
  for (int k = 0; k < 8; ++k) {
    const double e = exponential(y);
    y += 2 * (fraction - e) / (fraction + e);
  }
  return y + power * std::numbers::ln2;
}

/// Integral of the normal density from -infinity to x by the series of Abramowitz & Stegun (26.2.11), |x| <= 4.
double normal_share(double x) {
  double term = x, sum = x;
  for (int k = 1; k < 120 && std::abs(term) > 1e-18; ++k) {
    term *= x * x / (2 * k + 1);
    sum += term;
  }
  constexpr double inverse_root = 0.39894228040143267794;  // 1/sqrt(2 pi)
  return 0.5 + inverse_root * exponential(-0.5 * x * x) * sum;
}

/// The x in [-cut, cut] below which the share p of the normal distribution cut there lies, by bisection.
double cut_normal_quantile(double p) {
  const double low_share = normal_share(-cut), high_share = normal_share(cut);
  const double wanted = low_share + p * (high_share - low_share);
  double low = -cut, high = cut;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (normal_share(middle) < wanted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Number of grains between two sieves over their mass, up to a common factor: the mean of 1/d² over ln d.
double grains_per_mass(double d1, double d2) {
  const double a = 1 / (d1 * d1), b = 1 / (d2 * d2);
  return (a - b) / (2 * logarithm(d2 / d1));
}

/// Shares of the grains below each sieve, by number.
std::vector<double> shares_by_number(const std::vector<Sieve>& sieves) {
  std::vector<double> below(sieves.size(), 0);
  for (std::size_t k = 1; k < sieves.size(); ++k) {
    below[k] = below[k - 1] + (sieves[k].passing - sieves[k - 1].passing) *
                                  grains_per_mass(sieves[k - 1].diameter, sieves[k].diameter);
  }
  for (double& share : below) share /= below.back();
  return below;
}

/// The radius below which the share p of the grains lies.
double quantile(const SizeDistribution& sizes, const std::vector<double>& below, double p) {
  switch (sizes.kind) {
    case SizeDistribution::Kind::uniform:
      return sizes.smallest + p * (sizes.largest - sizes.smallest);
    case SizeDistribution::Kind::log_normal:
      return sizes.median * exponential(sizes.deviation * cut_normal_quantile(p));
    case SizeDistribution::Kind::sieve_curve:
      break;
  }
  std::size_t k = 1;
  while (k + 1 < below.size() && below[k] <= p) ++k;
  // Between two sieves mass is uniform in ln d, so that numbers go as d^-3 dd and 1/d² is uniform.
  const double within = (p - below[k - 1]) / (below[k] - below[k - 1]);
  const double a = 1 / (sizes.sieves[k - 1].diameter * sizes.sieves[k - 1].diameter);
  const double b = 1 / (sizes.sieves[k].diameter * sizes.sieves[k].diameter);
  return 0.5 / std::sqrt(a - within * (a - b));
}

}  // namespace

void check(const SizeDistribution& sizes) {
  switch (sizes.kind) {
    case SizeDistribution::Kind::uniform:
      if (is_size(sizes.smallest) && is_size(sizes.largest) && sizes.smallest <= sizes.largest) return;
      bad_input(
          fmt::format("radii from {} to {} m", sizes.smallest, sizes.largest),
          "the first is the smaller, both are from 1e-60 to 1e60, so that areas and moments of inertia are numbers",
          "Correct them: lengths are in m");
    case SizeDistribution::Kind::log_normal:
      if (is_size(sizes.median) && sizes.deviation >= 0 && sizes.deviation <= 2) return;
      bad_input(fmt::format("radii with the median {} m and the deviation {}", sizes.median, sizes.deviation),
                "the median is from 1e-60 to 1e60, the deviation of the logarithm from 0 to 2", "Correct them");
    case SizeDistribution::Kind::sieve_curve:
      break;
  }
  const auto& sieves = sizes.sieves;
  if (sieves.size() >= 2 && sieves.front().passing > sieves.back().passing) {
    bad_input("the sieve curve descends", "it begins with the smallest diameter, which nothing passes",
              "Write its rows in the opposite order");
  }
  if (sieves.size() >= 2 && sieves.front().passing == 0 && sieves.back().passing == 100) {
    bad_input("the sieve curve runs to 100", "what passes is a share of the mass, from 0 to 1, not in %",
              "Divide it by 100");
  }
  if (sieves.size() < 2 || sieves.front().passing != 0 || sieves.back().passing != 1) {
    bad_input("the sieve curve does not run from 0 to 1", "all of the mass lies between its first and last diameter",
              "Begin with a share of 0 and end with 1");
  }
  for (std::size_t k = 0; k < sieves.size(); ++k) {
    const bool ascends =
        k == 0 || (sieves[k].diameter > sieves[k - 1].diameter && sieves[k].passing >= sieves[k - 1].passing);
    if (is_size(sieves[k].diameter) && std::isfinite(sieves[k].passing) && ascends) continue;
    bad_input(fmt::format("point {} of the sieve curve is {} m, {}", k + 1, sieves[k].diameter, sieves[k].passing),
              "diameters ascend, from 1e-60 to 1e60 m, and what passes never falls", "Correct it");
  }
}

std::vector<Sieve> read_sieve_curve(const std::filesystem::path& path) {
  const std::vector<std::string> diameters = {"diameter", "d", "sieve", "size", "sieve_size", "grain_size", "opening"};
  const std::vector<std::string> shares = {"passing", "finer", "share", "share_passing", "cumulative"};
  TableFile file(path, {diameters, shares});
  std::size_t diameter = 0, passing = 1;
  if (!file.names().empty()) {
    const std::string why = "a sieve curve has the diameters and the share of the mass that passes";
    diameter = file.need(diameters, why);
    passing = file.need(shares, why);
  }
  const double metres = file.factor(diameter, Dimension::length).value_or(1);
  const double share = file.factor(passing, Dimension::share).value_or(1);
  std::vector<Sieve> sieves;
  while (file.next()) {
    if (file.names().empty() && file.width() != 2) {
      file.refuse_decimal_commas();
      file.fail(fmt::format("the row has {}", counted(std::ssize(file.cells()), "cell")),
                "a diameter in m and a share passing are needed", "Write two numbers with a comma between them");
    }
    // 100 % is 1 to the last bit.
    const double passes = file.number(passing, "share passing");
    sieves.push_back({metres * file.number(diameter, "diameter"), share < 1 ? passes / 100 : passes});
  }
  try {
    check(SizeDistribution{.kind = SizeDistribution::Kind::sieve_curve, .sieves = sieves});
  } catch (const Error& error) {
    throw error.at(path.string());
  }
  return sieves;
}

std::vector<double> draw_radii(const SizeDistribution& sizes, std::int64_t count, Random& random) {
  check(sizes);
  const bool curve = sizes.kind == SizeDistribution::Kind::sieve_curve;
  const std::vector<double> below = curve ? shares_by_number(sizes.sieves) : std::vector<double>{};
  std::vector<double> radii(static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < radii.size(); ++k) {
    radii[k] = quantile(sizes, below, (static_cast<double>(k) + random.uniform()) / static_cast<double>(count));
  }
  for (std::size_t k = radii.size(); k > 1; --k) std::swap(radii[k - 1], radii[random.below(k)]);
  return radii;
}

RadiusMoments moments_of(const SizeDistribution& sizes) {
  check(sizes);
  if (sizes.kind == SizeDistribution::Kind::uniform) {
    const double a = sizes.smallest, b = sizes.largest;
    return {0.5 * (a + b), (a * a + a * b + b * b) / 3};
  }
  if (sizes.kind == SizeDistribution::Kind::log_normal) {
    // E[r^k] = median^k exp(k² s²/2) [Phi(cut - k s) - Phi(-cut - k s)]/[Phi(cut) - Phi(-cut)]
    const auto share = [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); };
    const auto moment = [&](double k) {
      const double s = sizes.deviation;
      return std::pow(sizes.median, k) * std::exp(0.5 * k * k * s * s) * (share(cut - k * s) - share(-cut - k * s)) /
             (share(cut) - share(-cut));
    };
    return {moment(1), moment(2)};
  }
  // Mass is that of discs: with the mass uniform in ln d between sieves, E[r^k] over numbers is the integral of
  // d^(k-2).
  double numbers = 0, lengths = 0, squares = 0;
  for (std::size_t k = 1; k < sizes.sieves.size(); ++k) {
    const double d1 = sizes.sieves[k - 1].diameter, d2 = sizes.sieves[k].diameter;
    const double mass = sizes.sieves[k].passing - sizes.sieves[k - 1].passing;
    numbers += mass * grains_per_mass(d1, d2);
    lengths += mass * (1 / d1 - 1 / d2) / std::log(d2 / d1);
    squares += mass;
  }
  return {0.5 * lengths / numbers, 0.25 * squares / numbers};
}

namespace {

/// Those of grains and box that are not given.
std::vector<std::string> missing_amounts(const PackingAmount& amount) {
  std::vector<std::string> missing;
  if (!amount.grains) missing.emplace_back("grains");
  if (!amount.box) missing.emplace_back("box");
  return missing;
}

/// Says that sizes and box do not fit together, and that one of them is probably in mm.
[[noreturn]] void refuse_number(double wanted, Vec2 box, double diameter) {
  constexpr double few = 1, many = 1e7;
  const std::string number = wanted < few ? "less than one body" : fmt::format("{:.3g} bodies", wanted);
  bad_input_at("box",
               fmt::format("{} of {:.3g} m in diameter would fill the box of {:.4g} m by {:.4g} m", number, diameter,
                           box.x, box.y),
               fmt::format("they are {} to {}", few, many),
               fmt::format("Change the box or the radii: all lengths are in m, and {} may be in mm",
                           wanted < few ? "the radii or sieves" : "the box"));
}

void check(const PackingAmount& amount, const PackingOptions& options) {
  const bool falls = entry_of(options.method).open_top, dense = options.as_dense_as_possible;
  if (falls && options.box.periodic())
    bad_input_at("sides", "bodies fall into a periodic box", "they would never come to rest",
                 "Take walls, or another method");
  if (falls && (amount.solid_fraction || dense))
    bad_input_at("solid_fraction", "a solid fraction is asked for falling bodies",
                 "it results from the fall, lower with more friction", "Remove it");
  if (dense && !entry_of(options.method).as_dense_as_possible)
    bad_input_at("solid_fraction", fmt::format("solid_fraction = \"auto\" with {}", to_string(options.method)),
                 "the method has no rule to stop", "Give a number, or take growth");
  const int given =
      int{amount.grains.has_value()} + int{amount.box.has_value()} + int{amount.solid_fraction.has_value()};
  if (given > 2)
    bad_input("grains, box and solid_fraction are all given",
              falls || dense ? "grains and box give the amount" : "two of them give the third", "Remove one of them");
  if (given < 2 && dense)
    bad_input_at("solid_fraction",
                 fmt::format("solid_fraction = \"auto\" without {}", listed(missing_amounts(amount), " and ")),
                 "as dense as the method gets is no amount: grains and box give it",
                 "Add them, or give solid_fraction a number");
  if (given < 2)
    bad_input("the amount to pack is missing",
              falls || dense ? "grains and box give it" : "two of grains, box and solid_fraction give it",
              "Give two of them");
  if (amount.box && !(is_size(amount.box->x) && is_size(amount.box->y)))
    bad_input_at("box", fmt::format("the box is {} m by {} m", amount.box->x, amount.box->y),
                 "width and height are positive, from 1e-60 to 1e60 m, so that its area is a number", "Correct it");
}

}  // namespace

void set_amount(const PackingAmount& amount, const SizeDistribution& sizes, PackingOptions& options) {
  check(amount, options);
  Random random(~options.seed);  // sizes are independent of places
  if (amount.box) options.box.size = *amount.box;
  std::int64_t count = amount.grains.value_or(0);
  if (!amount.grains) {
    const double mean_area = unit_body_of(options.shape).area * moments_of(sizes).mean_square;
    const double wanted = std::round(*amount.solid_fraction * options.box.area() / mean_area);
    if (!(wanted >= 1 && wanted <= 1e7))
      refuse_number(wanted, options.box.size, 2 * std::sqrt(moments_of(sizes).mean_square));
    count = static_cast<std::int64_t>(wanted);
  }
  options.radii = draw_radii(sizes, count, random);
  if (!amount.box) {
    const double area = area_of(options.shape, options.radii) / *amount.solid_fraction;
    options.box.size = {std::sqrt(area * amount.aspect), std::sqrt(area / amount.aspect)};
  } else if (!amount.grains) {
    const double scale = std::sqrt(*amount.solid_fraction * options.box.area() / area_of(options.shape, options.radii));
    for (double& radius : options.radii) radius *= scale;
  }
}

ScalablePacking resized(ScalablePacking packing, std::int64_t grains, std::uint64_t seed) {
  PackingAmount& amount = packing.amount;
  if (amount.box && amount.grains) {
    *amount.box *= std::sqrt(static_cast<double>(grains) / static_cast<double>(*amount.grains));
  } else if (amount.box) {
    amount.aspect = amount.box->x / amount.box->y;
    amount.box.reset();
  }
  amount.grains = grains;
  packing.seed = seed;
  set_amount(amount, packing.sizes, packing);
  return packing;
}

}  // namespace equidem
