# A library that is too old, and one that is missing, end the configuration with a line that says so.
#   cmake -DSOURCE_DIR=... -DCOMPILER=... -DFOLDER=... -P dependencies.cmake
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${FOLDER})
file(WRITE ${FOLDER}/old/nanoflannConfig.cmake "")
file(WRITE ${FOLDER}/old/nanoflannConfigVersion.cmake "set(PACKAGE_VERSION 1.3.2)\nset(PACKAGE_VERSION_COMPATIBLE TRUE)\n")

function(expect line)
  execute_process(COMMAND ${CMAKE_COMMAND} -G Ninja -S ${SOURCE_DIR} -B ${FOLDER}/build -DCMAKE_CXX_COMPILER=${COMPILER}
                          ${ARGN} OUTPUT_QUIET ERROR_VARIABLE text RESULT_VARIABLE result)
  string(FIND "${text}" "${line}\n" found)
  if(result EQUAL 0 OR found EQUAL -1)
    message(FATAL_ERROR "not said: ${line}\n${text}")
  endif()
endfunction()

expect("kappaflow needs nanoflann 1.4 or later and found 1.3.2; Debian's package is libnanoflann-dev."
       -Dnanoflann_DIR=${FOLDER}/old)
expect("kappaflow needs fmt 9 or later and found none; Debian's package is libfmt-dev."
       -Unanoflann_DIR -DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON)
