/* PETSc's macros and types in plain C, for cppcheck alone. */
#define PETSC_INTERN extern
#define PETSC_EXTERN extern
#define PETSC_TRUE   1
#define PETSC_FALSE  0
#define PetscFunctionBegin
#define PetscFunctionReturn(code) return code
#define PetscCall(...)                                                                                                 \
  do {                                                                                                                 \
    int e_ = (__VA_ARGS__);                                                                                            \
    if (e_) return e_;                                                                                                 \
  } while (0)
#define PetscCallMPI(...) PetscCall(__VA_ARGS__)
#define PetscCheck(condition, comm, code, ...)                                                                         \
  do {                                                                                                                 \
    if (!(condition)) return code;                                                                                     \
  } while (0)
#define PetscMin(a, b)     ((a) < (b) ? (a) : (b))
#define PetscMax(a, b)     ((a) > (b) ? (a) : (b))
#define PetscMalloc1(n, p) ((*(p) = malloc((size_t)(n) * sizeof(**(p)))) ? 0 : 55)
#define PetscCalloc1(n, p) ((*(p) = calloc((size_t)(n), sizeof(**(p)))) ? 0 : 55)
#define PetscNew(p)        PetscCalloc1(1, p)
#define PetscFree(p)       (free(p), (p) = 0, 0)
typedef int PetscErrorCode, PetscBool, PetscInt, PetscMPIInt;
typedef double PetscReal;
typedef long long PetscInt64;
