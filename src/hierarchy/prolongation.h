#ifndef EQM_PROLONGATION_H
#define EQM_PROLONGATION_H

#include "hierarchy/blockmatrix.h"
#include "hierarchy/levelmap.h"

enum { EQM_PROLONGATION_WIDTH = 3 };

/* What takes motions of a coarser level's vertices to those of the next finer one's, in the directions that each has
   (EqmMotionFrame), three coarse vertices at most for each fine one. They are taken in the image, where a fine vertex
   is their mean with positive weights: affine motions of the plane and rotations of the sphere come out exact. */
typedef struct {
  PetscInt num_fine, num_coarse;
  PetscInt num_rows, num_columns; /* the same, with those of other ranks that products have to know */
  PetscInt *column;               /* EQM_PROLONGATION_WIDTH per row: coarse vertices; -1: none */
  EqmBlock *entry;                /* for each of these */
  unsigned char *plain;           /* per row: its blocks are multiples of one, by .. */
  PetscReal *weight;              /* EQM_PROLONGATION_WIDTH per row */
  PetscInt *start, *from;         /* per coarse vertex: which of these are its */
} EqmProlongation;

/* A fine vertex as the mean of coarse ones, which are given by their numbers on the finer level. */
typedef struct {
  PetscInt count, vertex[EQM_PROLONGATION_WIDTH];
  PetscReal weight[EQM_PROLONGATION_WIDTH];
} EqmProlongationRow;
/* Those of the vertices of the map's records begin .. end - 1, the last first, when all others of their rings have
   theirs; a coarse vertex's is itself. Not collective. */
PETSC_INTERN void EqmProlongationRows(const EqmLevelMap *map, PetscInt begin, PetscInt end, EqmProlongationRow *rows);

/* The prolongation with these rows, of which there are num_fine; `number`: of each coarse vertex among the num_coarse
   ones; room for num_rows. Not collective. */
PETSC_INTERN PetscErrorCode EqmProlongationSet(const EqmLevelMap *map, const EqmProlongationRow *rows,
                                               const PetscInt *number, PetscInt num_fine, PetscInt num_rows,
                                               PetscInt num_coarse, EqmProlongation *prolongation);
/* Find out which of the rows begin .. end - 1 are plain, once their blocks are there. Not collective. */
PETSC_INTERN void EqmProlongationFindPlain(EqmProlongation *prolongation, PetscInt begin, PetscInt end);
/* The places of the coarser map must be those of the finer one. Not collective. */
PETSC_INTERN PetscErrorCode EqmProlongationCreate(const EqmLevelMap *finer, const EqmLevelMap *coarser,
                                                  EqmProlongation *prolongation);
PETSC_INTERN PetscErrorCode EqmProlongationDestroy(EqmProlongation *prolongation);
/* fine += P coarse, and coarse = P^T fine; two numbers per vertex. Not collective. */
PETSC_INTERN void EqmProlongationAdd(const EqmProlongation *prolongation, const PetscReal *coarse, PetscReal *fine);
PETSC_INTERN void EqmProlongationRestrict(const EqmProlongation *prolongation, const PetscReal *fine,
                                          PetscReal *coarse);
/* P^T A P: its pattern, which that of A tells, and its entries for the present ones of A, symmetric to the last bit but
   for other ranks' columns. Not collective. */
PETSC_INTERN PetscErrorCode EqmProlongationGalerkinPattern(const EqmProlongation *prolongation,
                                                           const EqmBlockMatrix *fine, EqmBlockMatrix *coarse);
PETSC_INTERN PetscErrorCode EqmProlongationGalerkinFill(const EqmProlongation *prolongation, const EqmBlockMatrix *fine,
                                                        EqmBlockMatrix *coarse);

#endif
