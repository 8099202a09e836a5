/* Dense kernels of factorisations. */
#include "linalg/dense_vectors.h"
#include <float.h>

/* c[i, q] (-)= sum of a[i, p] a[j + q, p] over p < depth, for `many` columns q and the rows i = begin .. end - 1. */
EQM_INLINE void Subtract(const int many, const int replace, const double *a, PetscInt stride, PetscInt depth,
                         PetscInt j, PetscInt begin, PetscInt end, double *c, PetscInt c_stride)
{
  PetscInt i = begin;

#define STEP(Type, Single, LOAD)                                                                                       \
  do {                                                                                                                 \
    Type sum[GROUP];                                                                                                   \
    const double *column = a;                                                                                          \
    for (int q = 0; q < many; q++) sum[q] = (Type){0};                                                                 \
    for (PetscInt p = 0; p < depth; p++, column += stride) {                                                           \
      const Type x = *(const Type *)(column + i);                                                                      \
      for (int q = 0; q < many; q++) sum[q] += x * column[j + q];                                                      \
    }                                                                                                                  \
    for (int q = 0; q < many; q++) {                                                                                   \
      Type *const to = (Type *)(c + (size_t)q * (size_t)c_stride + i);                                                 \
      if (replace)                                                                                                     \
        *to = -sum[q];                                                                                                 \
      else                                                                                                             \
        *to -= sum[q];                                                                                                 \
    }                                                                                                                  \
  } while (0)
  FOR_ROWS(i, end, STEP);
#undef STEP
}

/* With the number of columns known to the compiler. */
EQM_INLINE void SubtractGroup(PetscInt many, const int replace, const double *a, PetscInt stride, PetscInt depth,
                              PetscInt j, PetscInt begin, PetscInt end, double *c, PetscInt c_stride)
{
  switch (many) {
  case 4:
    Subtract(4, replace, a, stride, depth, j, begin, end, c, c_stride);
    break;
  case 3:
    Subtract(3, replace, a, stride, depth, j, begin, end, c, c_stride);
    break;
  case 2:
    Subtract(2, replace, a, stride, depth, j, begin, end, c, c_stride);
    break;
  default:
    Subtract(1, replace, a, stride, depth, j, begin, end, c, c_stride);
  }
}

/* Divide rows by the transpose of the group's triangle, whose first entry is `triangle`; `rows` has the same columns.
 */
EQM_INLINE void DivideRows(PetscInt many, const double *triangle, PetscInt stride, PetscInt begin, PetscInt end,
                           double *rows)
{
  for (PetscInt q = 0; q < many; q++) {
    double *const column = rows + (size_t)q * (size_t)stride;
    const double inverse = 1. / triangle[(size_t)q * (size_t)(stride + 1)];
    for (PetscInt p = 0; p < q; p++) {
      const double *const before = rows + (size_t)p * (size_t)stride, factor = triangle[(size_t)p * (size_t)stride + q];
      for (PetscInt i = begin; i < end; i++) column[i] -= factor * before[i];
    }
    for (PetscInt i = begin; i < end; i++) column[i] *= inverse;
  }
}

/* Products of many columns go through copies in which what is read together lies together: strips of STRIP rows and
   groups of GROUP columns, DEPTH numbers deep. */
enum { STRIP = 8, DEPTH = 256, MOST_COPIED = 64, LEAST_COPIED = 32 };

EQM_INLINE void CopyStrip(const double *a, PetscInt stride, PetscInt depth, PetscInt begin, PetscInt end, double *strip)
{
  for (PetscInt p = 0; p < depth; p++) {
    const double *const column = a + (size_t)p * (size_t)stride + begin;
    if (end - begin >= STRIP) {
      *(Vector8 *)(strip + STRIP * p) = *(const Vector8 *)column;
    } else {
      for (PetscInt r = 0; r < STRIP; r++) strip[STRIP * p + r] = r < end - begin ? column[r] : 0.;
    }
  }
}

EQM_INLINE void CopyGroup(const double *a, PetscInt stride, PetscInt depth, PetscInt begin, PetscInt end, double *group)
{
  for (PetscInt p = 0; p < depth; p++) {
    const double *const column = a + (size_t)p * (size_t)stride + begin;
    for (PetscInt q = 0; q < GROUP; q++) group[GROUP * p + q] = q < end - begin ? column[q] : 0.;
  }
}

/* A strip times a group, taken off (or in place of) what stands at the rows below `rows` and columns below `many`. */
EQM_INLINE void SubtractTile(PetscBool replace, PetscInt depth, const double *strip, const double *group, PetscInt rows,
                             PetscInt many, double *c, PetscInt c_stride)
{
  Vector8 sum[GROUP] = {{0}};

  for (PetscInt p = 0; p < depth; p++) {
    const Vector8 x = *(const Vector8 *)(strip + STRIP * p);
    for (int q = 0; q < GROUP; q++) sum[q] += x * group[GROUP * p + q];
  }
  for (int q = 0; q < GROUP; q++) {
    double *const to = c + (size_t)q * (size_t)c_stride;
    if (q >= many) continue;
    if (rows >= STRIP) {
      if (replace)
        *(Vector8 *)to = -sum[q];
      else
        *(Vector8 *)to -= sum[q];
    } else {
      for (PetscInt r = 0; r < rows; r++) to[r] = replace ? -sum[q][r] : to[r] - sum[q][r];
    }
  }
}

