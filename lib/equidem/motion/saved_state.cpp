// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/motion/saved_state.hpp"

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {
constexpr const char* of_the_same_case = "Continue with the case that the state was saved from";
}  // namespace

const SavedArray& SavedState::array(std::string_view name) const {
  const auto found = std::ranges::find(arrays, name, &SavedArray::name);
  if (found != arrays.end()) return *found;
  bad_input(fmt::format("the saved state has no array '{}'", name), "this simulation saves one", of_the_same_case);
}

std::vector<double>& SavedState::operator[](std::string_view name) {
  return const_cast<std::vector<double>&>(std::as_const(*this)[name]);
}

void refuse_saved_number(std::string_view array, double number) {
  bad_input(fmt::format("the array '{}' of the saved state has {} where no such number can be", array, number),
            "it is of another case, or damaged", of_the_same_case);
}

void check_rows(const SavedArray& array, std::size_t columns) {
  if (array.columns == columns && array.values.size() % columns == 0) return;
  bad_input(fmt::format("the array '{}' of the saved state has {} numbers in rows of {}", array.name,
                        array.values.size(), array.columns),
            fmt::format("{} belong into a row", columns), of_the_same_case);
}

std::vector<double> numbers_of(std::span<const DiscMotion> motions) {
  return saved_rows({}, std::vector<DiscMotion>(motions.begin(), motions.end()), motion_numbers).values;
}

std::vector<DiscMotion> motions_of(std::span<const double> numbers) {
  std::vector<DiscMotion> motions(numbers.size() / 3);
  for (std::size_t k = 0; k < motions.size(); ++k)
    motions[k] = {{numbers[3 * k], numbers[3 * k + 1]}, numbers[3 * k + 2]};
  return motions;
}

void Oscillation::add(double time, double value) {
  if (samples_++ > 0 && (value_ < 0) != (value < 0)) {
    const double passage = time_ + (time - time_) * value_ / (value_ - value);
    if (passages_++ == 0) {
      first_ = passage;
    } else {
      const double between = passage - last_;
      shortest_ = passages_ == 2 ? between : std::min(shortest_, between);
      longest_ = std::max(longest_, between);
    }
    last_ = passage;
  }
  time_ = time;
  value_ = value;
}

std::optional<double> Oscillation::period() const {
  if (passages_ < 2) return std::nullopt;
  return 2 * (last_ - first_) / static_cast<double>(passages_ - 1);
}

std::optional<double> Oscillation::spread() const {
  if (passages_ < 2) return std::nullopt;
  const double mean = *period() / 2;
  return std::max(longest_ - mean, mean - shortest_) / mean;
}

}  // namespace equidem
