/* What the files of this folder share, and use of others. */
#ifndef EQM_STORE_H
#define EQM_STORE_H

#include <equimap/map.h>
#include "h5/h5.h"

/* Version of the layout of result files, their attribute format_version; files without it are of version 1, whose texts
   are of fixed length and which have fields of angles, all zero, for solids, too. */
#define EQM_RESULT_VERSION 2
/* Fail if a result was written in a layout that this library does not know. Collective. Errors: EQM_ERR_IO. */
PETSC_INTERN PetscErrorCode EqmCheckResultVersion(EqmH5 h5);

/* Does a name end in `suffix`, in small or capital letters? Not collective. */
PETSC_INTERN PetscBool EqmHasSuffix(const char *name, const char *suffix);
/* NAME.h5 becomes NAME`suffix`; to any other name the suffix is appended. Not collective. */
PETSC_INTERN PetscErrorCode EqmNameBeside(const char *file, const char *suffix, char *name, size_t length);
/* The lower edge of a bin of the histogram of ratios; of bin EQM_NUM_RATIO_BINS, the upper edge of the last. Not
   collective. */
PETSC_INTERN PetscReal EqmRatioEdge(const EqmDistortion *distortion, PetscInt bin);
/* Write the result file: everything about the map. Collective. Errors: EQM_ERR_IO. */
PETSC_INTERN PetscErrorCode EqmMapWriteResult(EqmMap map, const char *file);
/* Its part that holds the history. Collective. Errors: EQM_ERR_IO. */
PETSC_INTERN PetscErrorCode EqmResultDeclareHistory(EqmH5 h5, EqmMap map);
PETSC_INTERN PetscErrorCode EqmResultWriteHistory(EqmH5 h5, EqmMap map);
/* Write NAME.xmf, the mesh, and NAME.map.xmf, its image, beside the result NAME.h5 for ParaView. Collective; rank 0
 * writes. Errors: EQM_ERR_IO. */
PETSC_INTERN PetscErrorCode EqmMapWriteXdmf(EqmMap map, const char *result_file);
/* The array of the result file that holds the points of frame number %d of a morph. */
#define EQM_FRAME_PATH "/morph/frame_%03" PetscInt_FMT
/* Write NAME.morph.xmf beside the result NAME.h5: its frames as a time series from 0 to 1. Collective; rank 0 writes.
   Errors: EQM_ERR_IO. */
PETSC_INTERN PetscErrorCode EqmMapWriteMorph(EqmMap map, const char *result_file, PetscInt num_frames);
/* Free what EqmMapAdd... added. Not collective. */
PETSC_INTERN PetscErrorCode EqmMapResetExtras(EqmMap map);
/* Write the mesh with its vertices at their images (z = 0 for planar maps), with fields where the format has room.
   Collective; rank 0 gathers and writes. Errors: EQM_ERR_IO. */
PETSC_INTERN PetscErrorCode EqmMapWriteImage(EqmMap map, const char *file);

#endif
