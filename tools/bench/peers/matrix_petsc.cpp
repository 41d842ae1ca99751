// SPDX-License-Identifier: GPL-3.0-or-later
// [mpiexec -n RANKS] matrix_petsc FILE mumps|gamg|hypre [-tolerance T] [-solution FILE] [PETSc options]: solve the
// system that `bench_static --write-matrix FILE` wrote, mumps on one process. Prints seconds: order + analyze,
// factorize or set up, solve; the relative residual, the number of iterations, bytes of memory at the peak, processor
// seconds.
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <petscksp.h>
#include <sys/resource.h>

namespace {

struct System {
  std::int64_t size = 0, entries = 0, per_disc = 0, reserved = 0;
  std::vector<PetscInt> first, column;  // the upper triangle by rows
  std::vector<double> value, load, x, y;
  std::vector<PetscInt> component;
};

template <class Number>
void get(std::ifstream& file, std::vector<Number>& numbers, std::int64_t count) {
  numbers.resize(static_cast<std::size_t>(count));
  file.read(reinterpret_cast<char*>(numbers.data()), static_cast<std::streamsize>(numbers.size() * sizeof(Number)));
}

System read(const std::string& path) {
  System system;
  std::ifstream file(path, std::ios::binary);
  for (std::int64_t* number : {&system.size, &system.entries, &system.per_disc, &system.reserved}) {
    file.read(reinterpret_cast<char*>(number), sizeof *number);
  }
  get(file, system.first, system.size + 1);
  get(file, system.column, system.entries);
  get(file, system.value, system.entries);
  get(file, system.load, system.size);
  get(file, system.x, system.size);
  get(file, system.y, system.size);
  get(file, system.component, system.size);
  if (!file) {
    std::fprintf(stderr, "matrix_petsc: '%s' cannot be read\n", path.c_str());
    std::exit(2);
  }
  return system;
}

/// Rows begin to end, both triangles.
struct Rows {
  PetscInt begin = 0, end = 0;
  std::vector<PetscInt> first, column;
  std::vector<double> value;
};

Rows rows_of(const System& half, PetscInt begin, PetscInt end) {
  Rows rows{begin, end, {}, {}, {}};
  const auto for_each = [&](const auto& put) {
    // Ascending columns: those of earlier rows come first.
    for (PetscInt row = 0; row < end; ++row) {
      for (PetscInt k = half.first[static_cast<std::size_t>(row)]; k < half.first[static_cast<std::size_t>(row) + 1];
           ++k) {
        const PetscInt column = half.column[static_cast<std::size_t>(k)];
        if (row >= begin) put(row - begin, column, k);
        if (column != row && column >= begin && column < end) put(column - begin, row, k);
      }
    }
  };
  std::vector<PetscInt> next(static_cast<std::size_t>(end - begin) + 1, 0);
  for_each([&](PetscInt row, PetscInt, PetscInt) { ++next[static_cast<std::size_t>(row) + 1]; });
  for (std::size_t row = 1; row < next.size(); ++row) next[row] += next[row - 1];
  rows.first = next;
  rows.column.resize(static_cast<std::size_t>(next.back()));
  rows.value.resize(rows.column.size());
  for_each([&](PetscInt row, PetscInt column, PetscInt k) {
    const auto at = static_cast<std::size_t>(next[static_cast<std::size_t>(row)]++);
    rows.column[at] = column;
    rows.value[at] = half.value[static_cast<std::size_t>(k)];
  });
  return rows;
}

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double relative_residual(Mat matrix, Vec load, Vec solution) {
  Vec rest;
  VecDuplicate(load, &rest);
  MatMult(matrix, solution, rest);
  VecAYPX(rest, -1, load);
  double difference = 0, size = 0;
  VecNorm(rest, NORM_2, &difference);
  VecNorm(load, NORM_2, &size);
  VecDestroy(&rest);
  return difference / size;
}

/// Two translations and the rotation about the centre, in which discs turn too.
MatNullSpace rigid_motions(const System& system, PetscInt begin, Vec like) {
  double x = 0, y = 0;
  for (std::size_t k = 0; k < system.x.size(); ++k) {
    x += system.x[k] / static_cast<double>(system.size);
    y += system.y[k] / static_cast<double>(system.size);
  }
  Vec motion[3];
  for (int m = 0; m < 3; ++m) {
    VecDuplicate(like, &motion[m]);
    double* values = nullptr;
    PetscInt count = 0;
    VecGetLocalSize(motion[m], &count);
    VecGetArray(motion[m], &values);
    for (PetscInt k = 0; k < count; ++k) {
      const auto at = static_cast<std::size_t>(begin + k);
      const int c = system.component[at];
      const double turn = c == 0 ? y - system.y[at] : c == 1 ? system.x[at] - x : 1.0;
      values[k] = m < 2 ? static_cast<double>(c == m) : turn;
    }
    VecRestoreArray(motion[m], &values);
    for (int l = 0; l < m; ++l) {
      double product = 0;
      VecDot(motion[m], motion[l], &product);
      VecAXPY(motion[m], -product, motion[l]);
    }
    VecNormalize(motion[m], nullptr);
  }
  MatNullSpace space;
  MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_FALSE, 3, motion, &space);
  return space;
}

