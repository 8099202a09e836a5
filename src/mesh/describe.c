/* What a diagnosis means for a command, in words: what is wrong, where, how often, what to do. */
#include "mesh/target.h"

/* Who minds a finding. */
typedef enum { MINDED_BY_ALL, MINDED_BY_NONE, MINDED_BY_DISK, MINDED_BY_SPHERE } Minded;

/* How the numbers in `where` are shown. */
typedef enum { SHOW_NOTHING, SHOW_ONE, SHOW_EDGE, SHOW_TWINS, SHOW_LOOP } Show;

typedef struct {
  EqmFindingKind kind;
  PetscInt cell_size; /* 0: for triangles and tetrahedra alike */
  Minded minded;
  Show show;
  const char *one, *many; /* "{n}" the count, "{cell}" and "{cells}" what the mesh is made of */
  const char *advice;
} Phrase;

static const Phrase phrases[] = {
    {EQM_FINDING_NOT_FINITE, 0, MINDED_BY_ALL, SHOW_ONE, "1 vertex has a coordinate that is infinite or not a number",
     "{n} vertices have coordinates that are infinite or not numbers",
     "mend them in the file, or write it again from its source"},
    {EQM_FINDING_BAD_INDEX, 0, MINDED_BY_ALL, SHOW_ONE, "1 {cell} names a vertex that does not exist",
     "{n} {cells} name vertices that do not exist", "the file is damaged or cut short; write it again from its source"},
    {EQM_FINDING_DEGENERATE_CELL, 0, MINDED_BY_ALL, SHOW_ONE,
     "1 {cell} is flat: it repeats a vertex or has no {measure}",
     "{n} {cells} are flat: they repeat a vertex or have no {measure}",
     "-repair removes those that repeat a vertex, -prepare auto mends most of the others"},
    {EQM_FINDING_DUPLICATE_CELL, 0, MINDED_BY_ALL, SHOW_TWINS, "1 {cell} has the same vertices as another",
     "{n} {cells} have the same vertices as another", "-repair removes them"},
    {EQM_FINDING_NON_MANIFOLD_EDGE, 3, MINDED_BY_ALL, SHOW_EDGE, "1 edge belongs to more than two triangles",
     "{n} edges belong to more than two triangles",
     "the surface is not a manifold there; remove the extra triangles or split the vertices"},
    {EQM_FINDING_NON_MANIFOLD_EDGE, 4, MINDED_BY_ALL, SHOW_EDGE, "1 face belongs to more than two tetrahedra",
     "{n} faces belong to more than two tetrahedra", "the solid overlaps itself there; remove the extra tetrahedra"},
    {EQM_FINDING_NON_MANIFOLD_VERTEX, 3, MINDED_BY_ALL, SHOW_ONE,
     "1 vertex joins parts of the surface that have no edge in common there",
     "{n} vertices join parts of the surface that have no edge in common there",
     "the surface is not a manifold there; give each part a vertex of its own"},
    {EQM_FINDING_NON_MANIFOLD_VERTEX, 4, MINDED_BY_ALL, SHOW_ONE,
     "1 vertex joins parts of the solid that have no face in common there",
     "{n} vertices join parts of the solid that have no face in common there",
     "the solid is pinched there; thicken it, or give each part vertices of its own"},
    {EQM_FINDING_NOT_ORIENTABLE, 0, MINDED_BY_ALL, SHOW_ONE,
     "the surface is not orientable: a way around it comes back mirrored",
     "{n} pieces of the surface are not orientable: a way around them comes back mirrored",
     "no map preserves area on such a surface; cut the band open"},
    {EQM_FINDING_INCONSISTENT_ORIENTATION, 3, MINDED_BY_ALL, SHOW_EDGE,
     "1 edge has two triangles that do not turn the same way round",
     "{n} edges have two triangles that do not turn the same way round", "-repair turns triangles until all agree"},
    {EQM_FINDING_INCONSISTENT_ORIENTATION, 4, MINDED_BY_ALL, SHOW_ONE, "1 tetrahedron is inside out, unlike most",
     "{n} tetrahedra are inside out, unlike most", "-repair turns them"},
    {EQM_FINDING_OVERLAP, 4, MINDED_BY_ALL, SHOW_EDGE, "1 face has both its tetrahedra on the same side",
     "{n} faces have both their tetrahedra on the same side",
     "the solid folds over itself there; mesh it anew, or move the vertex that went through a face back"},
    {EQM_FINDING_COMPONENTS, 0, MINDED_BY_ALL, SHOW_ONE, "",
     "the mesh falls into {n} pieces, with one vertex of each named",
     "-prepare auto keeps the largest, -pieces each maps all; if they should hang together, -prepare weld joins "
     "vertices at "
     "the same place"},
    {EQM_FINDING_HOLES, 3, MINDED_BY_DISK, SHOW_ONE,
     "there is 1 hole beside the outer boundary, with one vertex of each boundary loop named",
     "there are {n} holes beside the outer boundary, with one vertex of each boundary loop named",
     "-prepare auto fills them; a disk has one boundary loop"},
    {EQM_FINDING_HOLES, 4, MINDED_BY_ALL, SHOW_ONE,
     "there is 1 cavity inside, with one vertex of each boundary surface named",
     "there are {n} cavities inside, with one vertex of each boundary surface named",
     "-prepare auto fills round ones; fill others with tetrahedra"},
    {EQM_FINDING_GENUS, 3, MINDED_BY_ALL, SHOW_LOOP, "the surface has 1 handle, like a cup",
     "the surface has {n} handles", "cut or fill the handles; tiny ones are often errors of a scan"},
    {EQM_FINDING_GENUS, 4, MINDED_BY_ALL, SHOW_NOTHING, "the solid has 1 tunnel through it",
     "the solid has {n} tunnels", "fill the tunnels or cut the solid open; a ball has none"},
    {EQM_FINDING_CLOSED, 0, MINDED_BY_DISK, SHOW_NOTHING, "the surface is closed: it has no boundary", "",
     "cut it open, or map it with `sphere`"},
    {EQM_FINDING_OPEN, 0, MINDED_BY_SPHERE, SHOW_NOTHING, "the surface is open: it has a boundary loop",
     "the surface is open: it has {n} boundary loops",
     "close the holes, or map a surface with one loop with `disk` or `square`"},
    {EQM_FINDING_DUPLICATE_VERTEX, 0, MINDED_BY_NONE, SHOW_TWINS, "1 vertex lies exactly where another one lies",
     "{n} vertices lie exactly where another one lies", "if the mesh is torn apart there, -prepare weld joins them"},
    {EQM_FINDING_UNREFERENCED, 0, MINDED_BY_NONE, SHOW_ONE, "1 vertex belongs to no usable {cell}",
     "{n} vertices belong to no usable {cell}", "harmless: they keep their number and take no part in the map"},
    {EQM_FINDING_NO_INTERIOR_VERTEX, 0, MINDED_BY_NONE, SHOW_ONE, "1 {cell} has all its vertices on the boundary",
     "{n} {cells} have all their vertices on the boundary",
     "their {measure} in the image depends on boundary vertices alone and may not be kept; -repair splits them"},
    {EQM_FINDING_CHORD, 0, MINDED_BY_NONE, SHOW_EDGE, "1 interior edge joins two boundary vertices",
     "{n} interior edges join two boundary vertices", "such edges can fold the map; -repair splits them"},
};

