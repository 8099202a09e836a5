/* Every piece of a mesh mapped on its own, to one result. */
#ifndef EQM_PIECES_H
#define EQM_PIECES_H

#include "maprun.h"

/* What came of a piece. */
typedef struct {
  PetscInt number; /* 1: the largest */
  EqmStatus status;
  PetscInt64 cells, folds;
  PetscReal measure; /* area, density included */
  PetscReal image;   /* that of its image */
  PetscReal energy, sd;
  char message[EQM_MESSAGE_MAX]; /* why it is not mapped */
} EqmPiece;

typedef struct {
  EqmMap map;              /* of the file's mesh: the image of each piece fills a unit target of its own */
  PetscInt num_pieces;     /* of the mesh */
  PetscInt num_mapped;     /* entries of `piece` that are mapped; others follow */
  EqmPiece *piece;         /* those of `num_pieces` */
  PetscInt *vertex, *cell; /* per vertex and cell of the slab the number of its piece, 0: it is not mapped */
} EqmPieces;

/* Map every piece that the target takes, prepared one by one, and tell of each. Collective. Errors: EQM_ERR_MESH (no
   piece can be mapped), EQM_ERR_USAGE. */
PETSC_INTERN PetscErrorCode EqmPiecesSolve(const char *command, const EqmIntakeOptions *options, const EqmIntake *input,
                                           const EqmStopFile *stop_file, EqmLedger ledger, EqmPieces *pieces);
/* The figures of the whole, after its pieces have been mapped: ratios, energies, status and arrays of pieces->map.
   `mark` is the EqmCellFate of the cells of the slab. Collective. */
PETSC_INTERN PetscErrorCode EqmPiecesMeasure(const char *command, const EqmIntake *input, EqmLedger ledger,
                                             const PetscInt *mark, EqmPieces *pieces);
/* The map with the images of its pieces side by side in the unit square, their areas in proportion: for a texture. Of
   maps to the disk or the square. Collective. */
PETSC_INTERN PetscErrorCode EqmPiecesCharts(const EqmPieces *pieces, EqmMap *charts);
PETSC_INTERN PetscErrorCode EqmPiecesDestroy(EqmPieces *pieces);

#endif
