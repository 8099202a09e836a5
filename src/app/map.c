/* equimap disk | square | sphere MESH -o OUT: read, diagnose, distribute, minimise, measure, write. */
#include "app.h"
#include "mesh/soup_private.h"
#include "base/progress.h"
#include "base/stop.h"
#include "format/format.h"
#include "intake/intake.h"
#include "maprun.h"
#include "pieces.h"
#include "start/start.h"
#include "store/map_private.h"
#include "store/output.h"
#include <string.h>

typedef struct {
  char output[PETSC_MAX_PATH_LEN], summary[PETSC_MAX_PATH_LEN], history[PETSC_MAX_PATH_LEN],
      density[PETSC_MAX_PATH_LEN], histogram[PETSC_MAX_PATH_LEN], ratios[PETSC_MAX_PATH_LEN],
      checkpoint[PETSC_MAX_PATH_LEN], restart[PETSC_MAX_PATH_LEN], uv[PETSC_MAX_PATH_LEN];
  PetscBool has_uv, has_output, has_summary, has_history, has_density, has_histogram, has_ratios, has_checkpoint,
      has_restart;
  EqmIntakeOptions input;
  EqmStopFile stop_file;
  char usage[PETSC_MAX_PATH_LEN];
  PetscInt hessian_eigenvalues, hessian; /* how many; of which Hessian, as in the list `hessians` */
  PetscReal radius;
  PetscBool dry_run;
  PetscInt pieces; /* as in the list `which_pieces` */
} MapOptions;

static const char *const hessians[] = {"energy", "appendix-b"};
static const char *const which_pieces[] = {"one", "each"};

static PetscErrorCode ReadOptions(MapOptions *options)
{
  PetscFunctionBegin;
  EqmPrepareOptionsInit(&options->input.prepare);
  PetscOptionsBegin(PETSC_COMM_WORLD, NULL, "Files", NULL);
  PetscCall(PetscOptionsString("-o",
                               "where the map goes: .h5 (everything, with an .xmf for ParaView), .obj .off .ply .vtu "
                               ".vtk .msh .mesh .gii; several with commas",
                               NULL, "", options->output, sizeof(options->output), &options->has_output));
  PetscCall(
      PetscOptionsString("-uv",
                         "write the surface itself with the map as texture coordinates: .obj (vt) or .ply (s, t); "
                         "of spheres longitude and latitude",
                         NULL, "", options->uv, sizeof(options->uv), &options->has_uv));
  PetscCall(PetscOptionsReal("-radius",
                             "multiply the images by this in mesh formats: 100 for HCP's spheres; .h5 keeps the unit "
                             "target, FreeSurfer's spheres have 100 always",
                             NULL, options->radius, &options->radius, NULL));
  PetscCall(PetscOptionsString("-summary", "write the run's figures as JSON", NULL, "", options->summary,
                               sizeof(options->summary), &options->has_summary));
  PetscCall(PetscOptionsString("-history", "write a row per iteration as CSV", NULL, "", options->history,
                               sizeof(options->history), &options->has_history));
  PetscCall(PetscOptionsString("-histogram", "write the histogram of angle errors as CSV", NULL, "", options->histogram,
                               sizeof(options->histogram), &options->has_histogram));
  PetscCall(PetscOptionsString("-ratio_histogram", "write the histogram of the ratios as CSV", NULL, "",
                               options->ratios, sizeof(options->ratios), &options->has_ratios));
  PetscCall(PetscOptionsString(
      "-density",
      "a positive weight per cell (CSV with a header, or /cell/density of an HDF5 file): keep mass instead of area",
      NULL, "", options->density, sizeof(options->density), &options->has_density));
  PetscCall(PetscOptionsBool("-repair", "mend first what is safe to mend (see equimap check)", NULL,
                             options->input.repair, &options->input.repair, NULL));
  PetscCall(EqmPrepareSetFromOptions(PetscOptionsObject, &options->input.prepare));
  PetscCall(PetscOptionsEList("-pieces",
                              "one: the mesh is one piece, or -prepare takes one; each: every piece is mapped to a "
                              "target of its own",
                              NULL, which_pieces, 2, which_pieces[options->pieces], &options->pieces, NULL));
  PetscCall(PetscOptionsReal("-noise",
                             "move every vertex of the surface along its normal by a random length of this standard "
                             "deviation, in the mesh's units: for studies of stability",
                             NULL, options->input.noise, &options->input.noise, NULL));
  PetscCall(PetscOptionsInt("-seed", "of the noise: another seed, other random numbers", NULL, options->input.seed,
                            &options->input.seed, NULL));
  PetscCall(PetscOptionsInt("-hessian_eigenvalues",
                            "compute so many of the smallest eigenvalues of the energy's Hessian at the result (needs "
                            "a build with SLEPc)",
                            NULL, options->hessian_eigenvalues, &options->hessian_eigenvalues, NULL));
  PetscCall(PetscOptionsEList("-hessian",
                              "which Hessian: that of the energy on the target, or that of the stretch energy in space "
                              "of 001 Appendix B (sphere)",
                              NULL, hessians, 2, hessians[options->hessian], &options->hessian, NULL));
  PetscCall(EqmLayoutHelpOptions(PetscOptionsObject));
  PetscCall(PetscOptionsBool("-dry_run", "look at options, mesh and outputs, say whether a run would begin, and stop",
                             NULL, options->dry_run, &options->dry_run, NULL));
  PetscOptionsEnd();
  if (options->has_density) options->input.density = options->density;
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-quiet", &options->input.quiet, NULL)); /* the solver lists these */
  PetscCall(PetscOptionsGetString(NULL, NULL, "-checkpoint", options->checkpoint, sizeof(options->checkpoint),
                                  &options->has_checkpoint));
  PetscCall(
      PetscOptionsGetString(NULL, NULL, "-restart", options->restart, sizeof(options->restart), &options->has_restart));
  if (options->has_checkpoint && !options->dry_run) options->input.checkpoint = options->checkpoint;
  PetscFunctionReturn(0);
}

