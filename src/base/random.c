#include "base/random.h"

PetscReal EqmHashUniform(PetscInt seed, PetscInt index, PetscInt channel)
{
  /* splitmix64 over the three numbers, one after the other */
  PetscInt64 part[3] = {seed, index, channel};
  uint64_t x = 0x9e3779b97f4a7c15u;

  for (int i = 0; i < 3; i++) {
    x += (uint64_t)part[i] + 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    x ^= x >> 31;
  }
  return (PetscReal)(x >> 11) * (1.0 / 9007199254740992.0);
}
