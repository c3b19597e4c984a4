# A run in Blender, as its Python module; skipped where that is not installed.
#   cmake -DPROGRAM=... -DSOURCE_DIR=... -DFOLDER=... -P blender.cmake
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/python_with.cmake)
python_with("bpy (Blender)" "import numpy, bpy")

file(REMOVE_RECURSE ${FOLDER})
execute_process(COMMAND ${PROGRAM} run ${CMAKE_CURRENT_LIST_DIR}/usd_scene.toml --quiet --format usd,obj,ply --out ${FOLDER}/run
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${PYTHON} ${CMAKE_CURRENT_LIST_DIR}/blender_check.py ${FOLDER}/run COMMAND_ERROR_IS_FATAL ANY)