/* -uv: surfaces only, formats with texture coordinates. */
static PetscErrorCode CheckTexture(const char *command, const char *file)
{
  const EqmFormat *const format = EqmFormatOfSuffix(file);

  PetscFunctionBegin;
  if (!format || !format->writes_texture)
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-uv %s: texture coordinates are written to .obj or .ply", file);
  if (!strcmp(command, "ball") || !strcmp(command, "cube"))
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-uv %s: solids have no texture coordinates", file);
  PetscFunctionReturn(0);
}

/* -pieces each: surfaces; what belongs to one run cannot be had. */
static PetscErrorCode CheckPieces(const char *command, const MapOptions *options)
{
  char start[PETSC_MAX_PATH_LEN] = "";
  PetscBool has_corners;

  PetscFunctionBegin;
  if (options->pieces == 0) PetscFunctionReturn(0);
  PetscCall(PetscOptionsGetString(NULL, NULL, "-start", start, sizeof(start), NULL));
  PetscCall(PetscOptionsHasName(NULL, NULL, "-corners", &has_corners));
  const char *const other = options->has_checkpoint || options->has_restart ? "-checkpoint"
                            : options->has_history                          ? "-history"
                            : options->hessian_eigenvalues > 0              ? "-hessian_eigenvalues"
                            : EqmStartIsFile(start)                         ? "-start FILE"
                            : has_corners                                   ? "-corners"
                                                                            : NULL;

  if (!strcmp(command, "ball") || !strcmp(command, "cube"))
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-pieces each is for surfaces; of a solid take one piece: -piece K");
  if (other)
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-pieces each has no %s, as that is of one run; take one piece: -piece K",
            other);
  if (options->has_uv && !strcmp(command, "sphere"))
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE,
            "-uv with -pieces each is for disk and square: spheres cannot lie side by side");
  PetscFunctionReturn(0);
}

