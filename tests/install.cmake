# Installs kappaflow, builds the example against it, and runs both.
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

# No settings of the project's own build may be needed, or reach the example's.
run(${CMAKE_COMMAND} -G Ninja -S ${SOURCE_DIR}/examples/find_package -B ${folder}/example
    -DCMAKE_PREFIX_PATH=${installed} -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_EXPORT_COMPILE_COMMANDS=ON)
file(READ ${folder}/example/compile_commands.json commands)
if(commands MATCHES "${SOURCE_DIR}/core|cmake_pch|-Wall|-Werror")
  message(FATAL_ERROR "the project's own settings reach the example: ${commands}")
endif()
run(${CMAKE_COMMAND} --build ${folder}/example)
run(${folder}/example/ball)
message("${text}")
if(NOT text MATCHES "vertices, at most 0\\.0")
  message(FATAL_ERROR "the ball's surface lost its material: ${text}")
endif()
