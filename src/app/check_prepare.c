#include "check_prepare.h"
#include "mesh/soup_private.h"
#include "mesh/target.h"
#include "prepare/prepare.h"
#include <string.h>

/* Steps of a preparation for the summary. */
static void AddSteps(cJSON *entry, const EqmPreparation *preparation)
{
  cJSON *const list = cJSON_AddArrayToObject(entry, "steps");

  for (PetscInt s = 0; s < preparation->num_steps; s++) {
    cJSON *const step = cJSON_CreateObject();

    cJSON_AddStringToObject(step, "step", preparation->step[s].step);
    cJSON_AddNumberToObject(step, "count", (double)preparation->step[s].count);
    cJSON_AddStringToObject(step, "what", preparation->step[s].what);
    cJSON_AddItemToArray(list, step);
  }
}

/* Prepare the mesh for a target, and report the result. */
static PetscErrorCode TryTarget(EqmSoup soup, const EqmTarget *target, PetscBool is_first, cJSON *all)
{
  char text[EQM_MESSAGE_MAX], steps[EQM_MESSAGE_MAX];
  EqmPrepareOptions options;
  EqmPreparation preparation;
  EqmDiagnosis diagnosis;
  PetscBool fatal;
  cJSON *entry;

  PetscFunctionBegin;
  EqmPrepareOptionsInit(&options);
  PetscCall(PetscStrncpy(options.steps, "auto", sizeof(options.steps)));
  options.target = target->name;
  PetscCall(EqmSoupPrepare(soup, &options, &preparation));
  PetscCall(EqmSoupDiagnose(preparation.soup, &diagnosis));
  PetscCall(EqmDiagnosisDescribe(&diagnosis, target->name, &fatal, text, sizeof(text)));
  PetscCall(EqmPreparationDescribe(&preparation, steps, sizeof(steps)));
  if (is_first) PetscCall(PetscPrintf(soup->comm, "with -prepare auto\n"));
  text[strcspn(text, "\n")] = '\0';
  PetscCall(PetscPrintf(soup->comm, "  %-10s%s%s\n", target->name, fatal ? "no   " : "yes  ",
                        fatal ? strchr(text, ' ') + 1 : steps));
  entry = cJSON_AddObjectToObject(all, target->name);
  cJSON_AddBoolToObject(entry, "takes", !fatal);
  AddSteps(entry, &preparation);
  PetscCall(EqmPreparationReset(&preparation));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCheckPreparation(EqmSoup soup, PetscInt num_targets, const PetscBool takes[], cJSON **prepared)
{
  const EqmTarget *targets;
  PetscInt count, tried = 0;

  PetscFunctionBegin;
  *prepared = NULL;
  for (PetscInt t = 0; t < num_targets; t++) {
    if (takes[t]) PetscFunctionReturn(0); /* a sound mesh */
  }
  *prepared = cJSON_CreateObject();
  EqmTargetsGet(&targets, &count);
  for (PetscInt t = 0; t < num_targets; t++) {
    const PetscBool wants_solid = (PetscBool)(targets[t].domain[EQM_TOPOLOGY_BALL] != NULL);

    if (wants_solid != (PetscBool)(soup->cell_size == 4)) continue;
    PetscCall(TryTarget(soup, &targets[t], (PetscBool)(tried == 0), *prepared));
    tried++;
  }
  PetscFunctionReturn(0);
}