/* Check before the run what would fail after it. */
static PetscErrorCode CheckArguments(const EqmCommandLine *line, MapOptions *options)
{
  const char *const mesh = options->input.mesh;

  PetscFunctionBegin;
  if (line->num_arguments != 1 && !(line->num_arguments == 0 && options->has_restart)) {
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "%s wants one mesh file, %d given; usage: equimap %s MESH -o OUT.h5",
            line->command, line->num_arguments, line->command);
  }
  if (!options->has_output) EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "no output named; add -o OUT.h5");
  if (!(options->radius > 0.) || PetscIsInfOrNanReal(options->radius))
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-radius %.6g: give a positive number", (double)options->radius);
  if (options->hessian_eigenvalues < 0)
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-hessian_eigenvalues: give 0 or more");
  if (options->hessian == 1 && strcmp(line->command, "sphere"))
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-hessian appendix-b: the Hessian of 001 Appendix B is for the sphere");
  if (options->hessian_eigenvalues > 0 && !EqmHessianAvailable()) {
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE,
            "-hessian_eigenvalues needs SLEPc (Debian: slepc-dev); install it and build equimap again");
  }
  PetscCall(CheckPieces(line->command, options));
  PetscCall(EqmMapCheckWritable(PETSC_COMM_WORLD, options->output));
  PetscCall(EqmIntakeChoose(PETSC_COMM_WORLD, line->num_arguments ? line->argument[0] : NULL,
                            options->has_restart ? options->restart : NULL, &options->input));
  PetscCall(PetscSNPrintf(options->usage, sizeof(options->usage), "equimap %s %s", line->command, mesh));
  options->input.usage = options->usage;
  options->input.target = line->command;
  options->input.any_size = PETSC_TRUE;
  PetscCall(EqmCheckOutput(PETSC_COMM_WORLD, mesh, options->output));
  if (options->has_uv) PetscCall(CheckTexture(line->command, options->uv));
  if (options->has_uv) PetscCall(EqmCheckOutput(PETSC_COMM_WORLD, mesh, options->uv));
  if (options->has_summary) PetscCall(EqmCheckOutput(PETSC_COMM_WORLD, mesh, options->summary));
  if (options->has_history) PetscCall(EqmCheckOutput(PETSC_COMM_WORLD, mesh, options->history));
  if (options->has_histogram) PetscCall(EqmCheckOutput(PETSC_COMM_WORLD, mesh, options->histogram));
  if (options->has_ratios) PetscCall(EqmCheckOutput(PETSC_COMM_WORLD, mesh, options->ratios));
  if (!options->has_checkpoint) PetscFunctionReturn(0);
  PetscCall(EqmCheckOutput(PETSC_COMM_WORLD, mesh, options->checkpoint));
  PetscCall(EqmSweepOutput(PETSC_COMM_WORLD, options->output));
  if (options->has_uv) PetscCall(EqmSweepOutput(PETSC_COMM_WORLD, options->uv));
  if (options->has_summary) PetscCall(EqmSweepOutput(PETSC_COMM_WORLD, options->summary));
  if (options->has_history) PetscCall(EqmSweepOutput(PETSC_COMM_WORLD, options->history));
  if (options->has_histogram) PetscCall(EqmSweepOutput(PETSC_COMM_WORLD, options->histogram));
  if (options->has_ratios) PetscCall(EqmSweepOutput(PETSC_COMM_WORLD, options->ratios));
  PetscFunctionReturn(0);
}

/* `texture`: the map that -uv shows. */
static PetscErrorCode Write(const MapOptions *options, EqmLedger ledger, EqmMap map, EqmMap texture)
{
  EqmStatus status;
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(EqmMapGetStatus(map, &status, NULL));
  PetscCall(EqmMapSetCost(map, ledger));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_WRITE));
  if (status != EQM_STATUS_STOPPED) { /* there is the checkpoint */
    PetscCall(EqmMapSetImageScale(map, options->radius));
    PetscCall(EqmMapWrite(map, options->output));
    PetscCall(EqmMapGetSoup(map, &soup));
    PetscCall(EqmPrintDropped(soup, options->output, PETSC_TRUE));
  }
  if (options->has_uv && status != EQM_STATUS_STOPPED) PetscCall(EqmMapWriteTexture(texture, options->uv));
  if (options->has_history) PetscCall(EqmMapWriteHistory(map, options->history));
  if (options->has_histogram) PetscCall(EqmMapWriteHistogram(map, options->histogram));
  if (options->has_ratios) PetscCall(EqmMapWriteRatioHistogram(map, options->ratios));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_WRITE));
  PetscCall(EqmMapSetCost(map, ledger));
  if (options->has_summary) PetscCall(EqmMapWriteSummary(map, options->summary));
  PetscFunctionReturn(0);
}

