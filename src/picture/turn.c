/* Surface and image of a result to turn in a browser: a script, and the numbers that it draws. */
#include "picture/turn.h"
#include "format/encoding.h"
#include "picture/thin.h"

enum { MOST_FACES = 120000 };

static const char script[] = {
#include "turn_js.inc"
};

void EqmWriteTurningScript(EqmAtomicFile *file)
{
  EqmAtomicPrint(file, "<script>\n");
  EqmAtomicWrite(file, script, sizeof(script));
  EqmAtomicPrint(file, "</script>\n");
}

static void WriteBytes(EqmAtomicFile *file, const char *name, const void *bytes, size_t count)
{
  EqmBase64Writer writer;

  EqmAtomicPrint(file, "%s: \"", name);
  EqmBase64Open(&writer, file);
  EqmBase64Write(&writer, bytes, count);
  EqmBase64Close(&writer);
  EqmAtomicPrint(file, "\",\n");
}

/* Numbers of the vertices that faces use, from 0; -1 for the others. */
static PetscInt NumberVertices(const EqmFaces *faces, PetscInt num_points, PetscInt *number)
{
  PetscInt count = 0;

  for (PetscInt v = 0; v < num_points; v++) number[v] = -1;
  for (PetscInt k = 0; k < 3 * faces->num_faces; k++)
    if (number[faces->vertices[k]] < 0) number[faces->vertices[k]] = count++;
  return count;
}

static PetscErrorCode WritePoints(EqmAtomicFile *file, const char *name, PetscInt num_points, const PetscInt *number,
                                  PetscInt count, const PetscReal *points)
{
  float *packed;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * count, &packed));
  for (PetscInt k = 0; k < 3 * num_points; k++)
    if (number[k / 3] >= 0) packed[3 * number[k / 3] + k % 3] = (float)points[k];
  WriteBytes(file, name, packed, sizeof(float) * 3 * (size_t)count);
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(0);
}

/* The corners of the faces, and a colour for each face: the one that it has in the still pictures. */
static PetscErrorCode WriteFaces(const EqmPage *page, const EqmResult *result, const EqmFaces *faces,
                                 const PetscInt *number, EqmAtomicFile *file)
{
  const PetscReal *const values = EqmPageValues(page, result);
  unsigned char *colours;
  uint32_t *corners;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * faces->num_faces, &colours, 3 * faces->num_faces, &corners));
  for (PetscInt f = 0; f < faces->num_faces; f++) {
    const PetscBool folded = (PetscBool) !(result->ratio[faces->cell[f]] > 0.);
    double rgb[3];
    EqmColorOf(folded ? (EqmColorScale){EQM_SCALE_RATIO, 2.0} : page->scale, folded ? -1. : values[faces->cell[f]],
               rgb);
    for (int k = 0; k < 3; k++) {
      colours[3 * f + k] = (unsigned char)(255.0 * rgb[k] + 0.5);
      corners[3 * f + k] = (uint32_t)number[faces->vertices[3 * f + k]];
    }
  }
  WriteBytes(file, "faces", corners, sizeof(uint32_t) * 3 * (size_t)faces->num_faces);
  WriteBytes(file, "colours", colours, 3 * (size_t)faces->num_faces);
  PetscCall(PetscFree2(colours, corners));
  PetscFunctionReturn(0);
}

static void WriteFrame(EqmAtomicFile *file, const char *name, const double axis[3])
{
  EqmAtomicPrint(file, "%s: [%.6f, %.6f, %.6f],\n", name, axis[0], axis[1], axis[2]);
}

PetscErrorCode EqmWriteTurning(const EqmPage *page, PetscInt k, EqmAtomicFile *file)
{
  const EqmResult *const result = &page->results[k];
  EqmFaces all, faces;
  EqmCamera camera;
  PetscInt *number, count;

  PetscFunctionBegin;
  PetscCall(EqmFacesOfSurface(result, &all));
  PetscCall(EqmThinFaces(&all, result->vertices, result->num_vertices, MOST_FACES, &faces));
  camera = EqmCameraChoose(&all, result->vertices, &page->options);
  PetscCall(PetscMalloc1(result->num_vertices, &number));
  count = NumberVertices(&faces, result->num_vertices, number);
  EqmAtomicPrint(file,
                 "<div id=\"turn%d\" class=\"turn\" hidden><canvas width=\"900\" height=\"900\"></canvas><canvas "
                 "width=\"900\" height=\"900\"></canvas><p>Drag to turn, wheel to zoom%s.</p></div>\n"
                 "<script>equimapTurn(document.getElementById(\"turn%d\"), {\n",
                 (int)k, faces.num_faces < all.num_faces ? "; the mesh is thinned out here" : "", (int)k);
  PetscCall(WritePoints(file, "surface", result->num_vertices, number, count, result->vertices));
  PetscCall(WritePoints(file, "image", result->num_vertices, number, count, result->images));
  PetscCall(WriteFaces(page, result, &faces, number, file));
  WriteFrame(file, "right", camera.right);
  WriteFrame(file, "up", camera.up);
  WriteFrame(file, "toward", camera.toward);
  EqmAtomicPrint(file, "flat: %s, yaw: 0, pitch: 0});</script>\n", result->dim == 2 ? "true" : "false");
  PetscCall(PetscFree(number));
  PetscCall(EqmFacesReset(&faces));
  PetscCall(EqmFacesReset(&all));
  PetscFunctionReturn(0);
}
