# cmake --build build/release --target package: a .tar.gz that runs from wherever it is unpacked, and on Debian and
# Ubuntu the packages kappaflow (what runs), libkappaflow-dev (what programs of others are built with) and kappaflow-mpi.
find_program(DPKG_SHLIBDEPS dpkg-shlibdeps)
find_program(FILE_COMMAND file)
set(CPACK_GENERATOR TGZ)
if(DPKG_SHLIBDEPS AND FILE_COMMAND)  # without them CPack would make a .deb that does not say which libraries it needs
  list(APPEND CPACK_GENERATOR DEB)
else()
  message(STATUS "No Debian packages: dpkg-dev or file is missing (tools/setup --package installs them)")
endif()

set(CPACK_PACKAGE_VENDOR "The kappaflow authors")
set(CPACK_PACKAGE_CONTACT "The kappaflow authors")
set(CPACK_PACKAGE_FILE_NAME kappaflow-${PROJECT_VERSION}-${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR})
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 0)  # all cores compress

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME kappaflow)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "gnuplot-nox | gnuplot, xvfb, xauth, ffmpeg")  # plots, pictures, films
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
"Simulates viscous liquids with particles and carries one textured triangle
mesh along on the implicit surface that they define, by several velocity
methods side by side.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libkappaflow-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libbullet-dev, libdeflate-dev, libeigen3-dev, libfmt-dev, libtbb-dev, libtomlplusplus-dev, libvtk9-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
"Libraries and headers for find_package(kappaflow): the solver, the implicit
surface and its tracker.")
set(CPACK_DEBIAN_MPI_PACKAGE_NAME kappaflow-mpi)
set(CPACK_DEBIAN_MPI_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "kappaflow (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_MPI_PACKAGE_RECOMMENDS "openmpi-bin | mpich")  # mpirun
set(CPACK_COMPONENT_MPI_DESCRIPTION "What kappaflow needs for runs of several processes by MPI.")
include(CPack)
