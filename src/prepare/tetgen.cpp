/* The one file of this library that is not C: TetGen has no other interface. */
#include "prepare/tetgen.h"
#include <cstdlib>
#include <cstring>
#include <new>
#include <tetgen.h>

static void SetFacets(tetgenio *surface, int num, const int *triangles)
{
  surface->numberoffacets = num;
  surface->facetlist = new tetgenio::facet[num];
  for (int t = 0; t < num; t++) {
    tetgenio::facet *const facet = &surface->facetlist[t];
    tetgenio::init(facet);
    facet->numberofpolygons = 1;
    facet->polygonlist = new tetgenio::polygon[1];
    tetgenio::init(facet->polygonlist);
    facet->polygonlist[0].numberofvertices = 3;
    facet->polygonlist[0].vertexlist = new int[3];
    std::memcpy(facet->polygonlist[0].vertexlist, triangles + 3 * t, 3 * sizeof(int));
  }
}

static int Run(const char *switches, tetgenio *surface, tetgenio *solid)
{
  char text[128];

  std::strncpy(text, switches, sizeof(text) - 1);
  text[sizeof(text) - 1] = '\0';
  try {
    tetrahedralize(text, surface, solid);
  } catch (int code) {
    return code ? code : 10;
  } catch (const std::bad_alloc &) {
    return EQM_TETGEN_NO_MEMORY;
  }
  return 0;
}

extern "C" int EqmTetgenRun(const char *switches, int num_vertices, const double *vertices, int num_triangles,
                            const int *triangles, int *num_points, double **points, int *num_cells, int **corners)
{
  tetgenio surface, solid;
  int outcome;

  *points = NULL;
  *corners = NULL;
  surface.firstnumber = 0;
  surface.numberofpoints = num_vertices;
  surface.pointlist = new double[3 * (size_t)num_vertices];
  std::memcpy(surface.pointlist, vertices, 3 * (size_t)num_vertices * sizeof(double));
  SetFacets(&surface, num_triangles, triangles);
  outcome = Run(switches, &surface, &solid);
  *num_points = outcome ? 0 : solid.numberofpoints;
  *num_cells = outcome ? 0 : solid.numberoftetrahedra;
  *points = (double *)std::malloc(3 * sizeof(double) * (size_t)*num_points + 1);
  *corners = (int *)std::malloc(4 * sizeof(int) * (size_t)*num_cells + 1);
  if (!*points || !*corners) return EQM_TETGEN_NO_MEMORY;
  if (*num_points) std::memcpy(*points, solid.pointlist, 3 * sizeof(double) * (size_t)*num_points);
  if (*num_cells) std::memcpy(*corners, solid.tetrahedronlist, 4 * sizeof(int) * (size_t)*num_cells);
  return outcome;
}
