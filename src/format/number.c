/* Decimal numbers, fast and in every locale, with the very bits that strtod gives. */
#define _GNU_SOURCE
#include "input.h"

#include <float.h>
#include <locale.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Digits of a number: `mantissa` times ten to the `exponent`. */
typedef struct {
  uint64_t mantissa;
  int exponent;
  PetscBool exact; /* mantissa and exponent hold all that is written */
} Decimal;

#define MAX_EXPONENT 100000 /* beyond what any double has; keeps the sum of exponents from overflowing */

/* Powers of ten that both double and an extended format of 64 bits hold exactly. */
static const double power_of_ten[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                      1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
#if LDBL_MANT_DIG >= 64
static const long double long_power_of_ten[] = {1e0L,  1e1L,  1e2L,  1e3L,  1e4L,  1e5L,  1e6L,  1e7L,  1e8L,  1e9L,
                                                1e10L, 1e11L, 1e12L, 1e13L, 1e14L, 1e15L, 1e16L, 1e17L, 1e18L, 1e19L,
                                                1e20L, 1e21L, 1e22L, 1e23L, 1e24L, 1e25L, 1e26L, 1e27L};
#endif

static inline PetscBool IsDigit(char c)
{
  return c >= '0' && c <= '9' ? PETSC_TRUE : PETSC_FALSE;
}

/* The digits before (`after_point` = 0) or after the decimal point (1). */
static inline const char *ScanDigits(const char *text, const char *end, int after_point, Decimal *number)
{
  for (; text < end && IsDigit(*text); ++text) {
    if (number->mantissa < UINT64_C(1000000000000000000)) {
      number->mantissa = 10 * number->mantissa + (uint64_t)(*text - '0');
      number->exponent -= after_point;
    } else { /* 19 digits are there already */
      if (*text != '0') number->exact = PETSC_FALSE;
      if (!after_point) ++number->exponent;
    }
    if (number->exponent <= -MAX_EXPONENT || number->exponent >= MAX_EXPONENT) {
      number->exponent += after_point ? 1 : -1;
      number->exact = PETSC_FALSE;
    }
  }
  return text;
}

static const char *ScanExponent(const char *text, const char *end, Decimal *number)
{
  const char *c = text + 1;
  int sign = 1, value = 0;

  if (c < end && (*c == '+' || *c == '-')) sign = *c++ == '-' ? -1 : 1;
  if (c == end || !IsDigit(*c)) return text; /* an e that belongs to something else */
  for (; c < end && IsDigit(*c); ++c) {
    if (value < MAX_EXPONENT) value = 10 * value + (*c - '0');
  }
  if (value >= MAX_EXPONENT) number->exact = PETSC_FALSE;
  number->exponent += sign * value;
  return c;
}

/* Round mantissa times ten to the exponent to a double where that is certain. */
static PetscBool RoundFast(const Decimal *number, double *value)
{
  const uint64_t w = number->mantissa;
  const int e = number->exponent;

  if (w == 0) {
    *value = 0.0;
    return PETSC_TRUE;
  }
  if (!number->exact) return PETSC_FALSE;
  if (w <= (UINT64_C(1) << 53) && e >= -22 && e <= 22) { /* both factors exact: one rounding */
    *value = e < 0 ? (double)w / power_of_ten[-e] : (double)w * power_of_ten[e];
    return PETSC_TRUE;
  }
#if LDBL_MANT_DIG >= 64
  if (e >= -27 && e <= 27) { /* wrong by half a unit in the 64th bit at most: does that leave the 53rd in doubt? */
    long double wide = e < 0 ? (long double)w / long_power_of_ten[-e] : (long double)w * long_power_of_ten[e];
    long double doubt = wide * 0x1p-63L;

    *value = (double)(wide - doubt);
    return *value == (double)(wide + doubt) ? PETSC_TRUE : PETSC_FALSE;
  }
#endif
  return PETSC_FALSE;
}

/* The C library's slow and exact way, in the C locale. */
static double RoundExactly(const char *text, size_t length)
{
  char small[128], *copy = length < sizeof(small) ? small : malloc(length + 1);
  locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  double value = NAN;

  if (copy && c_locale) {
    memcpy(copy, text, length);
    copy[length] = '\0';
    value = strtod_l(copy, NULL, c_locale);
  }
  if (c_locale) freelocale(c_locale);
  if (copy != small) free(copy);
  return value;
}

/* nan, inf and infinity in any case, and the nan(...) of some C libraries. */
static const char *ScanSpecial(const char *text, const char *end, double *value)
{
  const size_t length = (size_t)(end - text);

  if (length >= 3 && !strncasecmp(text, "nan", 3)) {
    const char *close = length > 3 && text[3] == '(' ? memchr(text, ')', length < 32 ? length : 32) : NULL;
    *value = NAN;
    return close ? close + 1 : text + 3;
  }
  if (length < 3 || strncasecmp(text, "inf", 3)) return NULL;
  *value = INFINITY;
  return length >= 8 && !strncasecmp(text, "infinity", 8) ? text + 8 : text + 3;
}

/* EqmParseReal - read a decimal number, nan or inf at the beginning of [text, end). Not collective. Returns the end of
   the number, or NULL if there is none. The bits are those of strtod in the C locale. */
const char *EqmParseReal(const char *text, const char *end, PetscReal *value)
{
  Decimal number = {0, 0, PETSC_TRUE};
  PetscBool negative = text < end && *text == '-' ? PETSC_TRUE : PETSC_FALSE;
  const char *first = text < end && (*text == '-' || *text == '+') ? text + 1 : text, *next, *point;
  double magnitude = 0;

  next = point = ScanDigits(first, end, 0, &number);
  if (next < end && *next == '.') next = ScanDigits(next + 1, end, 1, &number);
  if (next - first <= (point < next ? 1 : 0)) { /* no digit on either side of the point */
    next = ScanSpecial(first, end, &magnitude);
    if (!next) return NULL;
  } else {
    if (next < end && (*next == 'e' || *next == 'E')) next = ScanExponent(next, end, &number);
    if (!RoundFast(&number, &magnitude)) magnitude = RoundExactly(first, (size_t)(next - first));
  }
  *value = negative ? -magnitude : magnitude;
  return next;
}

/* EqmParseInteger - read a whole number of at most 18 digits at the beginning of [text, end). Not collective. Returns
   the end of the number, or NULL if there is none. */
const char *EqmParseInteger(const char *text, const char *end, PetscInt64 *value)
{
  PetscBool negative = text < end && *text == '-' ? PETSC_TRUE : PETSC_FALSE;
  const char *first = text < end && (*text == '-' || *text == '+') ? text + 1 : text, *c = first;
  PetscInt64 magnitude = 0;

  for (; c < end && IsDigit(*c); ++c) {
    if (magnitude > INT64_C(99999999999999999)) return NULL;
    magnitude = 10 * magnitude + (*c - '0');
  }
  if (c == first) return NULL;
  *value = negative ? -magnitude : magnitude;
  return c;
}
