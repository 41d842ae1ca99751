# SPDX-License-Identifier: GPL-3.0-or-later
# Pages, scripts, help and names that the library and the programs write are files of their own languages beside their
# code. Each is a constant of a header that is made here: page.css, without the line of its licence, is page_css.
function(equidem_make_texts target visibility header folder)
  set(constants "#pragma once\nnamespace equidem {\n")
  foreach(kind csv css html in js txt)
    file(GLOB_RECURSE texts CONFIGURE_DEPENDS ${folder}/*.${kind})
    foreach(file IN LISTS texts)
      set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
      file(READ ${file} text)
      string(REGEX REPLACE "^[^\n]*SPDX[^\n]*\n" "" text "${text}")
      get_filename_component(name ${file} NAME)
      string(MAKE_C_IDENTIFIER ${name} name)
      string(APPEND constants "inline constexpr const char* ${name} = R\"--(${text})--\";\n")
    endforeach()
  endforeach()
  file(CONFIGURE OUTPUT texts/${header} CONTENT "${constants}}  // namespace equidem\n" @ONLY)
  target_include_directories(${target} ${visibility} ${CMAKE_CURRENT_BINARY_DIR}/texts)
endfunction()
