# OBJ, PLY and GLB files as meshio and trimesh read them; skipped where these are not installed.
#   cmake -DPROGRAM=... -DSOURCE_DIR=... -DFOLDER=... -P meshes.cmake
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/python_with.cmake)
python_with("meshio or trimesh" "import numpy, meshio, trimesh")

file(REMOVE_RECURSE ${FOLDER})
execute_process(COMMAND ${PROGRAM} run ${CMAKE_CURRENT_LIST_DIR}/usd_scene.toml --duration 0.08 --quiet --format obj,ply,glb
                        --out ${FOLDER}/run COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${PYTHON} ${CMAKE_CURRENT_LIST_DIR}/meshes_check.py ${FOLDER}/run COMMAND_ERROR_IS_FATAL ANY)
