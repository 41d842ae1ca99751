// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The datasets of an assembly file (HDF5), which reading and writing share.
#pragma once

#include <cstddef>

namespace equidem::hdf5_columns {

/// A dataset with a row of `width` numbers for each of something; width 0: one number each, in a list.
struct Column {
  const char* name;
  std::size_t width;
  const char* unit;
};

inline constexpr Column cell = {"cell", 0, "m"}, box = {"box", 2, "m"}, discs = {"discs", 3, "m"},
                        sections = {"sections", 2, "m2, m4"}, contacts = {"contacts", 4, ""},
                        levers = {"levers", 2, "m"}, normals = {"normals", 2, "1"}, offsets = {"offsets", 2, "m"},
                        springs = {"springs", 2, "Pa"}, strengths = {"strengths", 2, "N/m"},
                        forces = {"forces", 2, "N/m"}, cell_areas = {"cell_areas", 0, "m2"},
                        facet_lengths = {"facet_lengths", 0, "m"};
inline constexpr Column all_columns[] = {cell,    box,     discs,     sections, contacts,   levers,       normals,
                                         offsets, springs, strengths, forces,   cell_areas, facet_lengths};

/// Rows that are read or written at once: a piece of some hundred KB.
inline constexpr std::size_t rows_at_once = 1 << 16;

}  // namespace equidem::hdf5_columns
