# SPDX-License-Identifier: GPL-3.0-or-later
# Third-party parts (Debian 12 packages); which room uses which is said in lib/CMakeLists.txt.
find_package(Threads REQUIRED)
find_package(fmt REQUIRED)
find_package(PkgConfig REQUIRED)

# SuiteSparse 5.12 ships neither CMake nor pkg-config files.
function(equidem_find_library target header library suffix)
  string(TOUPPER ${target} prefix)
  find_path(${prefix}_INCLUDE ${header} PATH_SUFFIXES ${suffix} REQUIRED)
  find_library(${prefix}_LIBRARY ${library} REQUIRED)
  add_library(equidem_${target} UNKNOWN IMPORTED)
  set_target_properties(equidem_${target} PROPERTIES IMPORTED_LOCATION ${${prefix}_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${${prefix}_INCLUDE})
endfunction()
equidem_find_library(cholmod cholmod.h cholmod suitesparse)
equidem_find_library(umfpack umfpack.h umfpack suitesparse)
pkg_check_modules(OPENBLAS REQUIRED IMPORTED_TARGET openblas)
find_package(CGAL REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json REQUIRED)
pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo)
if(EQUIDEM_BUILD_TOOLS)
  find_package(CLI11 REQUIRED)
endif()
