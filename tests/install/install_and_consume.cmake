# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -D build=... -D place=... -D consumer=... -D compiler=... -D generator=... -D sanitizers=... -D version=... -P
# this The installed tree is moved before it is used: nothing in it may point to where it was first.
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}\nended with ${result}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${place})
run(${CMAKE_COMMAND} --install ${build} --prefix ${place}/first)
file(RENAME ${place}/first ${place}/moved)

file(GLOB internal ${place}/moved/include/equidem/grains/kernels/*.hpp)
if(internal)
  message(FATAL_ERROR "internal headers are installed: ${internal}")
endif()
file(GLOB_RECURSE package ${place}/moved/*.cmake)
foreach(file IN LISTS package)
  file(READ ${file} text)
  foreach(path ${build} ${place}/first ${consumer})
    string(FIND "${text}" ${path} found)
    if(NOT found EQUAL -1)
      message(FATAL_ERROR "the installed file ${file} names ${path}")
    endif()
  endforeach()
endforeach()

set(flags "")
if(sanitizers)
  set(flags -D CMAKE_CXX_FLAGS=-fsanitize=${sanitizers})
endif()
run(${CMAKE_COMMAND} -S ${consumer} -B ${place}/build -G ${generator} -D CMAKE_CXX_COMPILER=${compiler}
  -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=${place}/moved -D wanted_version=${version} ${flags})
run(${CMAKE_COMMAND} --build ${place}/build)
run(${place}/build/consumer)
message(STATUS "the consumer printed: ${output}")
# Hexagonal block in tension with kT = 0: Poisson's ratio is 1/4 in plane strain whatever the size (Abe 1996, eq. 22).
if(NOT output MATCHES "^solid fraction 0\\.906900, Poisson's ratio 0\\.250000\n$")
  message(FATAL_ERROR "the consumer printed: ${output}")
endif()
