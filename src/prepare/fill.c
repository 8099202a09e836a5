/* Solids from closed surfaces, by TetGen [Si, TetGen, a Delaunay-based quality tetrahedral mesh generator, 2015]. */
#include "prepare/fill.h"
#include "mesh/soup_private.h"

#ifndef EQM_HAVE_TETGEN
const char *EqmFillMissing(void)
{
  return "this equimap was built without TetGen, which fills surfaces (its licence is the AGPL): install it (Debian: "
         "libtet1.5-dev) and build with -DEQUIMAP_TETGEN=ON; or write the surface as .stl and fill it with the "
         "programs "
         "tetgen -pYqa or gmsh";
}

PetscErrorCode EqmSoupFill(const EqmFillOptions *options, EqmSoup *soup)
{
  PetscFunctionBegin;
  (void)options;
  EqmFail((*soup)->comm, EQM_ERR_USAGE, "-fill: %s", EqmFillMissing());
}
#else
#include "geometry/simplex.h"
#include "prepare/tetgen.h"
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *EqmFillMissing(void)
{
  return NULL;
}

/* One closed surface without defects, of any number of handles. */
static PetscErrorCode CheckClosed(EqmSoup soup)
{
  const EqmFindingKind faults[] = {EQM_FINDING_NOT_FINITE, EQM_FINDING_BAD_INDEX, EQM_FINDING_DEGENERATE_CELL,
                                   EQM_FINDING_DUPLICATE_CELL, EQM_FINDING_NON_MANIFOLD_EDGE};
  EqmDiagnosis d;
  PetscInt64 count = 0;

  PetscFunctionBegin;
  if (soup->cell_size != 3) EqmFail(soup->comm, EQM_ERR_MESH, "-fill: %s is a solid already", soup->file);
  PetscCall(EqmSoupDiagnose(soup, &d));
  for (size_t k = 0; k < sizeof(faults) / sizeof(faults[0]); k++) count += d.finding[faults[k]].count;
  if (count || d.num_boundary_edges || d.num_components != 1)
    EqmFail(soup->comm, EQM_ERR_MESH,
            "-fill wants one closed surface, but %s has %" PetscInt64_FMT " pieces, %" PetscInt64_FMT
            " edges on boundaries and %" PetscInt64_FMT
            " other faults (equimap check); -prepare auto takes the largest piece and fills holes",
            soup->file, d.num_components, d.num_boundary_edges, count);
  PetscFunctionReturn(0);
}

/* TetGen's switches: fill (p), keep the surface as it is (Y), quality (q), volume (a), say nothing (Q). */
static void ChooseSwitches(const EqmFillOptions *options, const EqmSerialMesh *surface, char *text, size_t length)
{
  PetscReal edge = 0.;
  size_t used;

  for (PetscInt k = 0; k < 3 * surface->num_cells; k++) {
    const PetscReal *const p = surface->vertices + 3 * surface->cells[k];
    const PetscReal *const q = surface->vertices + 3 * surface->cells[k - k % 3 + (k + 1) % 3];
    const PetscReal u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    edge += PetscSqrtReal(EqmDot3(u, u)) / (3 * surface->num_cells);
  }
  used = (size_t)snprintf(text, length, "pYQq%.6g", (double)options->quality);
  if (options->volume > 0.) /* a regular tetrahedron of edge e has the volume e^3 / (6 sqrt 2) */
    (void)snprintf(text + used, length - used, "a%.17g",
                   (double)(options->volume * edge * edge * edge / (6. * PETSC_SQRT2)));
}

/* On rank 0: the solid takes the place of the surface. TetGen counts by int. */
static PetscErrorCode Fill(const EqmFillOptions *options, EqmSerialMesh *mesh, char *message, size_t length)
{
  char switches[96];
  double *points;
  int *triangles, *corners, num_points, num_cells, outcome;

  if (mesh->num_vertices > INT_MAX || mesh->num_cells > INT_MAX / 3) {
    (void)snprintf(message, length, "-fill: the surface has more triangles than TetGen can count");
    return EQM_ERR_MESH;
  }
  triangles = malloc(3 * sizeof(int) * (size_t)mesh->num_cells);
  if (!triangles) return PETSC_ERR_MEM;
  for (size_t k = 0; k < 3 * (size_t)mesh->num_cells; k++) triangles[k] = (int)mesh->cells[k];
  ChooseSwitches(options, mesh, switches, sizeof(switches));
  outcome = EqmTetgenApart(switches, (int)mesh->num_vertices, mesh->vertices, (int)mesh->num_cells, triangles,
                           &num_points, &points, &num_cells, &corners);
  free(triangles);
  PetscCall(EqmSerialMeshReset(mesh));
  if (!outcome) {
    mesh->cell_size = 4;
    mesh->num_vertices = num_points;
    mesh->num_cells = num_cells;
    PetscCall(PetscMalloc1(3 * (size_t)num_points + 1, &mesh->vertices));
    PetscCall(PetscMalloc1(4 * (size_t)num_cells + 1, &mesh->cells));
    memcpy(mesh->vertices, points, 3 * sizeof(double) * (size_t)num_points);
    for (size_t k = 0; k < 4 * (size_t)num_cells; k++) mesh->cells[k] = corners[k];
  }
  free(points);
  free(corners);
  if (!outcome) return 0;
  (void)snprintf(message, length, "-fill: TetGen cannot fill the surface (%d): %s", outcome,
                 outcome == EQM_TETGEN_NO_MEMORY ? "memory is short"
                 : outcome == EQM_TETGEN_CRASHED
                     ? "it crashed, as it does where triangles cross each other; mend these in a mesh editor"
                     : "triangles cross each other, or features are too small; mend it in a mesh editor");
  return EQM_ERR_MESH;
}

PetscErrorCode EqmSoupFill(const EqmFillOptions *options, EqmSoup *soup)
{
  char file[PETSC_MAX_PATH_LEN], message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error = 0;
  EqmSerialMesh mesh;
  PetscMPIInt rank;
  MPI_Comm comm = (*soup)->comm;

  PetscFunctionBegin;
  PetscCall(CheckClosed(*soup));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PetscStrncpy(file, (*soup)->file, sizeof(file)));
  PetscCall(EqmSoupGather(*soup, &mesh));
  PetscCall(EqmSoupDestroy(soup));
  if (rank == 0) error = Fill(options, &mesh, message, sizeof(message));
  PetscCall(EqmAgree(comm, error, message));
  PetscCall(EqmSoupCreateFromRoot(comm, &mesh, file, soup));
  PetscFunctionReturn(0);
}
#endif
