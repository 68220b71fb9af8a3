# find_package(untangled-client) gives the targets untangled::client (shared) and untangled::client_static.
# It lies in PREFIX/lib/cmake/untangled-client; headers are in PREFIX/include, libraries in PREFIX/lib.
get_filename_component(_untangled_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

if(NOT TARGET untangled::client)
  add_library(untangled::client SHARED IMPORTED)
  set_target_properties(untangled::client PROPERTIES
    IMPORTED_LOCATION "${_untangled_prefix}/lib/libuntangled_client.so"
    IMPORTED_NO_SONAME TRUE
    INTERFACE_INCLUDE_DIRECTORIES "${_untangled_prefix}/include")
endif()

if(NOT TARGET untangled::client_static)
  find_package(Threads REQUIRED)
  add_library(untangled::client_static STATIC IMPORTED)
  set_target_properties(untangled::client_static PROPERTIES
    IMPORTED_LOCATION "${_untangled_prefix}/lib/libuntangled_client.a"
    INTERFACE_INCLUDE_DIRECTORIES "${_untangled_prefix}/include"
    INTERFACE_LINK_LIBRARIES "Threads::Threads;${CMAKE_DL_LIBS};m")
endif()

unset(_untangled_prefix)
set(untangled-client_FOUND TRUE)
