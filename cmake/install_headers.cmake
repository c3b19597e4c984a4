# Installs the public headers under one prefix. In the tree they include each other as "core/types.h"; installed they do
# it as <kappaflow/core/types.h>, and tools/io is <kappaflow/io>.
#   set(SOURCE_DIR ...) set(BINARY_DIR ...) set(HEADERS ...) set(HEADER_DIR ...), as install.cmake does
cmake_minimum_required(VERSION 3.25)
foreach(header IN LISTS HEADERS)
  file(STRINGS ${SOURCE_DIR}/${header} includes REGEX "^#include \"")
  foreach(include IN LISTS includes)
    string(REGEX REPLACE "^#include \"([^\"]*)\".*" "\\1" included "${include}")
    if(NOT included IN_LIST HEADERS)
      message(FATAL_ERROR "${header} is public and includes ${included}, which is not: cmake/public_headers.cmake")
    endif()
  endforeach()
  file(READ ${SOURCE_DIR}/${header} text)
  string(REGEX REPLACE "#include \"(tools/)?([^\"\n]*)\"" "#include <kappaflow/\\2>" text "${text}")
  string(REGEX REPLACE "^tools/" "" installed ${header})
  file(WRITE ${BINARY_DIR}/public_headers/${installed} "${text}")
  get_filename_component(folder ${installed} DIRECTORY)
  file(INSTALL ${BINARY_DIR}/public_headers/${installed} DESTINATION ${HEADER_DIR}/kappaflow/${folder})
endforeach()
