// SPDX-License-Identifier: GPL-3.0-or-later
#include "homogenize/ensemble_report.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// K, G and nu: the others follow from them.
constexpr std::size_t told_quantities = 3;
constexpr std::size_t anisotropy_index = ensemble_quantities.size() - 1;

std::string shown(double value, int digits) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}g}", value, digits);
}

std::string rounded_percent(double share) {
  return fmt::format("{:.3g} %", 100 * share);
}

std::string table_of(const EnsembleStatistics& statistics, std::size_t quantity) {
  const EnsembleQuantity& q = ensemble_quantities[quantity];
  std::string text = fmt::format("{}{}\n", q.symbol, q.modulus ? ", Pa" : "");
  text += fmt::format("    discs  cells            mean   {:>4} % interval of the mean    sd of one cell   sd/mean\n",
                      fmt::format("{:.4g}", 100 * statistics.confidence));
  for (const EnsembleSize& size : statistics.sizes) {
    const MeanEstimate& e = size.estimates[quantity];
    const double relative = e.mean != 0 ? e.standard_deviation / std::abs(e.mean) : MeanEstimate::unknown;
    text += fmt::format("  {:>7}  {:>5}  {:>14}   {:>12} .. {:<12}  {:>15}   {:>7}\n", size.discs, e.samples,
                        shown(e.mean, 7), shown(e.low(), 6), shown(e.high(), 6), shown(e.standard_deviation, 3),
                        std::isnan(relative) ? "-" : rounded_percent(relative));
  }
  return text;
}

std::string describe_scatter(const SizeDependence& d, double confidence) {
  if (!d.measured_exponent) return "";
  const double t = student_critical_value(confidence, d.freedom);
  const double error = t * d.exponent_error;
  constexpr double too_wide = 0.5;  // an error that does not tell the exponent from 0
  if (d.exponent == 0.5 && error > too_wide) {
    return fmt::format(
        "  these samples do not tell how the scatter falls with size (exponent known to ± {:.2g}); N^-1/2 of many "
        "independent patches is used below\n",
        error);
  }
  const std::string text =
      fmt::format("  scatter {} as N^{:.2f} (± {:.2f}): ", *d.measured_exponent < 0 ? "grows" : "falls",
                  -*d.measured_exponent, error);
  if (d.exponent == 0.5) return text + "compatible with N^-1/2 of many independent patches, which is used below\n";
  return text + "not the N^-1/2 of many independent patches; the exponent measured is used below\n";
}

std::string describe_drift(const EnsembleStatistics& statistics, std::size_t quantity) {
  const SizeDependence& d = statistics.dependence[quantity];
  if (!d.limit) return "";
  const double t = student_critical_value(statistics.confidence, d.freedom);
  const char* unit = ensemble_quantities[quantity].modulus ? " Pa" : "";
  const EnsembleSize& largest = statistics.sizes.back();
  if (!d.drifts) {
    return fmt::format("  size: no drift seen; mean = limit + b/N would have b = {:.3g} ± {:.2g}{}\n", d.drift,
                       t * d.drift_error, unit);
  }
  return fmt::format(
      "  size: the mean drifts as {:.6g} + {:.3g}/N{} (limit ± {:.2g}, b ± {:.2g}): at N = {:.0f} it is still "
      "{:.2g}{} from the limit\n",
      *d.limit, d.drift, unit, t * d.limit_error, t * d.drift_error, largest.mean_discs,
      std::abs(d.drift) / largest.mean_discs, unit);
}

std::string describe_need(const EnsembleResult& result, std::size_t quantity) {
  const EnsembleStatistics& statistics = result.statistics;
  const SizeDependence& d = statistics.dependence[quantity];
  const char* symbol = ensemble_quantities[quantity].symbol;
  const double confidence = statistics.confidence;
  if (!d.scattered) {
    const bool several = statistics.sizes.front().estimates[quantity].samples > 1;
    return several ? "  all cells agree to round-off: any size does\n" : "";
  }
  const EnsembleSize& largest = statistics.sizes.back();
  const double one =
      student_critical_value(confidence, d.freedom) * d.amplitude * std::pow(largest.mean_discs, -d.exponent);
  const char* unit = ensemble_quantities[quantity].modulus ? " Pa" : "";
  std::string text;
  if (largest.estimates[quantity].samples > 0) {
    text += fmt::format(
        "  with {} confidence one cell of {:.0f} discs lies within {:.2g}{} of the mean, the mean of {} within "
        "{:.2g}{}\n",
        rounded_percent(confidence), largest.mean_discs, one, unit, result.plan.samples,
        one / std::sqrt(result.plan.samples), unit);
  }
  if (!result.accuracy) return text;
  const auto alone = needed_discs(statistics, quantity, *result.accuracy, 1);
  const auto averaged = needed_discs(statistics, quantity, *result.accuracy, result.plan.samples);
  if (!alone || !averaged) {
    return text + fmt::format("  {} is 0 within its error, or its scatter does not fall: no size reaches {} of it\n",
                              symbol, rounded_percent(*result.accuracy));
  }
  const auto smallest = std::find_if(statistics.sizes.begin(), statistics.sizes.end(),
                                     [&](const EnsembleSize& size) { return size.estimates[quantity].samples > 0; });
  const auto discs = [&](std::int64_t needed) {
    return fmt::format("{} discs{}", needed, static_cast<double>(needed) < smallest->mean_discs + 1 ? " at most" : "");
  };
  return text + fmt::format("  {} of {} with {} confidence needs one cell of {}, or the mean of {} cells of {}\n",
                            rounded_percent(*result.accuracy), symbol, rounded_percent(confidence), discs(*alone),
                            result.plan.samples, discs(*averaged));
}

