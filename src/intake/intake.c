/* The mesh that a run is given: read, mended if asked, refused if it cannot be mapped. */
#include "intake/intake.h"
#include "mesh/target.h"
#include "store/keptmesh.h"
#include "store/map_private.h"
#include <string.h>

/* What stands before a report: of which mesh it is, if there are two. */
#define OF_PART(part) (part) ? (part) : "", (part) ? ": " : ""

/* Print the lines of a text that begin with `head`. Collective. */
static PetscErrorCode PrintLinesWith(MPI_Comm comm, const char *part, const char *head, const char *text)
{
  PetscFunctionBegin;
  for (const char *line = text; line && *line;) {
    const char *const end = strchr(line, '\n');
    const int width = (int)(end ? end - line : (ptrdiff_t)strlen(line));

    if (!strncmp(line, head, strlen(head))) PetscCall(PetscPrintf(comm, "%s%s%.*s\n", OF_PART(part), width, line));
    line = end ? end + 1 : NULL;
  }
  PetscFunctionReturn(0);
}

/* What a repair did, in one line; `part` as in EqmIntakeOptions. Collective. */
PetscErrorCode EqmPrintRepair(MPI_Comm comm, const char *part, const EqmRepair *repair)
{
  PetscFunctionBegin;
  PetscCall(PetscPrintf(comm,
                        "%s%srepair: %" PetscInt64_FMT " twins and %" PetscInt64_FMT
                        " cells with a repeated vertex removed, %" PetscInt64_FMT " cells turned, %" PetscInt64_FMT
                        " cells split with %" PetscInt64_FMT " new vertices\n",
                        OF_PART(part), repair->duplicate_cells_removed, repair->degenerate_cells_removed,
                        repair->cells_flipped, repair->cells_split, repair->vertices_added));
  PetscFunctionReturn(0);
}

/* Mend a copy of the input; where there was nothing to mend, the input is what is mapped. */
static PetscErrorCode Mend(EqmIntake *intake)
{
  EqmRepair *const r = &intake->repair;

  PetscFunctionBegin;
  PetscCall(EqmSoupCopy(intake->given, &intake->mapped));
  PetscCall(EqmSoupRepair(&intake->mapped, r, &intake->parent));
  if (r->duplicate_cells_removed + r->degenerate_cells_removed + r->cells_flipped + r->cells_split) {
    PetscFunctionReturn(0);
  }
  PetscCall(EqmSoupDestroy(&intake->mapped));
  PetscCall(PetscFree(intake->parent));
  intake->mapped = intake->given;
  PetscFunctionReturn(0);
}

/* Look at what would be mapped: its topology, the target that was asked for or that it asks for, what is wrong. */
static PetscErrorCode Diagnose(const char *wanted, EqmIntake *intake, PetscBool *fatal, char *text, size_t length)
{
  const EqmTarget *natural;
  EqmDiagnosis diagnosis;

  PetscFunctionBegin;
  PetscCall(EqmSoupDiagnose(intake->mapped, &diagnosis));
  intake->topology = diagnosis.topology;
  natural = EqmTargetOfTopology(diagnosis.topology);
  intake->target = wanted || !natural ? wanted : natural->name;
  PetscCall(EqmDiagnosisDescribe(&diagnosis, intake->target, fatal, text, length));
  if (!intake->target) *fatal = PETSC_TRUE;
  PetscFunctionReturn(0);
}

/* Would the mesh be taken with -repair? */
static PetscErrorCode CouldBeMended(EqmIntake *intake, const char *wanted, PetscBool *could)
{
  char text[4 * EQM_MESSAGE_MAX];
  PetscBool fatal = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(Mend(intake));
  if (intake->mapped != intake->given) PetscCall(Diagnose(wanted, intake, &fatal, text, sizeof(text)));
  *could = (PetscBool)!fatal;
  PetscFunctionReturn(0);
}

/* The mesh is out of the question: say why, and whether -repair helps, would help or did not help. */
static PetscErrorCode Refuse(EqmIntake *intake, const EqmIntakeOptions *options, const char *findings)
{
  const char *const mesh = intake->given->file, *const target = intake->target;
  const char *const mended = options->repair ? ", not even after -repair" : "";
  PetscBool could = PETSC_FALSE;
  char hope[2 * PETSC_MAX_PATH_LEN] = "";

  PetscFunctionBegin;
  if (!options->repair) PetscCall(CouldBeMended(intake, options->target, &could));
  if (could) PetscCall(PetscSNPrintf(hope, sizeof(hope), "\nThis can be mended: %s -repair -o OUT", options->usage));
  if (target)
    EqmFail(intake->given->comm, EQM_ERR_MESH, "%s cannot be mapped to the %s%s:\n%s%s", mesh, target, mended, findings,
            hope);
  EqmFail(intake->given->comm, EQM_ERR_MESH, "%s is neither disk, sphere nor ball%s:\n%s%s", mesh, mended, findings,
          hope);
}

