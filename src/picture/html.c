/* One self-contained page: the picture, the numbers, where it came from, the history. */
#ifdef EQM_HAVE_CAIRO
#include "html.h"
#include "picture/surface.h"
#include <math.h>

/* Bytes to base64, three at a time; what is left over waits for the next piece. */
typedef struct {
  EqmAtomicFile *file;
  unsigned char waiting[3];
  int count;
} Encoder;

static void Flush(Encoder *encoder)
{
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const unsigned char *w = encoder->waiting;
  char text[4] = {digits[w[0] >> 2], digits[(w[0] & 3) << 4 | w[1] >> 4], digits[(w[1] & 15) << 2 | w[2] >> 6],
                  digits[w[2] & 63]};

  for (int k = encoder->count + 1; k < 4; k++) text[k] = '=';
  if (encoder->count > 0) EqmAtomicWrite(encoder->file, text, 4);
  encoder->waiting[0] = encoder->waiting[1] = encoder->waiting[2] = 0;
  encoder->count = 0;
}

static cairo_status_t Encode(void *closure, const unsigned char *bytes, unsigned int length)
{
  Encoder *encoder = (Encoder *)closure;

  for (unsigned int k = 0; k < length; k++) {
    encoder->waiting[encoder->count++] = bytes[k];
    if (encoder->count == 3) Flush(encoder);
  }
  return encoder->file->error_number ? CAIRO_STATUS_WRITE_ERROR : CAIRO_STATUS_SUCCESS;
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

static void PrintTextRow(EqmAtomicFile *file, const char *name, const char *value)
{
  EqmAtomicPrint(file, "<tr><th>%s</th><td>", name);
  PrintText(file, value);
  EqmAtomicPrint(file, "</td></tr>\n");
}

static void PrintNumberRow(EqmAtomicFile *file, const char *name, PetscReal value)
{
  EqmAtomicPrint(file, "<tr><th>%s</th><td>", name);
  if (isfinite(value))
    EqmAtomicPrintReals(file, 1, &value, ' ');
  else
    EqmAtomicPrint(file, "–");
  EqmAtomicPrint(file, "</td></tr>\n");
}

static void PrintHead(EqmAtomicFile *file, const EqmResult *result)
{
  EqmAtomicPrint(file, "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
                       "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>");
  PrintText(file, result->mesh_file);
  EqmAtomicPrint(
      file, "</title>\n<style>\n"
            "body{font:15px/1.5 system-ui,sans-serif;color:#212428;max-width:1600px;margin:1rem auto;padding:0 1rem}\n"
            "img{width:100%%;height:auto}\ntable{border-collapse:collapse;margin:1rem 0}\n"
            "th{text-align:left;font-weight:400;color:#6b7078;padding:.2rem 1.5rem .2rem 0;vertical-align:top}\n"
            "td{padding:.2rem 0;font-variant-numeric:tabular-nums;overflow-wrap:anywhere}\ntr{border-bottom:1px solid "
            "#e2e4e6}\n"
            "details td{padding-right:1.5rem}\n</style></head><body>\n");
}

static void PrintNumbers(EqmAtomicFile *file, const EqmResult *result)
{
  const EqmStatistics *ratio = &result->ratio_statistics;

  EqmAtomicPrint(file, "<h2>Numbers</h2>\n<table>\n");
  PrintNumberRow(file, "vertices", (PetscReal)result->num_vertices);
  PrintNumberRow(file, result->cell_size == 3 ? "triangles" : "tetrahedra", (PetscReal)result->num_cells);
  PrintNumberRow(file, "energy at the start", result->energy_initial);
  PrintNumberRow(file, "energy at the end", result->energy_final);
  PrintNumberRow(file, "ratio, mean", ratio->mean);
  PrintNumberRow(file, "ratio, standard deviation", ratio->sd);
  PrintNumberRow(file, "ratio, smallest", ratio->min);
  PrintNumberRow(file, "ratio, 25 %% of cells below", ratio->p25);
  PrintNumberRow(file, "ratio, 50 %% of cells below", ratio->p50);
  PrintNumberRow(file, "ratio, 75 %% of cells below", ratio->p75);
  PrintNumberRow(file, "ratio, 95 %% of cells below", ratio->p95);
  PrintNumberRow(file, "ratio, largest", ratio->max);
  if (result->cell_size == 3) PrintNumberRow(file, "angle error, mean, degrees", result->angle_mean);
  if (result->cell_size == 3) PrintNumberRow(file, "angle error, median, degrees", result->angle_median);
  PrintNumberRow(file, "folds", (PetscReal)result->folds);
  PrintNumberRow(file, "iterations", (PetscReal)result->iterations);
  PrintNumberRow(file, "seconds", result->seconds);
  EqmAtomicPrint(file, "</table>\n");
}

static void PrintProvenance(EqmAtomicFile *file, const EqmResult *result)
{
  EqmAtomicPrint(file, "<h2>Where it came from</h2>\n<table>\n");
  PrintTextRow(file, "mesh", result->mesh_file);
  if (result->other_file[0]) PrintTextRow(file, "registered with", result->other_file);
  PrintTextRow(file, "command", result->command);
  PrintTextRow(file, "method", result->method);
  PrintTextRow(file, "status", result->status);
  PrintTextRow(file, "message", result->message);
  PrintTextRow(file, "options", result->options);
  PrintNumberRow(file, "ranks", (PetscReal)result->ranks);
  PrintNumberRow(file, "threads", (PetscReal)result->threads);
  PrintTextRow(file, "equimap", result->version);
  PrintTextRow(file, "commit", result->commit);
  PrintTextRow(file, "date", result->date);
  EqmAtomicPrint(file, "</table>\n");
}

static void PrintHistory(EqmAtomicFile *file, const EqmResult *result)
{
  if (result->num_history == 0) return;
  EqmAtomicPrint(
      file,
      "<details><summary>History</summary>\n<table>\n<tr><td>iteration</td><td>energy</td><td>seconds</td></tr>\n");
  for (PetscInt k = 0; k < result->num_history; k++) {
    EqmAtomicPrint(file, "<tr><td>%.0f</td><td>", result->iteration[k]);
    EqmAtomicPrintReals(file, 1, &result->energy[k], ' ');
    EqmAtomicPrint(file, "</td><td>%.3f</td></tr>\n", result->elapsed[k]);
  }
  EqmAtomicPrint(file, "</table></details>\n");
}

/* Write the report for a browser, the picture inside. Not collective. */
PetscErrorCode EqmWriteHtml(const EqmResult *result, int width, EqmAtomicFile *file, cairo_status_t *status)
{
  Encoder encoder = {file, {0, 0, 0}, 0};

  PetscFunctionBegin;
  PrintHead(file, result);
  EqmAtomicPrint(file, "<img alt=\"the surface, its image and the convergence\" src=\"data:image/png;base64,");
  PetscCall(EqmPageToPng(result, width, Encode, &encoder, status));
  Flush(&encoder);
  EqmAtomicPrint(file, "\">\n");
  PrintNumbers(file, result);
  PrintProvenance(file, result);
  PrintHistory(file, result);
  EqmAtomicPrint(file, "</body></html>\n");
  PetscFunctionReturn(0);
}
#endif
