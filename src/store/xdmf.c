/* The XDMF files beside a result: XML that tells ParaView what the HDF5 file holds. The mesh and its image have a file
   each, so that neither hides the other. */
#include "store/map_private.h"
#include "mesh/soup_private.h"
#include "store/store.h"
#include "format/hdf5.h"
#include "format/xml.h"
#include "base/atomicfile.h"
#include <errno.h>
#include <libxml/xmlwriter.h>
#include <string.h>

typedef struct {
  xmlTextWriterPtr xml;
  const char *result; /* name of the result file, without its directory */
  PetscBool fine;     /* no call has failed so far */
} Writer;

static void Note(Writer *writer, int outcome)
{
  if (outcome < 0) writer->fine = PETSC_FALSE;
}

static void Open(Writer *writer, const char *element)
{
  Note(writer, xmlTextWriterStartElement(writer->xml, BAD_CAST element));
}

static void Close(Writer *writer)
{
  Note(writer, xmlTextWriterEndElement(writer->xml));
}

static void Attribute(Writer *writer, const char *name, const char *value)
{
  Note(writer, xmlTextWriterWriteAttribute(writer->xml, BAD_CAST name, BAD_CAST value));
}

/* An array of the result file, rows × width, 8 bytes a number. */
static void Array(Writer *writer, const char *path, const char *type, PetscInt rows, PetscInt width)
{
  char text[64];

  Open(writer, "DataItem");
  (void)snprintf(text, sizeof(text), "%" PetscInt_FMT " %" PetscInt_FMT, rows, width);
  if (width == 1) (void)snprintf(text, sizeof(text), "%" PetscInt_FMT, rows);
  Attribute(writer, "Dimensions", text);
  Attribute(writer, "NumberType", type);
  Attribute(writer, "Precision", "8");
  Attribute(writer, "Format", "HDF");
  Note(writer, xmlTextWriterWriteString(writer->xml, BAD_CAST writer->result));
  Note(writer, xmlTextWriterWriteString(writer->xml, BAD_CAST ":"));
  Note(writer, xmlTextWriterWriteString(writer->xml, BAD_CAST path));
  Close(writer);
}

static void Field(Writer *writer, const char *name, const char *center, const char *path, PetscInt rows, PetscInt width)
{
  Open(writer, "Attribute");
  Attribute(writer, "Name", name);
  Attribute(writer, "AttributeType", width == 1 ? "Scalar" : width == 3 ? "Vector" : "Matrix");
  Attribute(writer, "Center", center);
  Array(writer, path, "Float", rows, width);
  Close(writer);
}

/* What the input has per vertex and cell beside its mesh. */
static void InputFields(Writer *writer, EqmSoup soup)
{
  char path[EQM_FIELD_NAME + 16];

  for (PetscInt f = 0; f < soup->num_fields; f++) {
    const EqmMeshField *const field = &soup->fields[f];
    if (!EqmSoupHasFieldHdf5(soup, field, path, sizeof(path))) continue;
    Field(writer, field->name, field->on_cells ? "Cell" : "Node", path,
          field->on_cells ? soup->num_cells : soup->num_vertices, field->width);
  }
}

/* The cells with their fields, at the points of one array; the grid is left open. */
static void Grid(Writer *writer, const char *name, EqmSoup soup, const char *points, PetscInt dim)
{
  char text[32];

  Open(writer, "Grid");
  Attribute(writer, "Name", name);
  Attribute(writer, "GridType", "Uniform");
  Open(writer, "Topology");
  Attribute(writer, "TopologyType", soup->cell_size == 3 ? "Triangle" : "Tetrahedron");
  (void)snprintf(text, sizeof(text), "%" PetscInt_FMT, soup->num_cells);
  Attribute(writer, "NumberOfElements", text);
  Array(writer, "/mesh/cells", "Int", soup->num_cells, soup->cell_size);
  Close(writer);
  Open(writer, "Geometry");
  Attribute(writer, "GeometryType", dim == 3 ? "XYZ" : "XY");
  Array(writer, points, "Float", soup->num_vertices, dim);
  Close(writer);
  Field(writer, "ratio", "Cell", "/cell/ratio", soup->num_cells, 1);
  Field(writer, "vertex_ratio", "Node", "/vertex/ratio", soup->num_vertices, 1);
  if (soup->cell_size == 3) {
    Field(writer, "quasi_conformal", "Cell", "/cell/quasi_conformal", soup->num_cells, 1);
    Field(writer, "conformal_factor", "Node", "/vertex/conformal_factor", soup->num_vertices, 1);
  }
  if (soup->density) Field(writer, "density", "Cell", "/cell/density", soup->num_cells, 1);
  InputFields(writer, soup);
}

