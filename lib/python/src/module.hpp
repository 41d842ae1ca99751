// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The parts of the extension module equidem._core. Arguments arrive checked by the Python files of the package: arrays
/// have their type and shape.
#pragma once

#include <memory>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "equidem/core/stopwatch.hpp"

namespace equidem::python {

namespace py = pybind11;

/// Objects of a class come from functions of the module alone: Python cannot make one without its C++ part.
inline py::custom_type_setup made_here() {
  return py::custom_type_setup(
      [](PyHeapTypeObject* type) { type->ht_type.tp_flags |= Py_TPFLAGS_DISALLOW_INSTANTIATION; });
}

void bind_assembly(py::module_& module);
void bind_contacts(py::module_& module);
void bind_cases(py::module_& module);

using Floats = py::array_t<double, py::array::c_style>;
using Integers = py::array_t<std::int32_t, py::array::c_style>;

/// Work without the global lock. On Python's main thread Ctrl-C ends it with an Error of kind interrupted.
class LongWork {
 public:
  LongWork();

 private:
  std::unique_ptr<InterruptCatcher> catcher_;
  py::gil_scoped_release released_;
};

/// Whether progress is shown; verbs of the program decide by their option --quiet.
bool progress_wanted();

/// Threads and progress are afterwards as the user has set them: verbs set their own.
class KeptSettings {
 public:
  KeptSettings();
  ~KeptSettings();
  KeptSettings(const KeptSettings&) = delete;
  KeptSettings& operator=(const KeptSettings&) = delete;

 private:
  int threads_;
};

/// Do a task as LongWork.
template <class Task>
auto without_lock(const Task& task) {
  const LongWork working;
  return task();
}

enum class Access { read_only, writable };
/// An array in memory that `owner` keeps.
/// \param strides in bytes
template <class Number>
py::array view(std::shared_ptr<const void> owner, const Number* first, std::vector<py::ssize_t> shape,
               std::vector<py::ssize_t> strides, Access access = Access::read_only) {
  using Owner = std::shared_ptr<const void>;
  const py::capsule keeper(new Owner(std::move(owner)), [](void* kept) { delete static_cast<Owner*>(kept); });
  py::array result(py::dtype::of<Number>(), std::move(shape), std::move(strides), first, keeper);
  if (access == Access::read_only) result.attr("setflags")(py::arg("write") = false);
  return result;
}

/// Views the items of a vector: `columns` numbers of each, from `first` on, `step` bytes apart.
template <class Item, class Number>
py::array columns_of(const std::shared_ptr<const void>& owner, const std::vector<Item>& items, Number Item::*first,
                     py::ssize_t columns, py::ssize_t step = sizeof(Number)) {
  const auto rows = static_cast<py::ssize_t>(items.size());
  const Number* start = items.empty() ? nullptr : &(items.front().*first);
  if (columns == 1) return view(owner, start, {rows}, {sizeof(Item)});
  return view(owner, start, {rows, columns}, {sizeof(Item), step});
}

/// A vector of numbers as a writable array that owns it.
template <class Number>
py::array owned(std::vector<Number> numbers, std::vector<py::ssize_t> shape) {
  const auto owner = std::make_shared<const std::vector<Number>>(std::move(numbers));
  std::vector<py::ssize_t> strides(shape.size(), sizeof(Number));
  for (std::size_t k = shape.size(); k-- > 1;) strides[k - 1] = strides[k] * shape[k];
  return view(std::shared_ptr<const void>(owner), owner->data(), std::move(shape), std::move(strides),
              Access::writable);
}

}  // namespace equidem::python
