/* Text on a page; formatted numbers. */
#ifdef EQM_HAVE_CAIRO
#include "picture/plot.h"
#include <libxml/xmlstring.h>
#include <math.h>
#include <string.h>

void EqmSetInk(cairo_t *page, EqmInk ink)
{
  static const double inks[EQM_NUM_INKS][3] = {{0.13, 0.14, 0.16}, {0.42, 0.44, 0.47}, {0.88, 0.89, 0.90},
                                               {0.13, 0.40, 0.67}, {0.84, 0.42, 0.11}, {0.00, 0.55, 0.45},
                                               {0.58, 0.28, 0.62}, {0.35, 0.68, 0.90}, {0.80, 0.65, 0.00},
                                               {0.50, 0.30, 0.20}};

  cairo_set_source_rgb(page, inks[ink][0], inks[ink][1], inks[ink][2]);
}

EqmInk EqmInkOf(PetscInt number)
{
  static const EqmInk inks[EQM_MOST_RESULTS] = {EQM_BLUE, EQM_ORANGE, EQM_GREEN, EQM_VIOLET,
                                                EQM_SKY,  EQM_YELLOW, EQM_BROWN, EQM_INK};

  return inks[number % EQM_MOST_RESULTS];
}

static void SelectFont(cairo_t *page, double size, PetscBool bold)
{
  cairo_select_font_face(page, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(page, size);
}

/* Text from outside may hold anything, and cairo gives up a whole page for one byte that is not UTF-8. */
static void Clean(const char *text, char *clean, size_t length)
{
  const int valid = xmlCheckUTF8((const unsigned char *)text);
  size_t used = 0;

  for (const char *c = text; *c && used + 1 < length; c++) {
    const unsigned char byte = (unsigned char)*c;
    clean[used++] = byte < 0x20 ? ' ' : (char)(byte >= 0x80 && !valid ? '?' : byte);
  }
  while (valid && used > 0 && text[used] && ((unsigned char)text[used] & 0xC0) == 0x80)
    used--; /* cut between letters */
  clean[used] = '\0';
}

/* How wide a text is. Not collective. */
double EqmTextWidth(cairo_t *page, double size, PetscBool bold, const char *text)
{
  cairo_text_extents_t extents;

  SelectFont(page, size, bold);
  cairo_text_extents(page, text, &extents);
  return extents.x_advance;
}

/* Write a line of text with its baseline at y. Not collective. */
void EqmDrawText(cairo_t *page, double x, double y, double size, PetscBool bold, EqmAlignment alignment, EqmInk ink,
                 const char *text)
{
  char clean[512];
  double width;

  Clean(text, clean, sizeof(clean));
  width = EqmTextWidth(page, size, bold, clean);
  EqmSetInk(page, ink);
  cairo_move_to(page, x - (alignment == EQM_LEFT ? 0.0 : alignment == EQM_CENTER ? 0.5 * width : width), y);
  cairo_show_text(page, clean);
}

/* A power of ten with its exponent raised. */
static void AppendPower(int exponent, char *text, size_t length)
{
  static const char *const raised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  char digits[16];

  (void)snprintf(digits, sizeof(digits), "%d", exponent < 0 ? -exponent : exponent);
  (void)PetscStrlcat(text, exponent < 0 ? "10⁻" : "10", length);
  for (const char *d = digits; *d; d++) (void)PetscStrlcat(text, raised[*d - '0'], length);
}

/* Three or four digits: 0.0314, 2.51, 4.77×10⁻³, 10⁻⁴; a dash for what is not known. Not collective. */
void EqmNumberText(double value, char *text, size_t length)
{
  const double size = fabs(value);
  int exponent;
  double mantissa;

  if (!isfinite(value)) {
    (void)snprintf(text, length, "–");
  } else if (size == 0.0 || (size >= 0.01 && size < 1e5)) {
    (void)snprintf(text, length, "%.*g", size >= 1000 ? 5 : 4, value);
  } else {
    exponent = (int)floor(log10(size));
    mantissa = value / pow(10.0, exponent);
    if (fabs(mantissa) >= 9.9995) mantissa /= 10.0, exponent++;
    if (fabs(mantissa - 1.0) < 5e-5)
      (void)snprintf(text, length, "%s", "");
    else
      (void)snprintf(text, length, "%.4g×", mantissa);
    AppendPower(exponent, text, length);
  }
}

/* A power of ten as such. Not collective. */
void EqmPowerText(double value, char *text, size_t length)
{
  text[0] = '\0';
  AppendPower((int)lround(log10(value)), text, length);
}

/* A count with thin spaces between the thousands. Not collective. */
void EqmCountText(PetscInt64 count, char *text, size_t length)
{
  char digits[32];
  size_t used;

  (void)snprintf(digits, sizeof(digits), "%" PetscInt64_FMT, count);
  used = strlen(digits);
  text[0] = '\0';
  for (size_t k = 0; k < used; k++) {
    const char digit[2] = {digits[k], '\0'};
    (void)PetscStrlcat(text, digit, length);
    if (k + 1 < used && (used - k - 1) % 3 == 0 && digits[k] != '-') (void)PetscStrlcat(text, "\u2009", length);
  }
}
#endif
