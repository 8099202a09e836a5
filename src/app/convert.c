/* equimap convert IN OUT: from one mesh format to another, repaired or refined; the surface of a solid, the solid in a
   surface. */
#include "app.h"
#include "mesh/mesh_private.h"
#include "mesh/target.h"
#include "prepare/fill.h"
#include "prepare/prepare.h"

typedef struct {
  PetscBool repair, boundary, fill, has_target;
  EqmFillOptions filling;
  EqmPrepareOptions prepare;
  char target[32];
  PetscInt refine;
  PetscReal scale;
} ConvertOptions;

static PetscErrorCode ReadOptions(ConvertOptions *options)
{
  PetscFunctionBegin;
  options->repair = options->boundary = options->fill = PETSC_FALSE;
  options->filling = (EqmFillOptions){.quality = 1.4, .volume = 0.};
  options->refine = 0;
  options->scale = 1.;
  EqmPrepareOptionsInit(&options->prepare);
  PetscOptionsBegin(PETSC_COMM_WORLD, NULL, "Conversion of meshes (convert)", "convert");
  PetscCall(
      PetscOptionsBool("-repair",
                       "mend what is safe to mend (twins, repeated vertices, orientation, cells without an interior "
                       "vertex); kept vertices keep their numbers",
                       "convert", options->repair, &options->repair, NULL));
  PetscCall(EqmPrepareSetFromOptions(PetscOptionsObject, &options->prepare));
  PetscCall(PetscOptionsString("-target", "of -prepare: the command that the mesh is for; without it any that takes it",
                               "convert", "", options->target, sizeof(options->target), &options->has_target));
  PetscCall(PetscOptionsInt("-refine", "split every triangle into 4, every tetrahedron into 8, so many times",
                            "convert", options->refine, &options->refine, NULL));
  PetscCall(PetscOptionsReal("-scale", "multiply all coordinates by this factor", "convert", options->scale,
                             &options->scale, NULL));
  PetscCall(PetscOptionsBool("-boundary",
                             "write the surface around a solid: its boundary vertices in their order, triangles that "
                             "look outward",
                             "convert", options->boundary, &options->boundary, NULL));
  PetscCall(PetscOptionsBool("-fill",
                             "write the solid within a closed surface: its vertices and triangles stay, new vertices "
                             "come after them (built with TetGen); with -prepare holes are filled first",
                             "convert", options->fill, &options->fill, NULL));
  PetscCall(PetscOptionsReal("-fill_quality",
                             "of -fill: a tetrahedron's radius over its shortest edge, at most (above 1)", "convert",
                             options->filling.quality, &options->filling.quality, NULL));
  PetscCall(
      PetscOptionsReal("-fill_volume",
                       "of -fill: a tetrahedron's volume, at most, in those of a regular one on the surface's mean "
                       "edge; 0: any",
                       "convert", options->filling.volume, &options->filling.volume, NULL));
  PetscOptionsEnd();
  if (options->has_target && !EqmTargetFind(options->target))
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-target %s: there is no such map command", options->target);
  if (options->fill && !options->has_target)
    PetscCall(PetscStrncpy(options->target, "sphere", sizeof(options->target)));
  options->prepare.target = options->has_target || options->fill ? options->target : NULL;
  options->prepare.repair = options->repair;
  PetscFunctionReturn(0);
}

/* The prepared and repaired mesh takes the place of the one that was read. Collective. */
static PetscErrorCode Prepare(const EqmPrepareOptions *options, EqmSoup *soup)
{
  EqmPreparation preparation;

  PetscFunctionBegin;
  PetscCall(EqmSoupPrepare(*soup, options, &preparation));
  for (PetscInt s = 0; s < preparation.num_steps; s++) {
    PetscCall(PetscPrintf((*soup)->comm, "prepared: %s: %s\n", preparation.step[s].step, preparation.step[s].what));
  }
  PetscCall(EqmSoupDestroy(soup));
  *soup = preparation.soup;
  preparation.soup = NULL;
  PetscCall(EqmPreparationReset(&preparation));
  PetscFunctionReturn(0);
}

