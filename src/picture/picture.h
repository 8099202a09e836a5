/* Reports: a page of pictures and plots of one result, or of several beside each other. All but
   EqmReportWrite runs on one rank and is not collective. */
#ifndef EQM_PICTURE_H
#define EQM_PICTURE_H

#include <stdint.h>
#include <equimap/map.h>

enum { EQM_MOST_RESULTS = 8 };

/* What shows how the iteration went. */
typedef enum {
  EQM_CURVE_AUTO,   /* the energy; of conformal maps, whose energy is far from zero, the gradient, or else the excess */
  EQM_CURVE_ENERGY, /* E */
  EQM_CURVE_EXCESS, /* what E is above its smallest value */
  EQM_CURVE_GRADIENT /* the norm of the gradient */
} EqmCurve;

/* How a report is drawn. */
typedef struct {
  PetscInt width;    /* of the page in pixels */
  PetscBool has_eye; /* use `azimuth` and `elevation` instead of a view chosen for the mesh */
  PetscReal azimuth, elevation;
  char up[4];                     /* the axis that points up: x, y, z, -x, -y, -z; empty: guessed */
  PetscInt curve;                 /* an EqmCurve */
  char start[PETSC_MAX_PATH_LEN]; /* another map of the same mesh, drawn beside the image; empty: none */
  char lines[PETSC_MAX_PATH_LEN]; /* a CSV file of curves on the mesh; empty: none */
  PetscReal sharp;                /* edges where faces meet at more than so many degrees are drawn; 0: none */
} EqmReportOptions;

/* EqmReportWrite - draw a page of results into `picture`, its format by suffix: .png .pdf .svg .html. Several results,
   at most EQM_MOST_RESULTS, stand below each other with one colour scale and one table. Collective; rank 0 reads and
   draws. Errors: EQM_ERR_USAGE (suffix, number of results, or built without cairo), EQM_ERR_IO (not a result, cannot be
   written). */
PETSC_EXTERN PetscErrorCode EqmReportWrite(MPI_Comm comm, PetscInt num_results, const char *const *result_files,
                                           const char *picture, const EqmReportOptions *options);

enum { EQM_NUM_MARKS = 6 };

/* A result as it was stored, read back whole. */
typedef struct {
  char file[PETSC_MAX_PATH_LEN]; /* the result file */
  char command[64], method[64], status[64], message[EQM_MESSAGE_MAX], mesh_file[PETSC_MAX_PATH_LEN];
  char other_file[PETSC_MAX_PATH_LEN]; /* of a registration: B's mesh; else empty */
  char version[64], commit[64], date[64], options[8192];
  PetscInt64 iterations, folds, ranks, threads;
  PetscReal energy_initial, energy_final, angle_mean, angle_median, seconds;
  PetscReal quasi_mean, quasi_median, quasi_max;
  PetscInt num_vertices, num_cells, cell_size, dim;
  PetscReal *vertices; /* 3 * num_vertices */
  PetscReal *images;   /* 3 * num_vertices; planar maps have z = 0 */
  PetscReal *target;   /* of a registration: where vertices lie in the target, 3 * num_vertices; else NULL */
  PetscInt target_dim; /* coordinates there */
  PetscReal *distance; /* of a registration: from a vertex to its point on B, per vertex; else NULL */
  PetscInt num_landmarks, *landmark; /* of a registration: vertices of A, */
  PetscReal *landmark_goal;          /* and where they should go on B, 3 each */
  PetscReal *landmark_target;        /* the same in the target, 3 each; NULL: not known */
  PetscInt *curve;                   /* per landmark its feature curve, below 0: none; NULL: there are none */
  PetscInt *cells;                   /* cell_size * num_cells */
  PetscReal *weight;                 /* per cell: measure, density included */
  PetscReal *ratio;                  /* per cell */
  PetscReal *quasi_conformal;        /* per cell; NULL: not known */
  PetscBool has_angles;
  PetscInt64 angle_histogram[EQM_NUM_ANGLE_BINS];
  EqmStatistics ratio_statistics;
  EqmWeightedRatio weighted;
  PetscInt num_marks, mark[EQM_NUM_MARKS]; /* cells that are folded or distorted most, the worst first */
  PetscInt num_lines, *line; /* drawn on surface and image: two vertices each, and a curve's number, -1 for an edge */
  PetscInt num_history;
  PetscReal *iteration, *energy, *elapsed, *gradient; /* per row of the history */
} EqmResult;

