# Rules for `cmake --install`. Component `runtime`: programs, scenarios and their worlds. Component
# `development`: libraries with their headers, the IDL, and the CMake package for find_package(thalweg).
include(CMakePackageConfigHelpers)

# thalweg_targets_under(RESULT FOLDER TYPE...): the targets of these types defined in FOLDER and below.
function(thalweg_targets_under result folder)
  get_property(found DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  set(targets)
  foreach(target IN LISTS found)
    get_target_property(type ${target} TYPE)
    if(type IN_LIST ARGN)
      list(APPEND targets ${target})
    endif()
  endforeach()
  get_property(folders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(below IN LISTS folders)
    thalweg_targets_under(found ${below} ${ARGN})
    list(APPEND targets ${found})
  endforeach()
  set(${result} ${targets} PARENT_SCOPE)
endfunction()

# Tests are defined later, and are not installed.
thalweg_targets_under(THALWEG_PROGRAMS ${PROJECT_SOURCE_DIR} EXECUTABLE)
list(FILTER THALWEG_PROGRAMS EXCLUDE REGEX "^thalweg(-example-|_schema_generator$)")
install(TARGETS ${THALWEG_PROGRAMS} RUNTIME COMPONENT runtime)
install(DIRECTORY deploy/scenarios deploy/worlds DESTINATION ${CMAKE_INSTALL_DATADIR}/thalweg COMPONENT runtime)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT runtime)

# All libraries except those of the command line and of the gateway, which are parts of a single program.
thalweg_targets_under(THALWEG_LIBRARIES ${PROJECT_SOURCE_DIR} STATIC_LIBRARY INTERFACE_LIBRARY)
list(FILTER THALWEG_LIBRARIES EXCLUDE REGEX "^thalweg_(cli_|gateway_|warnings$)")
foreach(library IN LISTS THALWEG_LIBRARIES)
  string(REGEX REPLACE "^thalweg_" "" name ${library})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
endforeach()
install(TARGETS ${THALWEG_LIBRARIES} EXPORT thalweg-targets ARCHIVE COMPONENT development)
install(DIRECTORY common services DESTINATION ${THALWEG_INCLUDEDIR} COMPONENT development
  FILES_MATCHING PATTERN "*.h" PATTERN services/cli EXCLUDE PATTERN services/gateway EXCLUDE
  PATTERN cmake EXCLUDE PATTERN examples EXCLUDE)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/thalweg)
install(EXPORT thalweg-targets NAMESPACE thalweg:: DESTINATION ${package_dir} COMPONENT development)
configure_package_config_file(common/cmake/thalweg-config.cmake.in thalweg-config.cmake
  INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(thalweg-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/thalweg-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/thalweg-config-version.cmake
  DESTINATION ${package_dir} COMPONENT development)