/* The topologies that a target takes; without one, those that any target takes. */
static PetscErrorCode TargetTakes(const char *name, PetscBool takes[EQM_NUM_TOPOLOGIES])
{
  const EqmTarget *const target = name ? EqmTargetFind(name) : NULL;

  PetscFunctionBegin;
  PetscCheck(target || !name, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE, "There is no target '%s'", name);
  for (int t = 0; t < EQM_NUM_TOPOLOGIES; t++) {
    takes[t] = (PetscBool)(target ? target->domain[t] != NULL : EqmTargetOfTopology((EqmTopology)t) != NULL);
  }
  PetscFunctionReturn(0);
}

/* Append `phrase` with its placeholders filled in. */
static PetscErrorCode AppendPhrase(const EqmDiagnosis *diagnosis, const char *phrase, PetscInt64 count, char *text,
                                   size_t length)
{
  const PetscBool solid = (PetscBool)(diagnosis->cell_size == 4);
  char number[32];
  const char *const placeholder[4] = {"{n}", "{cells}", "{cell}", "{measure}"};
  const char *const word[4] = {number, solid ? "tetrahedra" : "triangles", solid ? "tetrahedron" : "triangle",
                               solid ? "volume" : "area"};
  char letter[2] = "";

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(number, sizeof(number), "%" PetscInt64_FMT, count));
  while (*phrase) {
    PetscBool filled = PETSC_FALSE;

    for (int k = 0; k < 4 && !filled; k++) {
      size_t width;

      PetscCall(PetscStrlen(placeholder[k], &width));
      PetscCall(PetscStrncmp(phrase, placeholder[k], width, &filled));
      if (!filled) continue;
      PetscCall(PetscStrlcat(text, word[k], length));
      phrase += width;
    }
    if (filled) continue;
    letter[0] = *phrase++;
    PetscCall(PetscStrlcat(text, letter, length));
  }
  PetscFunctionReturn(0);
}

