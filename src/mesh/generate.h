/* Test shapes: a lattice (what is connected to what) and a placement (where it lies in space). */
#ifndef EQM_GENERATE_H
#define EQM_GENERATE_H

#include <equimap/soup.h>
#include "base/random.h"

/* A lattice of a certain size. Which of the numbers mean something depends on the lattice. */
typedef struct {
  PetscInt cell_size;
  PetscInt num_vertices, num_cells;
  PetscInt size[3]; /* vertices (solids: cells) per direction, or the frequency of a subdivision in size[0] */
  PetscInt seed;
  PetscBool regular; /* no vertex is moved, and diagonals are parallel */
} EqmLatticePlan;

/* Connectivity of a shape, every vertex and cell computable on its own, so that each rank makes its slab alone. */
typedef struct {
  /* Choose the size nearest to n vertices. */
  void (*plan)(PetscInt n, EqmLatticePlan *plan);
  /* Parameters of a vertex, jittered: (u, v) in the unit square, (x, y) in the unit disk, a direction in space, or a
     point of the cube [-1, 1]^3. */
  void (*parameter)(const EqmLatticePlan *plan, PetscInt vertex, PetscReal parameter[3]);
  void (*cell)(const EqmLatticePlan *plan, PetscInt cell, PetscInt vertices[]);
} EqmLattice;

/* From a lattice's parameters to a point in space. */
typedef void (*EqmPlacement)(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3]);

PETSC_INTERN const EqmLattice EqmLatticeRectangle, EqmLatticeAnnulus, EqmLatticeMoebius, EqmLatticeTorus;
PETSC_INTERN const EqmLattice EqmLatticeHexagon, EqmLatticeIcosahedron;
PETSC_INTERN const EqmLattice EqmLatticeCube;

PETSC_INTERN void EqmPlaceCap(const EqmLatticePlan *, const PetscReal[3], PetscReal[3]);
PETSC_INTERN void EqmPlacePatch(const EqmLatticePlan *, const PetscReal[3], PetscReal[3]);
PETSC_INTERN void EqmPlaceHills(const EqmLatticePlan *, const PetscReal[3], PetscReal[3]);
PETSC_INTERN void EqmPlaceAnnulus(const EqmLatticePlan *, const PetscReal[3], PetscReal[3]);
PETSC_INTERN void EqmPlaceMoebius(const EqmLatticePlan *, const PetscReal[3], PetscReal[3]);
PETSC_INTERN void EqmPlaceTorus(const EqmLatticePlan *, const PetscReal[3], PetscReal[3]);
PETSC_INTERN void EqmPlaceSphere(const EqmLatticePlan *, const PetscReal[3], PetscReal[3]);
PETSC_INTERN void EqmPlaceHead(const EqmLatticePlan *, const PetscReal[3], PetscReal[3]);
PETSC_INTERN void EqmPlaceStarfish(const EqmLatticePlan *, const PetscReal[3], PetscReal[3]);
PETSC_INTERN void EqmPlaceCube(const EqmLatticePlan *, const PetscReal[3], PetscReal[3]);
PETSC_INTERN void EqmPlaceBall(const EqmLatticePlan *, const PetscReal[3], PetscReal[3]);
PETSC_INTERN void EqmPlaceFigure(const EqmLatticePlan *, const PetscReal[3], PetscReal[3]);
PETSC_INTERN void EqmPlaceBlob(const EqmLatticePlan *, const PetscReal[3], PetscReal[3]);

/* The mesh of a lattice whose size has been planned, each rank its slab. Collective. */
PETSC_INTERN PetscErrorCode EqmSoupFromLattice(MPI_Comm comm, const EqmLattice *lattice, const EqmLatticePlan *plan,
                                               EqmPlacement place, const char *name, EqmSoup *soup);

/* EqmSoupGenerateTarget - a regular mesh of a unit target: of the square n x n vertices, row by row; of the disk n
   rings of 6, 12, 18, ... vertices; of the sphere the icosahedron with its edges cut into n; of the ball concentric
   layers of tetrahedra, n from the centre to the boundary, of the cube the same. The target's name is one of these
   five.

   Collective; the same on any number of ranks. Errors: EQM_ERR_USAGE (n out of range). */
PETSC_INTERN PetscErrorCode EqmSoupGenerateTarget(MPI_Comm comm, const char *target, PetscInt n, EqmSoup *soup);

/* How far a vertex may be moved, in spacings: far enough to be irregular, near enough for no triangle to turn over. */
static inline PetscReal EqmLatticeJitter(const EqmLatticePlan *plan, PetscInt vertex, PetscInt channel)
{
  return plan->regular ? 0.0 : 0.18 * (2.0 * EqmHashUniform(plan->seed, vertex, channel) - 1.0);
}

#endif