/* The mesh as the file has it, with its density, and then with noise; `plain` is the one without. */
static PetscErrorCode Read(MPI_Comm comm, const EqmIntakeOptions *options, EqmIntake *intake, EqmSoup *plain)
{
  PetscFunctionBegin;
  if (options->is_copy)
    PetscCall(EqmKeptMeshRead(comm, options->mesh, &intake->given));
  else
    PetscCall(EqmSoupRead(comm, options->mesh, &intake->given));
  if (options->density) PetscCall(EqmSoupReadDensity(intake->given, options->density));
  *plain = intake->given;
  if (options->noise == 0.) PetscFunctionReturn(0);
  PetscCall(EqmSoupCopy(intake->given, plain));
  PetscCall(EqmSoupAddNoise(intake->given, options->noise, options->seed));
  PetscFunctionReturn(0);
}

/* The copy beside the checkpoint. */
static PetscErrorCode Keep(EqmSoup soup, const EqmIntakeOptions *options, EqmLedger ledger)
{
  char name[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_CHECKPOINT));
  PetscCall(EqmKeptMeshName(options->checkpoint, options->part, name, sizeof(name)));
  PetscCall(EqmKeptMeshWrite(soup, NULL, name, options->resumed));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_CHECKPOINT));
  PetscFunctionReturn(0);
}

/* EqmIntakeRead - read a mesh that is to be mapped, add noise and mend it if asked, refuse it if it cannot be mapped,
   leave a copy of it beside the checkpoint.

   Collective. options - as EqmIntakeChoose leaves them; intake - to be freed with EqmIntakeDestroy.
   Errors: those of EqmSoupRead, EqmSoupReadDensity and EqmSoupAddNoise; EQM_ERR_MESH with what is wrong, where, and
   whether -repair would help. */
PetscErrorCode EqmIntakeRead(MPI_Comm comm, const EqmIntakeOptions *options, EqmLedger ledger, EqmIntake *intake)
{
  char text[4 * EQM_MESSAGE_MAX];
  EqmSoup plain;
  PetscBool fatal;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(intake, sizeof(*intake)));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_READ));
  PetscCall(Read(comm, options, intake, &plain));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_READ));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_DIAGNOSE));
  intake->mapped = intake->given;
  if (!options->quiet && plain->note[0]) PetscCall(PetscPrintf(comm, "note: %s: %s\n", plain->file, plain->note));
  if (options->repair) PetscCall(Mend(intake));
  if (options->repair && !options->quiet) PetscCall(EqmPrintRepair(comm, options->part, &intake->repair));
  PetscCall(Diagnose(options->target, intake, &fatal, text, sizeof(text)));
  if (fatal) PetscCall(Refuse(intake, options, text));
  if (!options->quiet) PetscCall(PrintLinesWith(comm, options->part, "warning: ", text));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_DIAGNOSE));
  if (options->checkpoint) PetscCall(Keep(plain, options, ledger));
  if (plain != intake->given) PetscCall(EqmSoupDestroy(&plain));
  PetscFunctionReturn(0);
}

/* EqmIntakeTakeMap - the map of the mesh that was mapped becomes one of the mesh that was given; the two are the same
   where nothing was mended.

   Collective. mesh - made of intake->mapped; found - its map in that numbering; map - the answer, to be destroyed
   before `found`. */
PetscErrorCode EqmIntakeTakeMap(const EqmIntake *intake, EqmMesh mesh, EqmMap found, EqmMap *map)
{
  PetscReal *weight;

  PetscFunctionBegin;
  *map = found;
  if (intake->mapped == intake->given) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(intake->mapped->cell_end - intake->mapped->cell_start, &weight));
  PetscCall(EqmMeshCellsToInput(mesh, intake->mapped, 1, mesh->weight, weight));
  PetscCall(EqmMapOntoInput(found, intake->given, intake->parent, weight, map));
  (*map)->repair = intake->repair;
  PetscCall(PetscFree(weight));
  PetscFunctionReturn(0);
}

/* Free what EqmIntakeRead made. Collective. */
PetscErrorCode EqmIntakeDestroy(EqmIntake *intake)
{
  PetscFunctionBegin;
  if (intake->mapped != intake->given) PetscCall(EqmSoupDestroy(&intake->mapped));
  PetscCall(EqmSoupDestroy(&intake->given));
  PetscCall(PetscFree(intake->parent));
  intake->mapped = NULL;
  PetscFunctionReturn(0);
}
