/* The figures of the results of a page, one below the other, a column per result. */
#ifdef EQM_HAVE_CAIRO
#include "picture/page.h"
#include "picture/figures.h"
#include <string.h>

static const double row_height = 21.0;

/* The rows that say something of at least one result. */
static int RowsOf(const EqmPage *page, int rows[EQM_MOST_FIGURES])
{
  int count = 0;

  for (int f = 0; f < EqmNumFigures(); f++) {
    for (PetscInt k = 0; k < page->num; k++) {
      char text[EQM_FIGURE_TEXT_LENGTH];
      EqmFigureText(&page->results[k], f, text, sizeof(text));
      if (!text[0]) continue;
      rows[count++] = f;
      break;
    }
  }
  return count;
}

double EqmTableHeight(const EqmPage *page)
{
  int rows[EQM_MOST_FIGURES];

  return row_height * (RowsOf(page, rows) + (page->num > 1));
}

static void DrawLine(cairo_t *cairo, EqmBox box, double y)
{
  cairo_set_line_width(cairo, 1.0);
  EqmSetInk(cairo, EQM_PALE);
  cairo_move_to(cairo, box.x, y + 6.5);
  cairo_line_to(cairo, box.x + box.width, y + 6.5);
  cairo_stroke(cairo);
}

void EqmDrawTable(cairo_t *cairo, const EqmPage *page, EqmBox box)
{
  const double names = page->num > 1 ? 260.0 : 0.0, column = (box.width - names) / page->num;
  int rows[EQM_MOST_FIGURES];
  const int count = RowsOf(page, rows);
  double y = box.y + 10;

  for (PetscInt k = 0; k < page->num && page->num > 1; k++) {
    char number[16];
    (void)snprintf(number, sizeof(number), "%d", (int)k + 1);
    EqmDrawText(cairo, box.x + names + (k + 1) * column, y, 13, PETSC_TRUE, EQM_RIGHT, EqmInkOf(k), number);
  }
  if (page->num > 1) y += row_height;
  for (int r = 0; r < count; r++) {
    EqmDrawText(cairo, box.x, y, 13, PETSC_FALSE, EQM_LEFT, EQM_GREY, EqmFigureName(&page->results[0], rows[r]));
    for (PetscInt k = 0; k < page->num; k++) {
      char text[EQM_FIGURE_TEXT_LENGTH];
      EqmFigureText(&page->results[k], rows[r], text, sizeof(text));
      EqmDrawText(cairo, box.x + names + (k + 1) * column, y, 13, PETSC_TRUE, EQM_RIGHT, EQM_INK, text);
    }
    DrawLine(cairo, box, y);
    y += row_height;
  }
}
#endif
