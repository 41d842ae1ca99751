// SPDX-License-Identifier: GPL-3.0-or-later
#include "petsc.hpp"

#include <cstdio>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem::bench {
namespace {

std::filesystem::path program() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / "bench_static_petsc";
}

}  // namespace

bool has_petsc() {
  return std::filesystem::exists(program());
}

PetscSolution solve_by_petsc(const std::string& method, int processes, const std::filesystem::path& matrix,
                             double tolerance) {
  const std::filesystem::path answer = matrix.string() + ".solution";
  // Open MPI refuses to start processes of the superuser otherwise; other MPIs do not know these variables.
  const std::string start =
      processes > 1 ? fmt::format("OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpiexec -n {} ", processes)
                    : "";
  // Rigid motions in the interpolation (the global-matrix approach, Baker, Kolev & Yang 2010, needs nodal coarsening).
  const bool rigid = method == "petsc-hypre-rigid";
  const std::string command =
      fmt::format("{}'{}' '{}' {} -tolerance {:g} -solution '{}'{}", start, program().string(), matrix.string(),
                  method == "petsc-gamg" ? "gamg" : "hypre", tolerance, answer.string(),
                  rigid ? " -pc_hypre_boomeramg_nodal_coarsen 6 -pc_hypre_boomeramg_vec_interp_variant 3" : "");
  std::FILE* output = popen(command.c_str(), "r");
  if (output == nullptr) computation_failed("PETSc could not be started", "", "");
  PetscSolution result;
  double analyze = 0, residual = 0;
  const int read =
      std::fscanf(output, "analyze %lf factorize %lf solve %lf residual %lf iterations %d peak %lf cpu %lf", &analyze,
                  &result.set_up, &result.solve, &residual, &result.iterations, &result.peak_bytes, &result.cpu);
  if (pclose(output) != 0 || read != 7) computation_failed(fmt::format("'{}' failed", command), "", "");
  const std::string bytes = read_file(answer);
  std::filesystem::remove(answer);
  result.values.resize(bytes.size() / sizeof(double));
  bytes.copy(reinterpret_cast<char*>(result.values.data()), result.values.size() * sizeof(double));
  return result;
}

}  // namespace equidem::bench
