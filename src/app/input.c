/* The mesh that a map command is given: read, mended if asked, refused if it cannot be mapped. */
#include "app.h"
#include "store/keptmesh.h"
#include <string.h>

/* Print the lines of a text that begin with `head`; all of them if it is empty. Collective. */
static PetscErrorCode PrintLinesWith(const char *head, const char *text)
{
  PetscFunctionBegin;
  for (const char *line = text; line && *line;) {
    const char *const end = strchr(line, '\n');
    const int width = (int)(end ? end - line : (ptrdiff_t)strlen(line));

    if (!strncmp(line, head, strlen(head))) PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%.*s\n", width, line));
    line = end ? end + 1 : NULL;
  }
  PetscFunctionReturn(0);
}

/* What a repair did, in one line. Collective on PETSC_COMM_WORLD. */
PetscErrorCode EqmPrintRepair(const EqmRepair *repair)
{
  PetscFunctionBegin;
  PetscCall(PetscPrintf(PETSC_COMM_WORLD,
                        "repair: %" PetscInt64_FMT " twins and %" PetscInt64_FMT
                        " cells with a repeated vertex removed, %" PetscInt64_FMT " cells turned, %" PetscInt64_FMT
                        " cells split with %" PetscInt64_FMT " new vertices\n",
                        repair->duplicate_cells_removed, repair->degenerate_cells_removed, repair->cells_flipped,
                        repair->cells_split, repair->vertices_added));
  PetscFunctionReturn(0);
}

/* Mend a copy of the input; where there was nothing to mend, the input is what is mapped. */
static PetscErrorCode Mend(EqmInput *input)
{
  EqmRepair *const r = &input->repair;

  PetscFunctionBegin;
  PetscCall(EqmSoupCopy(input->given, &input->mapped));
  PetscCall(EqmSoupRepair(&input->mapped, r, &input->parent));
  if (r->duplicate_cells_removed + r->degenerate_cells_removed + r->cells_flipped + r->cells_split) {
    PetscFunctionReturn(0);
  }
  PetscCall(EqmSoupDestroy(&input->mapped));
  PetscCall(PetscFree(input->parent));
  input->mapped = input->given;
  PetscFunctionReturn(0);
}

/* Would the command take the mesh with -repair? */
static PetscErrorCode CouldBeMended(EqmInput *input, const char *command, PetscBool *could)
{
  char text[4 * EQM_MESSAGE_MAX];
  EqmDiagnosis diagnosis;
  PetscBool fatal = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(Mend(input));
  if (input->mapped != input->given) {
    PetscCall(EqmSoupDiagnose(input->mapped, &diagnosis));
    PetscCall(EqmDiagnosisDescribe(&diagnosis, command, &fatal, text, sizeof(text)));
  }
  *could = (PetscBool)!fatal;
  PetscFunctionReturn(0);
}

/* The mesh is out of the question: say why, and whether -repair helps, would help or did not help. */
static PetscErrorCode Refuse(EqmInput *input, const char *command, PetscBool repair, const char *findings)
{
  const char *const mesh = input->given->file;
  PetscBool could = PETSC_FALSE;
  char hope[EQM_MESSAGE_MAX] = "";

  PetscFunctionBegin;
  if (!repair) PetscCall(CouldBeMended(input, command, &could));
  if (could) {
    PetscCall(PetscSNPrintf(hope, sizeof(hope), "\nThis can be mended: equimap %s %s -repair -o OUT", command, mesh));
  }
  EqmFail(PETSC_COMM_WORLD, EQM_ERR_MESH, "%s cannot be mapped to the %s%s:\n%s%s", mesh, command,
          repair ? ", not even after -repair" : "", findings, hope);
}

/* The mesh as the file has it, with its density, and then with noise; `plain` is the one without. */
static PetscErrorCode Read(const EqmInputOptions *options, EqmInput *input, EqmSoup *plain)
{
  PetscFunctionBegin;
  if (options->is_copy)
    PetscCall(EqmKeptMeshRead(PETSC_COMM_WORLD, options->mesh, &input->given));
  else
    PetscCall(EqmSoupRead(PETSC_COMM_WORLD, options->mesh, &input->given));
  if (options->density) PetscCall(EqmSoupReadDensity(input->given, options->density));
  *plain = input->given;
  if (options->noise == 0.) PetscFunctionReturn(0);
  PetscCall(EqmSoupCopy(input->given, plain));
  PetscCall(EqmSoupAddNoise(input->given, options->noise, options->seed));
  PetscFunctionReturn(0);
}

/* EqmInputRead - read the mesh that `command` is to map, add noise and mend it if asked, refuse it if it cannot be
   mapped, leave a copy of it beside the checkpoint.

   Collective on PETSC_COMM_WORLD. options - as EqmInputChoose leaves them; input - to be freed with EqmInputDestroy.
   Errors: those of EqmSoupRead, EqmSoupReadDensity and EqmSoupAddNoise; EQM_ERR_MESH with what is wrong, where, and
   whether -repair would help. */
PetscErrorCode EqmInputRead(const char *command, const EqmInputOptions *options, EqmLedger ledger, EqmInput *input)
{
  char text[4 * EQM_MESSAGE_MAX];
  EqmDiagnosis diagnosis;
  EqmSoup plain;
  PetscBool fatal;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(input, sizeof(*input)));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_READ));
  PetscCall(Read(options, input, &plain));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_READ));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_DIAGNOSE));
  input->mapped = input->given;
  if (options->repair) PetscCall(Mend(input));
  if (options->repair && !options->quiet) PetscCall(EqmPrintRepair(&input->repair));
  PetscCall(EqmSoupDiagnose(input->mapped, &diagnosis));
  PetscCall(EqmDiagnosisDescribe(&diagnosis, command, &fatal, text, sizeof(text)));
  if (fatal) PetscCall(Refuse(input, command, options->repair, text));
  if (!options->quiet) PetscCall(PrintLinesWith("warning: ", text));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_DIAGNOSE));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_CHECKPOINT));
  if (options->checkpoint) PetscCall(EqmKeptMeshWrite(plain, options->checkpoint, options->resumed));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_CHECKPOINT));
  if (plain != input->given) PetscCall(EqmSoupDestroy(&plain));
  PetscFunctionReturn(0);
}

/* EqmInputTakeMap - the map of the mesh that was mapped becomes one of the mesh that was given; the two are the same
   where nothing was mended.

   Collective. mesh - made of input->mapped; found - its map in that numbering; map - the answer, to be destroyed before
   `found`. */
PetscErrorCode EqmInputTakeMap(const EqmInput *input, EqmMesh mesh, EqmMap found, EqmMap *map)
{
  PetscReal *weight;

  PetscFunctionBegin;
  *map = found;
  if (input->mapped == input->given) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(input->mapped->cell_end - input->mapped->cell_start, &weight));
  PetscCall(EqmMeshCellsToInput(mesh, input->mapped, 1, mesh->weight, weight));
  PetscCall(EqmMapOntoInput(found, input->given, input->parent, weight, map));
  (*map)->repair = input->repair;
  PetscCall(PetscFree(weight));
  PetscFunctionReturn(0);
}

/* Free what EqmInputRead made. Collective. */
PetscErrorCode EqmInputDestroy(EqmInput *input)
{
  PetscFunctionBegin;
  if (input->mapped != input->given) PetscCall(EqmSoupDestroy(&input->mapped));
  PetscCall(EqmSoupDestroy(&input->given));
  PetscCall(PetscFree(input->parent));
  input->mapped = NULL;
  PetscFunctionReturn(0);
}