/* Append " (first: 12-57, 57-90)". */
static PetscErrorCode AppendWhere(const EqmFinding *finding, Show show, char *text, size_t length)
{
  PetscFunctionBegin;
  const PetscBool is_loop = (PetscBool)(show == SHOW_LOOP);

  if (show == SHOW_NOTHING || !finding->shown) PetscFunctionReturn(0);
  PetscCall(PetscStrlcat(text,
                         is_loop                           ? " (around or through one: "
                         : finding->count > finding->shown ? " (first: "
                                                           : " (",
                         length));
  for (PetscInt i = 0; i < finding->shown; i++) {
    if (i) PetscCall(PetscStrlcat(text, is_loop ? "-" : ", ", length));
    for (int k = 0; k < 4 && finding->where[i][k] >= 0; k++) {
      const char *const between = show == SHOW_TWINS ? " like " : "-";
      char number[48];

      PetscCall(PetscSNPrintf(number, sizeof(number), "%s%" PetscInt_FMT, k ? between : "", finding->where[i][k]));
      PetscCall(PetscStrlcat(text, number, length));
    }
  }
  if (is_loop && finding->where[EQM_FINDING_SHOWN - 1][3] >= 0) PetscCall(PetscStrlcat(text, "-...", length));
  PetscCall(PetscStrlcat(text, ")", length));
  PetscFunctionReturn(0);
}

static PetscErrorCode AppendLine(const char *head, const char *line, char *text, size_t length)
{
  PetscFunctionBegin;
  if (text[0]) PetscCall(PetscStrlcat(text, "\n", length));
  PetscCall(PetscStrlcat(text, head, length));
  PetscCall(PetscStrlcat(text, line, length));
  PetscFunctionReturn(0);
}

static PetscBool IsMinded(const Phrase *phrase, const char *target, const PetscBool takes[])
{
  switch (phrase->minded) {
  case MINDED_BY_ALL:
    return PETSC_TRUE;
  case MINDED_BY_DISK:
    return (PetscBool)(takes[EQM_TOPOLOGY_DISK] && (phrase->kind != EQM_FINDING_CLOSED || !takes[EQM_TOPOLOGY_SPHERE]));
  case MINDED_BY_SPHERE:
    return (PetscBool)(target && takes[EQM_TOPOLOGY_SPHERE] && !takes[EQM_TOPOLOGY_DISK]);
  default:
    return PETSC_FALSE;
  }
}

/* Lines of the findings that are minded, or of those that are only worth a warning. */
static PetscErrorCode AppendFindings(const EqmDiagnosis *diagnosis, const char *target, const PetscBool takes[],
                                     PetscBool minded, PetscInt *count, char *text, size_t length)
{
  PetscFunctionBegin;
  for (size_t p = 0; p < PETSC_STATIC_ARRAY_LENGTH(phrases); p++) {
    const Phrase *const phrase = &phrases[p];
    const EqmFinding *const finding = &diagnosis->finding[phrase->kind];

    if (!finding->count || (phrase->cell_size && phrase->cell_size != diagnosis->cell_size)) continue;
    if (minded != IsMinded(phrase, target, takes)) continue;
    if (!minded && phrase->minded != MINDED_BY_NONE) continue;
    /* on a surface without two sides, edges that disagree are no fault that could be mended */
    if (phrase->kind == EQM_FINDING_INCONSISTENT_ORIENTATION && diagnosis->finding[EQM_FINDING_NOT_ORIENTABLE].count) {
      continue;
    }
    PetscCall(AppendLine(minded ? "error: " : "warning: ", "", text, length));
    PetscCall(AppendPhrase(diagnosis, finding->count == 1 ? phrase->one : phrase->many, finding->count, text, length));
    PetscCall(AppendWhere(finding, phrase->show, text, length));
    PetscCall(PetscStrlcat(text, ": ", length));
    PetscCall(AppendPhrase(diagnosis, phrase->advice, finding->count, text, length));
    ++*count;
  }
  PetscFunctionReturn(0);
}

