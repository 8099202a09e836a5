/* The mesh that a run is given: read, prepared and repaired if set, refused if it cannot be mapped. */
#include "intake/intake_private.h"
#include "mesh/mesh_private.h"
#include "mesh/handles.h"
#include "mesh/target.h"
#include "store/keptmesh.h"
#include "store/map_private.h"
#include <math.h>
#include <string.h>

/* The prepared mesh is mapped, if it is another than the given one. */
static PetscErrorCode Adopt(EqmIntake *intake)
{
  PetscFunctionBegin;
  intake->repair = intake->preparation.repair;
  if (intake->preparation.is_changed) {
    intake->mapped = intake->preparation.soup;
    intake->parent = intake->preparation.parent;
  } else {
    PetscCall(EqmPreparationReset(&intake->preparation));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmIntakePrepare(const EqmPrepareOptions *options, EqmIntake *intake)
{
  PetscFunctionBegin;
  PetscCall(EqmSoupPrepare(intake->given, options, &intake->preparation));
  PetscCall(Adopt(intake));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmIntakePrepareRest(const EqmPrepareOptions *options, const EqmPreparation *begun, EqmIntake *intake)
{
  PetscFunctionBegin;
  PetscCall(EqmPreparationCopy(intake->given, begun, &intake->preparation));
  PetscCall(EqmPrepareRest(intake->given, options, intake->components->automatic, &intake->preparation));
  PetscCall(Adopt(intake));
  PetscFunctionReturn(0);
}

/* Forget it. */
static PetscErrorCode Unprepare(EqmIntake *intake)
{
  PetscFunctionBegin;
  PetscCall(EqmPreparationReset(&intake->preparation));
  intake->mapped = intake->given;
  intake->parent = NULL;
  PetscFunctionReturn(0);
}

/* Vertices of a piece by their numbers in the whole. Of cells the numbers are those of the prepared mesh, as always. */
static PetscErrorCode NameVertices(const EqmIntake *intake, EqmDiagnosis *diagnosis)
{
  PetscFunctionBegin;
  for (int f = 0; f < EQM_NUM_FINDINGS; f++) {
    EqmFinding *const finding = &diagnosis->finding[f];

    if (f == EQM_FINDING_BAD_INDEX || f == EQM_FINDING_DEGENERATE_CELL || f == EQM_FINDING_DUPLICATE_CELL ||
        f == EQM_FINDING_NO_INTERIOR_VERTEX || finding->shown == 0)
      continue;
    PetscCall(EqmComponentsName(intake->components, intake->piece, 4 * finding->shown, finding->where[0]));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmIntakeDiagnose(const char *wanted, PetscBool with_places, EqmIntake *intake, PetscBool *fatal,
                                 char *text, size_t length)
{
  const EqmTarget *natural;
  EqmDiagnosis diagnosis;

  PetscFunctionBegin;
  PetscCall(EqmSoupDiagnose(intake->mapped, &diagnosis));
  if (with_places) PetscCall(EqmDiagnosisPlaceHandle(intake->mapped, &diagnosis));
  if (intake->components) PetscCall(NameVertices(intake, &diagnosis));
  intake->topology = diagnosis.topology;
  natural = EqmTargetOfTopology(diagnosis.topology);
  intake->target = wanted || !natural ? wanted : natural->name;
  PetscCall(EqmDiagnosisDescribe(&diagnosis, intake->target, fatal, text, length));
  if (!intake->target) *fatal = PETSC_TRUE;
  PetscFunctionReturn(0);
}

/* Would the mesh be taken with -repair, or else with -prepare auto? `advice` is the option; empty: with neither. */
static PetscErrorCode FindCure(EqmIntake *intake, const char *wanted, PetscBool can_prepare, char *advice,
                               size_t length)
{
  static const char *const cures[] = {"-repair", "-prepare auto", "-prepare auto -repair"};
  char text[4 * EQM_MESSAGE_MAX];
  PetscBool fatal = PETSC_TRUE;

  PetscFunctionBegin;
  advice[0] = '\0';
  for (int cure = 0; cure < (can_prepare ? 3 : 1) && fatal; cure++) {
    EqmPrepareOptions options;

    EqmPrepareOptionsInit(&options);
    options.target = wanted;
    options.repair = (PetscBool)(cure != 1);
    PetscCall(PetscStrncpy(options.steps, cure ? "auto" : "none", sizeof(options.steps)));
    PetscCall(Unprepare(intake));
    PetscCall(EqmIntakePrepare(&options, intake));
    if (intake->mapped != intake->given)
      PetscCall(EqmIntakeDiagnose(wanted, PETSC_FALSE, intake, &fatal, text, sizeof(text)));
    PetscCall(PetscStrncpy(advice, cures[cure], length));
  }
  if (fatal) advice[0] = '\0';
  PetscFunctionReturn(0);
}

/* Refuse the mesh: the reason, and whether an option would help or did not help. */
static PetscErrorCode Refuse(EqmIntake *intake, const EqmIntakeOptions *options, const char *findings)
{
  const char *const mesh = intake->given->file, *const target = intake->target;
  const PetscBool prepared = (PetscBool)(intake->mapped != intake->given && intake->preparation.num_steps);
  const char *const tried = options->repair ? ", not even after -repair" : prepared ? ", not even prepared" : "";
  char hope[2 * PETSC_MAX_PATH_LEN] = "", cure[64] = "";

  PetscFunctionBegin;
  if (!options->repair && !prepared)
    PetscCall(FindCure(intake, options->target, (PetscBool)(options->prepare.steps[0] != 0), cure, sizeof(cure)));
  if (cure[0]) PetscCall(PetscSNPrintf(hope, sizeof(hope), "\nThis can be mended: %s %s -o OUT", options->usage, cure));
  if (target)
    EqmFail(intake->given->comm, EQM_ERR_MESH, "%s cannot be mapped to the %s%s:\n%s%s", mesh, target, tried, findings,
            hope);
  EqmFail(intake->given->comm, EQM_ERR_MESH, "%s is neither disk, sphere nor ball%s:\n%s%s", mesh, tried, findings,
          hope);
}

static PetscErrorCode ReadSoup(MPI_Comm comm, const EqmIntakeOptions *options, EqmIntake *intake, EqmSoup *plain)
{
  PetscFunctionBegin;
  if (options->is_copy)
    PetscCall(EqmKeptMeshRead(comm, options->mesh, &intake->given));
  else
    PetscCall(EqmSoupRead(comm, options->mesh, &intake->given));
  if (options->any_size)
    PetscCall(EqmSoupBringIntoRange(intake->given, &intake->unit));
  else
    PetscCall(EqmSoupCheckExtent(intake->given));
  if (options->density) PetscCall(EqmSoupReadDensity(intake->given, options->density));
  *plain = intake->given;
  if (options->noise == 0.) PetscFunctionReturn(0);
  PetscCall(EqmSoupCopy(intake->given, plain));
  PetscCall(EqmSoupAddNoise(intake->given, ldexp(options->noise, (int)-intake->unit), options->seed));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmIntakeBegin(MPI_Comm comm, const EqmIntakeOptions *options, EqmLedger ledger, EqmIntake *intake,
                              EqmSoup *plain)
{
  PetscFunctionBegin;
  PetscCall(PetscMemzero(intake, sizeof(*intake)));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_READ));
  PetscCall(ReadSoup(comm, options, intake, plain));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_READ));
  intake->mapped = intake->given;
  if (!options->quiet && (*plain)->note[0])
    PetscCall(PetscPrintf(comm, "note: %s: %s\n", (*plain)->file, (*plain)->note));
  PetscFunctionReturn(0);
}

EqmPrepareOptions EqmIntakePrepareOptions(const EqmIntakeOptions *options)
{
  EqmPrepareOptions prepare = options->prepare;

  prepare.repair = options->repair;
  prepare.target = options->target;
  return prepare;
}

/* The copy beside the checkpoint, in the file's unit. */
static PetscErrorCode Keep(EqmSoup soup, PetscInt unit, const EqmIntakeOptions *options, EqmLedger ledger)
{
  char name[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_CHECKPOINT));
  PetscCall(EqmKeptMeshName(options->checkpoint, options->part, name, sizeof(name)));
  PetscCall(EqmSoupShift(soup, unit));
  PetscCall(EqmKeptMeshWrite(soup, NULL, name, options->resumed));
  PetscCall(EqmSoupShift(soup, -unit));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_CHECKPOINT));
  PetscFunctionReturn(0);
}

