// SPDX-License-Identifier: GPL-3.0-or-later
#include "petsc/part.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#include "equidem/assembly/least_rectangle.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem::petsc {
namespace {

/// A type of MPI of several doubles, for the life of one exchange.
class DiscValues {
 public:
  /// PETSc does not add types of one double.
  explicit DiscValues(int per_disc) : made_(per_disc > 1) {
    if (!made_) return;
    MPI_Type_contiguous(per_disc, MPI_DOUBLE, &type_);
    MPI_Type_commit(&type_);
  }
  ~DiscValues() {
    if (made_) MPI_Type_free(&type_);
  }
  DiscValues(const DiscValues&) = delete;
  DiscValues& operator=(const DiscValues&) = delete;
  [[nodiscard]] MPI_Datatype type() const { return type_; }

 private:
  bool made_;
  MPI_Datatype type_ = MPI_DOUBLE;
};

}  // namespace

Halo::Halo(const Ranks& ranks, const Part& part)
    : owned_(part.owned), ghosts_(static_cast<std::int64_t>(part.assembly.size()) - part.owned) {
  std::vector<std::int64_t> begin{0};  // the first place of each rank, and that behind the last one
  for (const std::int64_t discs : ranks.joined({&owned_, 1})) begin.push_back(begin.back() + discs);
  std::vector<PetscSFNode> owners(static_cast<std::size_t>(ghosts_));
  for (std::size_t g = 0; g < owners.size(); ++g) {
    const std::int64_t place = part.places[static_cast<std::size_t>(part.owned) + g];
    const auto next = std::upper_bound(begin.begin(), begin.end(), place);
    const auto owner = static_cast<std::int64_t>(next - begin.begin()) - 1;
    owners[g].rank = static_cast<PetscInt>(owner);
    owners[g].index = static_cast<PetscInt>(place - begin[static_cast<std::size_t>(owner)]);
  }
  check(PetscSFCreate(ranks.communicator(), &forest_));
  check(PetscSFSetGraph(forest_, static_cast<PetscInt>(owned_), static_cast<PetscInt>(ghosts_), nullptr,
                        PETSC_COPY_VALUES, owners.data(), PETSC_COPY_VALUES));
  check(PetscSFSetUp(forest_));
  // As owner this rank sends to those that mirror its discs.
  PetscInt mirrors = 0;
  const PetscMPIInt* mirror_ranks = nullptr;
  const PetscInt *first = nullptr, *discs = nullptr;
  check(PetscSFGetLeafRanks(forest_, &mirrors, &mirror_ranks, &first, &discs));
  for (PetscInt k = 0; k < mirrors; ++k) {
    if (mirror_ranks[k] == ranks.rank()) continue;
    ++neighbours_;
    bytes_ += static_cast<double>(first[k + 1] - first[k]) * sizeof(double);
  }
}

Halo::~Halo() {
  PetscSFDestroy(&forest_);
}

void Halo::mirror(std::span<double> values, int per_disc) const {
  const DiscValues unit(per_disc);
  double* const ghosts = values.data() + owned_ * per_disc;
  check(PetscSFBcastBegin(forest_, unit.type(), values.data(), ghosts, MPI_REPLACE));
  check(PetscSFBcastEnd(forest_, unit.type(), values.data(), ghosts, MPI_REPLACE));
}

void Halo::add(std::span<double> values, int per_disc) const {
  const DiscValues unit(per_disc);
  const std::span<double> ghosts = values.subspan(static_cast<std::size_t>(owned_ * per_disc));
  check(PetscSFReduceBegin(forest_, unit.type(), ghosts.data(), values.data(), MPI_SUM));
  check(PetscSFReduceEnd(forest_, unit.type(), ghosts.data(), values.data(), MPI_SUM));
  std::ranges::fill(ghosts, 0.0);
}

Whole whole_of(const Ranks& ranks, const Part& part) {
  const Assembly& assembly = part.assembly;
  const auto owned = static_cast<std::size_t>(part.owned);
  Whole whole;
  whole.discs = ranks.sum(part.owned);
  whole.contacts = ranks.sum(static_cast<std::int64_t>(assembly.contacts.size()));
  whole.owned = static_cast<std::int64_t>(ranks.largest(static_cast<double>(part.owned)));
  whole.ghosts = static_cast<std::int64_t>(ranks.largest(static_cast<double>(assembly.size() - owned)));
  double sums[5] = {0, 0, 0, 0, 0}, largest = 0;  // radii, their squares, cells, branches, sections
  for (std::size_t d = 0; d < owned; ++d) {
    sums[0] += assembly.radii[d];
    sums[1] += assembly.radii[d] * assembly.radii[d];
    largest = std::max(largest, assembly.radii[d]);
    if (!assembly.cell_areas.empty()) sums[2] += assembly.cell_areas[d];
    if (!assembly.sections.empty()) sums[4] += assembly.sections[d].area;
  }
  for (const Contact& contact : assembly.contacts) sums[3] += norm(assembly.branch(contact));
  ranks.sum(sums);
  const auto [low, high] = upright_rectangle({assembly.centres.data(), owned});
  whole.extents = {{ranks.smallest(low.x), ranks.smallest(low.y)}, {ranks.largest(high.x), ranks.largest(high.y)}};
  whole.mean_radius = sums[0] / static_cast<double>(whole.discs);
  whole.largest_radius = ranks.largest(largest);
  whole.area = assembly.period ? assembly.period->x * assembly.period->y : sums[2];
  const double covered = assembly.sections.empty() ? std::numbers::pi * sums[1] : sums[4];
  if (whole.area > 0) whole.solid_fraction = covered / whole.area;
  if (whole.contacts > 0) whole.mean_branch = sums[3] / static_cast<double>(whole.contacts);
  for (const auto& [name, group] : assembly.groups) whole.groups[name] = ranks.sum(std::ssize(group.discs));
  const std::int64_t most = std::numeric_limits<PetscInt>::max() / 3;
  if (whole.discs > most) {
    bad_input(fmt::format("the assembly has {}", counted(whole.discs, "disc")),
              fmt::format("this PETSc counts up to {} unknowns, three a disc", std::numeric_limits<PetscInt>::max()),
              "Use fewer discs, or build with a PETSc of 64-bit indices (petsc64-dev)");
  }
  return whole;
}

}  // namespace equidem::petsc
