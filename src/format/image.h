/* The image of a mesh as other programs leave it: in the vertices of a mesh file, in its texture coordinates, or as
   points. */
#ifndef EQM_FORMAT_IMAGE_H
#define EQM_FORMAT_IMAGE_H

#include <equimap/soup.h>

typedef enum {
  EQM_IMAGE_AUTO,     /* texture coordinates where the vertices repeat the mesh, else the vertices */
  EQM_IMAGE_VERTICES, /* the vertices */
  EQM_IMAGE_TEXTURE   /* the texture coordinates */
} EqmImageSource;

typedef struct {
  EqmSoup
      soup; /* the mesh that the image belongs to: the given one, or (owned) the one cut along the texture's seams */
  PetscBool owned;
  PetscInt dim;           /* 2 or 3 */
  PetscReal *coordinates; /* dim per vertex of the soup's slab */
  PetscInt num_copies;    /* vertices that the seams added; they come after the others */
  PetscBool texture;      /* texture coordinates were read */
} EqmImage;

PETSC_INTERN PetscErrorCode EqmImageRead(EqmSoup soup, const char *file, EqmImageSource source, EqmImage *image);
PETSC_INTERN PetscErrorCode EqmImageReset(EqmImage *image);

#endif
