// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/study.hpp"

#include <span>

#include "equidem/core/checksum.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

std::string Setting::label() const {
  std::vector<std::string> words;
  if (!method.empty()) words.push_back(method);
  for (const auto& [name, value] : values) words.push_back(fmt::format("{} = {:.6g}", name, value));
  return joined(words);
}

const ExpectedOrder* Study::expected(const Setting& setting, const std::string& quantity) const {
  const auto fits = [](const std::string& wanted, const std::string& given) {
    return wanted.empty() || wanted == given;
  };
  for (const ExpectedOrder& order : orders) {
    if (fits(order.problem, setting.problem) && fits(order.method, setting.method) && fits(order.quantity, quantity))
      return &order;
  }
  return nullptr;
}

std::string Study::checksum(const std::string& context) const {
  Checksum sum;
  const auto add = [&](const std::string& text) {
    sum.add(std::as_bytes(std::span(text)));
    sum.add(std::uint64_t{text.size()});
  };
  add(context);
  add(name);
  add(fmt::format("{}", static_cast<int>(truth)));
  for (const Quantity& q : quantities) add(fmt::format("{} {} {} {}", q.name, q.fact, q.relative, q.truth));
  for (const StudyTask& task : tasks) {
    add(task.setting.problem);
    add(task.setting.method);
    for (const auto& [key, value] : task.setting.values) add(fmt::format("{} {}", key, value));
  }
  return sum.text();
}

}  // namespace equidem
