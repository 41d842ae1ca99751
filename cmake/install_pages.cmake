# SPDX-License-Identifier: GPL-3.0-or-later
# At installation: the manual pages and the completion of the program `name`, printed by `program`, go to `destination`
# below the prefix. The first page refers to all others.
cmake_policy(VERSION 3.25)

set(share $ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/${destination})

function(write_help file)
  get_filename_component(folder ${file} DIRECTORY)
  file(MAKE_DIRECTORY ${folder})
  execute_process(COMMAND ${program} help ${ARGN} OUTPUT_FILE ${file} COMMAND_ERROR_IS_FATAL ANY)
  message(STATUS "Installing: ${file}")
endfunction()

function(write_page page section)
  set(file ${share}/man/man${section}/${page}.${section})
  write_help(${file} man ${ARGN})
  execute_process(COMMAND gzip -9nf ${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

write_page(${name} 1)
execute_process(COMMAND ${program} help man OUTPUT_VARIABLE first COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "\n\\.BR [^ \n]+ \\([0-9]\\)" references "${first}")
foreach(reference IN LISTS references)
  string(REGEX REPLACE "\n\\.BR (.*) \\(([0-9])\\)" "\\1;\\2" reference "${reference}")
  list(GET reference 0 page)
  list(GET reference 1 section)
  string(REPLACE "\\-" "-" page "${page}")
  string(REGEX REPLACE "^${name}-" "" topic ${page})
  write_page(${page} ${section} ${topic})
endforeach()

write_help(${share}/bash-completion/completions/${name} completion bash)