/* The same for the columns begin .. end - 1, at most MOST_COPIED, and the rows from row_begin on, as far as they are
   not above the diagonal. */
EQM_INLINE void SubtractCopied(PetscBool replace, const double *a, PetscInt stride, PetscInt depth, PetscInt begin,
                               PetscInt end, PetscInt row_begin, PetscInt row_end, double *c, PetscInt c_stride)
{
  double groups[MOST_COPIED * DEPTH] __attribute__((aligned(64))), strip[STRIP * DEPTH] __attribute__((aligned(64)));

  for (PetscInt p = 0; p < depth; p += DEPTH) {
    const PetscInt deep = PetscMin(DEPTH, depth - p);
    const double *const from = a + (size_t)p * (size_t)stride;
    for (PetscInt j = begin; j < end; j += GROUP)
      CopyGroup(from, stride, deep, j, end, groups + (size_t)(j - begin) * (size_t)deep);
    for (PetscInt i = row_begin; i < row_end; i += STRIP) {
      CopyStrip(from, stride, deep, i, row_end, strip);
      for (PetscInt j = begin; j < end && j < i + STRIP; j += GROUP)
        SubtractTile((PetscBool)(replace && p == 0), deep, strip, groups + (size_t)(j - begin) * (size_t)deep,
                     row_end - i, end - j, c + (size_t)(j - begin) * (size_t)c_stride + i, c_stride);
    }
  }
}

/* Columns begin .. end - 1 lose what `depth` columns before them say, rows from row_begin on. */
EQM_INLINE void SubtractColumns(const int replace, const double *a, PetscInt stride, PetscInt depth, PetscInt begin,
                                PetscInt end, PetscInt row_begin, PetscInt row_end, double *c, PetscInt c_stride)
{
  if (depth >= LEAST_COPIED && end - begin >= 2 * GROUP) {
    SubtractCopied((PetscBool)replace, a, stride, depth, begin, end, row_begin, row_end, c, c_stride);
    return;
  }
  for (PetscInt j = begin; j < end; j += GROUP)
    SubtractGroup(PetscMin(GROUP, end - j), replace, a, stride, depth, j, PetscMax(j, row_begin), row_end,
                  c + (size_t)(j - begin) * (size_t)c_stride, c_stride);
}

EQM_CLONES PetscBool EqmDenseFactorBlock(PetscScalar *matrix, PetscInt stride, PetscInt begin, PetscInt end)
{
  double *const block = matrix + (size_t)begin * (size_t)stride;

  if (begin > 0) SubtractColumns(0, matrix, stride, begin, begin, end, begin, end, block, stride);
  for (PetscInt j = begin; j < end; j += GROUP) {
    const PetscInt many = PetscMin(GROUP, end - j);
    double *const columns = matrix + (size_t)j * (size_t)stride, *const triangle = columns + j;
    SubtractGroup(many, 0, block, stride, j - begin, j, j, end, columns, stride);
    for (PetscInt q = 0; q < many; q++) {
      double *const column = triangle + (size_t)q * (size_t)stride;
      for (PetscInt p = 0; p < q; p++) {
        const double *const before = triangle + (size_t)p * (size_t)stride;
        for (PetscInt i = q; i < many; i++) column[i] -= before[q] * before[i];
      }
      if (!(column[q] > 0.)) return PETSC_FALSE;
      column[q] = PetscSqrtReal(column[q]);
      for (PetscInt i = q + 1; i < many; i++) column[i] /= column[q];
    }
    DivideRows(many, triangle, stride, j + many, end, columns);
  }
  return PETSC_TRUE;
}

EQM_CLONES void EqmDenseFactorRows(PetscScalar *matrix, PetscInt stride, PetscInt begin, PetscInt end,
                                   PetscInt row_begin, PetscInt row_end)
{
  double *const block = matrix + (size_t)begin * (size_t)stride;

  if (begin > 0) SubtractColumns(0, matrix, stride, begin, begin, end, row_begin, row_end, block, stride);
  for (PetscInt j = begin; j < end; j += GROUP) {
    const PetscInt many = PetscMin(GROUP, end - j);
    double *const columns = matrix + (size_t)j * (size_t)stride;
    SubtractGroup(many, 0, block, stride, j - begin, j, row_begin, row_end, columns, stride);
    DivideRows(many, columns + j, stride, row_begin, row_end, columns);
  }
}

EQM_CLONES void EqmDenseUpdate(const PetscScalar *b, PetscInt stride, PetscInt rows, PetscInt depth, PetscInt begin,
                               PetscInt end, PetscScalar *update)
{
  for (PetscInt j = begin; j < end; j += MOST_COPIED)
    SubtractColumns(1, b, stride, depth, j, PetscMin(j + MOST_COPIED, end), j, rows, update + (size_t)j * (size_t)rows,
                    rows);
}

EQM_CLONES PetscBool EqmDenseNarrow(const PetscScalar *l, PetscInt rows, PetscInt columns, float *narrow)
{
  int bad = 0;

  for (PetscInt j = 0; j < columns; j++) {
    const size_t diagonal = (size_t)j * (size_t)(rows + 1), end = (size_t)(j + 1) * (size_t)rows;
    for (size_t i = diagonal; i < end; i++) {
      narrow[i] = (float)l[i];
      bad |= !(PetscAbsReal(l[i]) <= FLT_MAX);
    }
    bad |= !(l[diagonal] >= FLT_MIN);
  }
  return (PetscBool)!bad;
}
