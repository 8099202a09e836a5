/* What -prepare auto would do for a mesh that no command takes as it is. */
#ifndef EQM_CHECK_PREPARE_H
#define EQM_CHECK_PREPARE_H

#include <equimap/soup.h>
#include <cjson/cJSON.h>

/* Try it for every target, in the order of the table, that `takes` says does not take the mesh; print what would be
   done and whether the target would then take it. `prepared` gets the same for the summary (cJSON_Delete it), or NULL
   where there is nothing to tell. Collective. */
PETSC_INTERN PetscErrorCode EqmCheckPreparation(EqmSoup soup, PetscInt num_targets, const PetscBool takes[],
                                                cJSON **prepared);

#endif
