#define _GNU_SOURCE
#include "xml.h"

#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <libxml/parser.h>

static void Ignore(void *context, const char *format, ...)
{
  (void)context;
  (void)format;
}

/* EqmXmlQuiet - libxml2 prints nothing by itself, whatever fails: its callers have their own sentences. Not collective.
 */
void EqmXmlQuiet(void)
{
  xmlSetGenericErrorFunc(NULL, Ignore);
}

/* EqmXmlEndDocument - close all elements and write what has been gathered; -1 where that fails. libxml2 keeps it a
   secret when it has no memory to encode it, but its buffer has no contents from then on. Not collective. */
int EqmXmlEndDocument(xmlTextWriterPtr xml, xmlOutputBufferPtr out)
{
  const int outcome = xmlTextWriterEndDocument(xml);

  return out->conv && !xmlBufContent(out->conv) ? -1 : outcome;
}

/* Entities are a way to make a small file use all memory; no mesh needs them. The parser itself reports their
   declarations, whatever encoding the file has. A document type without declarations, as GIFTI files have it, is fine.
 */
static void RefuseEntity(void *data, const xmlChar *name, int type, const xmlChar *public_id, const xmlChar *system_id,
                         xmlChar *content)
{
  xmlParserCtxtPtr context = data;

  *(PetscBool *)context->_private = PETSC_TRUE;
  xmlStopParser(context);
}

static PetscErrorCode RejectDocument(EqmInput *in, xmlParserCtxtPtr context)
{
  const xmlError *error = context ? xmlCtxtGetLastError(context) : NULL;
  const char *message = error && error->message ? error->message : "not an XML document\n";

  snprintf(in->error, in->error_length, "line %d: damaged or truncated XML: %.*s", error ? error->line : 1,
           (int)strcspn(message, "\n"), message);
  return EQM_ERR_IO;
}

/* EqmXmlParse - make a tree of `text`. Not collective. The caller frees it with xmlFreeDoc. Errors: EQM_ERR_IO (quiet).
 */
PetscErrorCode EqmXmlParse(EqmInput *in, const char *text, size_t length, xmlDocPtr *document)
{
  const size_t large = 10000000; /* from here on libxml2 needs the option for long texts */
  int options = XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING | XML_PARSE_NOCDATA | XML_PARSE_BIG_LINES;
  xmlParserCtxtPtr context;
  PetscBool has_entities = PETSC_FALSE;
  PetscErrorCode code = 0;

  EqmXmlQuiet();
  *document = NULL;
  if (length > INT_MAX)
    return EqmReject(in, EQM_ERR_IO, "more than 2 GB of XML: save with appended raw data, or as HDF5");
  if (length >= large) options |= XML_PARSE_HUGE;
  context = xmlNewParserCtxt();
  if (context) {
    context->_private = &has_entities;
    context->sax->entityDecl = RefuseEntity;
    *document = xmlCtxtReadMemory(context, text, (int)length, NULL, NULL, options);
  }
  if (has_entities) {
    if (*document) xmlFreeDoc(*document);
    *document = NULL;
    code = EqmReject(in, EQM_ERR_IO, "XML entities are not supported");
  } else if (!*document) {
    code = RejectDocument(in, context);
  }
  if (context) xmlFreeParserCtxt(context);
  return code;
}

/* EqmXmlIs - is the element called so? Not collective. */
PetscBool EqmXmlIs(xmlNodePtr node, const char *name)
{
  return node && node->type == XML_ELEMENT_NODE && !strcmp((const char *)node->name, name) ? PETSC_TRUE : PETSC_FALSE;
}

static xmlNodePtr FirstOf(xmlNodePtr node, const char *name)
{
  while (node && !EqmXmlIs(node, name)) node = node->next;
  return node;
}

/* EqmXmlChild - the first child element of this name, or NULL. Not collective. */
xmlNodePtr EqmXmlChild(xmlNodePtr parent, const char *name)
{
  return FirstOf(parent ? parent->children : NULL, name);
}

/* EqmXmlNext - the next sibling element of this name, or NULL. Not collective. */
xmlNodePtr EqmXmlNext(xmlNodePtr node, const char *name)
{
  return FirstOf(node->next, name);
}

/* EqmXmlAttribute - copy an attribute's value, cut to `length`; "" if there is none. Not collective. */
void EqmXmlAttribute(xmlNodePtr node, const char *name, char *value, size_t length)
{
  xmlChar *text = xmlGetProp(node, (const xmlChar *)name);

  snprintf(value, length, "%s", text ? (const char *)text : "");
  if (text) xmlFree(text);
}

/* EqmXmlInteger - an attribute that is a whole number. Not collective. Returns PETSC_FALSE if it is not. */
PetscBool EqmXmlInteger(xmlNodePtr node, const char *name, PetscInt64 *value)
{
  char text[32], *begin = text;
  const char *next;

  EqmXmlAttribute(node, name, text, sizeof(text));
  while (EqmIsSpace(*begin)) ++begin;
  next = EqmParseInteger(begin, begin + strlen(begin), value);
  while (next && EqmIsSpace(*next)) ++next;
  return next && !*next ? PETSC_TRUE : PETSC_FALSE;
}

/* EqmXmlReject - say what is wrong in an element. Not collective. Returns EQM_ERR_IO, quietly. */
PetscErrorCode EqmXmlReject(EqmInput *in, xmlNodePtr node, const char *format, ...)
{
  char name[64];
  va_list arguments;
  int used;

  EqmXmlAttribute(node, "Name", name, sizeof(name));
  used = snprintf(in->error, in->error_length, "line %ld, %s%s%s: ", xmlGetLineNo(node), (const char *)node->name,
                  name[0] ? " " : "", name);
  if (used < 0 || (size_t)used >= in->error_length) return EQM_ERR_IO;
  va_start(arguments, format);
  vsnprintf(in->error + used, in->error_length - (size_t)used, format, arguments);
  va_end(arguments);
  return EQM_ERR_IO;
}

/* EqmXmlGetText - the text of an element, without copying it where it is one piece. Not collective. EqmXmlTextReset
   must follow before the tree is freed. */
void EqmXmlGetText(xmlNodePtr node, EqmXmlText *text)
{
  xmlNodePtr child = node->children;

  text->owned = child && !child->next && child->type == XML_TEXT_NODE ? NULL : xmlNodeGetContent(node);
  text->text = text->owned ? (const char *)text->owned : child && child->content ? (const char *)child->content : "";
  text->length = strlen(text->text);
}

/* EqmXmlTextReset - free what EqmXmlGetText had to copy. Not collective. */
void EqmXmlTextReset(EqmXmlText *text)
{
  if (text->owned) xmlFree(text->owned);
  *text = (EqmXmlText){NULL, 0, NULL};
}

/* EqmXmlParseNumbers - `count` numbers separated by white space, into `reals` or else into `integers`. Not collective.
   Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmXmlParseNumbers(EqmInput *in, xmlNodePtr node, const EqmXmlText *text, PetscInt64 count,
                                  PetscReal *reals, PetscInt64 *integers)
{
  EqmInput numbers;

  EqmInputOpen(&numbers, text->text, text->length, in->error, in->error_length);
  for (PetscInt64 i = 0; i < count; ++i) {
    EqmSkipSpace(&numbers, 0);
    if (!(reals ? EqmReadReal(&numbers, &reals[i]) : EqmReadInteger(&numbers, &integers[i]))) {
      return EqmXmlReject(in, node, "number %lld of %lld is missing or not a number", (long long)i, (long long)count);
    }
  }
  return 0;
}