/* Read a result file whole. Errors: EQM_ERR_IO (not a result, damaged), and nothing is left to free. */
PETSC_INTERN PetscErrorCode EqmResultLoad(const char *file, EqmResult *result);
PETSC_INTERN PetscErrorCode EqmResultReset(EqmResult *result);
/* Compute what is not stored: weights, statistics, distances, the worst cells. */
PETSC_INTERN PetscErrorCode EqmResultEvaluate(EqmResult *result);
/* Find the lines to draw: the curves of a file, sharp edges. Errors: EQM_ERR_IO (no table of curves), EQM_ERR_USAGE (no
   such vertex). */
PETSC_INTERN PetscErrorCode EqmResultFindLines(EqmResult *result, const EqmReportOptions *options);

/* What the pictures of a result show: ratios, or for angle-preserving maps the quasi-conformal distortion. */
PETSC_INTERN PetscBool EqmResultIsConformal(const EqmResult *result);
/* Has the history norms of gradients? Some methods take none. */
PETSC_INTERN PetscBool EqmResultHasGradient(const EqmResult *result);
/* How the iteration went, per row of the history; `curve` is not EQM_CURVE_AUTO. NaN where there is none or it is
   zero. */
PETSC_INTERN void EqmResultCurve(const EqmResult *result, EqmCurve curve, double *values);
PETSC_INTERN const char *EqmCurveName(EqmCurve curve);

/* Triangles to draw, at the places of one array of points; each belongs to a cell. */
typedef struct {
  PetscInt num_faces;
  PetscInt *vertices; /* 3 per face, outward */
  PetscInt *cell;     /* per face */
} EqmFaces;

/* The triangles of a surface, or the boundary triangles of a solid. */
PETSC_INTERN PetscErrorCode EqmFacesOfSurface(const EqmResult *result, EqmFaces *faces);
/* The boundary of those tetrahedra whose centroids, with vertices at `points`, lie on the lower side of a plane: a
   solid cut open. `direction` is normal to the plane, which goes through the middle of all points. */
PETSC_INTERN PetscErrorCode EqmFacesOfCut(const EqmResult *result, const PetscReal *points,
                                          const PetscReal direction[3], EqmFaces *faces);
PETSC_INTERN PetscErrorCode EqmFacesReset(EqmFaces *faces);
/* Unit normals per vertex, 3 floats each, weighted by area; to be freed with PetscFree. */
PETSC_INTERN PetscErrorCode EqmFacesNormals(const EqmFaces *faces, const PetscReal *points, PetscInt num_points,
                                            float **normals);

/* An orthographic camera: an orthonormal frame, and the square that it sees. */
typedef struct {
  double right[3], up[3], toward[3]; /* `toward` points from the scene to the camera */
  double center[3], half_width;
} EqmCamera;

/* Above the plane, x to the right and y up. */
PETSC_INTERN EqmCamera EqmCameraFlat(void);
/* A camera that sees `pole` upwards and starts from the side of `front`, then walks `azimuth` degrees around the pole
   and rises by `elevation` degrees. */
