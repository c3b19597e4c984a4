# PySPH's .npz through tools/pysph/to_vtk.py hold what its .hdf5 do: the tracked particles are the same bytes. Skipped where
# there is no NumPy.
#   cmake -DPROGRAM=... -DSOURCE_DIR=... -DFOLDER=... -P pysph.cmake
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND python3 -c "import numpy" RESULT_VARIABLE without_numpy ERROR_QUIET)
if(NOT without_numpy EQUAL 0)
  message("NumPy is not installed: skipped")
  return()
endif()

file(REMOVE_RECURSE ${FOLDER})
file(COPY ${SOURCE_DIR}/tests/data/pysph/ DESTINATION ${FOLDER})
file(GLOB npz ${FOLDER}/*.npz)
execute_process(COMMAND python3 ${SOURCE_DIR}/tools/pysph/to_vtk.py ${npz} COMMAND_ERROR_IS_FATAL ANY)
foreach(kind hdf5 vtk)
  set(files ${FOLDER}/block_*.hdf5)
  if(kind STREQUAL vtk)
    set(files ${FOLDER}/block_*_fluid.vtk)
  endif()
  execute_process(COMMAND ${PROGRAM} track ${files} --out ${FOLDER}/${kind} --quiet COMMAND_ERROR_IS_FATAL ANY)
endforeach()
foreach(frame 0000 0001 0002)
  execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${FOLDER}/hdf5/particles/particles_${frame}.vtp
                          ${FOLDER}/vtk/particles/particles_${frame}.vtp COMMAND_ERROR_IS_FATAL ANY)
endforeach()