/* From the mesh that is mapped to the map of the mesh that was given. */
static PetscErrorCode Solve(const EqmCommandLine *line, const MapOptions *options, EqmLedger ledger,
                            const EqmIntake *input, EqmStatus *status)
{
  EqmMapRun run;
  EqmIntake whole;

  PetscFunctionBegin;
  PetscCall(EqmMapRunSolve(line->command, input, &options->stop_file, ledger, &run));
  PetscCall(EqmMapRunWithoutSplits(line->command, &options->input, input, &options->stop_file, ledger, &run, &whole));
  PetscCall(
      EqmMapTakeEigenvalues(options->hessian_eigenvalues, hessians[options->hessian], ledger, run.solver, run.map));
  PetscCall(EqmMapAddPolygons(run.map));
  PetscCall(EqmMapRestoreUnit(run.map, input->unit));
  if (run.found != run.map) PetscCall(EqmMapRestoreUnit(run.found, input->unit));
  PetscCall(Write(options, ledger, run.map, run.map));
  PetscCall(EqmMapGetStatus(run.map, status, NULL));
  PetscCall(EqmMapPrintResult((PetscBool)(options->input.quiet || whole.mapped),
                              *status == EQM_STATUS_STOPPED ? options->checkpoint : options->output, run.map,
                              run.map == run.found ? NULL : run.found));
  PetscCall(EqmMapRunDestroy(&run));
  PetscCall(EqmPreparationReset(&whole.preparation));
  PetscFunctionReturn(0);
}

/* The same for every piece. */
static PetscErrorCode SolvePieces(const EqmCommandLine *line, const MapOptions *options, EqmLedger ledger,
                                  const EqmIntake *input, EqmStatus *status)
{
  EqmPieces pieces;
  EqmMap texture;
  PetscInt dim;

  PetscFunctionBegin;
  PetscCall(EqmPiecesSolve(line->command, &options->input, input, &options->stop_file, ledger, &pieces));
  PetscCall(EqmMapGetDimension(pieces.map, &dim));
  if (options->has_uv && dim != 2)
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-uv with -pieces each is for maps to the plane");
  texture = pieces.map;
  if (options->has_uv) PetscCall(EqmPiecesCharts(&pieces, &texture));
  PetscCall(EqmMapAddPolygons(pieces.map));
  PetscCall(EqmMapRestoreUnit(pieces.map, input->unit));
  PetscCall(Write(options, ledger, pieces.map, texture));
  PetscCall(EqmMapPrintResult(PETSC_TRUE, options->output, pieces.map, NULL));
  PetscCall(EqmMapGetStatus(pieces.map, status, NULL));
  if (texture != pieces.map) PetscCall(EqmMapDestroy(&texture));
  PetscCall(EqmPiecesDestroy(&pieces));
  PetscFunctionReturn(0);
}

/* Run a map command, `equimap disk` and its like. Collective on PETSC_COMM_WORLD. The status is the map's. Errors:
   EQM_ERR_USAGE, and those of EqmIntakeRead, EqmSolverSetFromOptions and EqmMapWrite. */
PetscErrorCode EqmCommandMap(const EqmCommandLine *line, EqmStatus *status)
{
  MapOptions options = {.radius = 1.};
  EqmLedger ledger;
  EqmIntake input;

  PetscFunctionBegin;
  PetscCall(ReadOptions(&options));
  /* reads every option: with --help to list them, without it to find the unknown ones */
  PetscCall(EqmSolverHelp(PETSC_COMM_WORLD, line->command));
  if (line->help) PetscFunctionReturn(0);
  PetscCall(EqmRejectUnknownOptions(line));
  PetscCall(CheckArguments(line, &options));
  PetscCall(EqmStopCatchSignals(PETSC_COMM_WORLD));
  if (options.has_checkpoint) PetscCall(EqmStopWatchFile(PETSC_COMM_WORLD, options.checkpoint, &options.stop_file));
  PetscCall(EqmLedgerCreate(PETSC_COMM_WORLD, &ledger));
  if (!options.input.quiet) PetscCall(EqmLedgerSetHook(ledger, EqmPhasePrint));
  if (options.pieces)
    PetscCall(EqmIntakeReadGiven(PETSC_COMM_WORLD, &options.input, ledger, &input));
  else
    PetscCall(EqmIntakeRead(PETSC_COMM_WORLD, &options.input, ledger, &input));
  if (options.dry_run) {
    PetscCall(PetscPrintf(PETSC_COMM_WORLD,
                          "%s, %" PetscInt_FMT " vertices, %" PetscInt_FMT " cells: equimap %s can begin\n",
                          options.input.mesh, input.mapped->num_vertices, input.mapped->num_cells, line->command));
  } else if (options.pieces) {
    PetscCall(SolvePieces(line, &options, ledger, &input, status));
  } else {
    PetscCall(Solve(line, &options, ledger, &input, status));
  }
  PetscCall(EqmIntakeDestroy(&input));
  PetscCall(EqmLedgerDestroy(&ledger));
  PetscFunctionReturn(0);
}
