# SPDX-License-Identifier: GPL-3.0-or-later
# Third-party parts (Debian 12 packages); which room uses which is said in lib/CMakeLists.txt. This file is also
# installed: the static libraries of the rooms need the same parts wherever they are linked.

# Missing parts end the configuration of this project; in find_package(equidem) they make equidem not found, with the
# reason.
function(equidem_missing part)
  if(CMAKE_FIND_PACKAGE_NAME STREQUAL "equidem")
    set(equidem_FOUND FALSE PARENT_SCOPE)
    set(equidem_NOT_FOUND_MESSAGE "equidem needs ${part}, which was not found" PARENT_SCOPE)
  else()
    message(FATAL_ERROR
      "equidem needs ${part}, which was not found. tools/packages.txt lists the Debian packages to install.")
  endif()
endfunction()

# SuiteSparse 5.12 ships neither CMake nor pkg-config files.
macro(equidem_find_suitesparse library header)
  find_path(equidem_${library}_INCLUDE ${header} PATH_SUFFIXES suitesparse)
  find_library(equidem_${library}_LIBRARY ${library})
  mark_as_advanced(equidem_${library}_INCLUDE equidem_${library}_LIBRARY)
  if(NOT equidem_${library}_INCLUDE OR NOT equidem_${library}_LIBRARY)
    equidem_missing(${library})
  elseif(NOT TARGET equidem_${library})
    add_library(equidem_${library} UNKNOWN IMPORTED)
    set_target_properties(equidem_${library} PROPERTIES IMPORTED_LOCATION ${equidem_${library}_LIBRARY}
      INTERFACE_INCLUDE_DIRECTORIES ${equidem_${library}_INCLUDE})
  endif()
endmacro()

# Names of a module after the first are those it has elsewhere.
macro(equidem_find_by_pkg_config prefix module)
  if(PkgConfig_FOUND AND NOT TARGET PkgConfig::${prefix})
    pkg_search_module(${prefix} QUIET IMPORTED_TARGET ${module} ${ARGN})
  endif()
  if(NOT TARGET PkgConfig::${prefix})
    equidem_missing(${module})
  endif()
endmacro()

# Libraries of headers alone, which an installed equidem does without.
function(equidem_find_headers library header)
  find_path(equidem_${library}_INCLUDE ${header})
  mark_as_advanced(equidem_${library}_INCLUDE)
  if(NOT equidem_${library}_INCLUDE)
    equidem_missing(${library})
  elseif(NOT TARGET equidem_${library})
    add_library(equidem_${library} INTERFACE IMPORTED)
    set_target_properties(equidem_${library} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${equidem_${library}_INCLUDE})
  endif()
endfunction()

# Eigen before CGAL, which brings a FindEigen3 of its own that makes no target.
set(equidem_packages Threads fmt PkgConfig Eigen3 CGAL tomlplusplus nlohmann_json)
if(EQUIDEM_BUILD_TOOLS AND NOT CMAKE_FIND_PACKAGE_NAME STREQUAL "equidem")
  list(APPEND equidem_packages CLI11)
endif()
foreach(package IN LISTS equidem_packages)
  find_package(${package} QUIET)
  if(NOT ${package}_FOUND)
    equidem_missing(${package})
  endif()
endforeach()
if(NOT CMAKE_FIND_PACKAGE_NAME STREQUAL "equidem")
  equidem_find_headers(spectra Spectra/SymEigsSolver.h)
  equidem_find_headers(boost boost/math/tools/toms748_solve.hpp)
endif()
equidem_find_suitesparse(suitesparseconfig SuiteSparse_config.h)
equidem_find_suitesparse(cholmod cholmod.h)
equidem_find_suitesparse(umfpack umfpack.h)
equidem_find_by_pkg_config(OPENBLAS openblas)
equidem_find_by_pkg_config(CAIRO cairo)
equidem_find_by_pkg_config(HDF5 hdf5-serial hdf5)
