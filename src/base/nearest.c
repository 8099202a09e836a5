#include "base/nearest.h"
#include <ctype.h>
#include <string.h>

enum { LONGEST_WORD = 63 };

/* The Damerau-Levenshtein distance of two words, each letter moved once at most. Longer words are cut. */
static int Distance(const char *a, const char *b)
{
  int d[LONGEST_WORD + 1][LONGEST_WORD + 1];
  const int na = (int)strnlen(a, LONGEST_WORD), nb = (int)strnlen(b, LONGEST_WORD);

  for (int i = 0; i <= na; i++) d[i][0] = i;
  for (int j = 0; j <= nb; j++) d[0][j] = j;
  for (int i = 1; i <= na; i++) {
    for (int j = 1; j <= nb; j++) {
      const int x = tolower((unsigned char)a[i - 1]), y = tolower((unsigned char)b[j - 1]);

      d[i][j] = PetscMin(PetscMin(d[i - 1][j], d[i][j - 1]) + 1, d[i - 1][j - 1] + (x != y));
      if (i > 1 && j > 1 && x == tolower((unsigned char)b[j - 2]) && y == tolower((unsigned char)a[i - 2]))
        d[i][j] = PetscMin(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[na][nb];
}

const char *EqmNearestName(const char *word, const char *const names[], int num)
{
  const char *nearest = NULL;
  int least = 1 + (int)strlen(word) / 3;

  for (int k = 0; k < num; k++) {
    const int distance = Distance(word, names[k]);
    if (distance > least || (nearest && distance == least)) continue;
    nearest = names[k];
    least = distance;
  }
  return nearest;
}

PetscErrorCode EqmDidYouMean(const char *word, const char *const names[], int num, char *text, size_t length)
{
  const char *const nearest = EqmNearestName(word, names, num);

  PetscFunctionBegin;
  text[0] = '\0';
  if (nearest) PetscCall(PetscSNPrintf(text, length, " (did you mean %s?)", nearest));
  PetscFunctionReturn(0);
}