/* The surface of a solid takes its place. Collective. */
static PetscErrorCode TakeBoundary(EqmSoup *soup)
{
  EqmDiagnosis diagnosis;
  EqmLedger ledger;
  EqmMesh solid;
  EqmSurface surface;

  PetscFunctionBegin;
  PetscCall(EqmSoupDiagnose(*soup, &diagnosis));
  if (diagnosis.finding[EQM_FINDING_BAD_INDEX].count || diagnosis.finding[EQM_FINDING_DUPLICATE_CELL].count) {
    EqmFail((*soup)->comm, EQM_ERR_MESH, "%s: its boundary is unclear, see equimap check; -repair may help",
            (*soup)->file);
  }
  PetscCall(EqmLedgerCreate((*soup)->comm, &ledger));
  PetscCall(EqmMeshCreate(*soup, ledger, &solid));
  PetscCall(EqmSurfaceCreate(solid, &surface));
  PetscCall(EqmMeshDestroy(&solid));
  PetscCall(EqmLedgerDestroy(&ledger));
  PetscCall(EqmSoupDestroy(soup));
  *soup = surface->soup;
  surface->soup = NULL;
  PetscCall(EqmSurfaceDestroy(&surface));
  PetscFunctionReturn(0);
}

/* All that makes another mesh of it; the fields of the file then belong to no vertex and cell any more. */
static PetscErrorCode Change(const ConvertOptions *options, EqmSoup *soup)
{
  const PetscInt num_fields = (*soup)->num_fields;

  PetscFunctionBegin;
  PetscCall(Prepare(&options->prepare, soup));
  if (options->refine) PetscCall(EqmSoupRefine(soup, options->refine));
  if (options->boundary) PetscCall(TakeBoundary(soup));
  if (options->fill) PetscCall(EqmSoupFill(&options->filling, soup));
  if (num_fields && !(*soup)->num_fields)
    PetscCall(PetscPrintf((*soup)->comm, "note: left out: %" PetscInt_FMT " fields, as it is another mesh now\n",
                          num_fields));
  PetscFunctionReturn(0);
}

static PetscErrorCode PrintUsage(void)
{
  PetscFunctionBegin;
  PetscCall(PetscPrintf(
      PETSC_COMM_WORLD,
      "\nusage: equimap convert IN OUT [-prepare LIST] [-repair] [-refine TIMES] [-scale FACTOR] [-boundary] [-fill]\n"
      "The suffix of OUT chooses its format; IN's is seen from its content. Vertices keep their numbers; new ones\n"
      "come after them.\n"));
  PetscFunctionReturn(0);
}

/* Run `equimap convert`. Collective on PETSC_COMM_WORLD. Errors: EQM_ERR_USAGE, and those of EqmSoupRead,
   EqmSoupRepair, EqmSoupRefine, EqmSurfaceCreate and EqmSoupWrite. */
PetscErrorCode EqmCommandConvert(const EqmCommandLine *line, EqmStatus *status)
{
  ConvertOptions options;
  EqmSoup soup;

  PetscFunctionBegin;
  *status = EQM_STATUS_CONVERGED;
  PetscCall(ReadOptions(&options));
  if (line->help) {
    PetscCall(PrintUsage());
    PetscFunctionReturn(0);
  }
  PetscCall(EqmRejectUnknownOptions(line));
  if (line->num_arguments != 2) {
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "convert takes two files, IN and OUT, %d given", line->num_arguments);
  }
  if (options.fill && EqmFillMissing()) EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-fill: %s", EqmFillMissing());
  if (!(options.filling.quality > 1.) || !(options.filling.volume >= 0.))
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-fill_quality wants a number above 1, -fill_volume 0 or more");
  if (options.refine < 0)
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-refine %" PetscInt_FMT ": give 0 or more", options.refine);
  PetscCall(EqmSoupRead(PETSC_COMM_WORLD, line->argument[0], &soup));
  if (soup->note[0]) PetscCall(PetscPrintf(PETSC_COMM_WORLD, "note: %s: %s\n", soup->file, soup->note));
  if (options.scale != 1.) PetscCall(EqmSoupScale(soup, options.scale));
  PetscCall(Change(&options, &soup));
  PetscCall(EqmSoupWrite(soup, line->argument[1]));
  PetscCall(EqmPrintDropped(soup, line->argument[1], PETSC_FALSE));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s: %" PetscInt_FMT " vertices, %" PetscInt_FMT " %s -> %s\n",
                        line->argument[0], soup->num_vertices, soup->num_cells,
                        soup->cell_size == 3 ? "triangles" : "tetrahedra", line->argument[1]));
  PetscCall(EqmSoupDestroy(&soup));
  PetscFunctionReturn(0);
}
