// SPDX-License-Identifier: GPL-3.0-or-later
// matrix_petsc FILE mumps|gamg|hypre [PETSc options]: solve the system that `bench_static --write-matrix FILE` wrote.
// Prints seconds: order + analyze, factorize or set up, solve; the relative residual and the number of iterations.
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
MatNullSpace rigid_motions(const System& system, Vec like) {
  double x = 0, y = 0;
  for (std::size_t k = 0; k < system.x.size(); ++k) {
    x += system.x[k] / static_cast<double>(system.size);
    y += system.y[k] / static_cast<double>(system.size);
  }
  Vec motion[3];
  for (int m = 0; m < 3; ++m) {
    VecDuplicate(like, &motion[m]);
    double* values = nullptr;
    VecGetArray(motion[m], &values);
    for (std::size_t k = 0; k < system.x.size(); ++k) {
      const int c = system.component[k];
      const double turn = c == 0 ? y - system.y[k] : c == 1 ? system.x[k] - x : 1.0;
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
  MatNullSpaceCreate(PETSC_COMM_SELF, PETSC_FALSE, 3, motion, &space);
  return space;
}

void report(double analyze, double factorize, double solve, double residual, int iterations) {
  std::printf("analyze %.6f factorize %.6f solve %.6f residual %.3e iterations %d\n", analyze, factorize, solve,
              residual, iterations);
}

/// The upper triangle.
Mat half_of(System& system) {
  const auto n = static_cast<PetscInt>(system.size);
  Mat half;
  MatCreateSeqSBAIJWithArrays(PETSC_COMM_SELF, 1, n, n, system.first.data(), system.column.data(), system.value.data(),
                              &half);
  MatSetOption(half, MAT_SPD, PETSC_TRUE);
  return half;
}

void solve_by_mumps(System system) {
  const Mat half = half_of(system);
  Mat factor;
  Vec load, solution;
  VecCreateSeqWithArray(PETSC_COMM_SELF, 1, static_cast<PetscInt>(system.size), system.load.data(), &load);
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
  const auto b = static_cast<PetscInt>(system.per_disc);
  Mat matrix;
  MatConvert(half_of(system), MATSEQAIJ, MAT_INITIAL_MATRIX, &matrix);
  MatSetBlockSize(matrix, b);
  MatSetOption(matrix, MAT_SPD, PETSC_TRUE);
  Vec load, solution;
  VecCreateSeqWithArray(PETSC_COMM_SELF, b, static_cast<PetscInt>(system.size), system.load.data(), &load);
  VecDuplicate(load, &solution);
  KSP solver;
  PC pc;
  KSPCreate(PETSC_COMM_SELF, &solver);
  KSPSetType(solver, KSPCG);
  KSPSetNormType(solver, KSP_NORM_UNPRECONDITIONED);
  KSPSetTolerances(solver, 1e-8, 0, PETSC_DEFAULT, 100000);
  KSPSetOperators(solver, matrix, matrix);
  KSPGetPC(solver, &pc);
  PCSetType(pc, preconditioner);
  MatSetNearNullSpace(matrix, rigid_motions(system, load));
  KSPSetFromOptions(solver);
  const double start = now();
  KSPSetUp(solver);
  const double ready = now();
  KSPSolve(solver, load, solution);
  const double solved = now();
  PetscInt iterations = 0;
  KSPGetIterationNumber(solver, &iterations);
  report(0, ready - start, solved - ready, relative_residual(matrix, load, solution), static_cast<int>(iterations));
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
