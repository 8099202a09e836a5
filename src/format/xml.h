/* XML documents of mesh formats, read by libxml2 without network and without entities. */
#ifndef EQM_FORMAT_XML_H
#define EQM_FORMAT_XML_H

#include <libxml/tree.h>
#include <libxml/xmlwriter.h>
#include "input.h"
#include "scalar.h"

/* Text of an element. */
typedef struct {
  const char *text;
  size_t length;
  xmlChar *owned; /* to be freed, or NULL */
} EqmXmlText;

PETSC_INTERN void EqmXmlQuiet(void);
PETSC_INTERN int EqmXmlEndDocument(xmlTextWriterPtr xml, xmlOutputBufferPtr out);
PETSC_INTERN PetscErrorCode EqmXmlParse(EqmInput *in, const char *text, size_t length, xmlDocPtr *document);
PETSC_INTERN xmlNodePtr EqmXmlChild(xmlNodePtr parent, const char *name);
PETSC_INTERN xmlNodePtr EqmXmlNext(xmlNodePtr node, const char *name);
PETSC_INTERN PetscBool EqmXmlIs(xmlNodePtr node, const char *name);
PETSC_INTERN void EqmXmlAttribute(xmlNodePtr node, const char *name, char *value, size_t length);
PETSC_INTERN PetscBool EqmXmlInteger(xmlNodePtr node, const char *name, PetscInt64 *value);
PETSC_INTERN PetscErrorCode EqmXmlReject(EqmInput *in, xmlNodePtr node, const char *format, ...)
    PETSC_ATTRIBUTE_FORMAT(3, 4);
PETSC_INTERN void EqmXmlGetText(xmlNodePtr node, EqmXmlText *text);
PETSC_INTERN void EqmXmlTextReset(EqmXmlText *text);
PETSC_INTERN PetscErrorCode EqmXmlParseNumbers(EqmInput *in, xmlNodePtr node, const EqmXmlText *text, PetscInt64 count,
                                               PetscReal *reals, PetscInt64 *integers);

#endif
