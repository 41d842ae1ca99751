// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/cholmod_factorization.hpp"
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"
#include "equidem/linear/umfpack_factorization.hpp"

#include "support/catch.hpp"
#include "support/dense_oracle.hpp"
#include "support/fields.hpp"

using namespace equidem;

namespace {

/// A stiffness matrix that stays in place, with the order in which it is eliminated.
struct System {
  std::string name;
  Assembly assembly;
  ContactSprings springs;
  DegreesOfFreedom unknowns;
  ContactGraph graph;
  DissectionTree tree;
  StiffnessMatrix matrix;

  System(std::string title, Assembly discs, SpringConstants k, int per_disc,
         const std::function<bool(std::int32_t disc, int component)>& held)
      : name(std::move(title)),
        assembly(std::move(discs)),
        springs(k),
        graph(assembly),
        tree(dissect(assembly, graph)) {
    unknowns.per_disc = per_disc;
    unknowns.rotation_scale = assembly.mean_radius();
    for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
      for (int c = 0; c < per_disc; ++c) {
        const bool hold = held(static_cast<std::int32_t>(disc), c);
        unknowns.held.push_back(hold ? 1 : 0);
        if (!hold) ++unknowns.unknowns;
      }
    }
    unknowns.prescribed.assign(unknowns.held.size(), 0.0);
    matrix = assemble_stiffness(assembly, graph, springs, unknowns);
  }

  [[nodiscard]] MatrixOnGraph on_graph() const { return {matrix, assembly, graph}; }
};

std::function<bool(std::int32_t, int)> left_side(const Assembly& assembly) {
  return [discs = group(assembly, "left").discs](std::int32_t disc, int) {
    return std::find(discs.begin(), discs.end(), disc) != discs.end();
  };
}
bool first_disc_held(std::int32_t disc, int component) {
  return disc == 0 && component < 2;
}

constexpr SpringConstants usual{1e9, 0.5e9};

System hexagonal(SpringConstants k) {
  Assembly discs = hexagonal_lattice({.columns = 9, .rows = 8});
  const auto held = left_side(discs);
  return {"hexagonal", std::move(discs), k, 3, held};
}
System square_restrained() {
  Assembly discs = square_lattice({.columns = 7, .rows = 9});
  const auto held = left_side(discs);
  return {"square, rotation restrained", std::move(discs), usual, 2, held};
}
System periodic(int columns, int rows) {
  return {fmt::format("periodic hexagonal {} x {}", columns, rows),
          hexagonal_lattice({.columns = columns, .rows = rows, .periodic = true}), usual, 3, first_disc_held};
}
System delaunay() {
  Assembly discs = delaunay_assembly({.discs = 80});
  const auto held = left_side(discs);
  return {"delaunay", std::move(discs), usual, 3, held};
}
System all_held() {
  return {"all held", hexagonal_lattice({.columns = 2, .rows = 2}), usual, 3, [](std::int32_t, int) { return true; }};
}

struct LibrarySolver {
  std::string name;
  std::function<std::unique_ptr<Factorization>(const System&)> factorize;
};

LibrarySolver cholmod(const std::string& name, CholmodOrdering ordering) {
  return {name,
          [ordering](const System& s) { return cholmod_cholesky(s.on_graph(), s.unknowns, ordering, s.tree.order); }};
}

std::vector<LibrarySolver> cholesky_back_ends() {
  return {{"multifrontal Cholesky",
           [](const System& s) {
             const auto symbolic = std::make_shared<const SymbolicFactor>(analyze(s.tree, s.graph, s.matrix.block));
             return multifrontal_cholesky(symbolic, s.on_graph());
           }},
          cholmod("CHOLMOD, our order", CholmodOrdering::equidem),
          cholmod("CHOLMOD, METIS", CholmodOrdering::metis),
          cholmod("CHOLMOD, AMD", CholmodOrdering::amd)};
}
LibrarySolver umfpack() {
  return {"UMFPACK", [](const System& s) { return umfpack_lu(s.on_graph(), s.unknowns); }};
}

/// Largest relative error of the solutions of `count` random right-hand sides, solved at once.
double error_against_dense(const System& system, Factorization& factor, int count) {
  const test::DenseMatrix k = test::dense_matrix(system.matrix, system.assembly);
  std::vector<double> x = test::random_vector(k.size * count, 7);
  std::vector<double> expected;
  for (int c = 0; c < count; ++c) {
    const auto one = test::solve(k, {x.begin() + c * k.size, x.begin() + (c + 1) * k.size});
    expected.insert(expected.end(), one.begin(), one.end());
  }
  factor.solve(x, count);
  return test::relative_difference(x, expected);
}

}  // namespace

