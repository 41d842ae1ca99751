// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/motion/saved_state.hpp"

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

const std::vector<double>& SavedState::operator[](std::string_view name) const {
  const auto found = std::ranges::find(arrays, name, &SavedArray::name);
  if (found != arrays.end()) return found->values;
  bad_input(fmt::format("the saved state has no array '{}'", name), "this simulation saves one",
            "Continue with the case that the state was saved from");
}

std::vector<double>& SavedState::operator[](std::string_view name) {
  return const_cast<std::vector<double>&>(std::as_const(*this)[name]);
}

void refuse_saved_number(std::string_view array, double number) {
  bad_input(fmt::format("the array '{}' of the saved state has {} where no such number can be", array, number),
            "it is of another case, or damaged", "Continue with the case that the state was saved from");
}

std::vector<double> numbers_of(std::span<const DiscMotion> motions) {
  std::vector<double> numbers;
  numbers.reserve(3 * motions.size());
  for (const DiscMotion& motion : motions) numbers.insert(numbers.end(), {motion.u.x, motion.u.y, motion.theta});
  return numbers;
}

std::vector<DiscMotion> motions_of(std::span<const double> numbers) {
  std::vector<DiscMotion> motions(numbers.size() / 3);
  for (std::size_t k = 0; k < motions.size(); ++k)
    motions[k] = {{numbers[3 * k], numbers[3 * k + 1]}, numbers[3 * k + 2]};
  return motions;
}

}  // namespace equidem
