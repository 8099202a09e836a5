/* TetGen's library, which is C++, called from C. */
#ifndef EQM_TETGEN_H
#define EQM_TETGEN_H

#ifdef __cplusplus
extern "C" {
#endif

/* Outcomes beside TetGen's own, which are positive. */
enum { EQM_TETGEN_NO_MEMORY = -1, EQM_TETGEN_CRASHED = -2 };

/* Fill a closed surface. `points` and `corners` are malloc'ed, also where the outcome is not 0: TetGen's code of what
   is wrong with the surface, -1: no memory. */
int EqmTetgenRun(const char *switches, int num_vertices, const double *vertices, int num_triangles,
                 const int *triangles, int *num_points, double **points, int *num_cells, int **corners);
/* The same in a process of its own. */
int EqmTetgenApart(const char *switches, int num_vertices, const double *vertices, int num_triangles,
                   const int *triangles, int *num_points, double **points, int *num_cells, int **corners);

#ifdef __cplusplus
}
#endif
#endif
