/* Dense kernels of solves, with matrices in either precision. */
#include "linalg/dense_vectors.h"

/* x -= L y for a group of columns of L, `count` columns of x. */
EQM_INLINE void ForwardRows(const int many, const int count, const int is_single, const void *l, PetscInt stride,
                            PetscInt begin, PetscInt end, double (*y)[EQM_MOST_COLUMNS], double *x)
{
  PetscInt i = begin;

#define STEP(Type, Single, LOAD)                                                                                       \
  do {                                                                                                                 \
    Type sum[EQM_MOST_COLUMNS];                                                                                        \
    for (int q = 0; q < many; q++) __builtin_prefetch(Shift(l, is_single, (PetscInt64)(q + 2 * GROUP) * stride + i));  \
    for (int c = 0; c < count; c++) sum[c] = LOAD(Type, Single, l, is_single, (size_t)i) * y[0][c];                    \
    for (int q = 1; q < many; q++) {                                                                                   \
      const Type value = LOAD(Type, Single, l, is_single, (size_t)q * (size_t)stride + (size_t)i);                     \
      for (int c = 0; c < count; c++) sum[c] += value * y[q][c];                                                       \
    }                                                                                                                  \
    for (int c = 0; c < count; c++) *(Type *)(x + (size_t)c * (size_t)stride + i) -= sum[c];                           \
  } while (0)
  FOR_ROWS(i, end, STEP);
#undef STEP
}

EQM_INLINE void Forward(const int count, const int is_single, const void *l, PetscInt rows, PetscInt columns, double *x)
{
  for (PetscInt j = 0; j < columns; j += GROUP) {
    const PetscInt many = PetscMin(GROUP, columns - j);
    const void *const group = Shift(l, is_single, (PetscInt64)j * rows), *const triangle = Shift(group, is_single, j);
    double y[GROUP][EQM_MOST_COLUMNS];
    for (PetscInt q = 0; q < many; q++) {
      for (int c = 0; c < count; c++) {
        double value = x[(size_t)c * (size_t)rows + j + q];
        for (PetscInt p = 0; p < q; p++) value -= Number(triangle, is_single, (size_t)p * (size_t)rows + q) * y[p][c];
        x[(size_t)c * (size_t)rows + j + q] = y[q][c] =
            value / Number(triangle, is_single, (size_t)q * (size_t)(rows + 1));
      }
    }
    if (many == GROUP) {
      ForwardRows(GROUP, count, is_single, group, rows, j + GROUP, rows, y, x);
    } else {
      for (PetscInt q = 0; q < many; q++)
        ForwardRows(1, count, is_single, Shift(group, is_single, (PetscInt64)q * rows), rows, j + many, rows, y + q, x);
    }
  }
}

/* sum[q][c] = column q of L times column c of x, rows begin .. end - 1: four partial sums, then the rest. */
EQM_INLINE void DotRows(const int many, const int count, const int is_single, const void *l, PetscInt stride,
                        PetscInt begin, PetscInt end, const double *x, double (*sum)[EQM_MOST_COLUMNS])
{
  Vector4 partial[GROUP][EQM_MOST_COLUMNS];
  PetscInt i = begin;

  for (int q = 0; q < many; q++) {
    for (int c = 0; c < count; c++) partial[q][c] = (Vector4){0};
  }
  for (; i + 4 <= end; i += 4) {
    for (int q = 0; q < many; q++) {
      __builtin_prefetch(Shift(l, is_single, i - (PetscInt64)(2 * GROUP - q) * stride));
      const Vector4 value = LOAD_VECTOR(Vector4, Single4, l, is_single, (size_t)q * (size_t)stride + (size_t)i);
      for (int c = 0; c < count; c++) partial[q][c] += value * *(const Vector4 *)(x + (size_t)c * (size_t)stride + i);
    }
  }
  for (int q = 0; q < many; q++) {
    for (int c = 0; c < count; c++) {
      const Vector4 *const p = &partial[q][c];
      sum[q][c] = ((*p)[0] + (*p)[1]) + ((*p)[2] + (*p)[3]);
      for (PetscInt k = i; k < end; k++)
        sum[q][c] += Number(l, is_single, (size_t)q * (size_t)stride + (size_t)k) * x[(size_t)c * (size_t)stride + k];
    }
  }
}

EQM_INLINE void Backward(const int count, const int is_single, const void *l, PetscInt rows, PetscInt columns,
                         double *x)
{
  for (PetscInt j = (columns - 1) / GROUP * GROUP; j >= 0; j -= GROUP) {
    const PetscInt many = PetscMin(GROUP, columns - j);
    const void *const group = Shift(l, is_single, (PetscInt64)j * rows), *const triangle = Shift(group, is_single, j);
    double sum[GROUP][EQM_MOST_COLUMNS];
    if (many == GROUP) {
      DotRows(GROUP, count, is_single, group, rows, j + GROUP, rows, x, sum);
    } else {
      for (PetscInt q = 0; q < many; q++)
        DotRows(1, count, is_single, Shift(group, is_single, (PetscInt64)q * rows), rows, j + many, rows, x, sum + q);
    }
    for (PetscInt q = many - 1; q >= 0; q--) {
      for (int c = 0; c < count; c++) {
        double *const column = x + (size_t)c * (size_t)rows + j, value = column[q] - sum[q][c];
        for (PetscInt p = q + 1; p < many; p++)
          value -= Number(triangle, is_single, (size_t)q * (size_t)rows + p) * column[p];
        column[q] = value / Number(triangle, is_single, (size_t)q * (size_t)(rows + 1));
      }
    }
  }
}

/* The kernel with its constants known to the compiler. */
#define WITH_COUNT(Kernel, is_single)                                                                                  \
  do {                                                                                                                 \
    switch (count) {                                                                                                   \
    case 4:                                                                                                            \
      Kernel(4, is_single, l, rows, columns, x);                                                                       \
      break;                                                                                                           \
    case 3:                                                                                                            \
      Kernel(3, is_single, l, rows, columns, x);                                                                       \
      break;                                                                                                           \
    case 2:                                                                                                            \
      Kernel(2, is_single, l, rows, columns, x);                                                                       \
      break;                                                                                                           \
    default:                                                                                                           \
      Kernel(1, is_single, l, rows, columns, x);                                                                       \
    }                                                                                                                  \
  } while (0)

EQM_CLONES void EqmDenseForward(const PetscScalar *l, PetscInt rows, PetscInt columns, PetscInt count, PetscScalar *x)
{
  WITH_COUNT(Forward, 0);
}

EQM_CLONES void EqmDenseBackward(const PetscScalar *l, PetscInt rows, PetscInt columns, PetscInt count, PetscScalar *x)
{
  WITH_COUNT(Backward, 0);
}

EQM_CLONES void EqmDenseForwardSingle(const float *l, PetscInt rows, PetscInt columns, PetscInt count, PetscScalar *x)
{
  WITH_COUNT(Forward, 1);
}

EQM_CLONES void EqmDenseBackwardSingle(const float *l, PetscInt rows, PetscInt columns, PetscInt count, PetscScalar *x)
{
  WITH_COUNT(Backward, 1);
}
