/* The first grid of an XDMF file: topology, geometry, attributes. Versions 2 and 3 differ in the names of attributes.
 */
#include "xdmf_plan.h"
#include "xml.h"

#include <stdio.h>
#include <string.h>

/* Rows and width of an array: its first dimension and the product of the others. */
static PetscErrorCode ParseDimensions(EqmInput *in, xmlNodePtr node, EqmXdmfArray *array)
{
  char text[128];
  EqmInput numbers;
  PetscInt64 n;

  EqmXmlAttribute(node, "Dimensions", text, sizeof(text));
  EqmInputOpen(&numbers, text, strlen(text), in->error, in->error_length);
  array->rows = -1;
  array->width = 1;
  for (EqmSkipSpace(&numbers, 0); EqmRemaining(&numbers); EqmSkipSpace(&numbers, 0)) {
    if (!EqmReadInteger(&numbers, &n) || n < 0 || n > PETSC_MAX_INT)
      return EqmXmlReject(in, node, "its Dimensions=\"%s\" are none", text);
    if (array->rows < 0)
      array->rows = n;
    else
      array->width *= n;
    if (array->width > PETSC_MAX_INT) return EqmXmlReject(in, node, "its Dimensions=\"%s\" are too many", text);
  }
  if (array->rows < 0 || array->width < 1) return EqmXmlReject(in, node, "it has no Dimensions");
  return 0;
}

/* "file.h5:/path". */
static PetscErrorCode TakeReference(EqmInput *in, xmlNodePtr node, const EqmXmlText *text, EqmXdmfArray *array)
{
  size_t begin = 0, end = text->length, colon;

  while (begin < end && EqmIsSpace(text->text[begin])) ++begin;
  while (begin < end && EqmIsSpace(text->text[end - 1])) --end;
  for (colon = end; colon > begin && text->text[colon - 1] != ':'; --colon) continue;
  if (colon <= begin + 1 || colon == end || end - begin >= EQM_XDMF_PATH)
    return EqmXmlReject(in, node, "an array of an HDF5 file is named FILE.h5:/PATH");
  snprintf(array->file, sizeof(array->file), "%.*s", (int)(colon - 1 - begin), text->text + begin);
  snprintf(array->path, sizeof(array->path), "%.*s", (int)(end - colon), text->text + colon);
  return 0;
}

/* The numbers of the text; every number takes a byte at least. */
static PetscErrorCode TakeNumbers(EqmInput *in, xmlNodePtr node, const EqmXmlText *text, EqmXdmfArray *array)
{
  const PetscInt64 count = array->rows * array->width;

  if (count > (PetscInt64)text->length)
    return EqmXmlReject(in, node, "its text is too short for the %lld numbers of its Dimensions", (long long)count);
  EqmTry(PetscMalloc1(count + 1, &array->values));
  return EqmXmlParseNumbers(in, node, text, count, array->values, NULL);
}

/* The DataItem of an element. */
static PetscErrorCode ParseArray(EqmInput *in, xmlNodePtr parent, EqmXdmfArray *array)
{
  const xmlNodePtr node = EqmXmlChild(parent, "DataItem");
  char format[32];
  EqmXmlText text;
  PetscErrorCode code;

  if (!node) return EqmXmlReject(in, parent, "it has no DataItem");
  EqmTry(ParseDimensions(in, node, array));
  EqmXmlAttribute(node, "Format", format, sizeof(format));
  EqmXmlGetText(node, &text);
  if (!strcmp(format, "HDF"))
    code = TakeReference(in, node, &text, array);
  else if (!format[0] || !strcmp(format, "XML"))
    code = TakeNumbers(in, node, &text, array);
  else
    code = EqmXmlReject(in, node, "Format=\"%s\" is not read; XML and HDF are", format);
  EqmXmlTextReset(&text);
  return code;
}

/* An array of `width` numbers a row, which may be announced as one long row of numbers. */
static PetscErrorCode Shape(EqmInput *in, xmlNodePtr node, PetscInt64 width, EqmXdmfArray *array)
{
  if (array->width == width) return 0;
  if (array->width != 1 || array->rows % width)
    return EqmXmlReject(in, node, "%lld numbers a row where %lld are wanted", (long long)array->width,
                        (long long)width);
  array->rows /= width;
  array->width = width;
  return 0;
}

/* An attribute by its name of version 2 or of version 3. */
static void GetType(xmlNodePtr node, const char *name, char *type, size_t length)
{
  EqmXmlAttribute(node, name, type, length);
  if (!type[0]) EqmXmlAttribute(node, "Type", type, length);
}