/* EqmIntakeRead - read a mesh that is to be mapped, add noise and repair it if set, refuse it if it cannot be mapped,
   write a copy of it beside the checkpoint.

   Collective. options - as EqmIntakeChoose leaves them; intake - to be freed with EqmIntakeDestroy.
   Errors: those of EqmSoupRead, EqmSoupReadDensity and EqmSoupAddNoise; EQM_ERR_MESH with what is wrong, where, and
   whether -repair would help. */
PetscErrorCode EqmIntakeRead(MPI_Comm comm, const EqmIntakeOptions *options, EqmLedger ledger, EqmIntake *intake)
{
  char text[4 * EQM_MESSAGE_MAX];
  const EqmPrepareOptions prepare = EqmIntakePrepareOptions(options);
  EqmSoup plain;
  PetscBool fatal;

  PetscFunctionBegin;
  PetscCall(EqmIntakeBegin(comm, options, ledger, intake, &plain));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_DIAGNOSE));
  PetscCall(EqmIntakePrepare(&prepare, intake));
  if (!options->quiet) PetscCall(EqmPrintPreparation(comm, options->part, &intake->preparation));
  if (options->repair && !options->quiet) PetscCall(EqmPrintRepair(comm, options->part, &intake->repair));
  if (intake->repair.cells_split && !options->quiet) {
    PetscCall(PetscPrintf(comm,
                          "%s%snote: the map is made for the parts of the %" PetscInt64_FMT
                          " cells that were split; they themselves are measured afterwards\n",
                          EQM_OF_PART(options->part), intake->repair.cells_split));
  }
  PetscCall(EqmIntakeDiagnose(options->target, PETSC_TRUE, intake, &fatal, text, sizeof(text)));
  if (fatal) PetscCall(Refuse(intake, options, text));
  if (!options->quiet) PetscCall(EqmPrintLinesWith(comm, options->part, "warning: ", text));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_DIAGNOSE));
  if (options->checkpoint) PetscCall(Keep(plain, intake->unit, options, ledger));
  if (plain != intake->given) PetscCall(EqmSoupDestroy(&plain));
  PetscFunctionReturn(0);
}

