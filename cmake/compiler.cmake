# SPDX-License-Identifier: GPL-3.0-or-later
# fmt and the standard library take most of the time of compiling a file: what most files read is compiled once for
# all targets of the same flags. The preset tidy goes without, so that every file still includes what it uses.
set(EQUIDEM_PRECOMPILED <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory>
  <numbers> <optional>
  <span> <string> <string_view> <utility> <vector> <fmt/format.h>)

# Flags of every target of the project, on an interface target that is not installed.
add_library(equidem_compiler INTERFACE)
# Products and sums are fused only in targets with the property EQUIDEM_FUSED: whether they are depends on the compiler
# and the processor, and without it a seed gives the same assembly everywhere.
target_compile_options(equidem_compiler INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
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