static PetscErrorCode ParseMesh(EqmInput *in, xmlNodePtr grid, EqmXdmfPlan *plan)
{
  const xmlNodePtr topology = EqmXmlChild(grid, "Topology"), geometry = EqmXmlChild(grid, "Geometry");
  char type[64];

  if (!topology || !geometry) return EqmXmlReject(in, grid, "a mesh has Topology and Geometry");
  GetType(topology, "TopologyType", type, sizeof(type));
  plan->cell_size = !strcmp(type, "Triangle") ? 3 : !strcmp(type, "Tetrahedron") ? 4 : 0;
  if (!plan->cell_size) {
    (void)EqmXmlReject(in, topology, "cells are \"%s\": only Triangle and Tetrahedron can be mapped", type);
    return EQM_ERR_MESH;
  }
  EqmTry(ParseArray(in, topology, &plan->cells));
  EqmTry(Shape(in, topology, plan->cell_size, &plan->cells));
  GetType(geometry, "GeometryType", type, sizeof(type));
  if (type[0] && strcmp(type, "XYZ") && strcmp(type, "XY"))
    return EqmXmlReject(in, geometry, "points are \"%s\": XYZ and XY are read", type);
  EqmTry(ParseArray(in, geometry, &plan->points));
  return Shape(in, geometry, strcmp(type, "XY") ? 3 : 2, &plan->points);
}

/* Fields with a row per vertex or cell; what cannot be read is left out. */
static PetscErrorCode ParseFields(EqmInput *in, xmlNodePtr grid, EqmXdmfPlan *plan)
{
  for (xmlNodePtr node = EqmXmlChild(grid, "Attribute"); node; node = EqmXmlNext(node, "Attribute")) {
    const PetscInt f = plan->num_fields;
    char center[32];
    PetscBool known = PETSC_FALSE;

    if (f == EQM_XDMF_MOST_FIELDS) break;
    EqmXdmfArray *const array = &plan->field[f];
    EqmXmlAttribute(node, "Name", plan->name[f], sizeof(plan->name[f]));
    EqmXmlAttribute(node, "Center", center, sizeof(center));
    plan->on_cells[f] = strcmp(center, "Cell") ? PETSC_FALSE : PETSC_TRUE;
    for (PetscInt k = 0; k < f; ++k)
      known = known || (plan->on_cells[k] == plan->on_cells[f] && !strcmp(plan->name[k], plan->name[f])) ? PETSC_TRUE
                                                                                                         : PETSC_FALSE;
    if (known || !plan->name[f][0] || (!plan->on_cells[f] && center[0] && strcmp(center, "Node"))) continue;
    if (!ParseArray(in, node, array) && array->width <= 64 &&
        array->rows == (plan->on_cells[f] ? plan->cells.rows : plan->points.rows)) {
      ++plan->num_fields;
      continue;
    }
    EqmTry(PetscFree(array->values));
    *array = (EqmXdmfArray){0};
  }
  return 0;
}

/* The first grid that is no collection of others. */
static xmlNodePtr FindGrid(xmlNodePtr parent)
{
  for (xmlNodePtr grid = EqmXmlChild(parent, "Grid"); grid; grid = EqmXmlNext(grid, "Grid")) {
    const xmlNodePtr inner = FindGrid(grid);

    return inner ? inner : grid;
  }
  return NULL;
}

PetscErrorCode EqmXdmfParse(const char *bytes, size_t length, EqmXdmfPlan *plan, char *error, size_t error_length)
{
  EqmInput in;
  xmlDocPtr document;
  PetscErrorCode code;

  memset(plan, 0, sizeof(*plan));
  EqmInputOpen(&in, bytes, length, error, error_length);
  code = EqmXmlParse(&in, bytes, length, &document);
  const xmlNodePtr root = document ? xmlDocGetRootElement(document) : NULL;
  const xmlNodePtr grid = root ? FindGrid(EqmXmlChild(root, "Domain")) : NULL;

  if (!code && !grid) code = EqmReject(&in, EQM_ERR_IO, "an XDMF file has a Domain with a Grid");
  if (!code) code = ParseMesh(&in, grid, plan);
  if (!code) code = ParseFields(&in, grid, plan);
  if (document) xmlFreeDoc(document);
  return code;
}

PetscErrorCode EqmXdmfReset(EqmXdmfPlan *plan)
{
  EqmTry(PetscFree(plan->points.values));
  EqmTry(PetscFree(plan->cells.values));
  for (PetscInt f = 0; f < plan->num_fields; ++f) EqmTry(PetscFree(plan->field[f].values));
  return 0;
}
