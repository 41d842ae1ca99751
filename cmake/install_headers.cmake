# SPDX-License-Identifier: GPL-3.0-or-later
# At installation: the headers of the library that the programs include, and those that these include, go to
# `destination` below the prefix. What a program needs, a user of the library may need; the rest of `source`/lib is
# internal.
cmake_policy(VERSION 3.25)

file(GLOB_RECURSE unread ${source}/tools/command/*.?pp ${source}/tools/equidem/*.?pp ${source}/lib/python/src/*.?pp)
set(headers "")
while(unread)
  set(found "")
  foreach(file IN LISTS unread)
    file(STRINGS ${file} lines REGEX "^ *# *include \"equidem/")
    list(TRANSFORM lines REPLACE "^[^\"]*\"([^\"]*)\".*" "\\1")
    list(APPEND found ${lines})
  endforeach()
  list(REMOVE_DUPLICATES found)
  list(REMOVE_ITEM found ${headers})
  list(APPEND headers ${found})
  list(TRANSFORM found PREPEND "${source}/lib/" OUTPUT_VARIABLE unread)
endwhile()
foreach(header IN LISTS headers)
  get_filename_component(folder ${header} DIRECTORY)
  file(INSTALL ${source}/lib/${header} DESTINATION ${CMAKE_INSTALL_PREFIX}/${destination}/${folder})
endforeach()
