# Runs on several ranks, started by mpirun: the same bits every time and on any number of threads, checkpoints, refusals
# and a rank that dies. What the ranks compute is held against one rank by tests/solver/ranks_test.cpp.
#   cmake -DPROGRAM=... -DMPIRUN=... -DSOURCE_DIR=... -DFOLDER=... -P ranks.cmake
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND ${MPIRUN} --version OUTPUT_VARIABLE mpirun_is ERROR_VARIABLE mpirun_is)
if(NOT mpirun_is MATCHES "Open MPI|OpenRTE")  # whose words and exit codes are used here
  message("Open MPI is not installed: skipped")
  return()
endif()
# More ranks than cores, also as root.
set(ENV{OMPI_ALLOW_RUN_AS_ROOT} 1)
set(ENV{OMPI_ALLOW_RUN_AS_ROOT_CONFIRM} 1)
set(scene ${SOURCE_DIR}/scenes/staircase-small.toml)
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})

# ranks(NUMBER EXIT_CODE WORDS...): the program's words; leaves what it says in `said`, and in `told` what it prints.
function(ranks number expected)
  execute_process(COMMAND ${MPIRUN} --oversubscribe --bind-to none -n ${number} ${PROGRAM} ${ARGN}
                  WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE code ERROR_VARIABLE text OUTPUT_VARIABLE output TIMEOUT 60)
  if(NOT code STREQUAL expected)
    message(FATAL_ERROR "mpirun -n ${number} kappaflow ${ARGN}: ${code}, not ${expected}\n${output}${text}")
  endif()
  set(said "${text}" PARENT_SCOPE)
  set(told "${output}" PARENT_SCOPE)
endfunction()

function(expect_said line)
  string(REGEX MATCHALL "kappaflow: error" errors "${said}")
  list(LENGTH errors count)
  if(NOT said MATCHES "${line}" OR NOT count EQUAL 1)
    message(FATAL_ERROR "not said, or not once: ${line}\n${said}")
  endif()
endfunction()

function(expect_same a b)
  file(GLOB files RELATIVE ${FOLDER}/${a} ${FOLDER}/${a}/particles/*.vtp ${FOLDER}/${a}/surface-*/*.vtp)
  list(LENGTH files count)
  if(count EQUAL 0)
    message(FATAL_ERROR "${a}: no frames")
  endif()
  foreach(file IN LISTS files)
    file(SHA256 ${FOLDER}/${a}/${file} of_a)
    file(SHA256 ${FOLDER}/${b}/${file} of_b)
    if(NOT of_a STREQUAL of_b)
      message(FATAL_ERROR "${file} differs between ${a} and ${b}")
    endif()
  endforeach()
endfunction()

set(short --track material --quiet --duration 0.08)
ranks(4 0 run ${scene} ${short} --threads 1 --out once)
ranks(4 0 run ${scene} ${short} --threads 2 --out again)
expect_same(once again)

# Alone under mpirun it is the program as it is without.
ranks(1 0 run ${scene} ${short} --out one)
execute_process(COMMAND ${PROGRAM} run ${scene} ${short} --out without WORKING_DIRECTORY ${FOLDER} COMMAND_ERROR_IS_FATAL ANY)
expect_same(one without)

# expect_liquid_ranks(RUN NUMBER): of those that share the liquid.
function(expect_liquid_ranks run number)
  file(READ ${FOLDER}/${run}/run.json record)
  string(JSON found GET "${record}" liquid_ranks)
  if(NOT found EQUAL number)
    message(FATAL_ERROR "${run}: ${found} ranks share the liquid, not ${number}")
  endif()
endfunction()

# The first rank has the surfaces alone: the other one has all of the liquid, as one process has it. Where the surfaces are few,
# both share it.
ranks(2 0 run ${scene} ${short} --threads 1 --out apart)
expect_liquid_ranks(once 3)
expect_liquid_ranks(apart 1)
expect_same(apart without)
set(lava ${SOURCE_DIR}/scenes/lava.toml --track material --quiet --duration 0.02)
ranks(2 0 run ${lava} --threads 1 --out shared)
ranks(2 0 run ${lava} --threads 2 --out shared-again)
expect_liquid_ranks(shared 2)
expect_same(shared shared-again)

# By shares.
ranks(2 0 run ${lava} --threads 1 --shares 1,0.4 --out uneven)
ranks(2 0 run ${lava} --threads 1 --shares 2.5,1 --out uneven-again)
expect_same(uneven uneven-again)
file(READ ${FOLDER}/uneven/run.json record)
foreach(k 0 1)
  string(JSON share_${k} GET "${record}" shares ${k})
