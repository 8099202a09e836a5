# The plain comments of the headers as Doxygen reads them: the first is the file's; one before declarations belongs to
# all that follow it, up to the next comment or empty line; one behind a declaration belongs to it.
NR == 1 { sub(/^\/\* /, "/** \\file\n") }
/^\/\* ----/ { print ""; next }                      # headings between groups
/^\/\* / {                                           # a comment begins; the name in front is the declaration's own
  sub(/^\/\* (Eqm[A-Za-z]* - )?/, "/** ")
  comment = ""
  declared = 0
  inside = 1
}
inside {
  comment = comment $0 "\n"
  inside = !/\*\//
  print
  next
}
/^ *$/ { comment = "" }
/^PETSC_EXTERN / {
  if (declared++) printf "%s", comment
}
{
  if (sub(/^ +\/\* /, "/** ") == 0) sub(/ \/\* /, " /**< ")
  print
}
