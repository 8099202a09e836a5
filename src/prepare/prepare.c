/* The table of steps, and the loop over them. */
#include "prepare/step.h"
#include "prepare/components.h"
#include "mesh/soup_private.h"
#include "base/rows.h"
#include <string.h>

/* In the order of execution: each may create defects for later ones. */
static const EqmPrepareStep steps[] = {
    {"weld", "join boundary vertices at the same place, as seams of textures leave them", EqmStepWeld},
    {"split", "remove duplicate cells, cut non-manifold edges and vertices apart, turn what disagrees", EqmStepSplit},
    {"flat", "flip or collapse triangles without area", EqmStepFlat},
    {"largest", "keep the largest piece (-piece K: the K-th)", EqmStepLargest},
    {"holes", "fill all boundary loops but the longest, for a sphere all", EqmStepHoles},
    {"handles", "cut small handles (-handle_length) and fill both sides", EqmStepHandles},
};
enum { NUM_STEPS = sizeof(steps) / sizeof(steps[0]) };

void EqmPrepareOptionsInit(EqmPrepareOptions *options)
{
  memset(options, 0, sizeof(*options));
  strcpy(options->steps, "none");
  options->piece = 1;
  options->hole_weight = 1.;
  options->handle_length = .1;
}

/* Is a step named in a list that is separated by commas? */
static PetscBool IsListed(const char *list, const char *name)
{
  const size_t length = strlen(name);

  for (const char *item = list; item; item = strchr(item, ',')) {
    if (*item == ',') item++;
    if (!strncmp(item, name, length) && (item[length] == ',' || !item[length])) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

static PetscErrorCode CheckList(const char *list)
{
  char copy[256], names[256] = "auto, none";
  PetscBool known = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(copy, list, sizeof(copy)));
  if (!strcmp(list, "none") || !strcmp(list, "auto")) PetscFunctionReturn(0);
  for (char *item = strtok(copy, ","); item && known; item = strtok(NULL, ",")) {
    known = PETSC_FALSE;
    for (PetscInt s = 0; s < NUM_STEPS; s++) known = (PetscBool)(known || !strcmp(item, steps[s].name));
  }
  for (PetscInt s = 0; s < NUM_STEPS; s++) {
    PetscCall(PetscStrlcat(names, ", ", sizeof(names)));
    PetscCall(PetscStrlcat(names, steps[s].name, sizeof(names)));
  }
  if (!known || !list[0])
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-prepare %s: choose of %s; several with commas", list, names);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPrepareSetFromOptions(PetscOptionItems *PetscOptionsObject, EqmPrepareOptions *options)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsString("-prepare",
                               "before the map: auto (what the mesh needs), none, or a list of weld, split, flat, "
                               "largest, holes, handles: join seams, cut non-manifold parts apart, flip or collapse "
                               "flat triangles, keep the largest piece, fill holes, cut small handles",
                               NULL, options->steps, options->steps, sizeof(options->steps), NULL));
  PetscCall(PetscOptionsInt("-piece", "of -prepare largest: which piece to keep, 1 is the largest", NULL,
                            options->piece, &options->piece, NULL));
  PetscCall(PetscOptionsReal("-hole_weight",
                             "of -prepare holes: 1, a filled hole keeps its area; less, its image shrinks", NULL,
                             options->hole_weight, &options->hole_weight, NULL));
  PetscCall(
      PetscOptionsReal("-weld_tolerance",
                       "of -prepare weld: boundary vertices this close are one, as a share of the mesh's diameter",
                       NULL, options->weld_tolerance, &options->weld_tolerance, NULL));
  PetscCall(
      PetscOptionsReal("-handle_length",
                       "of -prepare handles: handles with a loop of at most this length are cut, as a share of the "
                       "mesh's diameter",
                       NULL, options->handle_length, &options->handle_length, NULL));
  PetscCall(CheckList(options->steps));
  if (options->piece < 1)
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-piece %" PetscInt_FMT ": give 1 or more", options->piece);
  if (!(options->hole_weight > 0.) || PetscIsInfReal(options->hole_weight))
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-hole_weight %.6g: give a positive number", (double)options->hole_weight);
  if (!(options->handle_length >= 0.))
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-handle_length %.6g: give 0 or more", (double)options->handle_length);
  if (!(options->weld_tolerance >= 0.) || options->weld_tolerance > .1) {
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-weld_tolerance %.6g: give a share of the mesh's diameter, 0 to 0.1",
            (double)options->weld_tolerance);
  }
  PetscFunctionReturn(0);
}