endforeach()
if(NOT share_0 EQUAL 1 OR NOT share_1 EQUAL 0.4)
  message(FATAL_ERROR "run.json: shares ${share_0} and ${share_1}")
endif()
file(SHA256 ${FOLDER}/shared/particles/particles_0001.vtp by_halves)
file(SHA256 ${FOLDER}/uneven/particles/particles_0001.vtp by_shares)
if(by_halves STREQUAL by_shares)
  message(FATAL_ERROR "the shares have changed nothing")
endif()

# Interrupted: the scene goes on for longer than it is let. The checkpoint does not know the shares, of which those of the ranks
# with liquid count.
execute_process(COMMAND sh -c "
  ${MPIRUN} --oversubscribe --bind-to none -n 4 ${PROGRAM} run ${scene} --track material --quiet --threads 1 --shares 8,1,0.5,0.75 --out stopped &
  while kill -0 $! && [ ! -e stopped/particles/particles_0002.vtp ]; do sleep 0.05; done
  kill -TERM $(cut -d' ' -f1 /proc/$!/task/$!/children); wait $!" WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE code ERROR_VARIABLE said TIMEOUT 60)
if(NOT code EQUAL 143 OR NOT said MATCHES "kappaflow run --resume stopped goes on")
  message(FATAL_ERROR "interrupted: ${code}\n${said}")
endif()
file(COPY ${FOLDER}/stopped/ DESTINATION ${FOLDER}/onward)
file(COPY ${FOLDER}/stopped/ DESTINATION ${FOLDER}/alone)
ranks(4 0 run --resume stopped --quiet --threads 1 --shares 2,4,2,3)
ranks(4 0 run ${scene} --track material --quiet --threads 1 --shares 8,1,0.5,0.75 --out whole)
expect_same(whole stopped)
expect_liquid_ranks(whole 2)  # two follow the surfaces
ranks(2 0 run --resume onward --quiet --threads 1)
execute_process(COMMAND ${PROGRAM} run --resume alone --quiet WORKING_DIRECTORY ${FOLDER} COMMAND_ERROR_IS_FATAL ANY)

# With a rigid body, and timed.
ranks(2 0 run ${SOURCE_DIR}/scenes/sphere-in-honey.toml ${short} --threads 1 --out body)
ranks(3 0 benchmark ${scene} --particles 3000,5000 --threads 1,2 --steps 1 --out speed.csv)
file(STRINGS ${FOLDER}/speed.csv lines)
list(LENGTH lines count)
string(REGEX MATCHALL "shares [0-9.]+,[0-9.]+,[0-9.]+\n" shares "${told}")
list(LENGTH shares proposals)
if(NOT count EQUAL 5 OR NOT lines MATCHES "messages_per_step" OR NOT proposals EQUAL 4)
  message(FATAL_ERROR "not a line for each size and number of threads: ${lines}\n${told}")
endif()

# One line says what is wrong, whoever finds it.
ranks(3 2 run missing.toml)
expect_said("missing.toml: no such file")
ranks(2 2 run ${scene} --threads)
expect_said("--threads")
ranks(2 2 run ${scene} --shares 1,0.5,1)
expect_said("--shares: found 3 values; expected one for each of the 2 ranks")
ranks(2 2 benchmark ${scene} --shares 1)
expect_said("--shares: found 1 value; expected one for each of the 2 ranks")
ranks(2 2 run ${scene} --shares 1,0)
expect_said("--shares: found \"0\"; expected a number above 0")
ranks(2 2 run ${scene} --shares -1,half)
expect_said("--shares: found \"-1\"; expected a number above 0")
ranks(1 2 run ${scene} --shares 1)
expect_said("--shares: this is the only process")
ranks(2 2 check ${scene})
expect_said("only kappaflow run and benchmark work on several ranks")

# A rank that dies takes the others along.
execute_process(COMMAND sh -c "
  ${MPIRUN} --oversubscribe --bind-to none -n 3 ${PROGRAM} run ${SOURCE_DIR}/scenes/slab.toml --track material --quiet --threads 1 --out killed &
  while kill -0 $! && [ ! -e killed/checkpoint.bin ]; do sleep 0.05; done
  kill -KILL $(cut -d' ' -f3 /proc/$!/task/$!/children); wait $!" WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE code ERROR_VARIABLE said TIMEOUT 60)
if(NOT code EQUAL 137)
  message(FATAL_ERROR "killed: ${code}\n${said}")
endif()