/* Add to the result which cells of the input have been mapped: 1, which left out: 0, and at which the surface was cut
   apart, so that their images are in the prepared mesh alone: 2. */
static PetscErrorCode MarkLeftOut(const EqmIntake *intake, EqmMap map)
{
  const EqmSoup given = intake->given;
  const PetscInt count = given->cell_end - given->cell_start;
  PetscInt *mark;
  PetscInt64 *mapped;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(count, &mark));
  PetscCall(PetscMalloc1(count + 1, &mapped));
  PetscCall(EqmIntakeMarkCells(intake, mark));
  for (PetscInt c = 0; c < count; c++) mapped[c] = mark[c] == EQM_CELL_LEFT_OUT ? 0 : mark[c] == EQM_CELL_CUT ? 2 : 1;
  PetscCall(EqmMapAddIntegers(map, "/cell/mapped", given->num_cells, given->cell_start, count, 0, mapped));
  PetscCall(PetscFree(mark));
  PetscFunctionReturn(0);
}

/* EqmIntakeTakeMap - turn the map of the mapped mesh into one of the given mesh; the two are the same where nothing was
   changed.

   Collective. mesh - made of intake->mapped; found - its map in that numbering; map - the result, to be destroyed
   before `found`. */
PetscErrorCode EqmIntakeTakeMap(const EqmIntake *intake, EqmMesh mesh, EqmMap found, EqmMap *map)
{
  const EqmPreparation *const preparation = &intake->preparation;
  PetscReal *weight;

  PetscFunctionBegin;
  *map = found;
  if (intake->mapped == intake->given) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(intake->mapped->cell_end - intake->mapped->cell_start, &weight));
  PetscCall(EqmMeshCellsToInput(mesh, intake->mapped, 1, mesh->weight, weight));
  PetscCall(EqmMapOntoInput(found, intake->given, intake->parent, preparation->vertex, weight, map));
  for (PetscInt s = 0; s < preparation->num_steps; s++) {
    const EqmPreparedStep *const step = &preparation->step[s];
    PetscCall(EqmMapAddPrepared(*map, step->step, step->count, step->what));
  }
  PetscCall(MarkLeftOut(intake, *map));
  (*map)->repair = intake->repair;
  PetscCall(PetscFree(weight));
  PetscFunctionReturn(0);
}

/* Free what EqmIntakeRead or EqmIntakePiece made. Collective. */
PetscErrorCode EqmIntakeDestroy(EqmIntake *intake)
{
  PetscFunctionBegin;
  PetscCall(EqmPreparationReset(&intake->begun));
  PetscCall(EqmPreparationReset(&intake->preparation));
  PetscCall(EqmSoupDestroy(&intake->given));
  intake->mapped = NULL;
  intake->parent = NULL;
  PetscFunctionReturn(0);
}
