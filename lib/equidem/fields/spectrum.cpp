// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/fields/spectrum.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr double pi = std::numbers::pi;

/// Fits harmonic parts to one history.
class HarmonicFit {
 public:
  HarmonicFit(std::span<const double> times, std::span<const double> values)
      : times_(times), values_(values), weights_(times.size()) {
    assert(times.size() == values.size() && times.size() >= 2);
    duration_ = times.back() - times.front();
    for (std::size_t k = 0; k < times.size(); ++k) {
      const double root = std::sin(pi * (times[k] - times.front()) / duration_);
      weights_[k] = root * root;
    }
  }
  [[nodiscard]] double duration() const { return duration_; }

  struct Part {
    double amplitude = 0;
    double explained = 0;  ///< of the weighted sum of squares
  };
  [[nodiscard]] Part at(double frequency) const {
    // Normal equations of 1, t, cos, sin; time from the middle in half durations.
    std::array<std::array<double, 5>, 4> m{};
    const double middle = 0.5 * (times_.front() + times_.back());
    for (std::size_t k = 0; k < times_.size(); ++k) {
      const double phase = 2 * pi * frequency * (times_[k] - middle);
      const std::array<double, 5> row{1, 2 * (times_[k] - middle) / duration_, std::cos(phase), std::sin(phase),
                                      values_[k]};
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = a; b < 5; ++b) m[a][b] += weights_[k] * row[a] * row[b];
    }
    // L D L^T: the matrix is symmetric and positive.
    for (std::size_t p = 0; p < 4; ++p)
      for (std::size_t a = p + 1; a < 4; ++a) {
        const double factor = m[p][a] / m[p][p];
        for (std::size_t b = a; b < 5; ++b) m[a][b] -= factor * m[p][b];
      }
    const double sine = m[3][4] / m[3][3];
    const double cosine = (m[2][4] - m[2][3] * sine) / m[2][2];
    return {std::hypot(cosine, sine), m[2][4] * m[2][4] / m[2][2] + m[3][4] * m[3][4] / m[3][3]};
  }

 private:
  std::span<const double> times_, values_;
  std::vector<double> weights_;  // Hann's window
  double duration_ = 0;
};

}  // namespace

std::vector<double> amplitude_spectrum(std::span<const double> times, std::span<const double> values,
                                       std::span<const double> frequencies) {
  const HarmonicFit fit(times, values);
  std::vector<double> amplitudes;
  for (const double frequency : frequencies) amplitudes.push_back(fit.at(frequency).amplitude);
  return amplitudes;
}

SpectralPeak spectral_peak(std::span<const double> times, std::span<const double> values, double lowest,
                           double highest) {
  constexpr std::size_t fewest = 8;
  if (times.size() < fewest)
    bad_input(fmt::format("the history has {}", counted(times.size(), "moment")),
              fmt::format("a period needs {} or more", fewest), "Measure more often, or longer");
  const HarmonicFit fit(times, values);
  const double low = std::max(lowest, 1.5 / fit.duration());
  const double high = std::min(highest, 0.5 * static_cast<double>(times.size() - 1) / fit.duration());
  const double step = 0.25 / fit.duration();
  if (!(low + 2 * step < high))
    bad_input(fmt::format("no frequency lies between {:.4g} and {:.4g} Hz", low, high),
              fmt::format("the history lasts {:.4g} s and has {} moments", fit.duration(), times.size()),
              "Look longer or more often, or widen the bounds");
  std::vector<double> frequencies, explained;
  double f = low;
  while (f <= high) {
    frequencies.push_back(f);
    explained.push_back(fit.at(f).explained);
    f += step;
  }
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const auto at = static_cast<std::size_t>(std::max_element(explained.begin(), explained.end()) - explained.begin());
  if (at == 0 || at + 1 == explained.size() || !(*most > *least) ||
      !(fit.at(frequencies[at]).amplitude > 1e-12 * (*most - *least)))
    computation_failed(fmt::format("the history has no harmonic part between {:.4g} and {:.4g} Hz", low, high),
                       "its spectrum has no peak there", "Look longer, or widen the bounds");
  // The top of one peak: golden section.
  double a = frequencies[at - 1], b = frequencies[at + 1];
  constexpr double golden = 0.6180339887498949;
  double c = b - golden * (b - a), d = a + golden * (b - a);
  double at_c = fit.at(c).explained, at_d = fit.at(d).explained;
  while (b - a > 1e-9 * b) {
    if (at_c > at_d) {
      b = d;
      d = c;
      at_d = at_c;
      c = b - golden * (b - a);
      at_c = fit.at(c).explained;
    } else {
      a = c;
      c = d;
      at_c = at_d;
      d = a + golden * (b - a);
      at_d = fit.at(d).explained;
    }
  }
  const double top = 0.5 * (a + b);
  return {top, fit.at(top).amplitude, 2 / fit.duration()};
}

double sloshing_period(double width, double depth, double gravity) {
  assert(width > 0 && depth > 0 && gravity > 0);
  return 2 * pi / std::sqrt(pi * gravity / width * std::tanh(pi * depth / width));
}

}  // namespace equidem
