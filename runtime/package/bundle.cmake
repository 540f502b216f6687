# cmake --install BUILD --component bundle --prefix DIR: a folder whose programs run on a machine that has only glibc.
option(SIGHTCELL_BUNDLE_MESA "The bundle carries Mesa's software OpenGL, for machines without any driver" ON)

# Libraries that are opened at run time, so that no program names them: some by libepoxy and oneTBB, the driver by
# libEGL and by Mesa.
set(sightcell_bundle_opened)
set(sightcell_bundle_mesa)
set(sightcell_bundle_tools)
if(SIGHTCELL_BUILD_BAKE)
  set(sightcell_bundle_tools tools)
  foreach(name libEGL.so.1 libGL.so.1 libtbbmalloc.so.2)
    find_library(SIGHTCELL_BUNDLE_${name} ${name})
    mark_as_advanced(SIGHTCELL_BUNDLE_${name})
    if(SIGHTCELL_BUNDLE_${name})
      list(APPEND sightcell_bundle_opened ${SIGHTCELL_BUNDLE_${name}})
    endif()
  endforeach()
  if(SIGHTCELL_BUNDLE_MESA)
    find_library(SIGHTCELL_BUNDLE_libEGL_mesa.so.0 libEGL_mesa.so.0)
    find_file(SIGHTCELL_BUNDLE_swrast_dri.so swrast_dri.so
      PATHS /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE} /usr/lib64 /usr/lib PATH_SUFFIXES dri NO_DEFAULT_PATH)
    mark_as_advanced(SIGHTCELL_BUNDLE_libEGL_mesa.so.0 SIGHTCELL_BUNDLE_swrast_dri.so)
    set(sightcell_bundle_mesa "${SIGHTCELL_BUNDLE_libEGL_mesa.so.0}")
    if(SIGHTCELL_BUNDLE_swrast_dri.so)  # since Mesa 24 libEGL_mesa names the driver
      list(APPEND sightcell_bundle_mesa "${SIGHTCELL_BUNDLE_swrast_dri.so}")
    endif()
  endif()
endif()
find_program(SIGHTCELL_PATCHELF patchelf)
mark_as_advanced(SIGHTCELL_PATCHELF)

set(sightcell_bundle_programs)
foreach(target sightcell_cli sightcell_sample_city sightcell_sample_headless_walk sightcell_sample_hello_cull)
  if(TARGET ${target})
    list(APPEND sightcell_bundle_programs $<TARGET_FILE_NAME:${target}>)
  endif()
endforeach()
configure_file(runtime/package/make_bundle.cmake.in ${PROJECT_BINARY_DIR}/package/make_bundle.cmake.in @ONLY)
file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/package/make_bundle-$<CONFIG>.cmake
  INPUT ${PROJECT_BINARY_DIR}/package/make_bundle.cmake.in)
install(CODE "include(\"${PROJECT_BINARY_DIR}/package/make_bundle-\${CMAKE_INSTALL_CONFIG_NAME}.cmake\")"
  COMPONENT bundle EXCLUDE_FROM_ALL)
