// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/names.hpp"

#include <algorithm>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

std::size_t tolerated(std::size_t letters) {
  return std::max<std::size_t>(letters < 4 ? 1 : 2, letters / 3);
}

}  // namespace

std::string alternatives(std::span<const std::string> names) {
  std::vector<std::string> quoted;
  for (const std::string& name : names) quoted.push_back(fmt::format("\"{}\"", name));
  return listed(std::move(quoted), " or ");
}

void refuse_name(std::string_view name, const char* what, std::span<const std::string> known) {
  const auto meant = nearest(name, known);
  bad_input(fmt::format("unknown {} '{}'", what, name), fmt::format("it must be {}", alternatives(known)),
            meant ? fmt::format("Did you mean \"{}\"?", *meant) : "Choose one of them");
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

std::optional<std::string> nearest(std::string_view name, std::span<const std::string> candidates) {
  std::optional<std::string> best;
  std::size_t least = tolerated(name.size()) + 1;
  // A word much longer than any key is none of them; its distance is not worth computing.
  if (name.size() > 100) return best;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < least && distance < candidate.size()) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace equidem