std::string describe_refusals(const EnsembleResult& result) {
  std::string text;
  int refused = 0;
  constexpr int named = 5;
  for (const EnsembleSample& sample : result.samples) {
    if (!sample.refused()) continue;
    if (refused++ < named) text += fmt::format("  {} discs, seed {}: {}\n", sample.discs, sample.seed, sample.refusal);
  }
  if (refused == 0) return "";
  if (refused > named) text += fmt::format("  and {} more, named in samples.csv\n", refused - named);
  return fmt::format("{} of {} have no moduli; the means are those of the others, not of all such cells:\n",
                     counted(refused, "cell"), result.samples.size()) +
         text + "\n";
}

JsonObject estimate_json(const MeanEstimate& e) {
  JsonObject object;
  object.set("mean", e.mean).set("standard_deviation", e.standard_deviation).set("standard_error", e.standard_error);
  object.set("confidence_interval", std::vector<double>{e.low(), e.high()});
  return object;
}

/// One value for each quantity, under the keys of `equidem homogenize`.
template <typename Value>
void set_by_quantity(JsonObject& object, const Value& value, bool with_anisotropy) {
  object.set("bulk_modulus_2d", value(0)).set("shear_modulus", value(1));
  object.set("poisson_ratio", JsonObject().set("plane_strain", value(2)).set("plane_stress", value(3)));
  object.set("young_modulus", JsonObject().set("plane_strain", value(4)).set("plane_stress", value(5)));
  if (with_anisotropy) object.set("anisotropy", value(anisotropy_index));
}

}  // namespace

std::string describe_ensemble(const EnsembleResult& result) {
  const EnsembleStatistics& statistics = result.statistics;
  std::string text = describe_refusals(result);
  for (std::size_t q = 0; q < ensemble_quantities.size(); ++q) {
    text += table_of(statistics, q);
    if (q < told_quantities) {
      text += describe_scatter(statistics.dependence[q], statistics.confidence);
      text += describe_drift(statistics, q);
      text += describe_need(result, q);
    }
    text += "\n";
  }
  return text;
}

void add_ensemble(JsonObject& object, const EnsembleResult& result) {
  const EnsembleStatistics& statistics = result.statistics;
  object.set("confidence", statistics.confidence);
  if (result.accuracy)
    object.set("accuracy", *result.accuracy);
  else
    object.set_null("accuracy");
  std::vector<JsonObject> sizes;
  for (const EnsembleSize& size : statistics.sizes) {
    JsonObject one;
    one.set("discs", size.discs).set("mean_discs", size.mean_discs);
    one.set("samples", size.estimates.front().samples).set("refused", size.refused);
    set_by_quantity(
        one, [&](std::size_t q) { return estimate_json(size.estimates[q]); }, true);
    sizes.push_back(std::move(one));
  }
  object.set("ensemble", sizes);

  JsonObject exponent, limit, needed;
  set_by_quantity(
      exponent,
      [&](std::size_t q) {
        const SizeDependence& d = statistics.dependence[q];
        JsonObject one;
        one.set("value", d.measured_exponent.value_or(MeanEstimate::unknown));
        one.set("standard_error", d.measured_exponent ? d.exponent_error : MeanEstimate::unknown);
        return one.set("used", d.exponent);
      },
      false);
  set_by_quantity(
      limit,
      [&](std::size_t q) {
        const SizeDependence& d = statistics.dependence[q];
        const double unknown = MeanEstimate::unknown;
        JsonObject one;
        one.set("value", d.limit.value_or(unknown)).set("standard_error", d.limit ? d.limit_error : unknown);
        one.set("drift", d.limit ? d.drift : unknown);
        one.set("drift_standard_error", d.limit ? d.drift_error : unknown);
        return one.set("drifts", d.drifts);
      },
      false);
  set_by_quantity(
      needed,
      [&](std::size_t q) {
        JsonObject one;
        const auto add = [&](const char* key, std::int64_t samples) {
          const auto discs = result.accuracy ? needed_discs(statistics, q, *result.accuracy, samples) : std::nullopt;
          if (discs)
            one.set(key, *discs);
          else
            one.set_null(key);
        };
        add("one_cell", 1);
        add("mean_of_samples", result.plan.samples);
        return one;
      },
      false);
  object.set("scatter_exponent", exponent).set("size_limit", limit).set("needed_discs", needed);

  std::vector<JsonObject> refusals;
  for (const EnsembleSample& sample : result.samples) {
    if (!sample.refused()) continue;
    refusals.push_back(JsonObject().set("discs", sample.discs).set("seed", sample.seed).set("why", sample.refusal));
  }
  object.set("refusals", refusals);
}

}  // namespace equidem
