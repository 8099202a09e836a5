# Installation: the program, the library, the headers, presets, batch scripts, pages, and two ways to find them: a CMake package (equimap::equimap)
# and pkg-config (equimap). Included at the end of the main CMakeLists.txt.
include(CMakePackageConfigHelpers)
set(EQUIMAP_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/equimap)

install(TARGETS equimap RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS libequimap EXPORT equimapTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
install(DIRECTORY config/ DESTINATION ${CMAKE_INSTALL_DATADIR}/equimap/config OPTIONAL)
install(DIRECTORY jobs/ DESTINATION ${CMAKE_INSTALL_DATADIR}/equimap/jobs USE_SOURCE_PERMISSIONS
        PATTERN demo.sh EXCLUDE PATTERN setup.sh EXCLUDE PATTERN __pycache__ EXCLUDE)
# The Python package is the same for every interpreter. The scripts of jobs/ look for it beside them.
set(EQUIMAP_PYTHON_DIR "" CACHE STRING "below the prefix, another place for the Python package, such as lib/python3.11/site-packages")
foreach(place ${CMAKE_INSTALL_DATADIR}/equimap/python ${EQUIMAP_PYTHON_DIR})
  install(DIRECTORY python/equimap DESTINATION ${place} FILES_MATCHING PATTERN "*.py")
endforeach()
install(DIRECTORY examples/ DESTINATION ${CMAKE_INSTALL_DATADIR}/equimap/examples USE_SOURCE_PERMISSIONS)
install(FILES README.md CHANGELOG.md CONTRIBUTING.md CITATION.cff LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs FILES_MATCHING PATTERN "*.md" PATTERN "*.png")
if(EQUIMAP_PAGES)
  install(DIRECTORY ${EQUIMAP_PAGES}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} OPTIONAL)
  install(FILES ${EQUIMAP_PAGES}/completion/equimap DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions OPTIONAL)
endif()
install(EXPORT equimapTargets NAMESPACE equimap:: DESTINATION ${EQUIMAP_PACKAGE_DIR})

# A static library does not say what it stands on: its users link that, too.
if(BUILD_SHARED_LIBS)
  set(EQUIMAP_STATIC FALSE)
else()
  set(EQUIMAP_STATIC TRUE)
endif()
configure_package_config_file(cmake/equimapConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/equimapConfig.cmake
                              INSTALL_DESTINATION ${EQUIMAP_PACKAGE_DIR})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/equimapConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/equimapConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/equimapConfigVersion.cmake
        DESTINATION ${EQUIMAP_PACKAGE_DIR})

# The pkg-config file finds its prefix from where it lies, so that an installed tree can be moved.
file(RELATIVE_PATH EQUIMAP_PC_TO_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
set(EQUIMAP_PC_REQUIRES "libxml-2.0, libcjson, zlib")
if(CAIRO_FOUND)
  string(APPEND EQUIMAP_PC_REQUIRES ", cairo")
endif()
if(PNG_FOUND)
  string(APPEND EQUIMAP_PC_REQUIRES ", libpng")
endif()
if(TIFF_FOUND)
  string(APPEND EQUIMAP_PC_REQUIRES ", libtiff-4")
endif()
if(SLEPC_FOUND)
  string(APPEND EQUIMAP_PC_REQUIRES ", slepc")
endif()
if(EQUIMAP_TETGEN)
  set(EQUIMAP_PC_TETGEN ${TETGEN_LIBRARY} -lstdc++)
endif()
if(EQUIMAP_SCALAPACK_LINKS)
  set(EQUIMAP_PC_SCALAPACK "${SCALAPACK_LIBRARY};")
endif()
string(REPLACE ";" " " EQUIMAP_PC_LIBS
       "${EQUIMAP_PC_TETGEN};${HDF5_LIBRARIES};${EQUIMAP_PC_SCALAPACK}${MUMPS_LIBRARY};${METIS_LIBRARY};${CHOLMOD_LIBRARY};${LAPACK_LIBRARIES};${OpenMP_C_FLAGS};-lm")
if(EQUIMAP_STATIC)
  set(EQUIMAP_PC_PUBLIC_REQUIRES ", ${EQUIMAP_PC_REQUIRES}")
  set(EQUIMAP_PC_PUBLIC_LIBS " ${EQUIMAP_PC_LIBS}")
endif()
configure_file(cmake/equimap.pc.in ${CMAKE_CURRENT_BINARY_DIR}/equimap.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/equimap.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# Environment Modules, Lmod: module use PREFIX/share/modulefiles.
configure_file(cmake/modulefile.in ${CMAKE_CURRENT_BINARY_DIR}/modulefile @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/modulefile DESTINATION ${CMAKE_INSTALL_DATADIR}/modulefiles/equimap RENAME ${PROJECT_VERSION})
install(FILES CITATION.cff DESTINATION ${CMAKE_INSTALL_DATADIR}/equimap)
