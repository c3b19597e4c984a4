# Installs the Python package and what its tests need into an environment of its own, and runs them; skipped, and it says
# so, where there is no Python 3.11 or later or pip does not reach its packages.
#   cmake -DSOURCE_DIR=... -DPROGRAM=... -DFOLDER=... -P python.cmake
cmake_minimum_required(VERSION 3.25)
find_package(Python 3.11 COMPONENTS Interpreter Development.Module)
if(NOT Python_FOUND)
  message("python: skipped, there is no Python 3.11 or later with its headers (Debian: python3-dev)")
  return()
endif()

set(python ${FOLDER}/environment/bin/python)
if(NOT EXISTS ${python})
  execute_process(COMMAND ${Python_EXECUTABLE} -m venv ${FOLDER}/environment RESULT_VARIABLE result OUTPUT_QUIET ERROR_QUIET)
  if(NOT result EQUAL 0)
    file(REMOVE_RECURSE ${FOLDER}/environment)
    message("python: skipped, ${Python_EXECUTABLE} makes no environments (Debian: python3-venv)")
    return()
  endif()
endif()
set(packages numpy "scikit-build-core>=0.11" "nanobind>=3.1,<4" pytest mypy pandas matplotlib nbformat nbclient ipykernel)
execute_process(COMMAND ${python} -m pip install --quiet --disable-pip-version-check --retries 1 --timeout 20 ${packages}
                RESULT_VARIABLE result ERROR_VARIABLE text)
if(NOT result EQUAL 0)
  string(REGEX MATCH "[^\n]*\n?$" text "${text}")
  message("python: skipped, pip does not reach its packages: ${text}")
  return()
endif()

execute_process(COMMAND ${python} -m pip install --quiet --no-build-isolation --no-deps --force-reinstall ${SOURCE_DIR}
                COMMAND_ERROR_IS_FATAL ANY)
set(ENV{KAPPAFLOW_PROGRAM} ${PROGRAM})
execute_process(COMMAND ${python} -m pytest -q -rs -p no:cacheprovider ${SOURCE_DIR}/tests/python WORKING_DIRECTORY ${FOLDER}
                COMMAND_ERROR_IS_FATAL ANY)
