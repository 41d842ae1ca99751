# SPDX-License-Identifier: GPL-3.0-or-later
# find_package(equidem): the target equidem::equidem, or one room of it such as equidem::statics.
set(equidem_FOUND TRUE)
include(${CMAKE_CURRENT_LIST_DIR}/packages.cmake)
if(equidem_FOUND)
  include(${CMAKE_CURRENT_LIST_DIR}/equidemTargets.cmake)
endif()
