# The program, and what find_package(kappaflow COMPONENTS surface solver scenes io) finds: libraries and their public
# headers, #include <kappaflow/surface/tracker/tracked_surfaces.h>.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
include(cmake/public_headers.cmake)

# Components of the installation, each a Debian package: what runs, what programs of others are built with, and what runs
# of several processes need (mpi).
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME development)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/kappaflow)

# The targets of each component of the package; all need those of core. A room of surface is a target of its own.
set(targets_core settings core)
set(targets_surface field mesh motion topology remesh measure tracker surface)
set(targets_solver solver)
set(targets_scenes scenes)
set(targets_io files writers)
foreach(component core surface solver scenes io)
  foreach(target IN LISTS targets_${component})
    set_target_properties(kappaflow_${target} PROPERTIES EXPORT_NAME ${target})
    install(TARGETS kappaflow_${target} EXPORT kappaflow-${component})
  endforeach()
  install(EXPORT kappaflow-${component} NAMESPACE kappaflow:: DESTINATION ${package_folder})
endforeach()
set_target_properties(kappaflow_writers PROPERTIES EXPORT_NAME io)
target_include_directories(kappaflow_settings INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
configure_package_config_file(cmake/kappaflowConfig.cmake.in ${PROJECT_BINARY_DIR}/kappaflowConfig.cmake
                              INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kappaflowConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kappaflowConfig.cmake ${PROJECT_BINARY_DIR}/kappaflowConfigVersion.cmake cmake/libdeflate.cmake
        DESTINATION ${package_folder})
install(CODE "set(SOURCE_DIR \"${PROJECT_SOURCE_DIR}\")
set(BINARY_DIR \"${PROJECT_BINARY_DIR}\")
set(HEADERS \"${KAPPAFLOW_PUBLIC_HEADERS}\")
set(HEADER_DIR \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}\")")
install(SCRIPT cmake/install_headers.cmake)

set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME program)
install(TARGETS kappaflow)
if(TARGET kappaflow_mpi)
  install(TARGETS kappaflow_mpi LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/kappaflow COMPONENT mpi)
endif()
install(DIRECTORY scenes DESTINATION share/kappaflow
        FILES_MATCHING PATTERN "*.toml" PATTERN "*.csv" PATTERN "*.vtp" PATTERN "*.obj" PATTERN "*.md")
install(FILES tools/paraview/open_run.py DESTINATION share/kappaflow/paraview)
install(FILES tools/blender/picture.py DESTINATION share/kappaflow/blender)
install(FILES tools/pysph/to_vtk.py DESTINATION share/kappaflow/pysph)
install(CODE "set(SOURCE_DIR \"${PROJECT_SOURCE_DIR}\")
set(BINARY_DIR \"${PROJECT_BINARY_DIR}\")
set(DOCUMENT_DIR \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DOCDIR}\")")
install(SCRIPT cmake/install_documents.cmake)
