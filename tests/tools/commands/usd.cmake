# What run --format usd and convert write, read back by the USD library; skipped where that is not installed.
#   cmake -DPROGRAM=... -DSOURCE_DIR=... -DFOLDER=... -P usd.cmake
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/python_with.cmake)
python_with(usd-core "import numpy; from pxr import Usd")

file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
function(check name scene)
  execute_process(COMMAND ${PROGRAM} run ${scene} --out ${FOLDER}/${name} --quiet --format usd ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${PROGRAM} convert ${FOLDER}/${name} --out ${FOLDER}/${name}-converted OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  foreach(usd ${name} ${name}-converted)
    execute_process(COMMAND ${PYTHON} ${CMAKE_CURRENT_LIST_DIR}/usd_check.py ${FOLDER}/${name} ${FOLDER}/${usd} COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
endfunction()

check(stairs ${SOURCE_DIR}/scenes/staircase-small.toml --duration 0.2 --track total,curvature-only)
check(moving ${CMAKE_CURRENT_LIST_DIR}/usd_scene.toml)
