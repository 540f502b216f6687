# What the library for clients of streamed scenes is linked with.
include("${CMAKE_CURRENT_LIST_DIR}/sightcell-needs.cmake")
sightcell_need(ZLIB zlib1g-dev)
sightcell_need(PkgConfig pkg-config)
sightcell_need_pc(libmd libmd libmd-dev)
sightcell_name_absent(stream)
