# What kappaflow is built with, each with the oldest version that is known to work. docs/install.md has them too.

function(kappaflow_check what least package found version)
  if(NOT found)
    message(FATAL_ERROR " kappaflow needs ${what} ${least} or later and found none; Debian's package is ${package}.")
  elseif(version AND version VERSION_LESS least)
    message(FATAL_ERROR
            " kappaflow needs ${what} ${least} or later and found ${version}; Debian's package is ${package}.")
  endif()
endfunction()

# kappaflow_needs(LIBRARY VERSION PACKAGE WORDS...): find_package with these words, or the end.
macro(kappaflow_needs library least package)
  find_package(${library} QUIET ${ARGN})
  if(${library}_VERSION_STRING AND NOT ${library}_VERSION)
    set(${library}_VERSION ${${library}_VERSION_STRING})
  endif()
  kappaflow_check(${library} ${least} ${package} "${${library}_FOUND}" "${${library}_VERSION}")
endmacro()

if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  kappaflow_check(g++ 12 g++ TRUE ${CMAKE_CXX_COMPILER_VERSION})
elseif(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  kappaflow_check(clang 14 clang TRUE ${CMAKE_CXX_COMPILER_VERSION})
endif()
kappaflow_needs(Eigen3 3.4 libeigen3-dev NO_MODULE)
kappaflow_needs(TBB 2021 libtbb-dev)
kappaflow_needs(nanoflann 1.4 libnanoflann-dev)
kappaflow_needs(fmt 9 libfmt-dev)
kappaflow_needs(tomlplusplus 3.3 libtomlplusplus-dev)
kappaflow_needs(cereal 1.3 libcereal-dev)  # only headers, on the compiler's own path
if(KAPPAFLOW_PYTHON)
  kappaflow_needs(VTK 9.1 libvtk9-dev COMPONENTS CommonDataModel FiltersCore)
  return()
endif()
kappaflow_needs(CLI11 2.1 libcli11-dev)
kappaflow_needs(ZLIB 1.2 zlib1g-dev)
kappaflow_needs(EXPAT 2.5 libexpat1-dev)
kappaflow_needs(PkgConfig 0.29 pkg-config)
pkg_search_module(HDF5 QUIET IMPORTED_TARGET hdf5-serial hdf5)
kappaflow_check(HDF5 1.10 libhdf5-dev "${HDF5_FOUND}" "${HDF5_VERSION}")
pkg_check_modules(CMARK_GFM QUIET IMPORTED_TARGET libcmark-gfm)
kappaflow_check(cmark-gfm 0.29 libcmark-gfm-dev "${CMARK_GFM_FOUND}" "${CMARK_GFM_VERSION}")
kappaflow_needs(X11 1.8 libx11-dev)  # to ask for a display before VTK's rendering aborts without one
kappaflow_needs(VTK 9.1 libvtk9-dev COMPONENTS
                CommonColor CommonCore CommonDataModel FiltersCore IOCore IOGeometry IOLegacy IOXML IOImage jsoncpp
                RenderingCore RenderingOpenGL2 RenderingFreeType)
# Only for .vdb files and the experiment level-sets. Debian's FindOpenVDB.cmake ends the configuration without Boost's libraries,
# of which nothing is used here.
find_path(OPENVDB_INCLUDE_DIR openvdb/openvdb.h)
find_library(OPENVDB_LIBRARY openvdb)
mark_as_advanced(OPENVDB_INCLUDE_DIR OPENVDB_LIBRARY)
if(OPENVDB_INCLUDE_DIR AND OPENVDB_LIBRARY)
  add_library(OpenVDB::openvdb UNKNOWN IMPORTED)
  set_target_properties(OpenVDB::openvdb PROPERTIES IMPORTED_LOCATION ${OPENVDB_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${OPENVDB_INCLUDE_DIR} INTERFACE_LINK_LIBRARIES TBB::tbb)
endif()
if(KAPPAFLOW_TESTS)
  kappaflow_needs(GTest 1.12 libgtest-dev)
endif()
if(KAPPAFLOW_BENCHMARKS)
  kappaflow_needs(benchmark 1.7 libbenchmark-dev)
endif()
