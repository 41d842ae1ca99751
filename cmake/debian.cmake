# SPDX-License-Identifier: GPL-3.0-or-later
# The Debian packages that cpack makes of the installed components; tools/package configures, builds and calls it.
set(EQUIDEM_MAINTAINER "The equidem developers <developers@equidem.example>" CACHE STRING
  "Maintainer of the Debian packages, with the address")
if(NOT EQUIDEM_RELEASE_DATE)
  message(FATAL_ERROR "CHANGELOG.md has no line '## [${PROJECT_VERSION}] - DATE' (packages tell the changes of their "
    "version). Add it, or correct the version in CMakeLists.txt.")
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL programs development)
if(EQUIDEM_BUILD_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_PACKAGE_CONTACT "${EQUIDEM_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
# The revision names the system, whose libraries the programs are linked with.
cmake_host_system_information(RESULT system QUERY DISTRIB_ID)
cmake_host_system_information(RESULT system_version QUERY DISTRIB_VERSION_ID)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1~${system}${system_version})

set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME equidem)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS "gnuplot-nox | gnuplot")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SUGGESTS python3-equidem)
set(CPACK_DEBIAN_PROGRAMS_DESCRIPTION "equilibrium and elastic moduli of assemblies of discs
Assemblies of discs of the discrete-element method are solved by assembled
stiffness matrices. The program computes their equilibrium, their effective
stiffness with bounds, the springs for wanted moduli, their stability and
waves; it packs discs and other bodies, and steps bonded and colliding bodies
in time.
.
Example cases are in /usr/share/doc/equidem/examples.")

# What the static libraries link, as packages.cmake finds it: the libraries of tools/packages.txt that builds need, but
# that of the command line.
file(STRINGS tools/packages.txt needed REGEX "^[^ ]*-dev +build")
list(FILTER needed EXCLUDE REGEX "^libcli11")
list(TRANSFORM needed REPLACE " .*" "")
list(JOIN needed ", " needed)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libequidem-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${needed}, pkgconf")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "equilibrium of assemblies of discs - C++ library
Assemblies of discs of the discrete-element method are solved by assembled
stiffness matrices: equilibrium, effective stiffness, stability, packings,
motion.
.
This package holds the headers, the static libraries and the CMake package:
find_package(equidem).")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-equidem)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
# The module is compiled for one version of Python.
math(EXPR next_minor "${EQUIDEM_MODULE_PYTHON_MINOR} + 1")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
  "python3 (>= 3.${EQUIDEM_MODULE_PYTHON_MINOR}), python3 (<< 3.${next_minor}), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-scipy, python3-pandas, python3-matplotlib")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
  "${PROJECT_SOURCE_DIR}/cmake/debian/postinst;${PROJECT_SOURCE_DIR}/cmake/debian/prerm")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "equilibrium of assemblies of discs - Python 3 module
Assemblies of discs of the discrete-element method are solved by assembled
stiffness matrices: equilibrium, effective stiffness, stability, packings,
motion.
.
This package holds the module equidem, which works on arrays of NumPy.")

set(changelog ${PROJECT_BINARY_DIR}/changelog.Debian)
find_program(python3 python3 NO_CACHE REQUIRED)
execute_process(COMMAND ${python3} cmake/debian/changelog.py CHANGELOG.md ${CPACK_DEBIAN_PACKAGE_RELEASE}
  ${EQUIDEM_MAINTAINER} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_FILE ${changelog} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND gzip -9nf ${changelog} COMMAND_ERROR_IS_FATAL ANY)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS CHANGELOG.md)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/debian/copyright ${changelog}.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME} COMPONENT ${component})
endforeach()

include(CPack)
