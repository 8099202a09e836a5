# The reference of the library by Doxygen; fails if Doxygen complains of a comment, or of a public function, type or macro
# without one. Fields of structures and values of enumerations may speak for themselves.
#   cmake -DDOXYGEN=PROGRAM -DDOXYFILE=FILE -DWARNINGS=FILE -P reference.cmake
get_filename_component(folder ${WARNINGS} DIRECTORY)
file(REMOVE_RECURSE ${folder})
file(MAKE_DIRECTORY ${folder})
execute_process(COMMAND ${DOXYGEN} ${DOXYFILE} RESULT_VARIABLE code)
file(STRINGS ${WARNINGS} lines)
list(FILTER lines EXCLUDE REGEX "\\((variable|enumvalue)\\) of .* is not documented")
list(JOIN lines "\n" text)
if(lines OR NOT code EQUAL 0)
  message(FATAL_ERROR "Doxygen ended with ${code}\n${text}")
endif()
