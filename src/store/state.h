/* The state of a run in a file, so that it can go on later as if it had never stopped.

   An object names what belongs to its state once, in one function that serves saving and loading alike:

       static PetscErrorCode State(EqmState state, Thing *thing)
       {
         PetscCall(EqmStateReal(state, "damping", &thing->damping));
         PetscCall(EqmStateReals(state, "weights", thing->num_weights, thing->weights));
         ...
       }

   While a file is written the function is called twice, first to announce and then to write, and must name the same
   things both times; it must not change them. While a file is loaded it is called once. What depends on another thing
   comes after it. Names are unique within a group. All calls are collective.

   The file is HDF5, in input numbering: the same whatever ranks wrote it. Every array carries its CRC-32, and so do the
   scalars and names together; the file appears complete or not at all, and the one before it is kept under its name
   with .previous behind. Per vertex arrays are /group/name; scalars stand in /state/integers and /state/reals, their
   names in the attributes integer_names and real_names. */
#ifndef EQM_STATE_H
#define EQM_STATE_H

#include <equimap/mesh.h>

typedef struct _p_EqmState *EqmState;

PETSC_INTERN PetscErrorCode EqmStateInt(EqmState state, const char *name, PetscInt *value);
PETSC_INTERN PetscErrorCode EqmStateInt64(EqmState state, const char *name, PetscInt64 *value);
PETSC_INTERN PetscErrorCode EqmStateBool(EqmState state, const char *name, PetscBool *value);
PETSC_INTERN PetscErrorCode EqmStateReal(EqmState state, const char *name, PetscReal *value);
PETSC_INTERN PetscErrorCode EqmStateText(EqmState state, const char *name, char *text, size_t length);
/* Reals that all ranks have alike. */
PETSC_INTERN PetscErrorCode EqmStateReals(EqmState state, const char *name, PetscInt count, PetscReal *values);
/* `width` reals per local vertex; ghosts are up to date after loading. */
PETSC_INTERN PetscErrorCode EqmStateVertices(EqmState state, const char *name, PetscInt width, PetscReal *local);

/* What must be now as it was when the file was written, `option` being its name for the user; a file that has another
   value is refused with EQM_ERR_CHECKPOINT. */
PETSC_INTERN PetscErrorCode EqmStateSameInt(EqmState state, const char *option, PetscInt64 value);
PETSC_INTERN PetscErrorCode EqmStateSameReal(EqmState state, const char *option, PetscReal value);
PETSC_INTERN PetscErrorCode EqmStateSameText(EqmState state, const char *option, const char *value);

/* Names from here on belong to the group of that name ("": to none). Not collective. */
PETSC_INTERN PetscErrorCode EqmStateGroup(EqmState state, const char *group);
/* Is this loading, or saving? Not collective. */
PETSC_INTERN PetscBool EqmStateIsLoading(EqmState state);
/* The mesh whose state it is. Not collective. */
PETSC_INTERN EqmMesh EqmStateMesh(EqmState state);
/* Vertices are those of this mesh from here on: for a method that solves on another mesh beside its own, which it gives
   back at the end. Collective. */
PETSC_INTERN PetscErrorCode EqmStateUseMesh(EqmState state, EqmMesh mesh);

typedef PetscErrorCode (*EqmStateVisit)(EqmState state, void *context);
/* Write what `visit` names. The disk may still be at work when this returns: `writing` is to be given to
   EqmStateFinish, before the next state is saved under the same name. Errors: EQM_ERR_IO, and the file that was there
   stays. */
PETSC_INTERN PetscErrorCode EqmStateSave(EqmMesh mesh, const char *file, EqmStateVisit visit, void *context,
                                         EqmState *writing);
/* Wait until the file is there for good; nothing to wait for if it is NULL. Errors: EQM_ERR_IO, and the file that was
   there stays. */
PETSC_INTERN PetscErrorCode EqmStateFinish(EqmState *writing);
/* Open a file for loading; everything in it is checked. Errors: EQM_ERR_IO (missing, not HDF5), EQM_ERR_CHECKPOINT (not
   a state, incomplete, damaged). */
PETSC_INTERN PetscErrorCode EqmStateOpen(EqmMesh mesh, const char *file, EqmState *state);
PETSC_INTERN PetscErrorCode EqmStateClose(EqmState *state);
/* What the file before `file` is called. Not collective. */
PETSC_INTERN PetscErrorCode EqmStatePreviousName(const char *file, char *previous, size_t length);

#endif
