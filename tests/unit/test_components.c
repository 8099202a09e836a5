/* Pieces of a mesh as meshes of their own: what is taken for one does not grow with the number of the others, nothing
   is lost, and numbers lead back to the whole. */
#include "support/testing.h"
#include "base/rows.h"
#include "prepare/components.h"

enum { SIDE = 4, SEAM = SIDE + 1, SHEET_VERTICES = 2 * SEAM * SEAM, SHEET_CELLS = 4 * SIDE * SIDE };

/* `num_sheets` sheets of different sizes, side by side, each of two halves with a seam between them: the vertices there
   are twice in the file. */
static PetscErrorCode MakeSheets(PetscInt num_sheets, EqmSoup *soup)
{
  EqmSerialMesh mesh = {.num_vertices = num_sheets * SHEET_VERTICES, .num_cells = num_sheets * SHEET_CELLS};
  PetscInt c = 0;

  PetscFunctionBegin;
  mesh.cell_size = 3;
  PetscCall(PetscMalloc1(3 * mesh.num_vertices, &mesh.vertices));
  PetscCall(PetscMalloc1(3 * mesh.num_cells, &mesh.cells));
  for (PetscInt v = 0; v < mesh.num_vertices; v++) {
    const PetscInt half = v / (SEAM * SEAM), i = v % (SEAM * SEAM) / SEAM, j = v % SEAM;

    mesh.vertices[3 * v] = (1. + .01 * (PetscReal)(half / 2)) * (PetscReal)(i + half % 2 * SIDE);
    mesh.vertices[3 * v + 1] = j;
    mesh.vertices[3 * v + 2] = 3. * (PetscReal)(half / 2);
    if (i == SIDE || j == SIDE) continue;
    const PetscInt corner[6] = {v, v + SEAM, v + SEAM + 1, v, v + SEAM + 1, v + 1};
    for (int k = 0; k < 6; k++) mesh.cells[3 * c + k] = corner[k];
    c += 2;
  }
  PetscCall(EqmSoupCreateFromRoot(PETSC_COMM_WORLD, &mesh, "sheets", soup));
  PetscCall(EqmSerialMeshReset(&mesh));
  PetscFunctionReturn(0);
}

/* Every vertex of a piece lies where the whole has it, and the one that stands for it at the same place. */
static PetscErrorCode CheckNumbers(const EqmComponents *components, PetscInt piece, EqmSoup given,
                                   const EqmPreparation *begun)
{
  const PetscInt num = given->num_vertices;
  PetscInt *name;
  PetscReal *here, *there, *in_whole;
  const EqmSoup whole = components->given;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(num, &name, 3 * num, &here, 3 * num, &there, 3 * num, &in_whole));
  for (PetscInt v = 0; v < num; v++) name[v] = v;
  PetscCall(EqmFetchRows(given->comm, given->vertex_end - given->vertex_start, num, name, MPIU_REAL, 3, given->vertices,
                         here));
  PetscCall(
      EqmFetchRows(given->comm, given->vertex_end - given->vertex_start, num, name, MPIU_INT, 1, begun->vertex, name));
  PetscCall(EqmFetchRows(given->comm, begun->soup->vertex_end - begun->soup->vertex_start, num, name, MPIU_REAL, 3,
                         begun->soup->vertices, there));
  for (PetscInt v = 0; v < num; v++) name[v] = v;
  PetscCall(EqmComponentsName(components, piece, num, name));
  PetscCall(EqmFetchRows(given->comm, whole->vertex_end - whole->vertex_start, num, name, MPIU_REAL, 3, whole->vertices,
                         in_whole));
  for (PetscInt k = 0; k < 3 * num; k++)
    CHECK(here[k] == in_whole[k] && here[k] == there[k], "vertex %d of piece %d", (int)(k / 3), (int)piece);
  name[0] = begun->soup->num_vertices + 2; /* as a later step numbers what it adds */
  PetscCall(EqmComponentsName(components, piece, 1, name));
  CHECK(name[0] == components->whole.soup->num_vertices + 2);
  PetscCall(PetscFree4(name, here, there, in_whole));
  PetscFunctionReturn(0);
}

/* The sizes are those of one sheet, however many there are. */
static PetscErrorCode TestSheets(PetscInt num_sheets)
{
  EqmPrepareOptions options;
  EqmComponents components;
  EqmSoup soup;

  PetscFunctionBegin;
  EqmPrepareOptionsInit(&options);
  PetscCall(PetscStrncpy(options.steps, "weld", sizeof(options.steps)));
  PetscCall(MakeSheets(num_sheets, &soup));
  PetscCall(EqmComponentsCreate(soup, &options, &components));
  CHECK(components.num_pieces == num_sheets, "%d pieces of %d", (int)components.num_pieces, (int)num_sheets);
  for (PetscInt p = 0; p < num_sheets; p++) {
    EqmPreparation begun;
    EqmDiagnosis diagnosis;
    EqmSoup given;

    PetscCall(EqmComponentsTake(&components, p, &given, &begun));
    CHECK(given->num_vertices == SHEET_VERTICES && begun.soup->num_vertices == SHEET_VERTICES, "%d and %d vertices",
          (int)given->num_vertices, (int)begun.soup->num_vertices);
    CHECK(given->num_cells == SHEET_CELLS && begun.soup->num_cells == SHEET_CELLS);
    for (PetscInt c = 0; c < begun.soup->cell_end - begun.soup->cell_start; c++)
      CHECK(begun.parent[c] == begun.soup->cell_start + c, "parent of cell %d", (int)c);
    PetscCall(EqmSoupDiagnose(begun.soup, &diagnosis));
    CHECK(diagnosis.topology == EQM_TOPOLOGY_DISK, "the seam is welded");
    CHECK_CLOSE(diagnosis.measure, 2. * SIDE * SIDE * (1. + .01 * (PetscReal)(num_sheets - 1 - p)), 1e-12, 100.);
    PetscCall(CheckNumbers(&components, p, given, &begun));
    PetscCall(EqmPreparationReset(&begun));
    PetscCall(EqmSoupDestroy(&given));
  }
  PetscCall(EqmComponentsReset(&components));
  PetscCall(EqmSoupDestroy(&soup));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestSheets(1));
  PetscCall(TestSheets(3));
  PetscCall(TestSheets(12));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
