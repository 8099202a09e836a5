/* What people look at: a page of pictures and plots of one result. All but EqmReportWrite runs on one rank. */
#ifndef EQM_PICTURE_H
#define EQM_PICTURE_H

#include <stdint.h>
#include <equimap/map.h>

PETSC_EXTERN PetscErrorCode EqmReportWrite(MPI_Comm comm, const char *result_file, const char *picture, PetscInt width);

/* A result as it was stored, read back whole. */
typedef struct {
  char command[64], method[64], status[64], message[EQM_MESSAGE_MAX], mesh_file[PETSC_MAX_PATH_LEN];
  char other_file[PETSC_MAX_PATH_LEN]; /* of a registration: B's mesh; else empty */
  char version[64], commit[64], date[64], options[8192];
  PetscInt64 iterations, folds, ranks, threads;
  PetscReal energy_initial, energy_final, angle_mean, angle_median, seconds;
  PetscInt num_vertices, num_cells, cell_size, dim;
  PetscReal *vertices; /* 3 * num_vertices */
  PetscReal *images;   /* 3 * num_vertices; planar maps have z = 0 */
  PetscReal *target;   /* of a registration: where vertices lie in the target, 3 * num_vertices; else NULL */
  PetscInt target_dim; /* coordinates there */
  PetscInt *cells;     /* cell_size * num_cells */
  PetscReal *ratio;    /* per cell */
  EqmStatistics ratio_statistics;
  PetscInt num_history;
  PetscReal *iteration, *energy, *elapsed; /* per row of the history */
} EqmResult;

PETSC_INTERN PetscErrorCode EqmResultLoad(const char *file, EqmResult *result);
PETSC_INTERN PetscErrorCode EqmResultReset(EqmResult *result);

/* Triangles to draw, at the places of one array of points; each belongs to a cell. */
typedef struct {
  PetscInt num_faces;
  PetscInt *vertices; /* 3 per face, outward */
  PetscInt *cell;     /* per face */
} EqmFaces;

PETSC_INTERN PetscErrorCode EqmFacesOfSurface(const EqmResult *result, EqmFaces *faces);
PETSC_INTERN PetscErrorCode EqmFacesOfCut(const EqmResult *result, const PetscReal direction[3], EqmFaces *faces);
PETSC_INTERN PetscErrorCode EqmFacesReset(EqmFaces *faces);
PETSC_INTERN PetscErrorCode EqmFacesNormals(const EqmFaces *faces, const PetscReal *points, PetscInt num_points,
                                            float **normals);

/* An orthographic eye: an orthonormal frame, and the square that it sees. */
typedef struct {
  double right[3], up[3], toward[3]; /* `toward` points from the scene to the eye */
  double center[3], half_width;
} EqmCamera;

PETSC_INTERN EqmCamera EqmCameraFlat(void);
PETSC_INTERN EqmCamera EqmCameraTurned(const double pole[3], const double front[3], double azimuth, double elevation);
PETSC_INTERN EqmCamera EqmCameraGuess(const EqmFaces *faces, const PetscReal *points);
PETSC_INTERN void EqmCameraFit(EqmCamera *camera, const EqmFaces *faces, const PetscReal *points);

/* What is seen in each sample of a square picture: which face, where in it. */
typedef struct {
  int size;      /* samples per side */
  int32_t *face; /* -1: nothing */
  float *depth;  /* larger is nearer */
  float *corner; /* 2 per sample: weights of the face's first two vertices */
} EqmRaster;

PETSC_INTERN PetscErrorCode EqmRasterCreate(int size, EqmRaster *raster);
PETSC_INTERN PetscErrorCode EqmRasterDestroy(EqmRaster *raster);
PETSC_INTERN PetscErrorCode EqmRasterDraw(EqmRaster *raster, const EqmCamera *camera, const EqmFaces *faces,
                                          const PetscReal *points, PetscInt num_points);

/* Colours, red green blue in 0 ... 1. */
typedef struct {
  double limit; /* ratios from 1/limit to limit have a colour of their own; on a log scale */
} EqmColorScale;

PETSC_INTERN EqmColorScale EqmColorScaleOf(const PetscReal *ratio, PetscInt count);
PETSC_INTERN void EqmColorOfRatio(EqmColorScale scale, double ratio, double rgb[3]);

/* A pattern in the image whose pull-back to the surface shows the map: patches of equal area, or squares, which an
   angle-preserving map leaves square where they are small. */
typedef enum {
  EQM_PATTERN_DISK,
  EQM_PATTERN_SQUARE,
  EQM_PATTERN_SPHERE,
  EQM_PATTERN_DISK_SQUARES,
  EQM_PATTERN_SPHERE_SQUARES
} EqmPattern;
PETSC_INTERN void EqmColorOfPattern(EqmPattern pattern, const double image[3], double rgb[3]);

/* What a picture shows of its faces. */
typedef struct {
  const EqmResult *result;
  const EqmFaces *faces;
  const float *normals; /* per vertex: shaded; NULL: flat colours */
  EqmCamera camera;
  EqmColorScale scale;
  PetscBool pulled_back; /* the pattern instead of the ratio */
  EqmPattern pattern;
  double relief; /* how much the light models the shape: 0 not at all ... 1 fully */
  double edges;  /* how dark the edges are drawn: 0 not at all ... 1 black */
} EqmScene;

/* Colour the samples, average `oversampling`^2 of them into a pixel: premultiplied ARGB, `stride` bytes a row. */
PETSC_INTERN PetscErrorCode EqmShade(const EqmRaster *raster, const EqmScene *scene, int oversampling,
                                     unsigned char *pixels, int stride);

/* Draw the page of a result into a file, its format by suffix: .png .pdf .svg .html. Not collective. Errors:
   EQM_ERR_USAGE (suffix, or built without cairo), EQM_ERR_IO; quiet, the reason is in `error`. */
PETSC_INTERN PetscErrorCode EqmPictureWrite(const EqmResult *result, const char *file, int width, char *error,
                                            size_t length);

#endif
