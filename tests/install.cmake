# Installs kappaflow, runs the program, and builds and runs programs outside of the project on the libraries.
#   cmake -DBUILD=... -DSOURCE_DIR=... -DCOMPILER=... -P install.cmake
cmake_minimum_required(VERSION 3.25)
set(folder ${BUILD}/install-test)
set(installed ${folder}/moved)
file(REMOVE_RECURSE ${folder})

function(run)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE text ERROR_VARIABLE text RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${text}")
  endif()
  set(text "${text}" PARENT_SCOPE)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${folder}/installed)
file(RENAME ${folder}/installed ${installed})  # it has to work wherever it lies
foreach(file share/doc/kappaflow/LICENSE share/doc/kappaflow/CITATION.cff share/doc/kappaflow/README.md
        share/doc/kappaflow/docs/methods.md share/doc/kappaflow/docs/images/staircase.png share/kappaflow/scenes/staircase.toml
        share/kappaflow/scenes/experiments/data share/kappaflow/paraview/open_run.py)
  if(NOT EXISTS ${installed}/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()
run(${CMAKE_COMMAND} -DFOLDER=${installed}/share/doc/kappaflow -P ${SOURCE_DIR}/tests/links.cmake)
run(${installed}/bin/kappaflow check ${installed}/share/kappaflow/scenes/staircase-small.toml)

# Experiments read the scenes that lie beside the program, not those of the source tree.
set(figure ${installed}/share/kappaflow/scenes/experiments/fig4.toml)
file(RENAME ${figure} ${figure}.away)
execute_process(COMMAND ${installed}/bin/kappaflow experiment fig4 --quick --out ${folder}/figures
                ERROR_VARIABLE text RESULT_VARIABLE result)
if(result EQUAL 0 OR NOT text MATCHES "${figure}")
  message(FATAL_ERROR "experiments do not read ${figure}: ${text}")
endif()
file(RENAME ${figure}.away ${figure})

# build_outside(FOLDER NAME [ARGUMENTS...]): a project of its own. No settings of the project's build may be needed, or
# reach it, and nothing but <kappaflow/...> its include path.
function(build_outside source name)
  run(${CMAKE_COMMAND} -G Ninja -S ${source} -B ${folder}/${name} -DCMAKE_PREFIX_PATH=${installed}
      -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Release -DCMAKE_EXPORT_COMPILE_COMMANDS=ON ${ARGN})
  file(READ ${folder}/${name}/compile_commands.json commands)
  if(commands MATCHES "${SOURCE_DIR}/core|${SOURCE_DIR} |${installed}/include/kappaflow|cmake_pch|-Wall|-Werror")
    message(FATAL_ERROR "the project's own settings reach ${name}: ${commands}")
  elseif(commands MATCHES "-march" AND NOT "${ARGN}" MATCHES "-march")
    message(FATAL_ERROR "-march reaches ${name}: ${commands}")
  endif()
  run(${CMAKE_COMMAND} --build ${folder}/${name})
endfunction()

# Every public header compiles alone. Headers of the tree that are not public are not installed.
include(${SOURCE_DIR}/cmake/public_headers.cmake)
list(TRANSFORM KAPPAFLOW_PUBLIC_HEADERS REPLACE "^tools/" "" OUTPUT_VARIABLE headers)
file(GLOB_RECURSE found RELATIVE ${installed}/include/kappaflow ${installed}/include/kappaflow/*)
list(SORT headers)
list(SORT found)
if(NOT found STREQUAL headers)
  message(FATAL_ERROR "installed headers are not the public ones:\n${found}\n${headers}")
endif()
build_outside(${SOURCE_DIR}/tests/outside/headers headers "-DHEADERS=${headers}")

# The example and the method of one's own give the same output whatever -march the program is compiled with.
build_outside(${SOURCE_DIR}/tests/outside/vtp vtp)
set(flags_plain "")
set(flags_avx2 -march=x86-64-v3)
foreach(build plain avx2)
  build_outside(${SOURCE_DIR}/examples/find_package drops_${build} "-DCMAKE_CXX_FLAGS=${flags_${build}}")
  build_outside(${SOURCE_DIR}/tests/outside/extending extending_${build} "-DCMAKE_CXX_FLAGS=${flags_${build}}")
  file(MAKE_DIRECTORY ${folder}/frames_${build})
  run(${CMAKE_COMMAND} -E chdir ${folder}/frames_${build} ${folder}/drops_${build}/drops)
  set(said_${build} "${text}")
  run(${folder}/extending_${build}/height)
  string(APPEND said_${build} "${text}")
endforeach()
message("${said_plain}")
if(NOT said_plain STREQUAL said_avx2)
  message(FATAL_ERROR "-march=x86-64-v3 gives another output:\n${said_avx2}")
endif()
run(${CMAKE_COMMAND} -E compare_files ${folder}/frames_plain/drops_20.vtp ${folder}/frames_avx2/drops_20.vtp)

# ParaView can open what the example wrote: two drops, and one piece in the end.
run(${folder}/vtp/vtp ${folder}/frames_plain/drops_0.vtp ${folder}/frames_plain/drops_20.vtp)
if(NOT text MATCHES "drops_0.vtp: 2 piece.s., sound\n.*drops_20.vtp: 1 piece.s., sound\n")
  message(FATAL_ERROR "the drops did not merge, or their files are damaged:\n${text}")
endif()
file(STRINGS ${folder}/frames_plain/drops.pvd entries REGEX "file=\"drops_[0-9]+.vtp\"")
list(LENGTH entries count)
if(NOT count EQUAL 21)
  message(FATAL_ERROR "drops.pvd lists ${count} frames, not 21")
endif()

# A component asks for what it needs and nothing else; one that there is not is said.
function(find_components components result_variable)
  file(WRITE ${folder}/find/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)
project(find LANGUAGES C CXX)
find_package(kappaflow 0.1 REQUIRED COMPONENTS ${components})\n")
  file(REMOVE_RECURSE ${folder}/find/build)
  execute_process(COMMAND ${CMAKE_COMMAND} -G Ninja -S ${folder}/find -B ${folder}/find/build -DCMAKE_PREFIX_PATH=${installed}
                          -DCMAKE_CXX_COMPILER=${COMPILER} ${ARGN}
                  OUTPUT_VARIABLE text ERROR_VARIABLE text RESULT_VARIABLE result)
  string(REGEX REPLACE "[ \n]+" " " text "${text}")
  set(text "${text}" PARENT_SCOPE)
  set(${result_variable} ${result} PARENT_SCOPE)
endfunction()

set(without "")
foreach(library tomlplusplus CLI11 EXPAT HDF5 nanoflann cereal ZLIB PkgConfig X11)
  list(APPEND without -DCMAKE_DISABLE_FIND_PACKAGE_${library}=ON)
endforeach()
find_components("surface io" result ${without})
if(NOT result EQUAL 0)
  message(FATAL_ERROR "the components surface and io ask for more than they need:\n${text}")
endif()
find_components(scenes result ${without})
if(result EQUAL 0)
  message(FATAL_ERROR "the component scenes does without toml++?")
endif()
find_components("surface pictures" result)
if(result EQUAL 0 OR NOT text MATCHES "kappaflow has no component \"pictures\"; its components are core, surface, solver, scenes, io")
  message(FATAL_ERROR "the unknown component is not said:\n${text}")
endif()
