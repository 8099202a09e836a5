/* equimap check MESH: what the mesh is, its defects, and each command's verdict. */
#include "app.h"
#include "mesh/soup_private.h"
#include "base/atomicfile.h"
#include "intake/intake.h"
#include "mesh/handles.h"
#include "mesh/target.h"
#include "check_prepare.h"

enum { MAX_TARGETS = 16 };
static const char *const finding_names[EQM_NUM_FINDINGS] = {"not_finite",
                                                            "bad_index",
                                                            "unreferenced_vertex",
                                                            "duplicate_vertex",
                                                            "degenerate_cell",
                                                            "duplicate_cell",
                                                            "non_manifold_edge",
                                                            "non_manifold_vertex",
                                                            "inconsistent_orientation",
                                                            "not_orientable",
                                                            "overlap",
                                                            "components",
                                                            "holes",
                                                            "genus",
                                                            "closed",
                                                            "open",
                                                            "wrong_cells",
                                                            "no_interior_vertex",
                                                            "chord"};

typedef struct {
  PetscBool repair;
  char out[PETSC_MAX_PATH_LEN], summary[PETSC_MAX_PATH_LEN];
} CheckOptions;

typedef struct {
  EqmDiagnosis diagnosis;
  const EqmTarget *targets;
  PetscInt num_targets;
  PetscBool repaired, takes[MAX_TARGETS];
  EqmRepair repair;
  const char *file;
  EqmStatus status;
  cJSON *prepared; /* what -prepare auto would do, or NULL */
} CheckReport;

static PetscErrorCode ReadOptions(CheckOptions *options)
{
  PetscFunctionBegin;
  PetscCall(PetscMemzero(options, sizeof(*options)));
  PetscOptionsBegin(PETSC_COMM_WORLD, NULL, "Diagnosis of a mesh (check)", "check");
  PetscCall(
      PetscOptionsBool("-repair",
                       "mend what is safe to mend (twins, repeated vertices, orientation, cells without an interior "
                       "vertex) and check the result",
                       "check", options->repair, &options->repair, NULL));
  PetscCall(PetscOptionsString("-o", "with -repair: where to write the mended mesh", "check", options->out,
                               options->out, sizeof(options->out), NULL));
  PetscCall(PetscOptionsString("-summary", "write the report to this file as JSON", "check", options->summary,
                               options->summary, sizeof(options->summary), NULL));
  PetscOptionsEnd();
  PetscFunctionReturn(0);
}

static PetscErrorCode PrintCounts(const CheckReport *report)
{
  const EqmDiagnosis *const d = &report->diagnosis;
  const PetscBool solid = (PetscBool)(d->cell_size == 4);
  MPI_Comm comm = PETSC_COMM_WORLD;

  PetscFunctionBegin;
  PetscCall(PetscPrintf(comm, "%s\n", report->file));
  PetscCall(PetscPrintf(comm, "  vertices          %" PetscInt64_FMT " (%" PetscInt64_FMT " on the boundary)\n",
                        d->num_vertices, d->num_boundary_vertices));
  PetscCall(PetscPrintf(comm, "  edges             %" PetscInt64_FMT " (%" PetscInt64_FMT " on the boundary)\n",
                        d->num_edges, d->num_boundary_edges));
  if (solid) PetscCall(PetscPrintf(comm, "  faces             %" PetscInt64_FMT "\n", d->num_faces));
  PetscCall(PetscPrintf(comm, "  %-16s  %" PetscInt64_FMT "\n", solid ? "tetrahedra" : "triangles", d->num_cells));
  PetscCall(PetscPrintf(comm,
                        "  pieces            %" PetscInt64_FMT ", %s %" PetscInt64_FMT
                        ", Euler characteristic %" PetscInt64_FMT,
                        d->num_components, solid ? "boundary surfaces" : "boundary loops", d->num_boundary_loops,
                        d->euler_characteristic));
  if (d->genus >= 0) PetscCall(PetscPrintf(comm, ", genus %" PetscInt64_FMT, d->genus));
  PetscCall(PetscPrintf(comm, "\n  %-16s  %.6g (cells from %.3g to %.3g)\n", solid ? "volume" : "area",
                        (double)d->measure, (double)d->smallest_cell, (double)d->largest_cell));
  PetscCall(PetscPrintf(comm, "  worst quality     %.3g (0 flat, 1 equilateral)\n", (double)d->worst_cell_quality));
  PetscFunctionReturn(0);
}

/* Print the lines of a text behind `indent`, or only the first one. */
static PetscErrorCode PrintLines(const char *indent, const char *text, PetscBool first_only)
{
  PetscFunctionBegin;
  for (const char *line = text; line && *line;) {
    const char *const end = strchr(line, '\n');
    const int width = (int)(end ? end - line : (ptrdiff_t)strlen(line));

    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s%.*s\n", indent, width, line));
    line = end && !first_only ? end + 1 : NULL;
  }
  PetscFunctionReturn(0);
}

