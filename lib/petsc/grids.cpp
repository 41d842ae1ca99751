// SPDX-License-Identifier: GPL-3.0-or-later
#include "petsc/grids.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "equidem/linear/multigrid/cycle.hpp"

namespace equidem::petsc {
namespace {

using multigrid::Grid;
using multigrid::Place;
using multigrid::Shape;

constexpr const char* mark = "equidem_grids";
constexpr PetscInt unknowns_of_node = 3;
/// Products with the matrix before and after each correction, and the part of the spectrum that they reduce. Products
/// cost more here than in the serial cycle, which takes several in one pass over memory: fewer are faster.
constexpr PetscInt degree = 3;
constexpr double range = 10;

PetscErrorCode create(PC preconditioner) {
  PetscContainer container = nullptr;
  PetscFunctionBegin;
  PetscCall(PCSetType(preconditioner, PCMG));
  PetscCall(PetscContainerCreate(PetscObjectComm(reinterpret_cast<PetscObject>(preconditioner)), &container));
  PetscCall(PetscObjectCompose(reinterpret_cast<PetscObject>(preconditioner), mark,
                               reinterpret_cast<PetscObject>(container)));
  PetscCall(PetscContainerDestroy(&container));
  PetscFunctionReturn(0);
}

/// The points of this rank on one level: discs, or nodes of a grid.
struct Points {
  std::vector<Vec2> at;        ///< over a
  std::vector<double> masses;  ///< of each: the discs that it stands for
  PetscInt unknowns = unknowns_of_node;
  std::span<const std::uint8_t> held{};  ///< per unknown; empty: none

  [[nodiscard]] bool is_held(std::size_t point, PetscInt e) const {
    return !held.empty() && held[point * static_cast<std::size_t>(unknowns) + static_cast<std::size_t>(e)] != 0;
  }
};

Points discs_of(const Network& network) {
  Points points;
  const auto owned = static_cast<std::size_t>(network.part().owned);
  const std::size_t b = network.block();
  points.unknowns = static_cast<PetscInt>(b);
  points.held = std::span(network.unknowns().held).first(network.owned());
  for (std::size_t d = 0; d < owned; ++d) {
    points.at.push_back((1 / network.unknowns().rotation_scale) * network.assembly().centres[d]);
    points.masses.push_back(points.is_held(d, 0) && points.is_held(d, 1) ? 0 : 1);
  }
  return points;
}

/// The nodes of a grid that are unknowns, numbered rank by rank: a node belongs to the lowest rank that has a point in
/// its cells.
struct Nodes {
  std::vector<PetscInt> number;   ///< per node of the grid; -1: none
  std::vector<std::size_t> mine;  ///< nodes of this rank
};

Nodes number_nodes(const Ranks& ranks, const Grid& grid, const std::vector<Place>& hosts) {
  std::vector<int> owner(grid.nodes(), ranks.count());
  for (const Place& host : hosts) {
    for (const std::size_t node : grid.nodes_of(static_cast<std::size_t>(host.cell))) {
      if (grid.kept(node)) owner[node] = ranks.rank();
    }
  }
  ranks.smallest(owner);
  Nodes nodes;
  nodes.number.assign(grid.nodes(), -1);
  std::vector<PetscInt> next(static_cast<std::size_t>(ranks.count()) + 2, 0);
  for (const int rank : owner) ++next[static_cast<std::size_t>(rank) + 1];
  for (std::size_t rank = 1; rank < next.size(); ++rank) next[rank] += next[rank - 1];
  for (std::size_t node = 0; node < owner.size(); ++node) {
    if (owner[node] == ranks.count()) continue;
    nodes.number[node] = next[static_cast<std::size_t>(owner[node])]++;
    if (owner[node] == ranks.rank()) nodes.mine.push_back(node);
  }
  return nodes;
}

/// A row of the interpolation: a component of the motion of a point by those of four nodes, of each a translation and
/// the rotation.
struct Row {
  PetscInt columns[8] = {};
  double values[8] = {};
  PetscInt count = 0;