/* Begin with the given mesh and identity numberings. */
static PetscErrorCode Begin(EqmSoup given, EqmPreparation *preparation)
{
  const PetscInt num_cells = given->cell_end - given->cell_start;
  const PetscInt num_vertices = given->vertex_end - given->vertex_start;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(preparation, sizeof(*preparation)));
  PetscCall(EqmSoupCopy(given, &preparation->soup));
  PetscCall(PetscMalloc1(num_cells, &preparation->parent));
  PetscCall(PetscMalloc1(num_vertices, &preparation->vertex));
  for (PetscInt c = 0; c < num_cells; c++) preparation->parent[c] = given->cell_start + c;
  for (PetscInt v = 0; v < num_vertices; v++) preparation->vertex[v] = given->vertex_start + v;
  PetscFunctionReturn(0);
}

/* Numbers through a change: number[k] becomes slab[number[k]]; -1 stays. Collective. */
static PetscErrorCode Follow(MPI_Comm comm, PetscInt slab_size, const PetscInt *slab, PetscInt num, PetscInt *number)
{
  PetscInt *wanted, *found, count = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(num, &wanted, num, &found));
  for (PetscInt k = 0; k < num; k++) {
    if (number[k] >= 0) wanted[count++] = number[k];
  }
  PetscCall(EqmFetchRows(comm, slab_size, count, wanted, MPIU_INT, 1, slab, found));
  count = 0;
  for (PetscInt k = 0; k < num; k++) {
    if (number[k] >= 0) number[k] = found[count++];
  }
  PetscCall(PetscFree2(wanted, found));
  PetscFunctionReturn(0);
}

/* Run one step, and count its changes. `num_given` is the size of the given mesh's slab of vertices. */
static PetscErrorCode RunStep(const EqmPrepareStep *step, const EqmPrepareOptions *options, PetscInt num_given,
                              EqmPreparation *preparation)
{
  EqmChange change = {.soup = preparation->soup};
  EqmPreparedStep report = {.step = step->name};
  const PetscInt num_cells = change.soup->cell_end - change.soup->cell_start;
  const PetscInt num_vertices = change.soup->vertex_end - change.soup->vertex_start;
  MPI_Comm comm = change.soup->comm;

  PetscFunctionBegin;
  PetscCall(step->run(options, &change, &report));
  if (step->run == EqmStepRepair) preparation->repair = change.repair;
  if (!report.count) PetscFunctionReturn(0);
  PetscCall(
      Follow(comm, num_cells, preparation->parent, change.soup->cell_end - change.soup->cell_start, change.parent));
  if (change.renumbers) PetscCall(Follow(comm, num_vertices, change.vertex, num_given, preparation->vertex));
  PetscCall(PetscFree(change.vertex));
  PetscCall(PetscFree(preparation->parent));
  preparation->parent = change.parent;
  preparation->soup = change.soup;
  preparation->is_changed = PETSC_TRUE;
  preparation->step[preparation->num_steps++] = report;
  PetscFunctionReturn(0);
}

/* Can the mesh be mapped to the target as it is? */
static PetscErrorCode IsReady(EqmSoup soup, const char *target, PetscBool *ready)
{
  char text[EQM_MESSAGE_MAX];
  EqmDiagnosis diagnosis;
  PetscBool fatal;

  PetscFunctionBegin;
  PetscCall(EqmSoupDiagnose(soup, &diagnosis));
  PetscCall(EqmDiagnosisDescribe(&diagnosis, target, &fatal, text, sizeof(text)));
  *ready = (PetscBool)!fatal;
  PetscFunctionReturn(0);
}

/* Steps first .. last - 1 of those of the list, one after the other; `weld` is left out if `without_weld`. */
static PetscErrorCode RunSteps(PetscInt num_given, const EqmPrepareOptions *options, PetscBool automatic,
                               PetscBool without_weld, PetscInt first, PetscInt last, EqmPreparation *preparation)
{
  PetscFunctionBegin;
  for (PetscInt s = first; s < last; s++) {
    if (without_weld && steps[s].run == EqmStepWeld) continue;
    if (automatic || IsListed(options->steps, steps[s].name))
      PetscCall(RunStep(&steps[s], options, num_given, preparation));
  }
  PetscFunctionReturn(0);
}