PETSC_INTERN EqmCamera EqmCameraTurned(const double pole[3], const double front[3], double azimuth, double elevation);
/* A default view, or the one of the options; all faces fit into the picture. */
PETSC_INTERN EqmCamera EqmCameraChoose(const EqmFaces *faces, const PetscReal *points, const EqmReportOptions *options);
/* Aim and zoom so that all faces fit into the picture. */
PETSC_INTERN void EqmCameraFit(EqmCamera *camera, const EqmFaces *faces, const PetscReal *points);
/* A point in a square picture of `size` units: x to the right, y down, z towards the camera. */
PETSC_INTERN void EqmCameraProject(const EqmCamera *camera, double size, const double point[3], double projected[3]);

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

/* What colours stand for. */
typedef enum {
  EQM_SCALE_RATIO,   /* from 1/limit over 1 to limit, logarithmic */
  EQM_SCALE_STRETCH, /* from 1 to limit, logarithmic */
  EQM_SCALE_DISTANCE /* from 0 to limit */
} EqmScaleKind;

typedef struct {
  EqmScaleKind kind;
  double limit; /* the last value that has a colour of its own */
} EqmColorScale;

/* A scale on which all but about a twentieth of the values have a colour of their own. Ratios and stretches that are
   closer to one than the smallest scale reaches get the smallest scale. */
PETSC_INTERN EqmColorScale EqmColorScaleOf(EqmScaleKind kind, const PetscReal *values, PetscInt count);
/* The scale that holds both, of one kind. */
PETSC_INTERN EqmColorScale EqmColorScaleJoin(EqmColorScale a, EqmColorScale b);
/* The value at a place of the scale, 0 ... 1. */
PETSC_INTERN double EqmColorScaleValue(EqmColorScale scale, double place);
/* The colour of a value: red, green, blue in 0 ... 1. Magenta for a ratio that is not positive: a folded cell. */
PETSC_INTERN void EqmColorOf(EqmColorScale scale, double value, double rgb[3]);

/* A pattern in the image whose pull-back to the surface shows the map: patches of equal area, or squares, which an
   angle-preserving map leaves square where they are small. */
typedef enum {
  EQM_PATTERN_DISK,
  EQM_PATTERN_SQUARE,
  EQM_PATTERN_SPHERE,
  EQM_PATTERN_CUBE,
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
  const PetscReal *cell_values;   /* what is coloured: values of cells, */
  const PetscReal *vertex_values; /* or of vertices; NULL both: the pattern */
  EqmPattern pattern;
  double relief; /* how much the light models the shape: 0 not at all ... 1 fully */
  double edges;  /* how dark the edges are drawn: 0 not at all ... 1 black */
} EqmScene;

/* Colour a picture of raster->size / oversampling pixels per side into `pixels`, premultiplied ARGB in words of 32
   bits, `stride` bytes a row. */
PETSC_INTERN PetscErrorCode EqmShade(const EqmRaster *raster, const EqmScene *scene, int oversampling,
                                     unsigned char *pixels, int stride);

/* A page: its results, and what they share. */
typedef struct {
  PetscInt num;
  const EqmResult *results;
  EqmColorScale scale, distances; /* of the pictures; of a registration's distances */
  PetscBool conformal;            /* all results are: the colours show what becomes of angles */
  EqmCurve curve;                 /* not EQM_CURVE_AUTO */
  const EqmResult *start;         /* another map of the first result's mesh, drawn beside its image; NULL: none */
  EqmReportOptions options;
} EqmPage;

/* `start` may be NULL. */
PETSC_INTERN EqmPage EqmPageOf(PetscInt num_results, const EqmResult *results, const EqmResult *start,
                               const EqmReportOptions *options);
/* What is coloured of a result on that page, per cell. */
PETSC_INTERN const PetscReal *EqmPageValues(const EqmPage *page, const EqmResult *result);

/* Draw a page into a file, whole or not at all, its format by suffix: .png .pdf .svg .html. Errors: EQM_ERR_USAGE
   (suffix, or built without cairo), EQM_ERR_IO; quiet, the reason is in `error`. */
PETSC_INTERN PetscErrorCode EqmPictureWrite(const EqmPage *page, const char *file, char *error, size_t length);

#endif