  void add(PetscInt column, double value) { columns[count] = column, values[count++] = value; }
};

Row row_of(const Grid& grid, const Nodes& nodes, const Place& host, PetscInt component) {
  const Shape shape = grid.shape(host);
  const auto corners = grid.nodes_of(static_cast<std::size_t>(host.cell));
  Row row;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const double weight = shape.weight[k];
    if (weight == 0) continue;
    const PetscInt first = unknowns_of_node * nodes.number[corners[k]];
    row.add(first + component, weight);
    if (component < 2) row.add(first + 2, weight * (component == 0 ? -shape.arm[k].y : shape.arm[k].x));
  }
  return row;
}

/// The motions of the points of this rank by those of the nodes.
Mat interpolation(const Ranks& ranks, const Grid& grid, const Nodes& nodes, const Points& points,
                  const std::vector<Place>& hosts) {
  const auto rows = static_cast<PetscInt>(points.at.size()) * points.unknowns;
  const auto columns = static_cast<PetscInt>(nodes.mine.size()) * unknowns_of_node;
  const PetscInt begin = nodes.mine.empty() ? 0 : unknowns_of_node * nodes.number[nodes.mine.front()];
  const auto for_each_row = [&](const auto& put) {
    PetscInt number = 0;
    for (std::size_t point = 0; point < points.at.size(); ++point) {
      for (PetscInt e = 0; e < points.unknowns; ++e, ++number)
        put(number, points.is_held(point, e) ? Row{} : row_of(grid, nodes, hosts[point], e));
    }
  };
  std::vector<PetscInt> own(static_cast<std::size_t>(rows)), others(own.size());
  for_each_row([&](PetscInt number, const Row& row) {
    for (PetscInt k = 0; k < row.count; ++k) {
      const bool mine = row.columns[k] >= begin && row.columns[k] < begin + columns;
      ++(mine ? own : others)[static_cast<std::size_t>(number)];
    }
  });
  Mat matrix = nullptr;
  check(MatCreateAIJ(ranks.communicator(), rows, columns, PETSC_DETERMINE, PETSC_DETERMINE, 0, own.data(), 0,
                     others.data(), &matrix));
  check(MatSetBlockSizes(matrix, points.unknowns, unknowns_of_node));
  check(MatSetOption(matrix, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  PetscInt first = 0, end = 0;
  check(MatGetOwnershipRange(matrix, &first, &end));
  for_each_row([&](PetscInt number, const Row& row) {
    const PetscInt at = first + number;
    check(MatSetValues(matrix, 1, &at, row.count, row.columns, row.values, INSERT_VALUES));
  });
  check(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  return matrix;
}

/// Makes the grid that stands for the points, and its matrix; the points become the nodes of this rank.
Mat coarsen(const Ranks& ranks, Grid& grid, Points& points) {
  std::vector<Place> places;
  for (const Vec2 at : points.at) places.push_back(grid.place(at));
  std::vector<double> masses = multigrid::node_masses(grid, places, points.masses);
  ranks.sum(masses);
  grid.keep_nodes(masses);
  for (Place& place : places) place = grid.host(place);
  const Nodes nodes = number_nodes(ranks, grid, places);
  Mat matrix = interpolation(ranks, grid, nodes, points, places);
  points = {};
  for (const std::size_t node : nodes.mine) {
    points.at.push_back(grid.position(node));
    points.masses.push_back(masses[node]);
  }
  return matrix;
}

void set_smoother(PC preconditioner, PetscInt level, bool discs) {
  KSP smoother = nullptr;
  PC blocks = nullptr;
  check(PCMGGetSmoother(preconditioner, level, &smoother));
  check(KSPSetType(smoother, KSPCHEBYSHEV));
  check(KSPSetTolerances(smoother, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, degree));
  // The energy of a contact is at most twice that of its ends: no eigenvalue of D^-1 K exceeds 2.
  constexpr double largest = 2, margin = 1.1;
  if (discs) {
    check(KSPChebyshevSetEigenvalues(smoother, largest, largest / range));
  } else {
    check(KSPChebyshevEstEigSet(smoother, 0, margin / range, 0, margin));
  }
  check(KSPGetPC(smoother, &blocks));
  check(PCSetType(blocks, PCPBJACOBI));
}

/// Without a grid there is nothing to smooth: each rank eliminates the whole.
void eliminate(PC preconditioner) {
  KSP solver = nullptr;
  PC all = nullptr;
  check(PCMGGetCoarseSolve(preconditioner, &solver));
  check(KSPSetType(solver, KSPPREONLY));
  check(KSPGetPC(solver, &all));
  check(PCSetType(all, PCREDUNDANT));
}

}  // namespace

void register_grids() {
  check(PCRegister(grids_type, create));
}

bool has_grids(PC preconditioner) {
  PetscObject marked = nullptr;
  PetscBool grids = PETSC_FALSE;
  check(PetscObjectQuery(reinterpret_cast<PetscObject>(preconditioner), mark, &marked));
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(preconditioner), PCMG, &grids));
  return marked != nullptr && grids == PETSC_TRUE;
}

void build_grids(const Network& network, PC preconditioner) {
  const Ranks& ranks = network.ranks();
  const Whole& whole = network.whole();
  const multigrid::CycleOptions options;
  std::vector<Mat> interpolations;
  if (whole.discs >= options.direct_below) {
    Points points = discs_of(network);
    const auto& period = network.assembly().period;
    Grid grid = multigrid::grid_over({.low = period ? Vec2{} : whole.extents.low,
                                      .high = period ? *period : whole.extents.high,
                                      .periodic = period.has_value(),
                                      .discs = static_cast<double>(whole.discs),
                                      .distance = whole.mean_branch,
                                      .unit = network.unknowns().rotation_scale},
                                     options.spacing);
    interpolations.push_back(coarsen(ranks, grid, points));
    while (grid.divisible()) {
      grid = grid.coarser();
      interpolations.push_back(coarsen(ranks, grid, points));
    }
  }
  const auto levels = static_cast<PetscInt>(interpolations.size()) + 1;
  check(PCMGSetLevels(preconditioner, levels, nullptr));
  check(PCMGSetGalerkin(preconditioner, PC_MG_GALERKIN_BOTH));
  for (PetscInt level = 1; level < levels; ++level) {
    Mat& matrix = interpolations[static_cast<std::size_t>(levels - 1 - level)];
    check(PCMGSetInterpolation(preconditioner, level, matrix));
    check(MatDestroy(&matrix));
    set_smoother(preconditioner, level, level + 1 == levels);
  }
  if (levels == 1) eliminate(preconditioner);
}

}  // namespace equidem::petsc
