/* Vectors of rows for the dense kernels: four columns at a time, rows in vectors of eight. A row's arithmetic does not
   depend on where in a vector it stands. */
#ifndef EQM_DENSE_VECTORS_H
#define EQM_DENSE_VECTORS_H

#include "linalg/dense.h"

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__GLIBC__) &&                           \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define EQM_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define EQM_CLONES
#endif
#define EQM_INLINE static inline __attribute__((always_inline))

typedef double Vector8 __attribute__((vector_size(64), aligned(8), may_alias));
typedef double Vector4 __attribute__((vector_size(32), aligned(8), may_alias));
typedef double Vector2 __attribute__((vector_size(16), aligned(8), may_alias));
typedef float Single8 __attribute__((vector_size(32), aligned(4), may_alias));
typedef float Single4 __attribute__((vector_size(16), aligned(4), may_alias));
typedef float Single2 __attribute__((vector_size(8), aligned(4), may_alias));

enum { GROUP = 4 };

/* Call STEP(type, type of single precision, LOAD) for as many rows as there are, in vectors that become shorter at the
   end. */
#define FOR_ROWS(row, end, STEP)                                                                                       \
  do {                                                                                                                 \
    for (; (row) + 8 <= (end); (row) += 8) STEP(Vector8, Single8, LOAD_VECTOR);                                        \
    for (; (row) + 4 <= (end); (row) += 4) STEP(Vector4, Single4, LOAD_VECTOR);                                        \
    for (; (row) + 2 <= (end); (row) += 2) STEP(Vector2, Single2, LOAD_VECTOR);                                        \
    for (; (row) < (end); (row)++) STEP(double, float, LOAD_NUMBER);                                                   \
  } while (0)

/* Numbers of a matrix in either precision, as those of double precision that all arithmetic is done in. */
#define LOAD_VECTOR(Double, Single, matrix, is_single, i)                                                              \
  ((is_single) ? __builtin_convertvector(*(const Single *)((const float *)(matrix) + (i)), Double)                     \
               : *(const Double *)((const double *)(matrix) + (i)))
#define LOAD_NUMBER(Double, Single, matrix, is_single, i) Number(matrix, is_single, i)

EQM_INLINE double Number(const void *matrix, const int is_single, size_t i)
{
  return is_single ? (double)((const float *)matrix)[i] : ((const double *)matrix)[i];
}

/* `n` numbers on. */
EQM_INLINE const void *Shift(const void *matrix, const int is_single, PetscInt64 n)
{
  return is_single ? (const void *)((const float *)matrix + n) : (const void *)((const double *)matrix + n);
}

#endif
