/* For tests whose checks go on after a failure: main ends with the number of `failures`. */
#ifndef EQM_FAILURES_H
#define EQM_FAILURES_H

#include <stdio.h>

static int failures;

/* Count a failure and say what is wrong if `condition` does not hold; the other arguments are a format and its values.
 */
#define CHECK(condition, ...)                                                                                          \
  do {                                                                                                                 \
    if (!(condition)) {                                                                                                \
      fprintf(stderr, "%s:%d: ", __FILE__, __LINE__);                                                                  \
      fprintf(stderr, __VA_ARGS__);                                                                                    \
      fprintf(stderr, "\n");                                                                                           \
      ++failures;                                                                                                      \
    }                                                                                                                  \
  } while (0)

#endif
