# Packages that CPack makes from the installed components: thalweg_VERSION_ARCH.deb and
# thalweg-dev_VERSION_ARCH.deb.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The thalweg authors <thalweg@users.noreply.github.com>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# Shown below the summary, which is the project's description.
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "Programs that explore a space with a stereo camera: depth, odometry, map, \
where to go next, and motion; a simulator that stands in for the robot; scenarios and worlds.")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Static libraries of the algorithms and of the Bus, their headers, \
the IDL, and a package for CMake.")

# The shared libraries that the programs link name the packages; fonts are read at run time.
file(STRINGS deploy/packages.txt fonts REGEX "^run fonts-")
list(TRANSFORM fonts REPLACE "^run " "")
list(JOIN fonts ", " CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME thalweg)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)

# Users of the libraries need the development packages that these were built with.
file(STRINGS deploy/packages.txt needed REGEX "^build .*-dev$")
list(TRANSFORM needed REPLACE "^build " "")
list(PREPEND needed "thalweg (= ${PROJECT_VERSION})")
list(JOIN needed ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME thalweg-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
include(CPack)