/* Print the verdict for every target: that the mesh can be mapped, or the first reason against it. */
static PetscErrorCode PrintVerdicts(CheckReport *report)
{
  char text[EQM_MESSAGE_MAX], head[32];
  PetscBool fatal;

  PetscFunctionBegin;
  report->status = EQM_STATUS_MESH;
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "findings\n"));
  PetscCall(EqmDiagnosisDescribe(&report->diagnosis, NULL, &fatal, text, sizeof(text)));
  PetscCall(PrintLines("  ", text, PETSC_FALSE));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "commands\n"));
  EqmTargetsGet(&report->targets, &report->num_targets);
  PetscCheck(report->num_targets <= MAX_TARGETS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "make MAX_TARGETS larger");
  for (PetscInt t = 0; t < report->num_targets; t++) {
    PetscCall(EqmDiagnosisDescribe(&report->diagnosis, report->targets[t].name, &fatal, text, sizeof(text)));
    report->takes[t] = (PetscBool)!fatal;
    if (!fatal) report->status = EQM_STATUS_CONVERGED;
    PetscCall(PetscSNPrintf(head, sizeof(head), "  %-10s%s", report->targets[t].name, fatal ? "no   " : "yes  "));
    PetscCall(PrintLines(head, strchr(text, ' ') + 1, PETSC_TRUE)); /* "error: " and "good: " are yes and no already */
  }
  PetscFunctionReturn(0);
}

static void AddFindings(const EqmDiagnosis *d, cJSON *parent)
{
  cJSON *const findings = cJSON_AddObjectToObject(parent, "findings");

  for (int k = 0; k < EQM_NUM_FINDINGS; k++) {
    const EqmFinding *const finding = &d->finding[k];
    cJSON *entry, *where;

    if (!finding->count) continue;
    entry = cJSON_AddObjectToObject(findings, finding_names[k]);
    cJSON_AddNumberToObject(entry, "count", (double)finding->count);
    where = cJSON_AddArrayToObject(entry, "where");
    for (PetscInt i = 0; i < finding->shown; i++) {
      cJSON *const place = cJSON_CreateArray();

      for (int c = 0; c < 4 && finding->where[i][c] >= 0; c++) {
        cJSON_AddItemToArray(place, cJSON_CreateNumber((double)finding->where[i][c]));
      }
      cJSON_AddItemToArray(where, place);
    }
  }
}

static void AddMesh(const CheckReport *report, cJSON *parent)
{
  const EqmDiagnosis *const d = &report->diagnosis;
  cJSON *const mesh = cJSON_AddObjectToObject(parent, "mesh");

  cJSON_AddStringToObject(mesh, "file", report->file);
  cJSON_AddNumberToObject(mesh, "vertices", (double)d->num_vertices);
  cJSON_AddNumberToObject(mesh, "edges", (double)d->num_edges);
  cJSON_AddNumberToObject(mesh, "faces", (double)d->num_faces);
  cJSON_AddNumberToObject(mesh, "cells", (double)d->num_cells);
  cJSON_AddNumberToObject(mesh, "cell_size", (double)d->cell_size);
  cJSON_AddNumberToObject(mesh, "boundary_vertices", (double)d->num_boundary_vertices);
  cJSON_AddNumberToObject(mesh, "boundary_edges", (double)d->num_boundary_edges);
  cJSON_AddNumberToObject(mesh, "components", (double)d->num_components);
  cJSON_AddNumberToObject(mesh, "boundary_loops", (double)d->num_boundary_loops);
  cJSON_AddNumberToObject(mesh, "euler_characteristic", (double)d->euler_characteristic);
  cJSON_AddNumberToObject(mesh, "genus", (double)d->genus);
  cJSON_AddStringToObject(mesh, "topology", EqmTopologyName(d->topology));
  cJSON_AddNumberToObject(mesh, "measure", d->measure);
  cJSON_AddNumberToObject(mesh, "smallest_cell", d->smallest_cell);
  cJSON_AddNumberToObject(mesh, "largest_cell", d->largest_cell);
  cJSON_AddNumberToObject(mesh, "worst_cell_quality", d->worst_cell_quality);
}