/* Triangles where tetrahedra are wanted, or the other way round. */
static PetscErrorCode AppendWrongCells(const EqmDiagnosis *diagnosis, const PetscBool takes[], PetscInt *count,
                                       char *text, size_t length)
{
  const PetscBool wants_solid = (PetscBool)(takes[EQM_TOPOLOGY_BALL] && !takes[EQM_TOPOLOGY_DISK]);
  const PetscBool wants_surface = (PetscBool)!takes[EQM_TOPOLOGY_BALL];
  const char *line = NULL;

  PetscFunctionBegin;
  if (diagnosis->cell_size == 3 && wants_solid) {
    line =
        "the mesh is a surface of triangles, a solid of tetrahedra is wanted: fill it (convert -fill), or take a mesh "
        "generator such as Gmsh, or map it as a surface";
  }
  if (diagnosis->cell_size == 4 && wants_surface) {
    line =
        "the mesh is a solid of tetrahedra, a surface of triangles is wanted: map it with `ball`, or take its surface "
        "with `convert -boundary`";
  }
  if (!line) PetscFunctionReturn(0);
  PetscCall(AppendLine("error: ", line, text, length));
  ++*count;
  PetscFunctionReturn(0);
}

/* A mesh that does not fit although no single finding says why. */
static PetscErrorCode AppendMisfit(const EqmDiagnosis *diagnosis, const PetscBool takes[], PetscInt *count, char *text,
                                   size_t length)
{
  PetscFunctionBegin;
  if (takes[diagnosis->topology] || *count) PetscFunctionReturn(0);
  PetscCall(AppendLine("error: ",
                       diagnosis->num_faces ? "the mesh is neither a disk, a sphere nor a ball: look at it in a viewer"
                                            : "no usable cell is left: look at the file",
                       text, length));
  ++*count;
  PetscFunctionReturn(0);
}

static PetscErrorCode AppendGoodNews(const EqmDiagnosis *diagnosis, const char *target, char *text, size_t length)
{
  char line[256];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(line, sizeof(line), "%s of %" PetscInt64_FMT " vertices and %" PetscInt64_FMT " %s%s%s",
                          EqmTopologyDescription(diagnosis->topology), diagnosis->num_vertices, diagnosis->num_cells,
                          diagnosis->cell_size == 4 ? "tetrahedra" : "triangles", target ? ", ready for " : "",
                          target ? target : ""));
  PetscCall(AppendLine("good: ", line, text, length));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDiagnosisDescribe(const EqmDiagnosis *diagnosis, const char *target, PetscBool *fatal, char *text,
                                    size_t length)
{
  PetscBool takes[EQM_NUM_TOPOLOGIES];
  PetscInt num_fatal = 0, num_warnings = 0;

  PetscFunctionBegin;
  PetscCall(TargetTakes(target, takes));
  text[0] = '\0';
  PetscCall(AppendWrongCells(diagnosis, takes, &num_fatal, text, length));
  PetscCall(AppendFindings(diagnosis, target, takes, PETSC_TRUE, &num_fatal, text, length));
  PetscCall(AppendMisfit(diagnosis, takes, &num_fatal, text, length));
  *fatal = (PetscBool)(num_fatal > 0);
  if (!*fatal) PetscCall(AppendGoodNews(diagnosis, target, text, length));
  PetscCall(AppendFindings(diagnosis, target, takes, PETSC_FALSE, &num_warnings, text, length));
  PetscFunctionReturn(0);
}
