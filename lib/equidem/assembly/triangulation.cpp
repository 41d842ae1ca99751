// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/triangulation.hpp"

#include <cassert>

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Regular_triangulation_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include "equidem/core/stopwatch.hpp"

namespace equidem {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

using DelaunayVertex = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<DelaunayVertex>>;

using RegularVertex = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel,
                                                                  CGAL::Regular_triangulation_vertex_base_2<Kernel>>;
using RegularFace = CGAL::Regular_triangulation_face_base_2<Kernel>;
using Regular = CGAL::Regular_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<RegularVertex, RegularFace>>;

/// Insert point after point, each search starting where the last one ended.
/// \throws Error of kind interrupted where the user asked to stop
template <typename Triangulation, typename PointOf>
void insert(Triangulation& triangulation, std::span<const std::int32_t> order, const PointOf& point_of) {
  constexpr std::size_t between_looks = 8192;
  typename Triangulation::Face_handle near;
  std::size_t inserted = 0;
  for (const std::int32_t k : order) {
    if (++inserted % between_looks == 0) stop_if_interrupted();
    const auto vertex = triangulation.insert(point_of(k), near);
    vertex->info() = k;
    near = vertex->face();
  }
}

template <typename Triangulation>
std::vector<TriangulationEdge> edges(const Triangulation& triangulation) {
  std::vector<TriangulationEdge> result;
  const auto index = [&](const auto& vertex) {
    return triangulation.is_infinite(vertex) ? std::int32_t{-1} : vertex->info();
  };
  if (triangulation.dimension() == 1) {
    for (auto edge = triangulation.finite_edges_begin(); edge != triangulation.finite_edges_end(); ++edge) {
      result.push_back({.a = edge->first->vertex(0)->info(), .b = edge->first->vertex(1)->info()});
    }
  }
  if (triangulation.dimension() < 2) return result;
  result.reserve(3 * triangulation.number_of_vertices());
  for (auto edge = triangulation.finite_edges_begin(); edge != triangulation.finite_edges_end(); ++edge) {
    const auto face = edge->first;
    const int k = edge->second;
    // Corners run counter-clockwise: seen along ccw(k) -> cw(k), corner k lies to the left.
    result.push_back({.a = face->vertex(Triangulation::ccw(k))->info(),
                      .b = face->vertex(Triangulation::cw(k))->info(),
                      .left = index(face->vertex(k)),
                      .right = index(triangulation.mirror_vertex(face, k))});
  }
  return result;
}

}  // namespace

std::vector<TriangulationEdge> triangulation_edges(std::span<const Vec2> points, std::span<const double> weights,
                                                   std::span<const std::int32_t> order) {
  assert(weights.empty() || weights.size() == points.size());
  if (weights.empty()) {
    Delaunay delaunay;
    insert(delaunay, order, [&](std::int32_t k) { return Kernel::Point_2(points[k].x, points[k].y); });
    return edges(delaunay);
  }
  Regular regular;
  insert(regular, order, [&](std::int32_t k) {
    return Kernel::Weighted_point_2(Kernel::Point_2(points[k].x, points[k].y), weights[k]);
  });
  return edges(regular);
}

}  // namespace equidem