/* The repair at the end. */
static PetscErrorCode RunRepair(PetscInt num_given, const EqmPrepareOptions *options, PetscBool automatic,
                                EqmPreparation *preparation)
{
  static const EqmPrepareStep repair = {"repair", NULL, EqmStepRepair};

  PetscFunctionBegin;
  if (options->repair || automatic) PetscCall(RunStep(&repair, options, num_given, preparation));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunAll(EqmSoup given, const EqmPrepareOptions *options, PetscBool automatic,
                             PetscBool without_weld, EqmPreparation *preparation)
{
  const PetscInt num_given = given->vertex_end - given->vertex_start;

  PetscFunctionBegin;
  PetscCall(Begin(given, preparation));
  PetscCall(RunSteps(num_given, options, automatic, without_weld, 0, NUM_STEPS, preparation));
  PetscCall(RunRepair(num_given, options, automatic, preparation));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupPrepare(EqmSoup given, const EqmPrepareOptions *options, EqmPreparation *preparation)
{
  PetscBool automatic = (PetscBool)!strcmp(options->steps, "auto"), ready = PETSC_FALSE;

  PetscFunctionBegin;
  if (automatic) PetscCall(IsReady(given, options->target, &ready));
  PetscCall(RunAll(given, options, (PetscBool)(automatic && !ready), PETSC_FALSE, preparation));
  if (!automatic || ready || !preparation->num_steps || strcmp(preparation->step[0].step, "weld"))
    PetscFunctionReturn(0);
  /* a seam may be the cut that makes a surface a disk: if the mesh is refused after welding, skip it */
  PetscCall(IsReady(preparation->soup, options->target, &ready));
  if (ready) PetscFunctionReturn(0);
  PetscCall(EqmPreparationReset(preparation));
  PetscCall(RunAll(given, options, PETSC_TRUE, PETSC_TRUE, preparation));
  PetscFunctionReturn(0);
}

/* Which of the steps it is. */
static PetscInt PlaceOfLargest(void)
{
  PetscInt s = 0;

  while (steps[s].run != EqmStepLargest) s++;
  return s;
}

PetscErrorCode EqmPrepareShared(EqmSoup given, const EqmPrepareOptions *options, PetscBool *automatic,
                                EqmPreparation *preparation)
{
  PetscBool ready = PETSC_FALSE;

  PetscFunctionBegin;
  *automatic = (PetscBool)!strcmp(options->steps, "auto");
  if (*automatic) PetscCall(IsReady(given, options->target, &ready));
  if (ready) *automatic = PETSC_FALSE;
  PetscCall(Begin(given, preparation));
  PetscCall(RunSteps(given->vertex_end - given->vertex_start, options, *automatic, options->without_weld, 0,
                     PlaceOfLargest(), preparation));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPrepareRest(EqmSoup given, const EqmPrepareOptions *options, PetscBool automatic,
                              EqmPreparation *preparation)
{
  const PetscInt num_given = given->vertex_end - given->vertex_start;

  PetscFunctionBegin;
  PetscCall(RunSteps(num_given, options, automatic, PETSC_FALSE, PlaceOfLargest() + 1, NUM_STEPS, preparation));
  PetscCall(RunRepair(num_given, options, automatic, preparation));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPreparationCopy(EqmSoup given, const EqmPreparation *from, EqmPreparation *to)
{
  const PetscInt num_cells = from->soup->cell_end - from->soup->cell_start;
  const PetscInt num_vertices = given->vertex_end - given->vertex_start;

  PetscFunctionBegin;
  *to = (EqmPreparation){.is_changed = from->is_changed};
  PetscCall(EqmSoupCopy(from->soup, &to->soup));
  PetscCall(PetscMalloc1(num_cells, &to->parent));
  PetscCall(PetscArraycpy(to->parent, from->parent, num_cells));
  PetscCall(PetscMalloc1(num_vertices, &to->vertex));
  PetscCall(PetscArraycpy(to->vertex, from->vertex, num_vertices));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPreparationReset(EqmPreparation *preparation)
{
  PetscFunctionBegin;
  PetscCall(EqmSoupDestroy(&preparation->soup));
  PetscCall(PetscFree(preparation->parent));
  PetscCall(PetscFree(preparation->vertex));
  preparation->num_steps = 0;
  preparation->is_changed = PETSC_FALSE;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPreparationDescribe(const EqmPreparation *preparation, char *text, size_t length)
{
  PetscFunctionBegin;
  text[0] = '\0';
  for (PetscInt s = 0; s < preparation->num_steps; s++) {
    PetscCall(PetscStrlcat(text, s ? "; " : "", length));
    PetscCall(PetscStrlcat(text, preparation->step[s].step, length));
    PetscCall(PetscStrlcat(text, ": ", length));
    PetscCall(PetscStrlcat(text, preparation->step[s].what, length));
  }
  PetscFunctionReturn(0);
}
