# Opens a run and a tracked sequence in ParaView and takes pictures; skipped where ParaView is not installed.
#   cmake -DPROGRAM=... -DSOURCE_DIR=... -DFOLDER=... -P paraview.cmake
cmake_minimum_required(VERSION 3.25)
find_program(PVBATCH pvbatch PATHS ${SOURCE_DIR}/build/paraview/bin NO_DEFAULT_PATH)  # of tools/setup --paraview
find_program(PVBATCH pvbatch)
if(NOT PVBATCH)
  message("ParaView is not installed: skipped")
  return()
endif()

file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})

# Debian's pvbatch is there without its modules, which exclude libvtk9-dev: tools/setup --paraview unpacks them.
file(WRITE ${FOLDER}/import.py "from paraview import simple\n")
execute_process(COMMAND xvfb-run -a -s -noreset ${PVBATCH} ${FOLDER}/import.py RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
if(failed)
  message("ParaView's Python is not installed: skipped")
  return()
endif()

function(open name)
  execute_process(COMMAND ${PROGRAM} ${ARGN} --out ${FOLDER}/${name} --quiet COMMAND_ERROR_IS_FATAL ANY)
  set(picture ${FOLDER}/${name}.png)
  # -noreset: pvbatch opens the display several times, and may meet the server while it starts anew after the last one.
  execute_process(COMMAND xvfb-run -a -s -noreset ${PVBATCH} ${SOURCE_DIR}/tools/paraview/open_run.py ${FOLDER}/${name} ${picture} 0.04
                  COMMAND_ERROR_IS_FATAL ANY COMMAND_ECHO STDOUT)
  file(SIZE ${picture} size)
  if(size LESS 20000)  # [bytes] 5000 where there is nothing but the names
    message(FATAL_ERROR "${picture} shows no surface: ${size} bytes")
  endif()
endfunction()

open(run run ${SOURCE_DIR}/scenes/staircase-small.toml --duration 0.08 --track total,regional)
open(track track ${SOURCE_DIR}/tests/data/splishsplash/*.vtk --fps 25 --velocity regional)