TEST_CASE("all_back_ends_give_the_answer_of_gauss") {
  auto back_ends = cholesky_back_ends();
  back_ends.push_back(umfpack());
  const int right_hand_sides = GENERATE(1, 3);
  for (const System& system : {hexagonal(usual), hexagonal({1e9, 1e9}), square_restrained(), periodic(4, 4),
                               periodic(2, 2), delaunay(), all_held()}) {
    for (const LibrarySolver& back_end : back_ends) {
      CAPTURE(system.name, system.unknowns.unknowns, back_end.name, right_hand_sides);
      const auto factor = back_end.factorize(system);
      REQUIRE(factor != nullptr);
      CHECK(error_against_dense(system, *factor, right_hand_sides) < 1e-11);
    }
  }
}

TEST_CASE("umfpack_solves_indefinite_systems_that_cholesky_refuses") {
  const double ratio = GENERATE(-0.05, -0.2, -0.3, -0.6);
  const System system = hexagonal({1e9, ratio * 1e9});
  for (const LibrarySolver& back_end : cholesky_back_ends()) {
    CAPTURE(ratio, back_end.name);
    CHECK(back_end.factorize(system) == nullptr);
  }
  const auto factor = umfpack().factorize(system);
  REQUIRE(factor != nullptr);
  CAPTURE(ratio, factor->report().smallest_pivot);
  CHECK_FALSE(factor->report().negative_pivots);
  CHECK(error_against_dense(system, *factor, 2) < 1e-11);
}

TEST_CASE("a_free_body_has_a_pivot_without_stiffness") {
  const System loose("free hexagonal", hexagonal_lattice({.columns = 5, .rows = 4}), usual, 3,
                     [](std::int32_t, int) { return false; });
  auto back_ends = cholesky_back_ends();
  back_ends.push_back(umfpack());
  for (const LibrarySolver& back_end : back_ends) {
    const auto factor = back_end.factorize(loose);
    CAPTURE(back_end.name);
    if (factor == nullptr) continue;
    CAPTURE(factor->report().smallest_pivot);
    CHECK(factor->report().smallest_pivot < 1e-12);
    CHECK(factor->report().smallest_component);
  }
}

TEST_CASE("cholmod_starts_no_threads") {
  const std::filesystem::path tasks = "/proc/self/task";  // one folder for each thread, on Linux
  if (!std::filesystem::exists(tasks)) return;
  const auto threads = [&] {
    return std::distance(std::filesystem::directory_iterator(tasks), std::filesystem::directory_iterator());
  };
  Assembly discs = hexagonal_lattice({.columns = 60, .rows = 60});  // fronts large enough to be shared out
  const auto held = left_side(discs);
  const System system("large hexagonal", std::move(discs), usual, 3, held);
  const auto before = threads();
  REQUIRE(cholesky_back_ends()[2].factorize(system) != nullptr);
  CHECK(threads() == before);
}

TEST_CASE("cholesky_back_ends_agree_on_the_smallest_pivot_with_one_order") {
  const System system = hexagonal(usual);
  const auto back_ends = cholesky_back_ends();
  const auto ours = back_ends[0].factorize(system), theirs = back_ends[1].factorize(system);
  REQUIRE((ours != nullptr && theirs != nullptr));
  const FactorReport &multifrontal = ours->report(), &supernodal = theirs->report();
  // Orders within a front may differ, and with them which pivot is smallest; its size differs little.
  CAPTURE(multifrontal.smallest_component.value(), supernodal.smallest_component.value());
  CHECK(supernodal.smallest_pivot == Approx(multifrontal.smallest_pivot).epsilon(0.5));
  CHECK(supernodal.nonzeros <= multifrontal.nonzeros);  // ours keeps held components
}

TEST_CASE("held_components_have_one_stiffness_whatever_holds_them") {
  for (const std::uint8_t why : {DegreesOfFreedom::supported, DegreesOfFreedom::without_stiffness}) {
    System system("one rotation is held", square_lattice({.columns = 3, .rows = 3}), usual, 3,
                  [](std::int32_t, int) { return false; });
    system.unknowns.held[3 * 4 + 2] = why;
    system.matrix = assemble_stiffness(system.assembly, system.graph, system.springs, system.unknowns);
    CAPTURE(static_cast<int>(why));
    CHECK(held_stiffness(system.matrix, system.unknowns) == system.springs.largest());
    CHECK(held_stiffness(system.matrix, system.unknowns) == system.matrix.diagonal_block(4)[8]);
  }
}
