/* Bytes of a file, changed at random: the same changes for the same state. */
#ifndef EQM_MUTATE_H
#define EQM_MUTATE_H

#include <stdint.h>
#include <string.h>

static uint64_t MutateRandom(uint64_t *state)
{
  *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return *state >> 33;
}

/* Change a few bytes: to anything, to a digit, by one bit; or put a large number, or take a piece away. Returns the new
   length. */
static size_t Mutate(char *bytes, size_t length, uint64_t *state)
{
  static const char *const numbers[] = {"99999999999999999999", "-1", "4294967295", "1e999", "0", "\377\377\377\377",
                                        "\377\377\377\177"};
  const int changes = 1 + (int)(MutateRandom(state) % 3);

  for (int i = 0; i < changes && length > 1; ++i) {
    const size_t at = MutateRandom(state) % length;
    const char *number = numbers[MutateRandom(state) % 7];

    switch (MutateRandom(state) % 5) {
    case 0:
      bytes[at] = (char)MutateRandom(state);
      break;
    case 1:
      bytes[at] = (char)('0' + MutateRandom(state) % 10);
      break;
    case 2:
      bytes[at] = (char)(bytes[at] ^ 1 << MutateRandom(state) % 8);
      break;
    case 3:
      for (size_t k = 0; number[k] && at + k < length; ++k) bytes[at + k] = number[k];
      break;
    default:
      memmove(bytes + at, bytes + at + 1, length - at - 1);
      --length;
    }
  }
  return length;
}

#endif
