/* Texts of mesh files, made line by line. */
#ifndef EQM_TEST_TEXT_H
#define EQM_TEST_TEXT_H

#include <petscsys.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* A text that grows, with line ends of one kind. */
typedef struct {
  char bytes[1 << 17];
  size_t length;
  const char *end;
} Text;

static inline void Line(Text *text, const char *format, ...) PETSC_ATTRIBUTE_FORMAT(2, 3);
static inline void Line(Text *text, const char *format, ...)
{
  va_list arguments;

  va_start(arguments, format);
  text->length += (size_t)vsnprintf(text->bytes + text->length, sizeof(text->bytes) - text->length, format, arguments);
  va_end(arguments);
  text->length += (size_t)snprintf(text->bytes + text->length, sizeof(text->bytes) - text->length, "%s", text->end);
}

static inline void Bytes(Text *text, const void *bytes, size_t length)
{
  memcpy(text->bytes + text->length, bytes, length);
  text->length += length;
}

enum { QUADS = 1, TEXTURE = 2, GROUPS = 4, BACKWARDS = 8, MIXED = 16, NUMBERS = 32 };

static inline void Face(Text *text, int kinds, int num, const int *corner, const char *rest)
{
  char line[200];
  int used = snprintf(line, sizeof(line), "f");

  for (int k = 0; k < num; k++) {
    used += snprintf(line + used, sizeof(line) - (size_t)used,
                     kinds & TEXTURE ? " %d/%d"
                     : k             ? " %d"
                                     : " %d//1",
                     corner[k], corner[k]);
  }
  Line(text, "%s%s", line, rest);
}

/* Rows of squares, `MIXED`: each row's faces directly behind its vertices; with lines that say nothing. */
static inline void MakeObjText(Text *text, PetscInt n, int kinds, const char *end)
{
  *text = (Text){.end = end};
  Line(text, "# made \\");
  Line(text, "mtllib none.mtl");
  for (PetscInt j = 0, passes = kinds & MIXED ? 1 : 2; j < passes * n; j++) {
    const PetscInt row = j % n;
    for (PetscInt i = 0; i < n && j < n; i++) {
      Line(text, i % 3 ? "v %.17g %g %g" : "  v  %.17g\t%g %g ", (double)i / 3., (double)row, .01 * (double)(i * row));
      if (kinds & TEXTURE)
        Line(text, i % 5 ? "vt %g %g" : "vt %g %g 0", (double)i / (double)n, (double)row / (double)n);
      if (i % 4 == 0) Line(text, "vn 0 0 1");
    }
    if (row == 2) Line(text, "usemtl paint");
    if (row % 4 == 1) Line(text, "%s", "");
    if (kinds & GROUPS && row % 3 == 1) Line(text, row % 2 ? "g part %d" : "o part %d", (int)(row / 2 % 4));
    if (kinds & NUMBERS && row % 2 == 1) Line(text, "g group_%d", (int)(row < 8 ? row : row / 2));
    for (PetscInt i = 0; i + 1 < n && row > 0 && (kinds & MIXED || j >= n); i++) {
      const PetscInt last = kinds & MIXED ? (row + 1) * n : n * n, shift = kinds & BACKWARDS ? -last - 1 : 0;
      const int a = (int)((row - 1) * n + i + 1 + shift), b = a + 1, c = b + (int)n, d = a + (int)n;
      if (kinds & QUADS && i % 2 == 0) {
        Face(text, kinds, 3, (const int[]){a, b, c}, " \\");
        Line(text, kinds & TEXTURE ? "  %d/%d" : "  %d", d, d);
      } else if (kinds & QUADS) {
        Face(text, kinds, 4, (const int[]){a, b, c, d}, " # a face");
      } else {
        Face(text, kinds, 3, (const int[]){a, b, c}, "");
      }
    }
  }
}

#endif
