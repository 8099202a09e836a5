/* The cells of a soup on their way to the ranks that own their vertices. */
#ifndef EQM_CELLS_H
#define EQM_CELLS_H

#include <equimap/soup.h>

/* Whether a cell of a soup names only vertices that exist, and none twice. */
typedef enum { EQM_CELL_USABLE, EQM_CELL_BAD_INDEX, EQM_CELL_REPEATED_VERTEX } EqmCellUse;
PETSC_INTERN EqmCellUse EqmSoupCellUse(EqmSoup soup, const PetscInt *cell);

/* The usable cells around the vertices that a rank owns, as they arrive, in input order: each with its input number,
   its vertices in input numbering and their owners. */
typedef struct {
  PetscInt cell_size, num_cells;
  PetscInt *records; /* per cell: input cell number, cell_size vertices, cell_size owners */
  PetscInt width;    /* integers per record */
} EqmStars;

PETSC_INTERN PetscErrorCode EqmStarsCollect(EqmSoup soup, const PetscInt *owner_of_slab, EqmStars *stars);
PETSC_INTERN PetscErrorCode EqmStarsReset(EqmStars *stars);

#endif
