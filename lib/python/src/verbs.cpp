// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include <pybind11/stl.h>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/given.hpp"
#include "equidem/core/stopwatch.hpp"

#include "case_inputs.hpp"
#include "result.hpp"
#include "verb_run.hpp"

namespace equidem::python {
namespace {

/// Carry out a verb. Returns (JSON of the result, arrays, assembly or None, wall clock of the verb in s).
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
    seconds = watch.seconds();
    json = delivery.json();
  }
  return py::make_tuple(json, arrays_of(delivery.arrays), std::const_pointer_cast<Assembly>(delivery.assembly),
                        seconds);
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
  module.def("run_verb", run_verb);
  module.def("case_reference", case_file_page);
}

}  // namespace equidem::python
