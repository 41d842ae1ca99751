// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The part of an assembly that one rank holds, and how it comes to it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <petscsf.h>

#include "equidem/assembly/assembly.hpp"
#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices/row_lattice.hpp"
#include "equidem/contact/contact_springs.hpp"

#include "petsc/ranks.hpp"

namespace equidem::petsc {

/// Discs of a rank and its contacts as an assembly of their own: first the discs that the rank owns, then those of
/// other ranks that its contacts reach ("ghosts"). A contact belongs to the rank of its first disc, disc i. Groups hold
/// discs that are owned.
struct Part {
  Assembly assembly;
  std::int64_t owned = 0;
  std::vector<std::int64_t> names;  ///< per disc: its number in the whole assembly, as the serial program has it
  std::vector<PetscInt> places;     ///< per disc: its place in vectors of PETSc, where each rank owns a stretch
};

/// Sends values of discs between the ranks that own and that mirror them.
class Halo {
 public:
  Halo(const Ranks& ranks, const Part& part);
  ~Halo();
  Halo(const Halo&) = delete;
  Halo& operator=(const Halo&) = delete;

  /// The values of ghosts become those of their owners.
  void mirror(std::span<double> values, int per_disc) const;
  /// The values of ghosts are added to those of their owners, and become 0.
  void add(std::span<double> values, int per_disc) const;

  /// Bytes that this rank sends in an exchange of one number for each disc.
  [[nodiscard]] double bytes() const { return bytes_; }
  [[nodiscard]] int neighbours() const { return neighbours_; }

 private:
  PetscSF forest_ = nullptr;
  std::int64_t owned_ = 0, ghosts_ = 0;
  double bytes_ = 0;
  int neighbours_ = 0;
};

/// Sums over all ranks that a part alone does not tell.
struct Whole {
  std::int64_t discs = 0, contacts = 0;
  std::int64_t ghosts = 0;    ///< largest number on a rank
  std::int64_t owned = 0;     ///< likewise
  double mean_radius = 0;     ///< m
  double largest_radius = 0;  ///< m
  double area = 0;            ///< m²; 0: not known
  double solid_fraction = 0;
  double mean_branch = 0;                      ///< m, mean distance of centres in contact
  Rectangle extents;                           ///< m, of the centres
  std::map<std::string, std::int64_t> groups;  ///< discs of each group
};
Whole whole_of(const Ranks& ranks, const Part& part);

/// The block of a rank with its ghosts; no rank holds more than that and the sides. Names are the numbers of
/// row_lattice. \throws Error (bad_input) as row_lattice; where there are more ranks than discs
Part lattice_part(const Ranks& ranks, const RowLattice& lattice);

/// The strip of a rank with its ghosts, of the assembly that delaunay_assembly makes. Every rank draws all points,
/// since each follows from those before it, and drops them when its strip is triangulated.
/// \throws Error (bad_input) on all ranks as delaunay_assembly; where there are more ranks than discs
Part delaunay_part(const Ranks& ranks, const DelaunayOptions& options);

struct ScatteredPart {
  Part part;
  std::optional<ContactSprings> springs;  ///< of its contacts
};

/// Each rank receives the discs of a stretch of Hilbert's curve, with their contacts.
/// \param whole of rank 0; null on the others
/// \param springs of its contacts, likewise
/// \throws Error (bad_input) on all ranks where there are more ranks than discs
ScatteredPart scattered_part(const Ranks& ranks, const Assembly* whole, const ContactSprings* springs);

}  // namespace equidem::petsc
