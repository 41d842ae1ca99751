# SPDX-License-Identifier: GPL-3.0-or-later
# Flags of every target of the project, on an interface target that is not installed.
add_library(equidem_compiler INTERFACE)
# Products and sums are fused only in targets with the property EQUIDEM_FUSED: whether they are depends on the compiler
# and the processor, and without it a seed gives the same assembly everywhere.
target_compile_options(equidem_compiler INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wno-psabi
  -ffp-contract=$<IF:$<BOOL:$<TARGET_PROPERTY:EQUIDEM_FUSED>>,fast,off>)
if(EQUIDEM_WARNINGS_AS_ERRORS)
  target_compile_options(equidem_compiler INTERFACE -Werror)
endif()
if(EQUIDEM_SANITIZE)
  # A finding ends the program, so that the test fails. GCC warns of uninitialized members of std::function in
  # instrumented code of the standard library.
  target_compile_options(equidem_compiler INTERFACE -fsanitize=${EQUIDEM_SANITIZE} -fno-sanitize-recover=all
    -fno-omit-frame-pointer -Wno-maybe-uninitialized)
  target_link_options(equidem_compiler INTERFACE -fsanitize=${EQUIDEM_SANITIZE})
endif()

# Loops over bodies and contacts, in the folder kernels of a room: no other target has options of its own. Vectors pass
# between inlined functions only, so no call depends on how the ABI passes them; lengths under a root are never
# negative. Each file takes so long to compile that batches gain nothing. Sanitizers make so much of what -O3 unrolls
# that one file takes ten minutes.
function(equidem_compile_kernels target)
  target_compile_options(${target} PRIVATE -fno-math-errno)
  if(NOT EQUIDEM_SANITIZE)
    target_compile_options(${target} PRIVATE $<$<NOT:$<CONFIG:Debug>>:-O3>)
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD OFF)
endfunction()
