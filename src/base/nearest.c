#include "base/nearest.h"
#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { LONGEST_WORD = 63 };

/* The Damerau-Levenshtein distance of two words, each letter moved once at most. Longer words are cut. */
static int Distance(const char *a, int na, const char *b, int nb)
{
  int d[LONGEST_WORD + 1][LONGEST_WORD + 1];

  na = PetscMin(na, LONGEST_WORD);
  nb = PetscMin(nb, LONGEST_WORD);
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

PetscErrorCode EqmDidYouMean(const char *word, const char *names, char *text, size_t length)
{
  const int word_length = (int)strlen(word);
  int least = 2 + word_length / 3, near_length = 0;
  const char *near = NULL;

  PetscFunctionBegin;
  for (const char *name = names + strspn(names, " ,"); *name; name += strspn(name, " ,")) {
    const int name_length = (int)strcspn(name, " ,"), distance = Distance(word, word_length, name, name_length);

    if (distance < least) {
      near = name;
      near_length = name_length;
      least = distance;
    }
    name += name_length;
  }
  text[0] = '\0';
  if (near) (void)snprintf(text, length, " (did you mean %.*s?)", near_length, near);
  PetscFunctionReturn(0);
}
