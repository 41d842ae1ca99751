// SPDX-License-Identifier: GPL-3.0-or-later
#include "verbs.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include <pybind11/complex.h>
#include <pybind11/stl.h>

#include "equidem/core/given.hpp"
#include "equidem/core/stopwatch.hpp"

#include "case_inputs.hpp"
#include "result.hpp"

namespace equidem::python {
namespace {

/// A result as it was delivered, which its texts and a page can be made of.
struct Delivered {
  Delivery delivery;

  /// Report, units and labels, as JSON: made when they are asked for, since they take as long as the numbers.
  [[nodiscard]] std::string texts() const { return delivery.texts().json(); }
  /// The page; its case and figures are written into the folder.
  [[nodiscard]] std::string page(const std::string& folder) const {
    const LongWork working;
    return delivery.page_drawn_in(folder);
  }
};

/// What could not be delivered, a file or a figure, as warnings of Python: the numbers are there all the same.
void warn_of(const Results& results) {
  const Result* const found = find_result(results, "warnings");
  const auto* sentences = found != nullptr ? std::get_if<std::vector<std::string>>(&found->value.value) : nullptr;
  if (sentences == nullptr) return;
  const py::object in_python = py::module_::import("equidem.errors").attr("in_python");
  for (const std::string& sentence : *sentences) {
    const auto told = py::cast<std::string>(in_python(sentence));
    if (PyErr_WarnEx(PyExc_RuntimeWarning, told.c_str(), 1) != 0) throw py::error_already_set();
  }
}

/// Carry out a verb. Returns (JSON of the numbers, arrays, assembly or None where it is the given one, wall clock of
/// the verb in s, Delivered).
py::tuple run_verb(const std::string& verb, const std::string& case_text, const std::string& case_file,
                   const std::shared_ptr<Assembly>& assembly, std::vector<std::string> overrides,
                   std::vector<std::string> options) {
  if (!progress_wanted() && std::ranges::find(options, "--quiet") == options.end()) options.emplace_back("--quiet");
  const CaseInputs inputs(case_text, case_file, assembly, std::move(overrides));
  Delivery delivery;
  std::string json;
  double seconds = 0;
  {
    const LongWork working;
    const KeptSettings settings;
    const Stopwatch watch;
    delivery = VerbRun(verb, inputs.case_file(), inputs.overrides(), options)(Arrays::wanted);
    const bool is_given = assembly && delivery.assembly && delivery.assembly->size() == assembly->size();
    if (is_given) delivery.assembly.reset();
    seconds = watch.seconds();
    json = delivery.numbers().json();
  }
  warn_of(delivery.results);
  const py::dict arrays = arrays_of(std::exchange(delivery.arrays, {}));
  auto made = std::const_pointer_cast<Assembly>(std::exchange(delivery.assembly, nullptr));
  return py::make_tuple(json, arrays, std::move(made), seconds, Delivered{std::move(delivery)});
}

}  // namespace

py::dict arrays_of(const std::vector<ResultArray>& arrays) {
  py::dict result;
  for (const ResultArray& array : arrays) {
    const auto rows = static_cast<py::ssize_t>(array.rows), columns = static_cast<py::ssize_t>(array.columns);
    const py::array made = std::visit(
        [&](const auto* first) {
          const auto size = static_cast<py::ssize_t>(sizeof(*first));
          const py::ssize_t stride = static_cast<py::ssize_t>(array.stride) * size;
          return columns == 1 ? view(array.owner, first, {rows}, {stride})
                              : view(array.owner, first, {rows, columns}, {stride, size});
        },
        array.numbers);
    result[py::str(array.name)] = py::make_tuple(made, array.unit);
  }
  return result;
}

void bind_verbs(py::module_& module) {
  py::class_<Delivered>(module, "Delivered", made_here()).def("texts", &Delivered::texts).def("page", &Delivered::page);
  module.def("run_verb", run_verb);
  module.def("flags_of_verbs", flags_of_verbs);
}

}  // namespace equidem::python
