# The program, and for find_package(kappaflow) the libraries kappaflow::core, solver, surface and scenes with their
# headers, which keep their paths: #include "surface/tracker/surface_tracker.h".
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

# Two components, which are two Debian packages: what runs, and what programs of others are built with.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME development)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/kappaflow)
set(header_folder ${CMAKE_INSTALL_INCLUDEDIR}/kappaflow)

foreach(library settings core solver field mesh motion topology remesh tracker measure surface scenes)
  set_target_properties(kappaflow_${library} PROPERTIES EXPORT_NAME ${library})
  install(TARGETS kappaflow_${library} EXPORT kappaflow)
endforeach()
target_include_directories(kappaflow_settings INTERFACE $<INSTALL_INTERFACE:${header_folder}>)
install(EXPORT kappaflow NAMESPACE kappaflow:: FILE kappaflowTargets.cmake DESTINATION ${package_folder})
configure_package_config_file(cmake/kappaflowConfig.cmake.in ${PROJECT_BINARY_DIR}/kappaflowConfig.cmake
                              INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kappaflowConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kappaflowConfig.cmake ${PROJECT_BINARY_DIR}/kappaflowConfigVersion.cmake
        DESTINATION ${package_folder})
foreach(folder core solver surface scenes)
  install(DIRECTORY ${folder} DESTINATION ${header_folder} FILES_MATCHING PATTERN "*.h"
          PATTERN benchmark EXCLUDE PATTERN experiments EXCLUDE)
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/core/version.h DESTINATION ${header_folder}/core)

set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME program)
install(TARGETS kappaflow)
install(DIRECTORY scenes DESTINATION share/kappaflow
        FILES_MATCHING PATTERN "*.toml" PATTERN "*.csv" PATTERN "*.vtp" PATTERN "*.md")
install(FILES tools/paraview/open_run.py DESTINATION share/kappaflow/paraview)
install(FILES tools/pysph/to_vtk.py DESTINATION share/kappaflow/pysph)
install(CODE "set(SOURCE_DIR \"${PROJECT_SOURCE_DIR}\")
set(BINARY_DIR \"${PROJECT_BINARY_DIR}\")
set(DOCUMENT_DIR \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DOCDIR}\")")
install(SCRIPT cmake/install_documents.cmake)
