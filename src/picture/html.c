/* One self-contained page: the picture, the numbers, where it came from, the history. */
#ifdef EQM_HAVE_CAIRO
#include "picture/html.h"
#include "picture/figures.h"
#include "picture/surface.h"
#include "picture/turn.h"
#include "format/encoding.h"
#include <stddef.h>
#include <string.h>

static cairo_status_t Encode(void *closure, const unsigned char *bytes, unsigned int length)
{
  EqmBase64Writer *const writer = (EqmBase64Writer *)closure;

  EqmBase64Write(writer, bytes, length);
  return writer->file->error_number ? CAIRO_STATUS_WRITE_ERROR : CAIRO_STATUS_SUCCESS;
}

/* Text from outside is shown as it is, whatever characters it has. */
static void PrintText(EqmAtomicFile *file, const char *text)
{
  for (const char *c = text; *c; c++) {
    switch (*c) {
    case '<':
      EqmAtomicPrint(file, "&lt;");
      break;
    case '>':
      EqmAtomicPrint(file, "&gt;");
      break;
    case '&':
      EqmAtomicPrint(file, "&amp;");
      break;
    case '"':
      EqmAtomicPrint(file, "&quot;");
      break;
    default:
      EqmAtomicWrite(file, c, 1);
    }
  }
}

static void PrintCell(EqmAtomicFile *file, const char *tag, const char *value)
{
  EqmAtomicPrint(file, "<%s>", tag);
  PrintText(file, value);
  EqmAtomicPrint(file, "</%s>", tag);
}

static const char *BaseName(const char *path)
{
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

static void PrintHead(EqmAtomicFile *file, const EqmPage *page)
{
  EqmAtomicPrint(file, "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
                       "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>");
  for (PetscInt k = 0; k < page->num; k++) {
    if (k) EqmAtomicPrint(file, ", ");
    PrintText(file, BaseName(page->results[k].mesh_file));
  }
  EqmAtomicPrint(
      file, "</title>\n<style>\n%s</style></head><body>\n",
      "body{font:15px/1.5 system-ui,sans-serif;color:#212428;max-width:1600px;margin:1rem auto;padding:0 1rem}\n"
      "img{width:100%;height:auto}\ntable{border-collapse:collapse;margin:1rem 0}\n"
      "th{text-align:left;font-weight:400;color:#6b7078;padding:.2rem 1.5rem .2rem 0;vertical-align:top}\n"
      "td{padding:.2rem 1.5rem .2rem 0;font-variant-numeric:tabular-nums;overflow-wrap:anywhere}\n"
      "tr{border-bottom:1px solid #e2e4e6}\n"
      ".turn canvas{width:49%;touch-action:none;cursor:grab}\n.turn p{color:#6b7078}\n");
}

/* The result's number, where there are several. */
static void PrintNumbering(EqmAtomicFile *file, const EqmPage *page)
{
  if (page->num == 1) return;
  EqmAtomicPrint(file, "<tr><th></th>");
  for (PetscInt k = 0; k < page->num; k++) EqmAtomicPrint(file, "<td><b>%d</b></td>", (int)k + 1);
  EqmAtomicPrint(file, "</tr>\n");
}

static void PrintFigures(EqmAtomicFile *file, const EqmPage *page)
{
  EqmAtomicPrint(file, "<h2>Figures</h2>\n<table>\n");
  PrintNumbering(file, page);
  for (int f = 0; f < EqmNumFigures(); f++) {
    EqmAtomicPrint(file, "<tr>");
    PrintCell(file, "th", EqmFigureName(page->results, f));
    for (PetscInt k = 0; k < page->num; k++) {
      char text[EQM_FIGURE_TEXT_LENGTH];
      EqmFigureText(&page->results[k], f, text, sizeof(text));
      PrintCell(file, "td", text[0] ? text : "–");
    }
    EqmAtomicPrint(file, "</tr>\n");
  }
  EqmAtomicPrint(file, "</table>\n");
}

static void PrintProvenance(EqmAtomicFile *file, const EqmPage *page)
{
  static const struct {
    const char *name;
    size_t offset;
  } rows[] = {{"result", offsetof(EqmResult, file)},
              {"mesh", offsetof(EqmResult, mesh_file)},
              {"registered with", offsetof(EqmResult, other_file)},
              {"command", offsetof(EqmResult, command)},
              {"method", offsetof(EqmResult, method)},
              {"status", offsetof(EqmResult, status)},
              {"message", offsetof(EqmResult, message)},
              {"options", offsetof(EqmResult, options)},
              {"equimap", offsetof(EqmResult, version)},
              {"commit", offsetof(EqmResult, commit)},
              {"date", offsetof(EqmResult, date)}};

  EqmAtomicPrint(file, "<h2>Where it came from</h2>\n<table>\n");
  PrintNumbering(file, page);
  for (size_t r = 0; r < sizeof(rows) / sizeof(rows[0]); r++) {
    PetscBool any = PETSC_FALSE;
    for (PetscInt k = 0; k < page->num; k++)
      any = (PetscBool)(any || *((const char *)&page->results[k] + rows[r].offset));
    if (!any) continue;
    EqmAtomicPrint(file, "<tr>");
    PrintCell(file, "th", rows[r].name);
    for (PetscInt k = 0; k < page->num; k++) PrintCell(file, "td", (const char *)&page->results[k] + rows[r].offset);
    EqmAtomicPrint(file, "</tr>\n");
  }
  EqmAtomicPrint(file, "</table>\n");
}

static void PrintHistory(EqmAtomicFile *file, const EqmResult *result)
{
  if (result->num_history == 0) return;
  EqmAtomicPrint(file, "<details><summary>History of ");
  PrintText(file, BaseName(result->file));
  EqmAtomicPrint(file, "</summary>\n<table>\n<tr><td>iteration</td><td>energy</td><td>seconds</td></tr>\n");
  for (PetscInt k = 0; k < result->num_history; k++)
    EqmAtomicPrint(file, "<tr><td>%.0f</td><td>%.7g</td><td>%.3f</td></tr>\n", result->iteration[k], result->energy[k],
                   result->elapsed[k]);
  EqmAtomicPrint(file, "</table></details>\n");
}

PetscErrorCode EqmWriteHtml(const EqmPage *page, int width, EqmAtomicFile *file, cairo_status_t *status)
{
  EqmBase64Writer writer;

  PetscFunctionBegin;
  PrintHead(file, page);
  EqmAtomicPrint(file, "<img alt=\"the surface, its image and the convergence\" src=\"data:image/png;base64,");
  EqmBase64Open(&writer, file);
  PetscCall(EqmPageToPng(page, width, Encode, &writer, status));
  EqmBase64Close(&writer);
  EqmAtomicPrint(file, "\">\n");
  EqmWriteTurningScript(file);
  for (PetscInt k = 0; k < page->num; k++) PetscCall(EqmWriteTurning(page, k, file));
  PrintFigures(file, page);
  PrintProvenance(file, page);
  for (PetscInt k = 0; k < page->num; k++) PrintHistory(file, &page->results[k]);
  EqmAtomicPrint(file, "</body></html>\n");
  PetscFunctionReturn(0);
}
#endif
