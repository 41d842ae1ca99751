// SPDX-License-Identifier: GPL-3.0-or-later
#include "matrix_file.hpp"

#include <fstream>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/assemble_stiffness.hpp"

#include "problem.hpp"

namespace equidem::bench {
namespace {

template <class Number>
void put(std::ofstream& file, const std::vector<Number>& numbers) {
  file.write(reinterpret_cast<const char*>(numbers.data()),
             static_cast<std::streamsize>(numbers.size() * sizeof(Number)));
}

}  // namespace

void write_matrix_file(const std::string& path, const std::string& kind, std::int64_t discs) {
  const Problem problem = build_problem(kind, discs);
  const ContactGraph graph(problem.assembly);
  const StiffnessMatrix matrix = assemble_stiffness(problem.assembly, graph, problem.springs, problem.unknowns);
  const CompressedColumns columns = compress(matrix, problem.assembly, graph, problem.unknowns);
  const auto per_disc = problem.unknowns.per_disc;
  std::vector<double> load, x, y;
  std::vector<std::int32_t> component;
  for (const std::int64_t k : columns.component) {
    load.push_back(problem.load[static_cast<std::size_t>(k)]);
    const Vec2 place =
        problem.assembly.centres[static_cast<std::size_t>(k / per_disc)] / problem.unknowns.rotation_scale;
    x.push_back(place.x);
    y.push_back(place.y);
    component.push_back(static_cast<std::int32_t>(k % per_disc));
  }
  std::ofstream file(path, std::ios::binary);
  put<std::int64_t>(file, {columns.size, static_cast<std::int64_t>(columns.values.size()), per_disc, 0});
  put<std::int32_t>(file, {columns.first.begin(), columns.first.end()});
  put<std::int32_t>(file, {columns.rows.begin(), columns.rows.end()});
  put(file, columns.values);
  put(file, load);
  put(file, x);
  put(file, y);
  put(file, component);
  if (!file.flush()) bad_input(fmt::format("'{}' cannot be written", path), "", "Choose another path");
}

}  // namespace equidem::bench