/* The grids of a document. */
typedef void (*Body)(Writer *writer, EqmMap map, PetscInt num_frames);

/* The mesh; every vertex has its image as a field. */
static void Mesh(Writer *writer, EqmMap map, PetscInt num_frames)
{
  (void)num_frames;
  Grid(writer, "mesh", map->soup, "/mesh/vertices", 3);
  Field(writer, "map", "Node", "/map/coordinates", map->soup->num_vertices, map->dim);
  Close(writer);
}

/* The image; every vertex has its position on the mesh as a field. */
static void Image(Writer *writer, EqmMap map, PetscInt num_frames)
{
  (void)num_frames;
  Grid(writer, "map", map->soup, "/map/coordinates", map->dim);
  Field(writer, "mesh", "Node", "/mesh/vertices", map->soup->num_vertices, 3);
  Close(writer);
}

/* A time series: the same cells at the points of one frame after the other. */
static void Frames(Writer *writer, EqmMap map, PetscInt num_frames)
{
  char text[64];

  Open(writer, "Grid");
  Attribute(writer, "Name", "morph");
  Attribute(writer, "GridType", "Collection");
  Attribute(writer, "CollectionType", "Temporal");
  for (PetscInt f = 0; f < num_frames; f++) {
    (void)snprintf(text, sizeof(text), EQM_FRAME_PATH, f);
    Grid(writer, "frame", map->soup, text, 3);
    Open(writer, "Time");
    (void)snprintf(text, sizeof(text), "%.17g", (double)f / (double)(num_frames - 1));
    Attribute(writer, "Value", text);
    Close(writer);
    Close(writer);
  }
  Close(writer);
}

static PetscBool Compose(EqmMap map, const char *result, Body body, PetscInt num_frames, xmlBufferPtr buffer)
{
  const xmlOutputBufferPtr out = xmlOutputBufferCreateBuffer(buffer, NULL);
  Writer writer = {out ? xmlNewTextWriter(out) : NULL, result, PETSC_TRUE};

  if (!writer.xml) return PETSC_FALSE;
  Note(&writer, xmlTextWriterSetIndent(writer.xml, 1));
  Note(&writer, xmlTextWriterStartDocument(writer.xml, "1.0", "UTF-8", NULL));
  Open(&writer, "Xdmf");
  Attribute(&writer, "Version", "3.0");
  Open(&writer, "Domain");
  body(&writer, map, num_frames);
  Note(&writer, EqmXmlEndDocument(writer.xml, out));
  xmlFreeTextWriter(writer.xml);
  return writer.fine;
}

typedef struct {
  EqmMap map;
  const char *result; /* without its folder */
  Body body;
  PetscInt num_frames;
} Contents;

static void Print(EqmAtomicFile *file, void *context)
{
  const Contents *const c = context;
  xmlBufferPtr buffer;

  EqmXmlQuiet();
  buffer = xmlBufferCreate();
  if (buffer && Compose(c->map, c->result, c->body, c->num_frames, buffer))
    EqmAtomicWrite(file, xmlBufferContent(buffer), (size_t)xmlBufferLength(buffer));
  else
    file->error_number = ENOMEM;
  if (buffer) xmlBufferFree(buffer);
}

static PetscErrorCode Write(EqmMap map, const char *result_file, const char *suffix, Body body, PetscInt num_frames)
{
  const char *const slash = strrchr(result_file, '/');
  Contents contents = {map, slash ? slash + 1 : result_file, body, num_frames};
  char name[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(EqmNameBeside(result_file, suffix, name, sizeof(name)));
  PetscCall(EqmAtomicPrintFile(map->soup->comm, name, Print, &contents));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapWriteXdmf(EqmMap map, const char *result_file)
{
  PetscFunctionBegin;
  PetscCall(Write(map, result_file, ".xmf", Mesh, 0));
  PetscCall(Write(map, result_file, ".map.xmf", Image, 0));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapWriteMorph(EqmMap map, const char *result_file, PetscInt num_frames)
{
  PetscFunctionBegin;
  PetscCall(Write(map, result_file, ".morph.xmf", Frames, num_frames));
  PetscFunctionReturn(0);
}
