# libequimap_sanitized - the library once more, under the address and undefined-behaviour sanitizers, with all that has
# been said of libequimap; what is linked with it is compiled in the same way.
set(flags -O1 -g1 -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=undefined)
add_library(libequimap_sanitized EXCLUDE_FROM_ALL ${EQUIMAP_SOURCES})
foreach(property INCLUDE_DIRECTORIES COMPILE_DEFINITIONS COMPILE_OPTIONS LINK_LIBRARIES INTERFACE_INCLUDE_DIRECTORIES
                 INTERFACE_LINK_LIBRARIES)
  get_target_property(value libequimap ${property})
  if(value)
    set_property(TARGET libequimap_sanitized PROPERTY ${property} ${value})
  endif()
endforeach()
target_compile_options(libequimap_sanitized PUBLIC ${flags})
target_link_options(libequimap_sanitized PUBLIC ${flags})
# Half of a compilation is PETSc's headers. The library itself is compiled without, so that a missing include is found.
# Files that want GNU's functions would say so too late.
target_precompile_headers(libequimap_sanitized PRIVATE <petscksp.h>)
target_compile_definitions(libequimap_sanitized PRIVATE _GNU_SOURCE=)