/// By the first process; memory and processor time are those of all.
void report(double analyze, double factorize, double solve, double residual, int iterations) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  double mine[2] = {1024.0 * static_cast<double>(usage.ru_maxrss), seconds(usage.ru_utime) + seconds(usage.ru_stime)};
  double all[2] = {0, 0};
  MPI_Reduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, 0, PETSC_COMM_WORLD);
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank != 0) return;
  std::printf("analyze %.6f factorize %.6f solve %.6f residual %.3e iterations %d peak %.0f cpu %.6f\n", analyze,
              factorize, solve, residual, iterations, all[0], all[1]);
}

/// Writes the solution to the file that -solution names, where it does.
void write_solution(Vec solution) {
  char path[PETSC_MAX_PATH_LEN] = "";
  PetscBool wanted = PETSC_FALSE;
  PetscOptionsGetString(nullptr, nullptr, "-solution", path, sizeof path, &wanted);
  if (wanted == PETSC_FALSE) return;
  Vec whole;
  VecScatter gather;
  VecScatterCreateToZero(solution, &gather, &whole);
  VecScatterBegin(gather, solution, whole, INSERT_VALUES, SCATTER_FORWARD);
  VecScatterEnd(gather, solution, whole, INSERT_VALUES, SCATTER_FORWARD);
  PetscInt size = 0;
  VecGetLocalSize(whole, &size);
  if (size == 0) return;
  const double* values = nullptr;
  VecGetArrayRead(whole, &values);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(size * sizeof(double)));
}

void solve_by_mumps(System system) {
  const auto n = static_cast<PetscInt>(system.size);
  Mat half, factor;
  MatCreateSeqSBAIJWithArrays(PETSC_COMM_SELF, 1, n, n, system.first.data(), system.column.data(), system.value.data(),
                              &half);
  MatSetOption(half, MAT_SPD, PETSC_TRUE);
  Vec load, solution;
  VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, system.load.data(), &load);
  VecDuplicate(load, &solution);
  MatGetFactor(half, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, &factor);
  MatMumpsSetIcntl(factor, 14, 40);  // per cent of memory over the estimate
  MatMumpsSetIcntl(factor, 7, 2);    // approximate minimum fill: the fastest here
  MatFactorInfo info;
  MatFactorInfoInitialize(&info);
  IS row, column;
  MatGetOrdering(half, MATORDERINGNATURAL, &row, &column);
  const double start = now();
  MatCholeskyFactorSymbolic(factor, half, row, &info);
  const double analyzed = now();
  MatCholeskyFactorNumeric(factor, half, &info);
  const double factorized = now();
  MatSolve(factor, load, solution);
  const double solved = now();
  report(analyzed - start, factorized - analyzed, solved - factorized, relative_residual(half, load, solution), 0);
}

void solve_by_multigrid(System system, const char* preconditioner) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  const auto b = static_cast<PetscInt>(system.per_disc), n = static_cast<PetscInt>(system.size);
  const auto begin_of = [&](int r) { return b * static_cast<PetscInt>(n / b * std::int64_t{r} / ranks); };
  Rows rows = rows_of(system, begin_of(rank), begin_of(rank + 1));
  for (auto* numbers : {&system.first, &system.column}) *numbers = {};
  system.value = {};
  const PetscInt count = rows.end - rows.begin;
  Mat matrix;
  if (ranks == 1) {
    MatCreateSeqAIJWithArrays(PETSC_COMM_WORLD, n, n, rows.first.data(), rows.column.data(), rows.value.data(),
                              &matrix);
  } else {
    MatCreateMPIAIJWithArrays(PETSC_COMM_WORLD, count, count, n, n, rows.first.data(), rows.column.data(),
                              rows.value.data(), &matrix);
    rows.first = rows.column = {};
    rows.value = {};
  }
  MatSetBlockSize(matrix, b);
  MatSetOption(matrix, MAT_SPD, PETSC_TRUE);
  Vec load, solution;
  VecCreateMPIWithArray(PETSC_COMM_WORLD, b, count, n, system.load.data() + rows.begin, &load);
  VecDuplicate(load, &solution);
  KSP solver;
  PC pc;
  double tolerance = 1e-8;
  PetscOptionsGetReal(nullptr, nullptr, "-tolerance", &tolerance, nullptr);
  KSPCreate(PETSC_COMM_WORLD, &solver);
  KSPSetType(solver, KSPCG);
  KSPSetNormType(solver, KSP_NORM_UNPRECONDITIONED);
  KSPSetTolerances(solver, tolerance, 0, PETSC_DEFAULT, 100000);
  KSPSetOperators(solver, matrix, matrix);
  KSPGetPC(solver, &pc);
  PCSetType(pc, preconditioner);
  MatSetNearNullSpace(matrix, rigid_motions(system, rows.begin, load));
  KSPSetFromOptions(solver);
  MPI_Barrier(PETSC_COMM_WORLD);
  const double start = now();
  KSPSetUp(solver);
  const double ready = now();
  KSPSolve(solver, load, solution);
  const double solved = now();
  PetscInt iterations = 0;
  KSPGetIterationNumber(solver, &iterations);
  report(0, ready - start, solved - ready, relative_residual(matrix, load, solution), static_cast<int>(iterations));
  write_solution(solution);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "matrix_petsc FILE mumps|gamg|hypre [PETSc options]\n");
    return 2;
  }
  const std::string path = argv[1], method = argv[2];
  PetscInitialize(&argc, &argv, nullptr, nullptr);
  System system = read(path);
  if (method == "mumps") {
    solve_by_mumps(std::move(system));
  } else {
    solve_by_multigrid(std::move(system), method == "gamg" ? PCGAMG : PCHYPRE);
  }
  PetscFinalize();
}
