# cpack -G DEB, in the build folder: one Debian package per component. Configure with -DCMAKE_INSTALL_PREFIX=/usr to
# install the libraries into Debian's folder of the architecture.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME sightcell)
set(CPACK_PACKAGE_VENDOR "The Sightcell authors")
set(CPACK_PACKAGE_CONTACT "The Sightcell authors")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_COMPONENTS_ALL ${sightcell_components})
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
# dpkg-shlibdeps (packages dpkg-dev and file) finds the packages of the libraries that our files are linked with; the
# shlibs file that CPack generates names the package of libsightcell.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")

# sightcell_deb(COMPONENT SECTION SYNOPSIS LAST-LINES)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${CMAKE_PROJECT_NAME} built using CMake")  # else it precedes every synopsis
macro(sightcell_deb component section synopsis last)
  string(TOUPPER ${component} sightcell_name)
  set(CPACK_DEBIAN_${sightcell_name}_PACKAGE_NAME ${sightcell_${component}_package})
  set(CPACK_DEBIAN_${sightcell_name}_PACKAGE_SECTION ${section})
  set(CPACK_COMPONENT_${sightcell_name}_DESCRIPTION "${synopsis}
Sightcell finds, ahead of time, which polygons of a scene can be seen from
every place a camera can be, and tells a renderer each frame what to draw.
.
${last}")
endmacro()

set(exact "(= ${PROJECT_VERSION})")
sightcell_deb(runtime libs "baked visibility for engines: shared library"
  "This package has the library that programs load.")

sightcell_deb(dev libdevel "baked visibility for engines: runtime, to build against"
  "This package has the headers, the static library and the files for CMake and\npkg-config.")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libsightcell1 ${exact}")
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "g++ | libstdc++-dev")  # for a static C program

sightcell_deb(stream-dev libdevel "baked visibility for engines: clients of streamed scenes"
  "This package has the header and the static library for programs that load\nscenes of \"sightcell pack --stream\" from a server.")
set(CPACK_DEBIAN_STREAM-DEV_PACKAGE_DEPENDS "libsightcell-dev ${exact}, libmd-dev, pkg-config, zlib1g-dev")

sightcell_deb(bake-dev libdevel "baked visibility for engines: the baker as a library"
  "This package has the headers and static libraries of the baker, for editors\nand asset pipelines.")
string(JOIN ", " CPACK_DEBIAN_BAKE-DEV_PACKAGE_DEPENDS "libsightcell-dev ${exact}" libembree-dev libtbb-dev
  librecast-dev libdraco-dev libmeshoptimizer-dev libfmt-dev libsqlite3-dev nlohmann-json3-dev libglm-dev libepoxy-dev
  libegl-dev libbrotli-dev libmd-dev libwebp-dev libxxhash-dev pkg-config zlib1g-dev)

sightcell_deb(tools graphics "baked visibility for engines: the baker"
  "This package has the programs: sightcell, the baker, and sightcell-city, a\ngenerator of test scenes.")
set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS libegl1)  # opened at run time
# The library is for samples/blender, whose users install this package.
set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS "libegl-mesa0 | libegl-vendor, libgl1-mesa-dri, libsightcell1 ${exact}")
include(CPack)