static char *MakeSummary(const CheckReport *report, const char *message)
{
  cJSON *const root = cJSON_CreateObject();
  cJSON *group;
  char *text;

  cJSON_AddStringToObject(root, "equimap", EqmVersion());
  cJSON_AddStringToObject(root, "command", "check");
  cJSON_AddStringToObject(root, "status", EqmStatusName(report->status));
  cJSON_AddNumberToObject(root, "exit_code", report->status);
  cJSON_AddStringToObject(root, "message", message);
  AddMesh(report, root);
  AddFindings(&report->diagnosis, root);
  group = cJSON_AddObjectToObject(root, "commands");
  for (PetscInt t = 0; t < report->num_targets; t++) {
    cJSON_AddBoolToObject(group, report->targets[t].name, report->takes[t]);
  }
  if (report->repaired) {
    group = cJSON_AddObjectToObject(root, "repair");
    cJSON_AddNumberToObject(group, "duplicate_cells_removed", (double)report->repair.duplicate_cells_removed);
    cJSON_AddNumberToObject(group, "degenerate_cells_removed", (double)report->repair.degenerate_cells_removed);
    cJSON_AddNumberToObject(group, "cells_flipped", (double)report->repair.cells_flipped);
    cJSON_AddNumberToObject(group, "cells_split", (double)report->repair.cells_split);
    cJSON_AddNumberToObject(group, "vertices_added", (double)report->repair.vertices_added);
    cJSON_AddNumberToObject(group, "vertices_unreferenced", (double)report->repair.vertices_unreferenced);
  }
  if (report->prepared) cJSON_AddItemReferenceToObject(root, "preparation", report->prepared);
  text = cJSON_Print(root);
  cJSON_Delete(root);
  return text;
}

static PetscErrorCode WriteSummary(const CheckReport *report, const char *file)
{
  char message[EQM_MESSAGE_MAX], *text;
  PetscBool fatal;

  PetscFunctionBegin;
  PetscCall(EqmDiagnosisDescribe(&report->diagnosis, NULL, &fatal, message, sizeof(message)));
  text = MakeSummary(report, message);
  PetscCall(EqmAtomicPrintFile(PETSC_COMM_WORLD, file, EqmAtomicPrintLine, text));
  cJSON_free(text);
  PetscFunctionReturn(0);
}

/* Areas or volumes of the file, of a mesh that was brought into range. */
static void TakeUnit(int exponent, EqmDiagnosis *d)
{
  d->measure = ldexp(d->measure, exponent);
  d->smallest_cell = ldexp(d->smallest_cell, exponent);
  d->largest_cell = ldexp(d->largest_cell, exponent);
}

static PetscErrorCode PrintUsage(void)
{
  PetscFunctionBegin;
  PetscCall(PetscPrintf(
      PETSC_COMM_WORLD,
      "\nusage: equimap check MESH [-repair [-o MENDED]] [-summary FILE.json]\n"
      "Tells what the mesh is, what is wrong with it (vertices and cells by their number in the file, from 0) and\n"
      "what each command would say. Ends with 0 if one of them can map it, with 3 if none can.\n"));
  PetscFunctionReturn(0);
}

/* Run `equimap check`. Collective on PETSC_COMM_WORLD. The status is EQM_STATUS_CONVERGED if a command can map the
   mesh, else EQM_STATUS_MESH. Errors: EQM_ERR_USAGE, and those of EqmSoupRead, EqmSoupRepair and EqmSoupWrite. */
PetscErrorCode EqmCommandCheck(const EqmCommandLine *line, EqmStatus *status)
{
  CheckOptions options;
  CheckReport report = {0};
  EqmSoup soup;
  PetscInt unit;

  PetscFunctionBegin;
  PetscCall(ReadOptions(&options));
  *status = EQM_STATUS_CONVERGED;
  if (line->help) {
    PetscCall(PrintUsage());
    PetscFunctionReturn(0);
  }
  PetscCall(EqmRejectUnknownOptions(line));
  if (line->num_arguments != 1) {
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "check takes one mesh file, %d given", line->num_arguments);
  }
  if (options.out[0] && !options.repair) {
    EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-o is for the mended mesh: give -repair too, or use equimap convert");
  }
  report.file = line->argument[0];
  PetscCall(EqmSoupRead(PETSC_COMM_WORLD, report.file, &soup));
  PetscCall(EqmSoupBringIntoRange(soup, &unit));
  if (options.repair) {
    PetscInt *parent;

    PetscCall(EqmSoupRepair(&soup, &report.repair, &parent));
    PetscCall(PetscFree(parent));
    report.repaired = PETSC_TRUE;
  }
  PetscCall(EqmSoupDiagnose(soup, &report.diagnosis));
  TakeUnit((int)(unit * (soup->cell_size - 1)), &report.diagnosis);
  PetscCall(EqmDiagnosisPlaceHandle(soup, &report.diagnosis));
  PetscCall(PrintCounts(&report));
  if (soup->note[0]) PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  note              %s\n", soup->note));
  if (report.repaired) PetscCall(EqmPrintRepair(PETSC_COMM_WORLD, NULL, &report.repair));
  PetscCall(PrintVerdicts(&report));
  if (!options.repair) PetscCall(EqmCheckPreparation(soup, report.num_targets, report.takes, &report.prepared));
  if (options.summary[0]) PetscCall(WriteSummary(&report, options.summary));
  PetscCall(EqmSoupShift(soup, unit));
  if (options.out[0]) PetscCall(EqmSoupWrite(soup, options.out));
  PetscCall(EqmSoupDestroy(&soup));
  cJSON_Delete(report.prepared);
  *status = report.status;
  PetscFunctionReturn(0);
}
